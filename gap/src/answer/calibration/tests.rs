use super::*;
use asami_dataset::Seed;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

/// Two effects whose evidence is honest, or counts three times too much.
fn cases(n: usize, exaggerated: f64, seed: u64) -> Vec<Case> {
    let mut rng = Seed(seed).stream("calibration/test");
    (0..n)
        .map(|_| {
            let u: f64 = rng.random();
            let truth = if u < 0.3 {
                NONE
            } else if u < 0.65 {
                "a"
            } else {
                "b"
            };
            let nats = |cause: &str, rng: &mut asami_dataset::Rng| {
                let normal: f64 = StandardNormal.sample(rng);
                // Log-likelihood ratios of a shift of 2 standard deviations.
                exaggerated * (2.0 * (normal + if cause == truth { 2.0 } else { 0.0 }) - 2.0)
            };
            let evidence = ["a", "b"].map(|cause| (cause.to_owned(), nats(cause, &mut rng)));
            let (truth, evidence) = (truth.to_owned(), evidence.into());
            Case { truth, shown: None, evidence, absorbed_nats: None, off_by: None }
        })
        .collect()
}

#[test]
fn intervals_are_stretched_until_nine_in_ten_planted_sizes_lie_in_them() {
    let mut of = cases(200, 1.0, 3);
    for (i, case) in of.iter_mut().enumerate() {
        case.off_by = Some(i as f64 / 50.0);
    }
    let [low, high] = Calibration::learn(&of).interval(10.0, [9.0, 12.0]);
    assert!((low - (10.0 - 3.58)).abs() < 1e-9 && (high - (10.0 + 2.0 * 3.58)).abs() < 1e-9, "{low} {high}");
    assert_eq!(Calibration::learn(&of[..10]).interval(10.0, [9.0, 12.0]), [9.0, 12.0]);
}

#[test]
fn exaggerated_evidence_is_brought_down_and_probabilities_then_mean_what_they_say() {
    let calibration = Calibration::learn(&cases(1500, 3.0, 1));
    let held = cases(4000, 3.0, 2);
    let raw = Calibration::default();
    assert!(log_loss(&calibration, &held) < log_loss(&raw, &held) - 0.1);
    // Of answers given about 80 %, about 80 % are right: 4 standard errors.
    let (mut right, mut sum, mut n) = (0.0, 0.0, 0.0);
    for case in &held {
        for (cause, p) in calibration.probabilities(&case.evidence) {
            if (0.7..0.9).contains(&p) {
                right += f64::from(u8::from(cause == case.truth));
                sum += p;
                n += 1.0;
            }
        }
    }
    assert!(n > 300.0 && (right - sum).abs() < 4.0 * (n * 0.16_f64).sqrt() + 0.02 * n, "{right} {sum} {n}");
}

#[test]
fn the_set_holds_nine_truths_in_ten() {
    let calibration = Calibration::learn(&cases(1500, 3.0, 3));
    let held = cases(4000, 3.0, 4);
    let holds = |case: &&Case| {
        let probabilities = calibration.probabilities(&case.evidence);
        calibration.set90(&case.evidence, &probabilities).contains(&case.truth)
    };
    let share = held.iter().filter(holds).count() as f64 / held.len() as f64;
    assert!((0.87..0.95).contains(&share), "{share}");
}

#[test]
fn probabilities_add_up_and_more_evidence_never_makes_a_cause_less_probable() {
    let calibration = Calibration::learn(&cases(300, 1.0, 5));
    let p = |nats: f64| {
        let evidence = Evidence::from([("a".to_owned(), nats), ("b".to_owned(), 1.0)]);
        let all = calibration.probabilities(&evidence);
        assert!((all.values().sum::<f64>() - 1.0).abs() < 1e-12);
        all["a"]
    };
    assert!(p(-5.0) < p(0.0) && p(0.0) < p(3.0) && p(3.0) < p(8.0));
}

