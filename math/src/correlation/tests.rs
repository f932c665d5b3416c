use super::*;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// The definition, in 64-bit floats, over the places where both signals have a value.
fn definition(a: &[i16], b: &[i16], lag: isize) -> (i64, Option<f64>) {
    let at = |i: usize| {
        let b = b.get((i as isize + lag).try_into().ok().unwrap_or(usize::MAX))?;
        (a[i] != ABSENT && *b != ABSENT).then_some((f64::from(a[i]), f64::from(*b)))
    };
    let both: Vec<(f64, f64)> = (0..a.len()).filter_map(at).collect();
    let n = both.len() as f64;
    let (x, y) = both.iter().fold((0.0, 0.0), |s, v| (s.0 + v.0 / n, s.1 + v.1 / n));
    let ss = both.iter().fold([0.0; 3], |s, v| {
        let (dx, dy) = (v.0 - x, v.1 - y);
        [s[0] + dx * dx, s[1] + dy * dy, s[2] + dx * dy]
    });
    (both.len() as i64, (ss[0] > 1e-6 && ss[1] > 1e-6).then(|| ss[2] / (ss[0] * ss[1]).sqrt()))
}

/// A rough profile with holes, and the same `shift` places later with noise.
fn profiles(seed: u64, n: usize, shift: usize, noise: i16) -> (Vec<i16>, Vec<i16>) {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut level = 0i16;
    let clean: Vec<i16> = (0..n + shift)
        .map(|_| {
            if rng.random::<f64>() < 0.1 {
                level = (rng.random::<f64>() * 60_000.0 - 30_000.0) as i16;
            }
            level
        })
        .collect();
    let mut seen = |from: usize| -> Vec<i16> {
        (0..n)
            .map(|i| match rng.random::<f64>() {
                hole if hole < 0.15 => ABSENT,
                _ => clean[from + i].saturating_add((f64::from(noise) * (rng.random::<f64>() - 0.5)) as i16),
            })
            .collect()
    };
    (seen(shift), seen(0))
}

#[test]
fn transforms_give_the_direct_result_and_exact_counts() {
    for (seed, n) in [(1000, 50), (1001, 7001), (1002, 30_000)] {
        let (a, b) = profiles(seed, n, 20, 500);
        let c: Vec<i16> = b.iter().rev().copied().take(n / 2).collect();
        let found = correlograms(&[&a, &b, &c], &[(0, 1), (1, 0), (2, 1)], -60..=40);
        for (correlogram, (a, b)) in found.iter().zip([(&a, &b), (&b, &a), (&c, &b)]) {
            for (i, (&count, &coefficient)) in correlogram.counts.iter().zip(&correlogram.coefficients).enumerate() {
                let (n, expected) = definition(a, b, i as isize - 60);
                let exact = Overlap::at(a, b, i as isize - 60);
                assert_eq!((count, exact.count), (n, n), "seed {seed}");
                match expected {
                    Some(expected) => {
                        assert!((coefficient - expected).abs() < 1e-9, "{coefficient} and {expected}");
                        assert!((exact.coefficient().unwrap() - expected).abs() < 1e-12);
                    }
                    None => assert!(coefficient.is_nan()),
                }
            }
        }
    }
}

#[test]
fn the_shift_of_a_profile_is_found_to_a_fraction_of_a_place() {
    let (a, b) = profiles(1003, 20_000, 17, 2000);
    let correlogram = &correlograms(&[&a, &b], &[(0, 1)], lags_to(100))[0];
    let peak = Peak::of(correlogram, &a, &b, 0.1, 10).unwrap().refined(correlogram, &a, &b);
    assert_eq!(peak.lag, 17);
    assert!(peak.sub_step.abs() < 0.05 && peak.coefficient > 0.99 && peak.second < 0.5, "{peak:?}");
    // A parabola sampled off its vertex.
    let parabola = |x: f64| 0.9 - 0.02 * (x - 0.3) * (x - 0.3);
    let (place, curvature) = vertex(parabola(-1.0), parabola(0.0), parabola(1.0));
    assert!((place - 0.3).abs() < 1e-12 && (curvature - 0.04).abs() < 1e-12);
}

#[test]
fn signals_that_say_nothing_have_no_peak() {
    let (flat, empty, one) = (vec![5i16; 300], vec![ABSENT; 300], vec![1i16]);
    let signals: [&[i16]; 4] = [&flat, &empty, &one, &[]];
    let pairs: Vec<(usize, usize)> = (0..16).map(|i| (i / 4, i % 4)).collect();
    for (correlogram, (a, b)) in correlograms(&signals, &pairs, lags_to(20)).iter().zip(pairs) {
        assert_eq!(Peak::of(correlogram, signals[a], signals[b], 0.1, 3), None);
    }
    assert!(correlograms(&signals, &[(0, 9)], lags_to(3))[0].coefficients.iter().all(|c| c.is_nan()));
}

proptest! {
    #[test]
    fn any_signals_agree_with_the_definition(
        a in proptest::collection::vec(any::<i16>(), 0..80),
        b in proptest::collection::vec(prop_oneof![Just(ABSENT), Just(0i16), any::<i16>()], 0..80),
        first in -100isize..50, more in 0isize..60,
    ) {
        let found = &correlograms(&[&a, &b], &[(0, 1)], first..=first + more)[0];
        for (i, (&count, &coefficient)) in found.counts.iter().zip(&found.coefficients).enumerate() {
            let (n, expected) = definition(&a, &b, first + i as isize);
            prop_assert_eq!(count, n);
            // Where the transform cannot tell it says so.
            if let Some(expected) = expected.filter(|_| !coefficient.is_nan()) {
                prop_assert!((coefficient - expected).abs() < 1e-9, "{} and {}", coefficient, expected);
            }
        }
        let exact = (first..=first + more).filter_map(|lag| Overlap::at(&a, &b, lag).coefficient());
        let greatest = exact.fold(None, |best: Option<f64>, c| Some(best.map_or(c, |b| b.max(c))));
        let peak = Peak::of(found, &a, &b, 0.0, 1).map(|peak| peak.refined(found, &a, &b));
        prop_assert_eq!(peak.map(|peak| peak.coefficient), greatest);
    }
}
