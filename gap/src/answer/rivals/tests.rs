//! On likelihoods that are written down: what is planted is found.

use asami_dataset::Log;

use super::{AllAtOnce, ForwardSelection};
use crate::answer::contest::{CannotDiagnose, Diagnoses, Judges, Likelihood};
use crate::answer::diagnosis::Verdict;
use crate::plant::{Planted, Variant};

/// Every effect, with its choices, moves a reading of its own; each block measures all of them with noise of one.
#[derive(Clone)]
struct Readings {
    kinds: Vec<Variant>,
    truth: Vec<Planted>,
    per_block: f64,
}

/// How far an effect with these choices moves its reading: 1 at the middle of its law.
fn moved(effects: &[Planted], of: &Variant) -> f64 {
    let moves = |planted: &Planted| {
        let (least, greatest) = planted.variant.sizes();
        planted.variant.sign * planted.size / (least * greatest).sqrt()
    };
    let same = |planted: &&Planted| planted.variant.about == of.about && planted.variant.choices == of.choices;
    effects.iter().filter(same).map(moves).sum()
}

/// Kinds that differ in more than their side of the null value.
fn kinds() -> Vec<Variant> {
    let mut kinds = Variant::all("plain", 4, &[]);
    kinds.dedup_by(|a, b| a.about == b.about && a.choices == b.choices);
    kinds
}

impl Likelihood for Readings {
    fn blocks(&self, effects: &[Planted]) -> Vec<f64> {
        let off: Vec<f64> = self.kinds.iter().map(|kind| moved(&self.truth, kind) - moved(effects, kind)).collect();
        (0..40)
            .map(|block| {
                let noise = f64::from((block * 7) % 11 - 5) / if block % 4 < 2 { 3.5 } else { -3.5 };
                let residual = |(off, place): (&f64, i32)| self.per_block * off + noise * f64::from(place % 3);
                -0.5 * off.iter().zip(1..).map(residual).map(|residual| residual * residual).sum::<f64>()
            })
            .collect()
    }

    fn observations(&self) -> usize {
        40
    }

    fn apart(&self, _: &[Planted], _: &[Planted]) -> f64 {
        0.0
    }
}

impl Judges for Readings {
    fn of<'a>(&'a self, _: &'a Log) -> Result<Box<dyn Likelihood + 'a>, CannotDiagnose> {
        Ok(Box::new(self.clone()))
    }
}

fn named(diagnoser: &dyn Diagnoses) -> Vec<String> {
    let diagnosis = diagnoser.diagnose(&Log::default()).expect("diagnosed");
    assert_eq!(diagnosis.verdict == Verdict::None, diagnosis.which[0].effects == ["none"]);
    diagnosis.which[0].effects.clone()
}

#[test]
fn each_effect_is_named_where_it_is_planted_alone_and_none_where_there_is_none() {
    let variants = Variant::all("plain", 4, &[]);
    assert!(!variants.is_empty());
    // One kind of each effect is enough.
    let mut kinds = kinds();
    kinds.dedup_by_key(|kind| kind.about.name);
    let planted = kinds.iter().step_by(3).map(|variant| {
        let (least, greatest) = variant.sizes();
        vec![Planted { variant: variant.clone(), size: (least * greatest).sqrt() }]
    });
    for truth in planted.chain([Vec::new()]) {
        let expected = truth.first().map_or("none", |planted: &Planted| planted.variant.about.name).to_owned();
        let readings = Readings { kinds: self::kinds(), truth, per_block: 3.0 };
        let all = AllAtOnce { judges: &readings, variants: variants.clone(), evaluations: 6000 };
        let forward = ForwardSelection { judges: &readings, variants: variants.clone(), most: 2 };
        assert_eq!(named(&all).concat(), expected);
        assert_eq!(named(&forward).concat(), expected);
    }
}

#[test]
fn forward_selection_adds_a_second_effect_and_all_at_once_never_does() {
    let variants = Variant::all("plain", 4, &[]);
    let mut abouts: Vec<_> = variants.iter().map(|variant| variant.about).collect();
    abouts.dedup();
    let of = |about| {
        let variant = variants.iter().find(|variant| variant.about == about).expect("a variant").clone();
        let size = 0.8 * variant.sizes().1;
        Planted { variant, size }
    };
    let truth = vec![of(abouts[0]), of(abouts[1])];
    let readings = Readings { kinds: kinds(), truth, per_block: 3.0 };
    let forward = ForwardSelection { judges: &readings, variants: variants.clone(), most: 3 };
    let mut both = named(&forward);
    both.sort();
    let mut expected = vec![abouts[0].name.to_owned(), abouts[1].name.to_owned()];
    expected.sort();
    assert_eq!(both, expected);
    let all = AllAtOnce { judges: &readings, variants, evaluations: 6000 };
    assert_eq!(named(&all).len(), 1);
}