/// Half of the logs say plainly which of ten causes it is; in the others the truth is anywhere within 9 nats of the most evident.
#[test]
fn what_is_clear_has_no_wider_a_set_because_other_logs_are_not() {
    let of = |n: usize, seed: u64| -> Vec<Case> {
        let mut rng = Seed(seed).stream("calibration/test");
        let names: Vec<String> = (0..10).map(|i| format!("cause {i}")).collect();
        let mut case = |is_clear: bool| {
            let truth = rng.random_range(0..names.len());
            let other = rng.random_range(0..names.len());
            let nats = |i: usize, behind: f64| match (i == truth, i == other) {
                (true, _) => 100.0 - if is_clear { 0.0 } else { behind },
                (false, true) if !is_clear => 100.0,
                _ => 20.0,
            };
            let evidence = names.iter().enumerate().map(|(i, name)| (name.clone(), nats(i, 9.0 * rng.random::<f64>())));
            let evidence = evidence.collect();
            Case { truth: names[truth].clone(), shown: None, evidence, absorbed_nats: None, off_by: None }
        };
        (0..n).map(|i| case(i % 2 == 0)).collect()
    };
    let calibration = Calibration::learn(&of(1000, 11));
    let held = of(2000, 12);
    for is_clear in [true, false] {
        let (mut held_in, mut size, mut n) = (0.0, 0.0, 0.0);
        for case in held.iter().enumerate().filter(|(i, _)| (i % 2 == 0) == is_clear).map(|(_, case)| case) {
            let set = calibration.set90(&case.evidence, &calibration.probabilities(&case.evidence));
            held_in += f64::from(u8::from(set.contains(&case.truth)));
            size += set.len() as f64;
            n += 1.0;
        }
        assert!(held_in / n > 0.88, "clear: {is_clear}: {}", held_in / n);
        assert!(if is_clear { size / n < 1.01 } else { size / n > 1.5 }, "clear: {is_clear}: {}", size / n);
    }
}

/// Of what is plainly `a`, every fifth has `b` besides, which does not show.
fn with_hidden(n: usize) -> Vec<Case> {
    let of = |i: usize| {
        let truth = if i.is_multiple_of(5) { "a+b" } else { "a" };
        let wobble = 0.3 * ((i * 7 % 11) as f64 - 5.0) / 5.0;
        let nats = [("a", 40.0), ("b", 2.0), ("a+b", 39.5 + wobble), ("unknown/timing", 33.0)];
        let evidence = nats.map(|(cause, nats)| (cause.to_owned(), nats)).into();
        Case { truth: truth.to_owned(), shown: Some("a".to_owned()), evidence, absorbed_nats: None, off_by: None }
    };
    (0..n).map(of).collect()
}

#[test]
fn what_may_have_another_beside_it_is_not_certain_and_its_set_holds_what_shows() {
    let cases = with_hidden(400);
    let calibration = Calibration::learn(&cases);
    let probabilities = calibration.probabilities(&cases[1].evidence);
    assert!((probabilities["a"] - 0.8).abs() < 0.06, "{probabilities:?}");
    assert_eq!(calibration.set90(&cases[1].evidence, &probabilities), ["a"]);
}

#[test]
fn of_two_effects_of_which_one_does_not_show_the_other_stands_for_both() {
    let calibration = Calibration { thresholds: [0.0; STRATA], ..Calibration::default() };
    let set = |pair: f64| {
        let nats = [("a", 40.0), ("b", 2.0), ("a+b", pair), ("unknown/timing", 33.0)];
        let evidence = Evidence::from(nats.map(|(cause, nats)| (cause.to_owned(), nats)));
        let probabilities = calibration.probabilities(&evidence);
        assert!(probabilities["a+b"] > probabilities["b"], "{probabilities:?}");
        calibration.set90(&evidence, &probabilities)
    };
    assert_eq!(set(39.0), ["a", "unknown", "b", "none"].map(str::to_owned));
    assert_eq!(set(60.0)[..2], ["a+b", "a"]);
}

#[test]
fn a_block_is_held_against_the_cause_that_it_was_put_on_top_of() {
    let evidence = |pair: f64| {
        let nats = [("a", 40.0), ("b", 2.0), ("a+b", pair), ("unknown/timing", pair - 5.0)];
        Evidence::from(nats.map(|(cause, nats)| (cause.to_owned(), nats)))
    };
    let odds = |pair: f64| {
        let evidence = evidence(pair);
        let p = Calibration::default().scores(&evidence);
        let of = |cause: &str| p.iter().find(|it| it.0 == cause).map_or(f64::NAN, |it| it.1);
        of("unknown/timing") - of("a+b")
    };
    assert_eq!((leader(&evidence(60.0)), leader(&evidence(41.0))), ("a+b", "a"));
    assert!((odds(60.0) - odds(90.0)).abs() < 1e-9, "{} {}", odds(60.0), odds(90.0));
    assert_eq!(leader(&Evidence::from([("a".to_owned(), 2.0)])), NONE);
}

