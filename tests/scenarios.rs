//! Scenario files: the shipped ones are read, broken ones are refused with file, line, rule and value.

use std::path::Path;

use asami::scenario;

fn shown(bad: scenario::Bad) -> String {
    let handler = miette::GraphicalReportHandler::new_themed(miette::GraphicalTheme::none());
    let mut out = String::new();
    handler.render_report(&mut out, &bad).expect("writing to memory");
    out
}

#[test]
fn every_shipped_scenario_is_read() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios");
    let mut read = 0;
    for entry in std::fs::read_dir(folder).expect("the folder is there") {
        let path = entry.expect("readable").path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            read += 1;
            if let Err(bad) = scenario::read(&path) {
                panic!("{}", shown(bad));
            }
        }
    }
    assert!(read > 0);
}
