//! From the file's values to a scenario that can be run: every rule in one place, every fault at once.

mod expect;
mod origin;
mod rows;

use asami_dataset::parameters::{Fault, Parameter, Parameters};

use super::wire::Wire;
use super::{Scenario, Study};

pub use origin::effects_fit;

const fn number(name: &'static str, unit: &'static str, range: (f64, f64)) -> Parameter {
    Parameter { name, unit, default: 0.0, range, whole: false, about: "" }
}

/// An hour: longer logs do not fit the house's memory.
const DURATION: Parameter = number("duration_s", "s", (1.0, 3600.0));

/// Checks everything; `None` only with at least one fault.
pub fn scenario(name: &str, wire: Wire, faults: &mut Vec<Fault>) -> Option<Scenario> {
    if wire.about.trim().is_empty() {
        fault(faults, "about", "about must state the question that the scenario asks, not nothing");
    }
    wire.divergence.check("divergence", faults);
    let origin = origin::origin(&wire, faults);
    wire.learners.check("learners", faults);
    let rows = rows::rows(&wire, origin.as_ref(), faults);
    let starting = wire.starting.clone().unwrap_or_default();
    starting.check("starting", faults);
    if wire.starting.is_some() && !matches!(wire.study, Study::Plane | Study::Stride) {
        let study = wire.study.name();
        let message = format!("starting belongs to studies \"plane\" and \"stride\"; this one's is \"{study}\"");
        fault(faults, "starting", message);
    }
    for (i, expect) in wire.expect.iter().enumerate() {
        expect::expectation(i, expect, wire.study, &rows, faults);
    }
    let Wire { about, study, learners, divergence, expect, .. } = wire;
    let name = name.to_owned();
    Some(Scenario { name, about, study, origin: origin?, rows, learners, starting, divergence, expect })
}

fn fault(faults: &mut Vec<Fault>, path: &str, message: impl Into<String>) {
    faults.push(Fault { path: path.to_owned(), message: message.into() });
}
