//! The action model from a known sensor model.

use asami_dataset::models::Curve;
use asami_dataset::{ActionModel, Log, Models, Rng, SensorModel};
use asami_math::decomposition::dot;
use asami_math::polynomial::Polynomial;
use asami_math::regression::least_squares;

use crate::learner::{CannotLearn, Learned, Learner, Trace, Verdict, learner};
use crate::line::Line;

learner! {
    /// Stronger 2008, section 3.2.2: the regression of eq. 3.2, with unknowns w_0, a_0, ..., a_d, on the places
    /// `w_s` that the given sensor model sees.
    ///
    /// The unit of length is the given model's. No standard errors: the robot's own straying adds up, so
    /// that the errors are not independent.
    ActionFromSensor, "action_from_sensor",
    "Learns the action model, taking a sensor model as known.",
    source "Stronger 2008, section 3.2.2, eq. 3.2, Figure 3.6", needs Sensor,
    {
        /// Degree of the action model, a polynomial of the command.
        action_degree: u32 = 4, "1", 1.0..=8.0;
    }
}

impl Learner for ActionFromSensor {
    fn learn(&self, log: &Log, given: &Models, _rng: &mut Rng) -> Result<Learned, CannotLearn> {
        let line = Line::try_from(log)?;
        let Some(SensorModel::DistanceOfHeight(sensor)) = &given.sensor else {
            return Err(CannotLearn::NotGiven("a sensor model from observation to place"));
        };
        let degree = self.action_degree as usize;
        line.require(degree + 3)?;
        let w_s: Vec<f64> = line.rows.iter().map(|row| sensor.polynomial.at(row.o)).collect();
        let scale = line.command_scale();
        let regressors: Vec<Vec<f64>> = line
            .cumulated_powers(degree, scale)
            .into_iter()
            .map(|cumulated| [1.0].into_iter().chain(cumulated).collect())
            .collect();
        let rows = regressors.iter().cloned().zip(w_s.iter().copied());
        let not_finite = || CannotLearn::Undetermined("observations or commands overflow".to_string());
        let fit = least_squares(degree + 2, rows).solve().ok_or_else(not_finite)?;
        let w_a: Vec<f64> = regressors.iter().map(|row| dot(row, &fit.coefficients)).collect();
        let action = Polynomial { coefficients: fit.coefficients[1..].to_vec(), centre: 0.0, scale };
        Ok(Learned {
            models: Models { action: Some(ActionModel::Polynomial(Curve::from(action))), ..Models::default() },
            verdict: Verdict::Converged,
            traces: vec![
                Trace { name: "w_a", points: line.trace(&w_a) },
                Trace { name: "w_s", points: line.trace(&w_s) },
            ],
            lacks: line.lacks(degree),
            ..Learned::default()
        })
    }
}