/// A library that is wrong by up to six parts in a hundred of what it explains takes as much for a second effect.
pub(super) fn with_a_library_that_errs(n: usize) -> Vec<Case> {
    let of = |i: usize| {
        let (u, v) = ((i * 7 % 11) as f64 / 10.0, (i * 5 % 13) as f64 / 12.0);
        let both = i.is_multiple_of(4);
        let nats = if both { 15.0 + 45.0 * v } else { 10.0 * exp(4.6 * v) };
        let beyond = 0.06 * nats * u + if both { 15.0 + 10.0 * v } else { -2.0 };
        let evidence = [("a", nats), ("b", 1.0), ("a+b", nats + beyond), ("unknown/timing", nats - 8.0)];
        let evidence = evidence.map(|(cause, nats)| (cause.to_owned(), nats)).into();
        let truth = if both { "a+b" } else { "a" }.to_owned();
        Case { truth, shown: None, evidence, absorbed_nats: None, off_by: None }
    };
    (0..n).map(of).collect()
}

#[test]
fn a_share_of_what_an_effect_explains_is_the_library_s_error_and_speaks_for_nothing_else() {
    let calibration = Calibration::learn(&with_a_library_that_errs(400));
    let of = |nats: f64, beyond: f64| {
        let evidence = [("a", nats), ("b", 1.0), ("a+b", nats + beyond), ("unknown/timing", nats - 8.0)];
        calibration.probabilities(&evidence.map(|(cause, nats)| (cause.to_owned(), nats)).into())
    };
    let (plain, pushed) = (of(30.0, 20.0), of(1000.0, 40.0));
    assert!(plain["a+b"] > 0.7 && pushed["a"] > 0.7, "{plain:?} {pushed:?}");
}

/// The same, and causes in nobody's list of which a block says less than its freedom costs, or more.
#[test]
fn what_speaks_against_the_unknown_counts_however_much_there_is_of_an_effect() {
    let unknown = |i: usize| {
        let (nats, beyond) = (5.0 + (i % 20) as f64, -4.0 + (i % 7) as f64);
        let evidence = [("a", nats), ("b", 1.0), ("a+b", nats - 2.0), ("unknown/timing", nats + beyond)];
        let evidence = evidence.map(|(cause, nats)| (cause.to_owned(), nats)).into();
        Case { truth: "unknown/timing".to_owned(), shown: None, evidence, absorbed_nats: None, off_by: None }
    };
    let cases = [with_a_library_that_errs(400), (0..100).map(unknown).collect()].concat();
    let calibration = Calibration::learn(&cases);
    assert!(calibration.error > 0.005, "{calibration:?}");
    let unknown = |nats: f64, beyond: f64| {
        let evidence = [("a", nats), ("b", 1.0), ("a+b", nats - 2.0), ("unknown/timing", nats + beyond)];
        calibration.probabilities(&evidence.map(|(cause, nats)| (cause.to_owned(), nats)).into())[UNKNOWN]
    };
    assert!(unknown(20.0, 2.0) > 0.6 && unknown(20.0, -8.0) < 0.2, "{} {}", unknown(20.0, 2.0), unknown(20.0, -8.0));
    assert!(unknown(1000.0, -8.0) < 0.2, "{}", unknown(1000.0, -8.0));
}

/// Of `a` a tenth is wrong, of `c` nothing; a second effect says as much beside either.
#[test]
fn the_error_is_each_effect_s_own() {
    let of = |i: usize| {
        let (first, errs) = if i.is_multiple_of(2) { ("a", 0.1) } else { ("c", 0.0) };
        let (u, v) = ((i * 7 % 11) as f64 / 10.0, (i * 5 % 13) as f64 / 12.0);
        let nats = 20.0 * exp(3.0 * v);
        let both = i.is_multiple_of(5);
        let beyond = errs * nats * (0.7 + 0.3 * u) + if both { 8.0 + 30.0 * u } else { -2.0 };
        let pair = format!("b+{first}");
        let evidence = [(first, nats), ("b", 1.0), (&*pair, nats + beyond), ("unknown/timing", nats - 8.0)];
        let evidence = evidence.map(|(cause, nats)| (cause.to_owned(), nats)).into();
        let truth = if both { pair } else { first.to_owned() };
        Case { truth, shown: None, evidence, absorbed_nats: None, off_by: None }
    };
    let calibration = Calibration::learn(&(0..400).map(of).collect::<Vec<_>>());
    let p = |first: &str| {
        let pair = format!("b+{first}");
        let evidence = [(first, 200.0), ("b", 1.0), (&*pair, 218.0), ("unknown/timing", 192.0)];
        calibration.probabilities(&evidence.map(|(cause, nats)| (cause.to_owned(), nats)).into())[&pair]
    };
    assert!(p("a") < 0.2 && p("c") > 0.8, "{} {} {calibration:?}", p("a"), p("c"));
}

