//! Every number of the robot that a scenario may set.

// Defaults are literals, pi among them, to its last digit.
#![allow(clippy::approx_constant)]

use asami_dataset::parameters::Fault;

asami_dataset::parameters! {
    /// Gaussian noise on the motion, new each step, in the robot's frame (section 4.4.2 leaves its size open).
    pub struct Motion {
        /// One step.
        time_step_s: f64 = 0.05, "s", 0.001..=1.0;
        /// Standard deviation of one step's rightward displacement.
        right_sd_m: f64 = 0.005, "m", 0.0..=0.1;
        /// Standard deviation of one step's forward displacement.
        forward_sd_m: f64 = 0.005, "m", 0.0..=0.1;
        /// Standard deviation of one step's turn.
        turn_sd_rad: f64 = 0.02, "rad", 0.0..=1.0;
    }
}

asami_dataset::parameters! {
    /// How the velocities that the actions lead to differ from the attempted ones. The standard deviations are
    /// in units of the suite's greatest attempted velocities; each robot draws its own from them, once.
    pub struct Distortion {
        /// From least to greatest rightward velocity of the 40 actions.
        right_range_m_per_s: f64 = 0.71, "m/s", 0.01..=5.0;
        /// From least to greatest forward velocity.
        forward_range_m_per_s: f64 = 0.84, "m/s", 0.01..=5.0;
        /// From least to greatest turning rate.
        turn_range_rad_per_s: f64 = 3.141592653589793, "rad/s", 0.01..=20.0;
        /// Share of a velocity that is lost where it is attempted at the suite's greatest.
        bend: f64 = 0.1, "1", 0.0..=0.5;
        /// Standard deviation of the shares of each attempted velocity that come out as another.
        leak_sd: f64 = 0.04, "1", 0.0..=0.3;
        /// Standard deviation of the velocities that every action has on top, for example a turn to one side.
        bias_sd: f64 = 0.03, "1", 0.0..=0.3;
        /// Standard deviation of the velocities that each action has on top, of its own.
        irregular_sd: f64 = 0.06, "1", 0.0..=0.3;
        /// Which robot: the seed of its distortion, not of a log.
        robot: u64 = 1, "1", 0.0..=9e15;
    }
}

asami_dataset::parameters! {
    /// When beacons are seen, and how large and where.
    pub struct Sight {
        /// Height of a beacon of 200 mm in the image times its distance from the camera (section 2.5.1).
        height_px_m: f64 = 38.3887, "px.m", 1.0..=1000.0;
        /// The camera ahead of the body's centre, from which distances are measured.
        camera_ahead_m: f64 = 0.1, "m", 0.0..=0.3;
        /// Pixels of a beacon's height that the vision loses at its rims.
        lost_px: f64 = 1.0, "px", -5.0..=5.0;
        /// Standard deviation of the noise on heights.
        sigma1_px: f64 = 1.0, "px", 0.0..=20.0;
        /// Standard deviation of the noise on bearings.
        sigma2_rad: f64 = 0.5, "rad", 0.0..=2.0;
        /// Beacons nearer to the body's centre are not recognised.
        near_m: f64 = 1.275, "m", 0.5..=20.0;
        /// Nor are beacons farther from it.
        far_m: f64 = 4.175, "m", 0.5..=20.0;
        /// Width of what the camera sees; 56.9 degrees on an ERS-7.
        view_rad: f64 = 0.9931, "rad", 0.1..=6.2;
        /// Greatest pan either way of the head while it scans.
        scan_amplitude_rad: f64 = 1.4, "rad", 0.0..=3.2;
        /// From left to right and back.
        scan_period_s: f64 = 2.0, "s", 0.1..=60.0;
        /// Share of the beacons in view that the vision recognises.
        recognised: f64 = 0.86, "1", 0.0..=1.0;
    }
}

asami_dataset::tables! {
    /// The robot's tables in a scenario.
    pub struct PlainConfig {
        /// `[plain.motion]`
        motion: Motion;
        /// `[plain.distortion]`
        distortion: Distortion;
        /// `[plain.sight]`
        sight: Sight;
    }
    rule near_before_far
}

fn near_before_far(config: &PlainConfig, path: &str, faults: &mut Vec<Fault>) {
    let (near_m, far_m) = (config.sight.near_m, config.sight.far_m);
    if near_m >= far_m {
        let message = format!("near_m must be less than far_m ({far_m}), not {near_m}");
        faults.push(Fault { path: format!("{path}.sight.near_m"), message });
    }
}

#[cfg(test)]
mod tests {
    use asami_dataset::parameters::Parameters;

    use super::*;

    fn faults(text: &str) -> Vec<String> {
        let config: PlainConfig = toml::from_str(text).unwrap();
        let mut faults = Vec::new();
        config.check("plain", &mut faults);
        faults.into_iter().map(|fault| fault.path).collect()
    }

    #[test]
    fn tables_are_checked_and_unknown_keys_refused() {
        assert_eq!(faults(""), Vec::<String>::new());
        assert_eq!(faults("[motion]\nturn_sd_rad = -1.0"), ["plain.motion.turn_sd_rad"]);
        assert_eq!(faults("[sight]\nnear_m = 4.0\nfar_m = 3.0"), ["plain.sight.near_m"]);
        assert!(toml::from_str::<PlainConfig>("[sight]\nfog_ratio = 0.1").is_err());
    }

    /// A camera may not come to stand in or behind a beacon that it sees.
    #[test]
    fn every_sight_in_range_has_a_height() {
        let least = Sight::table().iter().find(|it| it.name == "near_m").map(|it| it.range.0).unwrap();
        let most = Sight::table().iter().find(|it| it.name == "camera_ahead_m").map(|it| it.range.1).unwrap();
        assert!(most < least, "a camera {most} m ahead passes beacons seen from {least} m");
    }
}
