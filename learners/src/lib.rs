//! Pure algorithms that learn sensor and action models from a log: no physics, no files, no clock,
//! no printing.
//!
//! The list at the end of this file is the table of contents: one file and one row per learner.

pub mod action_from_sensor;
pub mod algorithm1;
mod augmented;
pub mod batch;
pub mod canonical;
pub mod car_alternating;
pub mod car_best;
pub mod car_graph;
pub mod car_lines;
pub mod car_published;
pub mod car_registered;
pub mod car_sides;
pub mod degree_selection;
pub mod dual_ekf;
pub mod em;
pub mod em_1d_published;
pub mod em_best;
pub mod em_exact;
pub mod em_head;
pub mod em_iterated;
pub mod em_noise;
pub mod em_published;
pub mod em_robust;
pub mod em_rts;
pub mod em_shared;
pub mod em_squarem;
pub mod joint_ekf;
pub mod learner;
pub mod lidar;
pub mod likelihood;
pub mod line;
pub mod plane;
pub mod sensor_constant_action;
pub mod sensor_from_action;
mod view;

use std::collections::BTreeMap;

use asami_dataset::parameters::{Fault, Parameters, out_of_range};

pub use learner::{About, CannotLearn, Declared, Lack, Learned, Learner, Needs, Step, Trace, Verdict};

/// Makes the `[learners]` table and everything that walks it out of one list.
macro_rules! learners {
    ($($name:ident => $T:ident),* $(,)?) => {
        /// The `[learners]` table of a scenario: parameters of learners, where they differ from the defaults.
        #[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields, default)]
        pub struct Learners {
            $(#[doc = concat!("`[learners.", stringify!($name), "]`")]
              #[serde(skip_serializing_if = "Option::is_none")]
              pub $name: Option<$name::$T>,)*
        }

        /// Every learner there is, in the order of this list.
        #[must_use]
        pub fn catalogue() -> Vec<&'static About> {
            vec![$($name::$T::about()),*]
        }

        impl Learners {
            /// The learner `name` with this table's parameters (defaults where it has none), those in
            /// `with` set on top.
            ///
            /// # Errors
            /// One fault for an unknown learner, and for each unknown parameter and value out of range.
            pub fn configured(&self, name: &str, with: &BTreeMap<String, f64>) -> Result<Box<dyn Learner>, Vec<Fault>> {
                match name {
                    $(stringify!($name) => {
                        let mut learner = self.$name.clone().unwrap_or_default();
                        let path = format!("learners.{name}");
                        let mut faults = Vec::new();
                        for (parameter, value) in with {
                            override_one(&mut learner, &path, parameter, *value, &mut faults);
                        }
                        if faults.is_empty() {
                            learner.check(&path, &mut faults);
                        }
                        if faults.is_empty() { Ok(Box::new(learner)) } else { Err(faults) }
                    })*
                    _ => Err(vec![Fault { path: "learners".into(), message: format!("there is no learner {name}") }]),
                }
            }

            /// Adds a fault for every parameter out of range.
            pub fn check(&self, path: &str, faults: &mut Vec<Fault>) {
                $(if let Some(learner) = &self.$name {
                    learner.check(&format!("{path}.{}", stringify!($name)), faults);
                })*
            }
        }
    };
}

/// Sets one parameter, or says why not.
fn override_one<T: Parameters>(learner: &mut T, path: &str, name: &str, value: f64, faults: &mut Vec<Fault>) {
    let Some(i) = T::table().iter().position(|parameter| parameter.name == name) else {
        faults.push(Fault { path: path.into(), message: format!("there is no parameter {name}") });
        return;
    };
    if let Some(fault) = out_of_range(path, &T::table()[i], value) {
        faults.push(fault);
        return;
    }
    learner.set(name, value);
}

learners! {
    sensor_constant_action => SensorConstantAction,
    sensor_from_action => SensorFromAction,
    action_from_sensor => ActionFromSensor,
    degree_selection => DegreeSelection,
    algorithm1 => Algorithm1,
    canonical => Canonical,
    likelihood => Likelihood,
    em_published => EmPublished,
    em_rts => EmRts,
    em_iterated => EmIterated,
    em_exact => EmExact,
    em_noise => EmNoise,
    em_head => EmHead,
    em_robust => EmRobust,
    em_squarem => EmSquarem,
    em_shared => EmShared,
    em_best => EmBest,
    em_1d_published => Em1dPublished,
    batch => Batch,
    joint_ekf => JointEkf,
    dual_ekf => DualEkf,
    car_published => CarPublished,
    car_graph => CarGraph,
    car_lines => CarLines,
    car_alternating => CarAlternating,
    car_sides => CarSides,
    car_registered => CarRegistered,
    car_best => CarBest,
}