/// Half of all cases have `command_scale`, of which nobody can see anything, a quarter `height_bias`, which is plain, and a quarter
/// nothing: what shows nothing may be either of two, and without the one in the list it is the *unknown* two times in three.
#[test]
fn what_is_taken_out_of_the_list_may_be_there_and_not_show() {
    let of = |i: usize| {
        let (truth, bias) = match i % 4 {
            0 => (NONE, -2.0),
            1 => ("height_bias", 40.0),
            _ => ("command_scale", -2.0),
        };
        let wobble = 0.2 * ((i * 7 % 11) as f64 - 5.0) / 5.0;
        let block = f64::max(bias, 0.0) - 6.0 + wobble;
        let nats = [
            ("command_scale", wobble),
            ("height_bias", bias - wobble),
            ("unknown/static_motion", block),
            ("unknown/timing", block),
        ];
        let evidence = nats.map(|(cause, nats)| (cause.to_owned(), nats)).into();
        Case { truth: truth.to_owned(), shown: None, evidence, absorbed_nats: None, off_by: None }
    };
    let cases: Vec<Case> = (0..800).map(of).collect();
    let share = |without: &[String], cause: &str| {
        let left = less(&cases, without);
        let calibration = Calibration::of(&left);
        let unseen = left.iter().find(|it| it.case.evidence["height_bias"] < 0.0).expect("half of them");
        let probabilities = calibration.probabilities(&unseen.case.evidence);
        assert!((probabilities.values().sum::<f64>() - 1.0).abs() < 1e-9, "{probabilities:?}");
        probabilities.get(cause).copied().unwrap_or(0.0)
    };
    let gone = ["command_scale".to_owned()];
    let [whole, less] = [share(&[], "command_scale"), share(&gone, UNKNOWN)];
    assert!((whole - 2.0 / 3.0).abs() < 0.07 && (less - 2.0 / 3.0).abs() < 0.12, "{whole} {less}");
    assert!(share(&[], UNKNOWN) < 0.07, "{}", share(&[], UNKNOWN));
}

/// Two others together are no more probable for what a third one says, be that as much as it may; beside it, one that does not show
/// may be there.
#[test]
fn what_the_most_evident_effect_says_speaks_for_none_that_are_without_it() {
    let calibration = Calibration::learn(&with_hidden(300));
    let of = |nats: f64| {
        let evidence = [("a", nats), ("b", 4.0), ("c", 3.0), ("b+c", 5.0), ("a+b", nats - 1.0)];
        let evidence = Evidence::from(evidence.map(|(cause, nats)| (cause.to_owned(), nats)));
        let p = calibration.probabilities(&evidence);
        assert!(p["a+b"] > 0.01 * p["a"], "{p:?}");
        p["b+c"] / p["a+b"]
    };
    let [little, much] = [8.0, 40.0].map(of);
    assert!(much < 0.5 * little && much < 0.05, "{little} {much}");
}

/// What counts for a tenth takes a tenth of what the set may miss.
#[test]
fn the_set_misses_a_twelfth_of_what_cases_count_for() {
    let even: Vec<(f64, f64)> = (0..119).map(|i| (f64::from(i), 1.0)).collect();
    assert_eq!(least_in_set(&even), Some(9.0));
    let rare: Vec<(f64, f64)> = (0..119).map(|i| (f64::from(i), if i < 60 { 0.1 } else { 1.0 })).collect();
    // A twelfth of 1 + 6 + 59.
    assert_eq!(least_in_set(&rare), Some(54.0));
    assert_eq!(least_in_set(&even[..3]), Some(0.0));
    assert_eq!(least_in_set(&[]), None);
}
