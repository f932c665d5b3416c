//! The car's Velodyne HDL-64E: 64 lasers that turn ten times a second on a moving, pitching body.
//!
//! [`Velodyne::scan`] takes the [`Scenery`] and the track of [`SensorPose`]s, and gives what the sensor records. Every
//! laser is fired at its own time, from where the sensor is then.

mod art;
mod beams;
mod movers;
mod pose;
mod returns;
mod scan;
mod scenery;
#[cfg(test)]
mod tests;
mod track;
mod unit;

pub use pose::SensorPose;
pub use scan::Velodyne;
pub use scenery::Scenery;
pub use track::TrackError;
pub use unit::{Laser, Unit};

asami_dataset::parameters! {
    /// How a Velodyne works. The default is the dissertation's, a Velodyne HDL-64E (Stronger 2008, section 2.5.2).
    pub struct VelodyneConfig {
        /// Firings of one laser a second.
        firing_rate_hz: f64 = 7800.0, "Hz", 100.0..=50000.0;
        /// Revolutions a second, clockwise seen from above.
        turn_rate_hz: f64 = 10.0, "Hz", 1.0..=30.0;
        /// Angle of the base, the dissertation's theta_b: from the car's rightward axis, counter-clockwise, to where the encoder's zero points. The default is the 89.1 degrees of section 5.4.
        base_rad: f64 = 1.5550883635269477, "rad", -6.3..=6.3;
        /// From a firing's first laser, the lowest, to its last, the highest.
        bank_s: f64 = 48e-6, "s", 0.0..=0.0001;
        /// How far lasers stand off the spin axis: even ones, counted upwards from 0, to the left of where they look, odd ones to the right. Factory tables of later units say 0.026 m.
        offset_m: f64 = 0.0, "m", -0.1..=0.1;
        /// Nothing nearer gives a return.
        least_range_m: f64 = 0.9, "m", 0.0..=10.0;
        /// Nothing farther gives a return.
        greatest_range_m: f64 = 120.0, "m", 1.0..=131.0;
        /// Standard deviation of a range.
        range_sd_m: f64 = 0.015, "m", 0.0..=1.0;
        /// Share of returns that get lost whatever they come from.
        dropouts: f64 = 0.005, "1", 0.0..=1.0;
        /// From this range, half of the returns of a white wall get lost for being too weak, and more of darker or slanting surfaces.
        half_lost_range_m: f64 = 300.0, "m", 1.0..=100000.0;
    }
}
