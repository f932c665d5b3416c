//! How far off what motion capture shows may be by chance.

use std::collections::BTreeMap;

use asami_dataset::Dataset;

/// Each is left out in turn.
const PARTS: usize = 10;

/// Standard errors of all that is shown of a whole log, by a delete-a-group jackknife (Efron and Tibshirani, *An Introduction to the Bootstrap*,
/// 1993, eq. 11.5): truth and sightings of a tenth of the time are left out in turn, so that what errs together for less than that is not taken for
/// many errors. None for what is not shown each time.
#[must_use]
pub fn errors(dataset: &Dataset, shown: impl Fn(&Dataset) -> BTreeMap<String, f64>) -> BTreeMap<String, f64> {
    let (Some(first), Some(last)) = (dataset.truth.track.first(), dataset.truth.track.last()) else {
        return BTreeMap::new();
    };
    let part_s = (last.t_s - first.t_s) / PARTS as f64;
    let ends_s = |i: usize| [i, i + 1].map(|end| first.t_s + end as f64 * part_s);
    let found: Vec<BTreeMap<String, f64>> = (0..PARTS).map(|i| shown(&without(dataset, ends_s(i)))).collect();
    let error = |name: &String| {
        let values: Vec<f64> = found.iter().filter_map(|it| it.get(name).copied()).collect();
        let mean = values.iter().sum::<f64>() / PARTS as f64;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        (values.len() == PARTS).then(|| (squares * (PARTS - 1) as f64 / PARTS as f64).sqrt())
    };
    found[0].keys().filter_map(|name| Some((name.clone(), error(name)?))).collect()
}

/// The log without truth and sightings of a while.
fn without(dataset: &Dataset, [from_s, to_s]: [f64; 2]) -> Dataset {
    let kept = |t_s: f64| !(from_s..to_s).contains(&t_s);
    let mut rest = dataset.clone();
    rest.truth.track = dataset.truth.track.iter().filter(|it| kept(it.t_s)).copied().collect::<Vec<_>>().into();
    rest.log.sightings = dataset.log.sightings.iter().filter(|it| kept(it.t_s)).cloned().collect::<Vec<_>>().into();
    rest
}

#[cfg(test)]
mod tests {
    use asami_dataset::{Seed, Sighting, Size, TruePose, Truth};
    use rand_distr::{Distribution, Normal};

    use super::*;

    /// Ranges of nothing, one a second, with errors of 0.1 m.
    fn ranges(seed: u64, n: usize) -> Dataset {
        let (noise, mut rng) = (Normal::new(0.0, 0.1).unwrap(), Seed(seed).stream("ranges"));
        let mut of = Dataset::default();
        let pose = |t_s: f64| TruePose { t_s, x_m: 0.0, y_m: 0.0, theta_rad: 0.0, v_m_per_s: None };
        let seen =
            |t_s: f64, error_m: f64| Sighting { t_s, landmark: 1, size: Size::RangeM(2.0 + error_m), bearing_rad: 0.0 };
        of.log.sightings = (0..n).map(|i| seen(i as f64, noise.sample(&mut rng))).collect::<Vec<_>>().into();
        of.truth = Truth { track: (0..n).map(|i| pose(i as f64)).collect::<Vec<_>>().into(), survey: None };
        of
    }

    fn mean(dataset: &Dataset) -> BTreeMap<String, f64> {
        let of = |seen: &Sighting| seen.size.value();
        let n = dataset.log.sightings.len() as f64;
        BTreeMap::from([("mean".to_owned(), dataset.log.sightings.iter().map(of).sum::<f64>() / n)])
    }

    /// Of a mean of 400 errors of 0.1 m it is 5 mm; of one log by a jackknife of ten within a factor of two, and in the mean square of 200
    /// logs to a tenth.
    #[test]
    fn a_mean_is_as_unsure_as_its_errors_say() {
        let squares = (0..200).map(|seed| errors(&ranges(seed, 400), mean)["mean"].powi(2));
        let rms_m = (squares.sum::<f64>() / 200.0).sqrt();
        assert!((rms_m / 0.005 - 1.0).abs() < 0.1, "{rms_m}");
        assert!((0.0025..0.01).contains(&errors(&ranges(1, 400), mean)["mean"]));
    }

    /// What is shown by nine of ten parts alone has none.
    #[test]
    fn what_is_not_always_shown_has_no_error() {
        let only = |dataset: &Dataset| {
            let whole = dataset.log.sightings.iter().any(|it| it.t_s == 50.0);
            if whole { mean(dataset) } else { BTreeMap::new() }
        };
        assert!(errors(&ranges(3, 100), only).is_empty());
        assert!(errors(&Dataset::default(), mean).is_empty());
    }
}
