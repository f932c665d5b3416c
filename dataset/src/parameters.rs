//! Parameters declared once: type, default, unit and range together with the field.
//!
//! [`parameters!`](crate::parameters!) makes a struct that TOML can read (unknown keys are errors, missing keys take the
//! default), and the table that range checks, `--effect NAME.PARAM=VALUE`, `list` and the
//! documentation are made from.

/// What a table of parameters says about one of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Key in TOML; carries the unit as a suffix.
    pub name: &'static str,
    /// Unit, `"1"` for a pure number.
    pub unit: &'static str,
    /// Value where none is given; of an effect, the value at which it does nothing.
    pub default: f64,
    /// Least and greatest value allowed.
    pub range: (f64, f64),
    /// Whether only whole numbers are.
    pub whole: bool,
    /// What it is.
    pub about: &'static str,
}

/// A value outside its range.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Keys from the file's root to the value, joined by dots.
    pub path: String,
    /// The rule and the value.
    pub message: String,
}

/// A table whose values can be checked, listed and set by name.
pub trait Parameters {
    /// The parameters, in the order of declaration.
    fn table() -> &'static [Parameter]
    where
        Self: Sized;
    /// Their values, in the same order.
    fn values(&self) -> Vec<f64>;
    /// Sets one by name; `false`, and nothing is set, if there is none of that name or its type cannot hold the value.
    fn set(&mut self, name: &str, value: f64) -> bool;
    /// Adds a fault for every value out of range; `path` is the table's own place in the file.
    fn check(&self, path: &str, faults: &mut Vec<Fault>);
}

/// The fault of `value` under `parameter`, if any.
#[must_use]
pub fn out_of_range(path: &str, parameter: &Parameter, value: f64) -> Option<Fault> {
    let (least, greatest) = parameter.range;
    let name = parameter.name;
    let message = if !(least..=greatest).contains(&value) {
        let unit = if parameter.unit == "1" { String::new() } else { format!(" {}", parameter.unit) };
        format!("{name} must lie in {least}..={greatest}{unit}, not {value}")
    } else if parameter.whole && value.fract() != 0.0 {
        format!("{name} must be a whole number, not {value}")
    } else {
        return None;
    };
    Some(Fault { path: format!("{path}.{name}"), message })
}

/// Declares a struct of numbers with defaults, units and ranges.
///
/// ```
/// asami_dataset::parameters! {
///     /// A spring.
///     pub struct Spring {
///         /// How stiff it is.
///         stiffness_n_per_m: f64 = 10.0, "N/m", 0.0..=100.0;
///         /// How many turns it has.
///         turns: u32 = 5, "1", 1.0..=50.0;
///     }
/// }
/// use asami_dataset::parameters::Parameters;
/// let mut spring = Spring::default();
/// assert!(spring.set("stiffness_n_per_m", 200.0));
/// assert!(!spring.set("turns", 1.5) && !spring.set("turns", -1.0) && spring.turns == 5);
/// let mut faults = Vec::new();
/// spring.check("body.spring", &mut faults);
/// assert_eq!(faults[0].path, "body.spring.stiffness_n_per_m");
/// assert_eq!(faults[0].message, "stiffness_n_per_m must lie in 0..=100 N/m, not 200");
/// ```
#[macro_export]
macro_rules! parameters {
    ($(#[$meta:meta])* pub struct $T:ident {
        $($(#[doc = $about:literal])* $name:ident: $type:ident = $default:literal, $unit:literal, $least:literal..=$greatest:literal;)*
    }) => {
        $(#[$meta])*
        #[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields, default)]
        pub struct $T { $($(#[doc = $about])* #[doc = concat!("Unit: ", $unit, "; default ", stringify!($default), ".")] pub $name: $type,)* }
        impl Default for $T {
            fn default() -> Self { Self { $($name: $default),* } }
        }
        impl $crate::parameters::Parameters for $T {
            fn table() -> &'static [$crate::parameters::Parameter] {
                const TABLE: &[$crate::parameters::Parameter] = &[$($crate::parameters::Parameter {
                    name: stringify!($name), unit: $unit, default: $default as f64, range: ($least, $greatest),
                    whole: (0.5 as $type) as f64 != 0.5, about: concat!($($about),*),
                }),*];
                TABLE
            }
            fn values(&self) -> Vec<f64> { vec![$(self.$name as f64),*] }
            fn set(&mut self, name: &str, value: f64) -> bool {
                match name {
                    $(stringify!($name) => {
                        let held = value as $type;
                        let whole = held as f64 == value;
                        if whole { self.$name = held; }
                        whole
                    })*
                    _ => false,
                }
            }
            fn check(&self, path: &str, faults: &mut Vec<$crate::parameters::Fault>) {
                let values = <Self as $crate::parameters::Parameters>::values(self);
                for (parameter, value) in <Self as $crate::parameters::Parameters>::table().iter().zip(values) {
                    faults.extend($crate::parameters::out_of_range(path, parameter, value));
                }
            }
        }
    };
}

/// Declares a struct of tables of parameters, as a robot has in a scenario, and of keys beside them that are no numbers.
/// A rule that concerns several numbers follows as a function of the same arguments as `check`.
///
/// ```
/// asami_dataset::parameters! {
///     /// A spring.
///     pub struct Spring {
///         /// How stiff it is.
///         stiffness_n_per_m: f64 = 10.0, "N/m", 0.0..=100.0;
///     }
/// }
/// asami_dataset::tables! {
///     /// A suspension.
///     pub struct Suspension {
///         /// At the front wheels.
///         front: Spring;
///         /// At the rear wheels.
///         rear: Spring;
///     }
///     keys {
///         /// Who made it.
///         maker: String;
///     }
/// }
/// let mut suspension = Suspension::default();
/// suspension.rear.stiffness_n_per_m = 200.0;
/// let mut faults = Vec::new();
/// suspension.check("car.suspension", &mut faults);
/// assert_eq!(faults[0].path, "car.suspension.rear.stiffness_n_per_m");
/// assert_eq!(Suspension::tables().map(|(name, _)| name), ["front", "rear"]);
/// ```
#[macro_export]
macro_rules! tables {
    (
        $(#[$meta:meta])* pub struct $T:ident { $($(#[doc = $about:literal])* $name:ident: $table:ident;)* }
        $(keys { $($(#[doc = $about_key:literal])* $key:ident: $type:ident;)* })?
        $(rule $rule:ident)?
    ) => {
        $(#[$meta])*
        #[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields, default)]
        pub struct $T {
            $($($(#[doc = $about_key])* pub $key: $type,)*)?
            $($(#[doc = $about])* pub $name: $table,)*
        }
        impl $T {
            /// The tables' names and parameters, for the catalogue.
            #[must_use]
            pub fn tables() -> [(&'static str, &'static [$crate::parameters::Parameter]); [$(stringify!($name)),*].len()] {
                [$((stringify!($name), <$table as $crate::parameters::Parameters>::table())),*]
            }

            /// Adds a fault for every value that breaks a rule; `path` is the table's own place in the file.
            pub fn check(&self, path: &str, faults: &mut Vec<$crate::parameters::Fault>) {
                $($crate::parameters::Parameters::check(&self.$name, &format!("{path}.{}", stringify!($name)), faults);)*
                $($rule(self, path, faults);)?
            }
        }
    };
}
