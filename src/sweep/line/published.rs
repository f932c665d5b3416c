//! What the dissertation prints, and where: D. Stronger, *Autonomous Sensor and Action Model Learning
//! for Mobile Robots*, University of Texas at Austin, 2008.

use crate::scenario::Start;

/// One published row.
#[derive(Clone, Copy, Debug)]
pub struct Published {
    /// What we call its learner.
    pub learner: &'static str,
    /// What it started from.
    pub start: Option<Start>,
    /// How long it learned; `None` of what does not learn.
    pub duration_s: Option<f64>,
    /// Mean and standard deviation of the sensor model's error.
    pub sensor_rmse_mm: Option<(f64, Option<f64>)>,
    /// Mean and standard deviation of the action model's error.
    pub action_rmse_mm_per_s: Option<(f64, Option<f64>)>,
    /// How many trials converged.
    pub converged: Option<u32>,
    /// Of how many.
    pub trials: Option<u32>,
    /// Mean and standard deviation of `| |k|/|b| - 1 |`.
    pub scale_difference: Option<(f64, Option<f64>)>,
    /// Mean and standard deviation of the sensor model's degree, where it is chosen on the way.
    pub sensor_degree: Option<(f64, Option<f64>)>,
    /// Where it is printed.
    pub place: &'static str,
}

/// Everything that chapter 3 prints about errors.
pub const CHAPTER_3: &[Published] = &[
    Published {
        learner: "algorithm1",
        start: Some(Start::C),
        duration_s: Some(150.0),
        sensor_rmse_mm: Some((70.4, Some(13.9))),
        action_rmse_mm_per_s: Some((29.6, Some(12.4))),
        converged: Some(15),
        trials: Some(15),
        scale_difference: Some((0.08, Some(0.06))),
        sensor_degree: None,
        place: "Table 3.1, row 1; section 3.3.2",
    },
    Published {
        learner: "algorithm1",
        start: Some(Start::Sgn),
        duration_s: Some(150.0),
        sensor_rmse_mm: Some((85.3, Some(24.5))),
        action_rmse_mm_per_s: Some((31.3, Some(9.2))),
        converged: Some(15),
        trials: Some(15),
        scale_difference: None,
        sensor_degree: None,
        place: "Table 3.1, row 2; section 3.3.3",
    },
    Published {
        learner: "algorithm1",
        start: Some(Start::One),
        duration_s: Some(300.0),
        sensor_rmse_mm: Some((88.6, Some(11.5))),
        action_rmse_mm_per_s: Some((27.3, Some(6.2))),
        converged: Some(10),
        trials: Some(15),
        scale_difference: None,
        sensor_degree: None,
        place: "Table 3.1, row 3; section 3.3.3",
    },
    Published {
        learner: "degree_selection",
        start: Some(Start::ReferenceQuartic),
        duration_s: Some(300.0),
        sensor_rmse_mm: Some((101.0, Some(34.0))),
        action_rmse_mm_per_s: None,
        converged: None,
        trials: Some(15),
        scale_difference: None,
        sensor_degree: Some((3.33, Some(1.29))),
        place: "section 3.3.3, Polynomial Degree Selection",
    },
    Published {
        learner: "floor",
        start: None,
        duration_s: None,
        sensor_rmse_mm: Some((48.8, None)),
        action_rmse_mm_per_s: Some((17.2, None)),
        converged: None,
        trials: None,
        scale_difference: None,
        sensor_degree: None,
        place: "section 3.3.2: best cubic and best quartic",
    },
    Published {
        learner: "unlearned",
        start: Some(Start::C),
        duration_s: None,
        sensor_rmse_mm: None,
        action_rmse_mm_per_s: Some((43.0, None)),
        converged: None,
        trials: None,
        scale_difference: None,
        sensor_degree: None,
        place: "section 3.3.2: A0(c) = c as it is",
    },
];
