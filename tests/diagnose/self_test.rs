//! `diagnose --self-test`.

use crate::{Bench, kept_library, said};

/// As many cases as are asked for are planted, and every one is counted; a second run counts the same.
#[test]
fn a_self_test_counts_every_case_it_plants() {
    let bench = Bench::new();
    let log = bench.log("nominal", "1006", &[]);
    let runs = ["first", "second"].map(|out| bench.diagnose_with(&kept_library(), &log, out, &["--self-test=4"]));
    for run in &runs {
        assert_eq!(run.status.code(), Some(0), "{}", said(&run.stderr));
    }
    let text = said(&runs[0].stdout);
    assert!(text.contains("of 4 in the 90 % set"), "{text}");
    let counted = |what: &str| -> usize {
        let after = text.split(what).nth(1).and_then(|rest| rest.split(" of ").nth(1));
        after.and_then(|rest| rest.split_whitespace().next()).map_or(0, |n| n.parse().expect("a number"))
    };
    let cases = ["no effect planted", "one effect planted", "two effects planted"].map(counted);
    assert_eq!(cases.iter().sum::<usize>(), 4, "{text}");
    assert_eq!(runs[0].stdout, runs[1].stdout);
}
