//! Cars that come the other way, evenly and without end.

use asami_dataset::Rng;
use rand::RngExt;

use crate::scenes::solid::Solid;

/// How fast they drive.
const SPEED_M_PER_S: f64 = 5.0;
/// Half the extents of body and cabin, forward, aside and up, and how high their middles are.
const BOXES: [([f64; 3], f64); 2] = [([2.1, 0.85, 0.36], 0.54), ([1.1, 0.72, 0.28], 1.16)];

/// Cars on a closed way of their own. They are seen, and nothing runs into them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Traffic {
    /// Places of the road's surface in the order in which they are driven, about a metre apart.
    way: Vec<[f64; 3]>,
    /// Where each car is at first, in steps of the way.
    starts: Vec<f64>,
}

impl Traffic {
    /// As many cars for each km of `way`, whose places are a metre apart; evenly, give or take half a gap. At least
    /// one, unless there are to be none.
    #[must_use]
    pub fn new(way: Vec<[f64; 3]>, per_km: f64, rng: &mut Rng) -> Self {
        let length = way.len() as f64;
        let count = (1e-3 * per_km * length).ceil();
        let start = |i: usize| (i as f64 + 0.5 * rng.random::<f64>()) * length / count;
        Self { starts: (0..count as usize).map(start).collect(), way }
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.starts.is_empty()
    }

    /// The boxes of all cars at a time.
    #[must_use]
    pub fn solids(&self, t_s: f64) -> Vec<Solid> {
        let place = |step: f64| {
            let step = step.rem_euclid(self.way.len() as f64);
            let (first, share) = (step as usize, step.fract());
            let [a, b] = [first, first + 1].map(|i| self.way[i % self.way.len()]);
            let ahead = [b[0] - a[0], b[1] - a[1]];
            let length_m = (ahead[0] * ahead[0] + ahead[1] * ahead[1]).sqrt().max(1e-9);
            ([0, 1, 2].map(|k| a[k] + share * (b[k] - a[k])), ahead.map(|x| x / length_m))
        };
        let boxes = |start: &f64| {
            let (at_m, along) = place(start + SPEED_M_PER_S * t_s);
            BOXES.map(|(half_m, up_m)| Solid { centre_m: [at_m[0], at_m[1], at_m[2] + up_m], half_m, along })
        };
        self.starts.iter().flat_map(boxes).collect()
    }
}
