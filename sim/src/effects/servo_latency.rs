//! Servos that act late.

use std::collections::VecDeque;

use asami_dataset::Rng;

use crate::effect::{Effect, Stage, effect};

effect! {
    /// Every set-point reaches its motor a fixed time after the gait has chosen it, the neck's too.
    ServoLatency, "servo_latency",
    "Set-points reach the servos a fixed time after the gait has chosen them.",
    Actuation, Timing, fits ["aibo"],
    source "hobby servos lag by 80 to 160 ms, good drives by under 25 ms",
    drawn [latency_s: Size { way: Up, least: 0.008, greatest: 0.16 }],
    {
        /// From the gait's choice to the motor.
        latency_s: f64 = 0.0, "s", 0.0..=0.3;
    }
}

impl Effect for ServoLatency {
    fn stage(&self, _rng: Rng) -> Option<Stage> {
        if self.is_null() {
            return None;
        }
        let latency_s = self.latency_s;
        let mut chosen: VecDeque<(f64, Vec<f64>)> = VecDeque::new();
        Some(Stage::Joint(Box::new(move |t_s, aimed_rad| {
            let due_s = t_s - latency_s;
            chosen.push_back((t_s, aimed_rad.to_vec()));
            while chosen.get(1).is_some_and(|(second_s, _)| *second_s <= due_s) {
                chosen.pop_front();
            }
            let (Some((first_s, first)), second) = (chosen.front(), chosen.get(1)) else { return };
            // Between ticks set-points move evenly; before the first one they stand.
            let (second_s, second) = second.map_or((*first_s, first), |(t_s, angles)| (*t_s, angles));
            let part = if due_s > *first_s { (due_s - first_s) / (second_s - first_s) } else { 0.0 };
            for ((aimed, first), second) in aimed_rad.iter_mut().zip(first).zip(second) {
                *aimed = first + part * (second - first);
            }
        })))
    }
}
