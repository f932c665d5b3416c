//! What is known of a robot before its own log is looked at: what others of its make have.
//!
//! Whether robots of a make have an effect is taken to be exchangeable: each has it with the same unknown probability, a
//! beta distribution of which is believed beforehand (a hierarchical model; Gelman et al. 2013, "Bayesian Data Analysis", chapter
//! 5). Nothing is taken over of how large an effect is.

use std::collections::BTreeMap;

use asami_math::elementary::ln;

use crate::answer::diagnosis::Diagnosis;

/// How probable an effect is of which nothing is known: ten to one are against it.
const SHARE: f64 = 1.0 / 11.0;
/// That counts as much as so many robots.
const COUNTS: f64 = 1.0;

/// Other robots of a make: none to begin with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Kin {
    robots: f64,
    /// How many of them have an effect, each as probably as its diagnosis says.
    having: BTreeMap<String, f64>,
}

impl Kin {
    /// A robot of which no other's log is known.
    pub const NONE: Self = Self { robots: 0.0, having: BTreeMap::new() };

    /// Robots by the diagnoses of their own logs.
    #[must_use]
    pub fn of<'a>(others: impl IntoIterator<Item = &'a Diagnosis>) -> Self {
        let mut kin = Self::NONE;
        for other in others {
            kin.robots += 1.0;
            for cause in other.which.iter().filter(|cause| cause.names_effects()) {
                for effect in &cause.effects {
                    *kin.having.entry(effect.clone()).or_default() += cause.probability;
                }
            }
        }
        kin
    }

    /// How many others there are.
    #[must_use]
    pub fn robots(&self) -> usize {
        self.robots as usize
    }

    /// The logarithm of the odds against an effect.
    #[must_use]
    pub fn against_nats(&self, effect: &str) -> f64 {
        let having = self.having.get(effect).copied().unwrap_or_default();
        let without = (self.robots - having).max(0.0);
        ln((without + COUNTS * (1.0 - SHARE)) / (having + COUNTS * SHARE))
    }

    /// By how much more the odds are against it than were nothing known.
    #[must_use]
    pub fn more_against_nats(&self, effect: &str) -> f64 {
        self.against_nats(effect) - Self::NONE.against_nats(effect)
    }
}

#[cfg(test)]
mod tests {
    use asami_dataset::Seed;

    use super::*;
    use crate::answer::diagnosis::Cause;
    use crate::plant::Planted;
    use crate::real::layers::{ANY_SHARE, Least, layers};
    use crate::straight::Straight;
    use crate::weigh::causes::UNKNOWN;

    /// A robot that has these effects with a probability, and nobody knows what else.
    fn having(effects: &[&str], probability: f64) -> Diagnosis {
        let nothing = Diagnosis::flat(&[]);
        let cause = |effects: &[&str], probability: f64| Cause {
            effects: effects.iter().map(|it| (*it).to_owned()).collect(),
            probability,
            ..nothing.which[0].clone()
        };
        let which = vec![cause(effects, probability), cause(&[UNKNOWN], 1.0 - probability)];
        Diagnosis { which, ..nothing.clone() }
    }

    /// The beta distribution's own rule of succession; ten to one where nobody is known.
    #[test]
    fn what_others_have_is_expected() {
        let four = [0.9, 1.0, 1.0, 1.0].map(|probability| having(&["wheel_lag", "wheel_base"], probability));
        let kin = Kin::of(&four);
        let odds = |effect: &str| kin.against_nats(effect).exp();
        assert!((Kin::NONE.against_nats("wheel_lag").exp() - 10.0).abs() < 1e-9);
        let posterior = (3.9 + SHARE) / (4.0 + 1.0);
        assert!((odds("wheel_lag") - (1.0 - posterior) / posterior).abs() < 1e-9, "{}", odds("wheel_lag"));
        assert!(kin.more_against_nats("wheel_lag") < 0.0, "it is expected");
        assert!((odds("command_delay") - (5.0 - SHARE) / SHARE).abs() < 1e-9, "none of four has it");
        assert!(kin.more_against_nats("command_delay") > 0.0);
    }

    /// What is just too little for a name by itself has one among robots that all have it; what is just enough has none among
    /// robots of which none has it.
    #[test]
    fn what_others_have_needs_less_evidence_and_what_they_have_not_more() {
        let kinds = ["command_scale", "wheel_base"].map(Straight::kind);
        let wave = |t: usize, step: f64| (step * t as f64).sin();
        let names = |share: f64, others: &[Diagnosis]| -> Vec<&str> {
            let truth = [0.5, share].into_iter().zip(kinds.clone());
            let truth: Vec<Planted> =
                truth.map(|(share, variant)| Planted { size: share * variant.sizes().1, variant }).collect();
            let log = Straight::new(&truth, &[&|t| wave(t, 0.37), &|t| wave(t, 0.91)], Seed(3));
            let least = Least { kin: Kin::of(others), ..ANY_SHARE };
            layers(&log, &kinds, &least).iter().map(|it| it.weighed.effect).collect()
        };
        let with: Vec<Diagnosis> = (0..4).map(|_| having(&["command_scale", "wheel_base"], 1.0)).collect();
        let without: Vec<Diagnosis> = (0..4).map(|_| having(&["command_scale"], 1.0)).collect();
        let (one, both) = (vec!["command_scale"], vec!["command_scale", "wheel_base"]);
        assert_eq!([names(0.21, &[]), names(0.21, &with)], [one.clone(), both.clone()]);
        assert_eq!([names(0.23, &[]), names(0.23, &without)], [both, one]);
    }

    #[test]
    fn robots_that_differ_say_little() {
        let kin = Kin::of(&[having(&["wheel_lag"], 1.0), having(&["command_delay"], 1.0)]);
        assert!(kin.against_nats("wheel_lag").abs() < kin.against_nats("pan_offset"));
        assert_eq!(kin.against_nats("wheel_lag"), kin.against_nats("command_delay"));
    }
}
