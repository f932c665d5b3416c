//! The catalogue of effects: one file and one row each.

pub mod command_delay;
pub mod command_scale;
pub mod ground_friction;

use asami_dataset::parameters::{Fault, Parameters};

use crate::effect::{About, Effect};

/// Makes the `[effects]` table and everything that walks it out of one list.
macro_rules! effects {
    ($($name:ident => $T:ident),* $(,)?) => {
        /// The `[effects]` table of a scenario: an effect is on where its table stands.
        #[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields, default)]
        pub struct Effects {
            $(#[doc = concat!("`[effects.", stringify!($name), "]`")]
              #[serde(skip_serializing_if = "Option::is_none")]
              pub $name: Option<$name::$T>,)*
        }

        /// Every effect there is, in the order in which they act.
        #[must_use]
        pub fn catalogue() -> Vec<&'static About> {
            vec![$($name::$T::about()),*]
        }

        impl Effects {
            /// The effects that are on, in the catalogue's order.
            pub fn iter(&self) -> impl Iterator<Item = &dyn Effect> {
                [$(self.$name.as_ref().map(|effect| effect as &dyn Effect)),*].into_iter().flatten()
            }

            /// Sets one parameter, switching its effect on; `false` if there is no such parameter.
            pub fn set(&mut self, name: &str, parameter: &str, value: f64) -> bool {
                match name {
                    $(stringify!($name) => self.$name.get_or_insert_default().set(parameter, value),)*
                    _ => false,
                }
            }

            /// The same effects less one.
            #[must_use]
            pub fn without(&self, name: &str) -> Self {
                let mut rest = self.clone();
                match name { $(stringify!($name) => rest.$name = None,)* _ => {} }
                rest
            }

            /// Adds a fault for every parameter out of range.
            pub fn check(&self, path: &str, faults: &mut Vec<Fault>) {
                $(if let Some(effect) = &self.$name {
                    effect.check(&format!("{path}.{}", stringify!($name)), faults);
                })*
            }
        }
    };
}

effects! {
    command_delay => CommandDelay,
    command_scale => CommandScale,
    ground_friction => GroundFriction,
}
