//! Normalised innovations of a filter with given models.

use asami_dataset::Models;
use asami_learners::em::consistency::nis_in_plane;

use crate::synthetic::{Walker, truth};

/// With noise given so many times too large or small.
fn with_noise(models: &Models, factor: f64) -> Models {
    let mut models = models.clone();
    models.noise.sigma1_px = models.noise.sigma1_px.map(|sigma| factor * sigma);
    models.noise.sigma2_rad = models.noise.sigma2_rad.map(|sigma| factor * sigma);
    models.noise.motion_sd = models.noise.motion_sd.map(|sd| sd.map(|sd| factor * sd));
    models
}

#[test]
fn is_one_for_true_models_and_tells_noise_that_is_wrong() {
    let walker = Walker { cubic: true, sigma2_rad: 0.1, ..Walker::default() };
    let log = walker.log(1002);
    let models = truth(&walker);
    let nis = nis_in_plane(&log, &models).unwrap();
    // 2 n squares of standard normals have a mean of standard deviation sqrt(2 / 2 n) = 1 / sqrt(n); four of these
    // and 2 % for linearisation.
    let n = log.sightings.len() as f64;
    assert!((nis - 1.0).abs() < 4.0 / n.sqrt() + 0.02, "{nis} over {n}");
    // Covariances all times four leave the filter as it is, and divide its normalised innovations by four.
    let doubled = nis_in_plane(&log, &with_noise(&models, 2.0)).unwrap();
    assert!((4.0 * doubled / nis - 1.0).abs() < 0.05, "{doubled}");
    assert!(nis_in_plane(&log, &with_noise(&models, 0.5)).unwrap() > 3.0);
}

#[test]
fn models_of_another_kind_have_none() {
    let walker = Walker { steps: 1000, ..Walker::default() };
    let log = walker.log(1003);
    assert_eq!(nis_in_plane(&log, &Models::default()), None);
    assert_eq!(nis_in_plane(&log, &Models { sensor: None, ..truth(&walker) }), None);
    let no_motion =
        Models { noise: asami_dataset::Noise { motion_sd: None, ..truth(&walker).noise }, ..truth(&walker) };
    assert_eq!(nis_in_plane(&log, &no_motion), None);
}
