//! The numbers in the documents are those of the reference results.

use std::path::Path;

#[test]
fn no_document_is_stale() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let documents = asami::splice::documents(root).unwrap();
    let stale: Vec<_> = documents.iter().filter(|document| document.is_stale()).map(|stale| &stale.path).collect();
    assert!(stale.is_empty(), "{stale:?}: run `cargo run --bin splice`");
}
