//! Two effects at once: what the weaker one shows beside the other, and which of two is taken out of the list.

use std::collections::BTreeSet;

use asami::blind::referee::judge;
use asami::blind::scenario::Measure;
use asami::blind::tally::{Asked, Share, asked, measure};
use asami_gap::{Likelihood, Planted, Variant};

use super::{ASKED, blind, effect, record, results};

/// What effects gain by name and size.
struct Gains<F>(F);

impl<F: Fn(&[Planted]) -> f64 + Sync> Likelihood for Gains<F> {
    fn blocks(&self, effects: &[Planted]) -> Vec<f64> {
        vec![(self.0)(effects)]
    }

    fn observations(&self) -> usize {
        100
    }

    fn apart(&self, _: &[Planted], _: &[Planted]) -> f64 {
        100.0
    }
}

fn planted(name: &str) -> Planted {
    let variant = Variant::all("plain", 4, &[]).into_iter().find(|it| it.about.name == name).expect("in the catalogue");
    let (least, greatest) = variant.sizes();
    Planted { variant, size: (least * greatest).sqrt() }
}

fn size_of(effects: &[Planted], name: &str) -> Option<f64> {
    effects.iter().find(|it| it.variant.about.name == name).map(|it| it.size)
}

#[test]
fn an_effect_shows_beside_another_by_what_the_other_cannot_explain_at_any_size() {
    let (delay, scale) = (planted("command_delay"), planted("command_scale"));
    let variants = Variant::all("plain", 4, &[]);
    let asked = blind(ASKED).asked;
    let (of_delay, of_scale) = (delay.size, scale.size);
    let each = |gain: &(dyn Fn(&[Planted]) -> f64 + Sync), planted: &[Planted]| {
        let reference = judge(&Gains(gain), planted, &variants, &asked);
        (reference.d_each.expect("planted"), reference.d_det.expect("planted"))
    };
    // Half a logarithm of a hundred observations for each effect more (Schwarz 1978).
    let price = 0.5 * 100.0_f64.ln();
    let apart = move |size: Option<f64>, truth: f64, gain: f64| {
        size.map_or(0.0, |size| gain - 100.0 * (size / truth).ln().powi(2))
    };

    let alone = move |effects: &[Planted]| {
        apart(size_of(effects, "command_delay"), of_delay, 30.0)
            + apart(size_of(effects, "command_scale"), of_scale, 12.0)
    };
    let both = [delay.clone(), scale.clone()];
    let (found, _) = each(&alone, &both);
    assert!((found - (12.0 - price)).abs() < 1e-9, "{found}");
    let (found, all) = each(&alone, &both[..1]);
    assert!(found == all && (found - (30.0 - price)).abs() < 1e-9, "{found} {all}");

    // Without the scale a delay of another size gains 8 of its 12 nats.
    let shared = move |effects: &[Planted]| match (size_of(effects, "command_delay"), size_of(effects, "command_scale"))
    {
        (Some(size), None) => 38.0 - 100.0 * (size / (1.3 * of_delay)).ln().powi(2),
        _ => alone(effects),
    };
    let (found, _) = each(&shared, &both);
    assert!((found - (4.0 - price)).abs() < 0.05, "{found}");
}

#[test]
fn one_of_two_is_taken_out_with_what_acts_like_it_but_never_the_other() {
    let mut one_of_two = blind(ASKED).asked;
    one_of_two.without_one_of_two = true;
    let effects = [effect("a", &["a", "b", "c"]), effect("b", &["a", "b"])];
    let found: BTreeSet<Vec<String>> = (1..=40).map(|number| one_of_two.withheld(number, &effects)).collect();
    let words = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<String>>();
    assert_eq!(found, BTreeSet::from([words(&["a", "c"]), words(&["b"])]));
    assert!(one_of_two.withheld(1, &effects[..1]).is_empty() && one_of_two.withheld(1, &[]).is_empty());
    assert!(blind(ASKED).asked.withheld(1, &effects).is_empty());
}

#[test]
fn of_two_effects_both_count_and_a_third_is_counted() {
    let mut records = vec![
        record(&["a", "b"], "a+b", 0.95, true, 12.0),
        record(&["a", "b"], "a", 0.95, false, 40.0),
        record(&["a", "b"], "a+c", 0.95, false, 4.0),
        record(&["a", "b"], "unknown", 0.85, false, 15.0),
        record(&[], "c", 0.85, false, 15.0),
    ];
    records[3].withheld = vec!["b".to_owned()];
    records[3].answers[0].named_right = true;
    assert_eq!(records[3].listed(), [&"a".to_owned()]);
    let results = results(records);
    let all: Vec<Asked<'_>> = asked(&results, 0).collect();
    let share = |what| measure(what, &all).share.expect("a share");
    assert_eq!(share(Measure::NamedRight), Share { count: 2, of: 4 });
    assert_eq!(share(Measure::NothingElseNamed), Share { count: 3, of: 4 });
    let trials = asami::blind::rows::trials(&results);
    let truths: Vec<&str> = trials.lines().skip(1).map(|line| line.split(',').nth(3).expect("a column")).collect();
    assert_eq!(truths, ["a+b", "a+b", "a+b", "a+unknown", "none"]);
    let (_, table) = asami::blind::tables::all(&results).into_iter().find(|(name, _)| name == "two").expect("a table");
    let cases: Vec<_> = table.rows.iter().map(|row| row.cells[2].value).collect();
    assert_eq!(cases[..5], [0.0, 1.0, 2.0, 1.0, 4.0].map(Some), "{table:?}");
}
