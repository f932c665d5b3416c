//! Keeping the beacon straight ahead.

use asami_dataset::Sighting;

use super::config::HeadingHold;

/// The heading hold's memory: when and where it last saw its beacon.
#[derive(Clone, Debug)]
pub struct Heading {
    hold: HeadingHold,
    beacon: Option<u16>,
    last: Option<(f64, f64)>,
}

impl Heading {
    /// Holds on `beacon`, if there is one.
    #[must_use]
    pub fn new(hold: HeadingHold, beacon: Option<u16>) -> Self {
        Self { hold, beacon, last: None }
    }

    /// Takes note of one frame's sightings.
    pub fn look(&mut self, sightings: &[Sighting]) {
        if let Some(seen) = sightings.iter().find(|sighting| Some(sighting.landmark) == self.beacon) {
            self.last = Some((seen.t_s, seen.bearing_rad));
        }
    }

    /// The turning rate to add to an attempt at `t_s`; none to a robot that is told to stand.
    #[must_use]
    pub fn turn_rad_per_s(&self, t_s: f64, attempt: &[f64; 3]) -> f64 {
        match self.last {
            Some((seen_s, bearing_rad)) if t_s - seen_s <= self.hold.memory_s && *attempt != [0.0; 3] => {
                (self.hold.gain_per_s * bearing_rad).clamp(-self.hold.clip_rad_per_s, self.hold.clip_rad_per_s)
            }
            _ => 0.0,
        }
    }
}
