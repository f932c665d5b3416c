//! A town on a hillside.

use crate::effect::{Effect, effect};
use crate::knobs::Knobs;

effect! {
    /// All ground rises evenly towards one side of the world: down leans by as much.
    RoadGrade, "road_grade",
    "The whole town lies on a slope.",
    Dynamics, StaticMotion, fits ["car"],
    source "residential streets rise by 0 to 8 %, in hilly towns by up to 20 %",
    drawn [y_slope: Size { way: Either, least: 0.0005, greatest: 0.06 }],
    {
        /// Rise for each metre towards world +x.
        x_slope: f64 = 0.0, "1", -0.2..=0.2;
        /// Rise for each metre towards world +y.
        y_slope: f64 = 0.0, "1", -0.2..=0.2;
    }
}

impl Effect for RoadGrade {
    fn tune(&self, _t_s: f64, knobs: &mut Knobs) {
        // Knobs hold sines.
        let per_m = (1.0 + self.x_slope * self.x_slope + self.y_slope * self.y_slope).sqrt();
        for (sine, slope) in knobs.ground.slope.iter_mut().zip([self.x_slope, self.y_slope]) {
            *sine += slope / per_m;
        }
    }
}
