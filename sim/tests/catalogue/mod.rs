//! Walks over the catalogue of effects, for every suite that holds it against a robot.

use asami_sim::effect::{About, Draw, Way};
use asami_sim::effects::{Effects, catalogue};

/// The parameter that says when an effect begins; by itself it does nothing.
pub const BEGIN: &str = "from_s";

/// One effect with every parameter at its null value.
pub fn null(about: &About) -> Effects {
    let mut effects = Effects::default();
    for parameter in about.parameters {
        assert!(effects.set(about.name, parameter.name, parameter.default), "{}.{}", about.name, parameter.name);
    }
    effects
}

pub fn fitting(robot: &str) -> Vec<&'static About> {
    catalogue().into_iter().filter(|about| about.fits.contains(&robot)).collect()
}

/// Adds an effect as its law plants it, with its size `part` of the way from least to greatest by ratio.
pub fn plant(effects: &mut Effects, about: &About, part: f64) {
    let mut distance = 0.0;
    for (_, draw) in about.law {
        if let Draw::Size { way, least, greatest } = draw {
            distance = least * (greatest / least).powf(part) * if *way == Way::Down { -1.0 } else { 1.0 };
        }
    }
    for (name, draw) in about.law {
        let default = about.parameters.iter().find(|it| it.name == *name).map(|it| it.default).unwrap_or(f64::NAN);
        let value = match draw {
            Draw::Size { .. } | Draw::Same => default + distance,
            Draw::Choice(values) | Draw::Landmark(values) => values[0],
        };
        assert!(effects.set(about.name, name, value), "{}.{name}", about.name);
    }
}

pub fn planted(about: &About, part: f64) -> Effects {
    let mut effects = Effects::default();
    plant(&mut effects, about, part);
    effects
}

/// In the upper half of the law, by ratio.
pub const LARGE: f64 = 0.8;
