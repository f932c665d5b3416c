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
    let read = look(&mut Cart::new(1.0), 1.4, 0, &Surveying::default()).unwrap();
    let height = height(1.4, &read);
    assert_eq!((height.distance_m, height.height_px, height.readings), (1.4, 30.0, 100));
    assert!((height.sd_px - (100.0f64 / 99.0).sqrt()).abs() < 1e-12);
    let mut blind = Cart { sees: false, ..Cart::new(1.0) };
    let error = look(&mut blind, 1.4, 0, &Surveying::default());
    assert_eq!(error, Err(CannotSurvey::NotSeen { distance_m: 1.4, found: 0, wanted: 100 }));
}

#[test]
fn placements_share_the_readings() {
    let how = Surveying { readings: 100, placements: 7, stand_s: 0.5, ..Surveying::default() };
    let reads = (0..7).map(|placement| look(&mut Cart::new(1.0), 1.4, placement, &how).unwrap());
    let reads: Vec<_> = reads.collect();
    assert_eq!(reads.iter().map(Vec::len).sum::<usize>(), 100);
    assert!(reads.iter().flatten().all(|sighting| sighting.t_s >= 0.5));
}

/// Turns evenly about a point off its centre: a circle, however the stretches are cut.
#[test]
fn velocities_in_the_robot_frame_are_those_of_the_arc() {
    struct Carousel {
        t_s: f64,
        velocity: [f64; 3],
    }
    impl World for Carousel {
        fn known(&self) -> Known {
            Known::default()
        }
        fn t_s(&self) -> f64 {
            self.t_s
        }
        fn pose(&self) -> TruePose {
            // A body at constant velocity (right, forward, turn) from the origin: the integral of R(turn t)
            // (right, forward).
            let [right, forward, turn] = self.velocity;
            let angle = turn * self.t_s;
            let (sine, versine) = (angle.sin() / turn, (1.0 - angle.cos()) / turn);
            let (x_m, y_m) = (right * sine - forward * versine, right * versine + forward * sine);
            TruePose { t_s: self.t_s, x_m, y_m, theta_rad: asami_math::angle::wrap_rad(angle), v_m_per_s: None }
        }
        fn tick(&mut self, _action: Action, record: &mut Record) {
            record.track.push(self.pose());
            self.t_s += 1.0 / 30.0;
        }
    }
    let velocity = [-0.12, 0.3, 1.7];
    for arc_s in [0.1, 1.0, 1.5] {
        let how = Surveying { arc_s, ..Surveying::default() };
        let got = super::velocity(&mut Carousel { t_s: 0.0, velocity }, 7, Hold::forward(0.0).0, &how);
        assert_eq!(got.action, 7);
        let got = [got.vx_m_per_s, got.vy_m_per_s, got.vtheta_rad_per_s];
        for (got, wanted) in got.iter().zip(velocity) {
            assert!((got - wanted).abs() < 1e-9, "{got} for {wanted}, stretches of {arc_s} s");
        }
    }
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
