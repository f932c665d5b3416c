//! The sensor model from one constant action: while it lasts, time is place.

use asami_dataset::models::Curve;
use asami_dataset::{Log, Models, Rng, SensorModel};
use asami_math::polynomial::Polynomial;

use crate::learner::{CannotLearn, Learned, Learner, Trace, Verdict, learner};
use crate::line::Line;

learner! {
    /// Stronger 2008, section 3.2.1, first part: polynomial regression on `(o_t, t)` over the longest
    /// stretch of one constant action, knowing nothing about that action.
    ///
    /// Time is multiplied by the command, so that the unit is the metre if the robot does as it is told,
    /// and places grow forward as in the other learners; the zero is where the stretch begins. Standard
    /// errors are those of independent errors in time.
    SensorConstantAction, "sensor_constant_action",
    "Learns the sensor model from the longest stretch of one constant action.",
    source "Stronger 2008, section 3.2.1, Figure 3.5a", needs Nothing,
    {
        /// Degree of the sensor model, a polynomial of the observation.
        sensor_degree: u32 = 3, "1", 1.0..=8.0;
    }
}

impl Learner for SensorConstantAction {
    fn learn(&self, log: &Log, _given: &Models, _rng: &mut Rng) -> Result<Learned, CannotLearn> {
        let line = Line::try_from(log)?;
        let degree = self.sensor_degree as usize;
        line.require(degree + 2)?;
        let stretch = longest_stretch(&line);
        let none = || CannotLearn::Undetermined("no command other than 0 lasts for some observations".to_string());
        let c_m_per_s = stretch.c_m_per_s.filter(|_| stretch.rows.len() >= degree + 2).ok_or_else(none)?;
        let seen = &line.rows[stretch.rows];
        let start_s = seen[0].t_s;
        let points: Vec<(f64, f64)> = seen.iter().map(|row| (row.o, (row.t_s - start_s) * c_m_per_s)).collect();
        let (centre, scale) = line.observation_scaling();
        let not_finite = || CannotLearn::Undetermined("the observations overflow".to_string());
        let (sensor, regression) =
            Polynomial::fit(points.iter().copied(), degree, centre, scale).ok_or_else(not_finite)?;
        let w_s = seen.iter().map(|row| [row.t_s, sensor.at(row.o)]).collect();
        let w_a = seen.iter().zip(&points).map(|(row, (_, place))| [row.t_s, *place]).collect();
        let se = regression.standard_errors().unwrap_or_default();
        Ok(Learned {
            models: Models {
                sensor: Some(SensorModel::DistanceOfHeight(Curve { polynomial: sensor, se })),
                ..Models::default()
            },
            verdict: Verdict::Converged,
            traces: vec![Trace { name: "w_a", points: w_a }, Trace { name: "w_s", points: w_s }],
            lacks: line.lacks(0),
            ..Learned::default()
        })
    }
}

/// Observations between which one command was in force.
struct Stretch {
    c_m_per_s: Option<f64>,
    rows: std::ops::Range<usize>,
}

/// The stretch of one command other than 0 with the most observations.
fn longest_stretch(line: &Line) -> Stretch {
    let mut longest = Stretch { c_m_per_s: None, rows: 0..0 };
    let mut now = Stretch { c_m_per_s: None, rows: 0..0 };
    for i in 0..line.rows.len() {
        let before = line.pieces(i).iter().filter(|piece| piece.dt_s > 0.0);
        for piece in before {
            if now.c_m_per_s != Some(piece.c_m_per_s) {
                // The row before began this command, if it was seen at that moment; it is left out.
                now = Stretch { c_m_per_s: Some(piece.c_m_per_s), rows: i..i };
            }
        }
        now.rows.end = i + 1;
        if now.c_m_per_s.is_some_and(|c| c != 0.0) && now.rows.len() > longest.rows.len() {
            longest = Stretch { c_m_per_s: now.c_m_per_s, rows: now.rows.clone() };
        }
    }
    longest
}
