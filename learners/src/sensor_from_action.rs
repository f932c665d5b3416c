//! The sensor model from a known action model.

use asami_dataset::models::Curve;
use asami_dataset::{Log, Models, Rng, SensorModel};
use asami_math::polynomial::Polynomial;

use crate::learner::{CannotLearn, Learned, Learner, Trace, Verdict, learner};
use crate::line::{Line, given_action};

learner! {
    /// Stronger 2008, section 3.2.1, second part: polynomial regression on `(o_t, w_a,t)`, where the place
    /// `w_a` is the sum of what the given action model says of the commands.
    ///
    /// The unit of length is the given model's. No standard errors: the errors of `w_a` add up and are
    /// anything but independent.
    SensorFromAction, "sensor_from_action",
    "Learns the sensor model, taking an action model as known.",
    source "Stronger 2008, section 3.2.1, Figure 3.5b", needs Action,
    {
        /// Degree of the sensor model, a polynomial of the observation.
        sensor_degree: u32 = 3, "1", 1.0..=8.0;
    }
}

impl Learner for SensorFromAction {
    fn learn(&self, log: &Log, given: &Models, _rng: &mut Rng) -> Result<Learned, CannotLearn> {
        let line = Line::try_from(log)?;
        let action = given_action(given)?;
        let degree = self.sensor_degree as usize;
        line.require(degree + 2)?;
        let w_a = line.places(action);
        let (centre, scale) = line.observation_scaling();
        let points = line.rows.iter().map(|row| row.o).zip(w_a.iter().copied());
        let not_finite = || CannotLearn::Undetermined("observations or commands overflow".to_string());
        let (sensor, _) = Polynomial::fit(points, degree, centre, scale).ok_or_else(not_finite)?;
        let w_s: Vec<f64> = line.rows.iter().map(|row| sensor.at(row.o)).collect();
        Ok(Learned {
            traces: vec![
                Trace { name: "w_a", points: line.trace(&w_a) },
                Trace { name: "w_s", points: line.trace(&w_s) },
            ],
            models: Models { sensor: Some(SensorModel::DistanceOfHeight(Curve::from(sensor))), ..Models::default() },
            verdict: Verdict::Converged,
            lacks: line.lacks(0),
            ..Learned::default()
        })
    }
}
