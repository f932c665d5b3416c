use asami_dataset::{Action, Frame, Known, Sighting, Size, TruePose};

use super::*;

/// Moves at a known multiple of the command, seen by a noiseless camera every fifth tick.
struct Cart {
    ticks: u64,
    y_m: f64,
    gain: f64,
    drift_m_per_s: f64,
    sees: bool,
}

const TICK_S: f64 = 0.01;

impl Cart {
    fn new(gain: f64) -> Self {
        Self { ticks: 0, y_m: -6.0, gain, drift_m_per_s: 0.0, sees: true }
    }
}

impl World for Cart {
    fn known(&self) -> Known {
        Known::default()
    }

    fn t_s(&self) -> f64 {
        self.ticks as f64 * TICK_S
    }

    fn pose(&self) -> TruePose {
        TruePose { t_s: self.t_s(), x_m: 0.0, y_m: self.y_m, theta_rad: 0.0, v_m_per_s: None }
    }

    fn tick(&mut self, action: Action, record: &mut Record) {
        let command = action.forward_m_per_s().unwrap_or(0.0);
        if self.ticks.is_multiple_of(5) {
            let t_s = self.t_s();
            record.track.push(self.pose());
            record.seen.frames.push(Frame { t_s, head_pan_rad: 0.0 });
            if self.sees {
                // Two heights in turn, of known mean and spread.
                let height_px = if record.seen.frames.len().is_multiple_of(2) { 29.0 } else { 31.0 };
                let size = Size::HeightPx(height_px);
                record.seen.sightings.push(Sighting { t_s, landmark: 0, size, bearing_rad: 0.0 });
            }
        }
        self.y_m += (self.gain * command + self.drift_m_per_s) * TICK_S;
        self.ticks += 1;
    }
}

#[test]
fn lines_are_timed_exactly_where_the_speed_is_constant() {
    for command in [-0.3, -0.14, 0.12, 0.3] {
        let speed = timed_m_per_s(&mut Cart::new(0.8), command, &Surveying::default());
        assert!((speed.unwrap() - 0.8 * command).abs() < 1e-9, "{command}");
    }
}

#[test]
fn slow_walks_and_drift_are_timed_over_a_fixed_time() {
    let how = Surveying::default();
    assert!((timed_m_per_s(&mut Cart::new(0.8), 0.06, &how).unwrap() - 0.048).abs() < 1e-9);
    let mut drifting = Cart { drift_m_per_s: 0.003, ..Cart::new(0.8) };
    assert!((timed_m_per_s(&mut drifting, 0.0, &how).unwrap() - 0.003).abs() < 1e-9);
    assert!(drifting.t_s() < how.run_up_s + how.slow_time_s + 0.1);
}

#[test]
fn a_robot_that_turns_back_never_arrives() {
    struct Bouncing(Cart);
    impl World for Bouncing {
        fn known(&self) -> Known {
            self.0.known()
        }
        fn t_s(&self) -> f64 {
            self.0.t_s()
        }
        fn pose(&self) -> TruePose {
            self.0.pose()
        }
        fn tick(&mut self, action: Action, record: &mut Record) {
            if self.0.t_s() > 14.0 {
                self.0.gain = 0.0;
            }
            self.0.tick(action, record);
        }
    }
    let error = timed_m_per_s(&mut Bouncing(Cart::new(1.0)), 0.2, &Surveying::default());
    assert!(matches!(error, Err(CannotSurvey::NeverArrived { .. })), "{error:?}");
}

#[test]
fn heights_have_their_mean_and_spread() {
    let height = height(&mut Cart::new(1.0), 1.4, &Surveying::default()).unwrap();
    assert_eq!((height.distance_m, height.height_px, height.readings), (1.4, 30.0, 100));
    assert!((height.sd_px - (100.0f64 / 99.0).sqrt()).abs() < 1e-12);
    let mut blind = Cart { sees: false, ..Cart::new(1.0) };
    let error = super::height(&mut blind, 1.4, &Surveying::default());
    assert_eq!(error, Err(CannotSurvey::NotSeen { distance_m: 1.4, found: 0, wanted: 100 }));
}

#[test]
fn commands_and_distances_are_the_dissertations() {
    let how = Surveying::default();
    let commands = how.commands_m_per_s();
    assert_eq!((commands.len(), commands[0], commands[15], commands[30]), (31, -0.3, 0.0, 0.3));
    assert!((commands[1] + 0.28).abs() < 1e-12);
    let distances = how.distances_m();
    assert_eq!(distances.len(), 13);
    assert!((distances[12] - 3.6).abs() < 1e-12);
}
