//! All that helped: lasers off the axis, scans matched point to line, and an action model whose roll-out is learned.

use asami_dataset::{Log, Models, Rng};

use crate::car_sides::CarSides;
use crate::learner::{CannotLearn, Learned, Learner, learner};
use crate::lidar::{Car, Fit, FreeRun, Registered};

learner! {
    /// As `car_sides`, but for the action model: as that of `car_registered`, but the coefficients of acceleration are those whose roll-out over
    /// the whole drive comes nearest the measured speeds, in place of those that explain each acceleration by itself: better where the
    /// model runs free, worse one step ahead. Standard errors are those of the last Gauss-Newton step, what is left taken to be a first-order process; the
    /// delay is taken as known.
    CarBest, "car_best",
    "As car_sides, with the action model of car_registered, but coefficients whose roll-out over the whole drive comes nearest the measured speeds.",
    source "this project; Ljung 1999, section 7.2", needs Firings,
    {
        /// From one scan to the next; 0 takes every turn.
        scan_interval_s: f64 = 0.5, "s", 0.0..=10.0;
        /// Of a longer drive so many turns are used for the angles, spread over it; 0: all.
        most_turns: u32 = 100, "1", 0.0..=1000000.0;
        /// Delays up to this are tried.
        most_delay_s: f64 = 0.5, "s", 0.0..=2.0;
        /// Share of 9.81 m/s^2 that a term may make at full pedals and the greatest speed, one standard deviation; 0: any.
        grip: f64 = 1.0, "1", 0.0..=100.0;
    }
}

impl CarBest {
    /// The answers to Algorithm 3's questions.
    #[must_use]
    pub fn car(&self) -> Car {
        let &Self { scan_interval_s, most_turns, most_delay_s, grip } = self;
        let fit = Fit::FreeRun(FreeRun { from: Registered { most_delay_s, grip } });
        Car { fit, ..CarSides { scan_interval_s, most_turns }.car() }
    }
}

impl Learner for CarBest {
    fn learn(&self, log: &Log, given: &Models, _rng: &mut Rng) -> Result<Learned, CannotLearn> {
        self.car().learn(log, given)
    }
}
