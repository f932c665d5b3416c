//! What other robots of a make have, by the answers that were written of their logs.

use std::path::Path;

use asami_gap::Diagnosis;
use asami_gap::answer::diagnosis::SCHEMA;
use asami_gap::real::kin::Kin;
use miette::Report;

/// Reads a `diagnosis.json` of each of them.
///
/// # Errors
/// Which file is none, and why.
pub fn read(paths: &[impl AsRef<Path>]) -> Result<Kin, Report> {
    let others: Vec<Diagnosis> = paths.iter().map(|path| one(path.as_ref())).collect::<Result<_, _>>()?;
    Ok(Kin::of(&others))
}

fn one(path: &Path) -> Result<Diagnosis, Report> {
    let shown = path.display();
    let text = std::fs::read_to_string(path).map_err(|error| miette::miette!("cannot read {shown}: {error}"))?;
    let found: Diagnosis = serde_json::from_str(&text)
        .map_err(|error| miette::miette!("{shown}: {error}: must be what `diagnose` writes as diagnosis.json"))?;
    if found.schema != SCHEMA {
        return Err(miette::miette!("{shown}: schema must be {SCHEMA}, not {}", found.schema));
    }
    if let Some(cause) = found.which.iter().find(|cause| !(0.0..=1.0).contains(&cause.probability)) {
        let (effects, probability) = (cause.effects.join("+"), cause.probability);
        return Err(miette::miette!("{shown}: the probability of {effects} must lie in 0..=1, not {probability}"));
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said_of(text: &str) -> String {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("diagnosis.json");
        std::fs::write(&path, text).unwrap();
        read(&[path]).map_or_else(|error| format!("{error}"), |kin| format!("{:.3}", kin.against_nats("wheel_lag")))
    }

    #[test]
    fn what_is_no_answer_is_refused_by_file_line_and_value() {
        let mut whole = Diagnosis::flat(&[]);
        let of = |it: &Diagnosis| serde_json::to_string_pretty(it).unwrap();
        // One robot of which it is not named.
        assert_eq!(said_of(&of(&whole)), format!("{:.3}", ((1.0 + 10.0 / 11.0) * 11.0_f64).ln()));
        whole.which[0].probability = 1.5;
        assert!(said_of(&of(&whole)).contains("must lie in 0..=1, not 1.5"));
        whole.schema += 1;
        assert!(said_of(&of(&whole)).contains("schema must be"));
        assert!(said_of("{\n\"schema\": no").contains("line 2 column"));
        assert!(read(&["no/such.json"]).unwrap_err().to_string().contains("cannot read no/such.json"));
    }
}
