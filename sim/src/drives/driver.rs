//! A person at the wheel: follows a route, slows for corners, stops at stop lines, pulls away again.
//!
//! Eyes see the road ahead, hands and feet follow late and not quite as meant: a dead time and a lag on every
//! movement, a foot that needs time from pedal to pedal, slow moods of speed and place in the lane, tremor.

use std::collections::VecDeque;

use asami_dataset::{Action, Rng, TruePose};
use asami_math::elementary::{atan, exp, hypot, ln_1p, sin_cos, tan};
use rand_distr::{Distribution, StandardNormal};

use crate::robots::car::Model;
use crate::scenes::town::Route;
use crate::world::{Drive, Seen};

asami_dataset::parameters! {
    /// How a person drives.
    pub struct Driving {
        /// Speed along free streets.
        cruise_m_per_s: f64 = 5.25, "m/s", 1.0..=15.0;
        /// Standard deviation of its moods.
        cruise_sd_m_per_s: f64 = 0.35, "m/s", 0.0..=3.0;
        /// How long a mood lasts.
        mood_s: f64 = 12.0, "s", 0.5..=100.0;
        /// Yaw rate that feels right in a corner.
        corner_yaw_rad_per_s: f64 = 0.175, "rad/s", 0.05..=1.0;
        /// Acceleration when pulling away.
        acceleration_m_per_s2: f64 = 2.1, "m/s^2", 0.3..=5.0;
        /// Deceleration at which braking from the usual speed begins.
        braking_m_per_s2: f64 = 2.7, "m/s^2", 0.3..=8.0;
        /// Share of it that is left when the car comes to a stop.
        easing: f64 = 0.3, "1", 0.05..=1.0;
        /// Relative standard deviation of both from stop to stop.
        vigour_sd: f64 = 0.07, "1", 0.0..=0.5;
        /// Least and most time stood at a stop line.
        least_wait_s: f64 = 1.5, "s", 0.0..=60.0;
        /// Most time stood at a stop line.
        most_wait_s: f64 = 4.0, "s", 0.0..=60.0;
        /// Time between what is seen and what hands and feet do.
        dead_time_s: f64 = 0.2, "s", 0.0..=1.0;
        /// Time constant of their movements.
        lag_s: f64 = 0.15, "s", 0.01..=2.0;
        /// From pedal to pedal.
        change_s: f64 = 0.3, "s", 0.0..=2.0;
        /// Relative tremor of the feet.
        foot_tremor: f64 = 0.03, "1", 0.0..=0.5;
        /// Tremor of the hands, in full turns of the steering.
        hand_tremor: f64 = 0.004, "1", 0.0..=0.2;
        /// How far ahead the eyes are, in time.
        look_ahead_s: f64 = 1.5, "s", 0.2..=5.0;
        /// And at least.
        least_look_ahead_m: f64 = 5.5, "m", 1.0..=30.0;
        /// Standard deviation of the place in the lane.
        wander_m: f64 = 0.08, "m", 0.0..=1.0;
        /// How long a place in the lane is kept.
        wander_s: f64 = 6.0, "s", 0.5..=100.0;
    }
}

/// What the driver knows of the car by feel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feel {
    /// Throttle for each m/s^2 when pulling away.
    pub throttle_s2_per_m: f64,
    /// Throttle that holds a speed, for each m/s.
    pub holding_s_per_m: f64,
    /// Throttle that creeping saves, for each m/s below its speed.
    pub creeping_s_per_m: f64,
    /// Speed at which the car creeps of itself.
    pub creep_m_per_s: f64,
    /// Brake for each m/s^2.
    pub brake_s2_per_m: f64,
    /// How late the car answers the steering.
    pub late_s: f64,
    /// Front wheels' angle at full steering.
    pub steering_rad: f64,
    /// From axle to axle.
    pub wheelbase_m: f64,
    /// What is followed, the Velodyne's place, before the rear axle.
    pub before_rear_axle_m: f64,
}

impl Default for Feel {
    fn default() -> Self {
        Self {
            throttle_s2_per_m: 0.084,
            holding_s_per_m: 0.012,
            creeping_s_per_m: 0.02,
            creep_m_per_s: 2.0,
            brake_s2_per_m: 0.1,
            late_s: 0.2,
            steering_rad: 0.6,
            wheelbase_m: 2.332,
            before_rear_axle_m: 1.066,
        }
    }
}

impl Feel {
    /// Of a race car: light, long, with a lock of 16 degrees and brakes of its own.
    const RACE_CAR: Self = Self {
        throttle_s2_per_m: 0.03,
        holding_s_per_m: 0.012,
        creeping_s_per_m: 0.02,
        creep_m_per_s: 2.0,
        brake_s2_per_m: 0.09,
        late_s: 0.15,
        steering_rad: 0.2793,
        wheelbase_m: 2.9718,
        before_rear_axle_m: 1.2933,
    };

    /// Of a car that ships with the program.
    #[must_use]
    pub fn of(model: Model) -> Self {
        match model {
            Model::Vehicross => Self::default(),
            Model::Av21 => Self::RACE_CAR,
        }
    }
}

/// What is being done about the next stop line.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mind {
    /// Under way.
    Going,
    /// Braking for the stop line.
    Stopping,
    /// Standing until then.
    Waiting { until_s: f64 },
}

#[derive(Clone, Copy, Debug, Default)]
struct Limbs {
    throttle: f64,
    brake: f64,
    steering: f64,
}

/// The person.
pub struct Driver {
    config: Driving,
    feel: Feel,
    route: Route,
    rng: Rng,
    mind: Mind,
    pose: Option<TruePose>,
    last_t_s: f64,
    along_m: f64,
    /// Index of the next stop line, of those of all rounds.
    next_stop: usize,
    vigour: [f64; 2],
    mood: Drift,
    wander: Drift,
    tremor: [Drift; 2],
    /// Correction of the throttle by the speed's error.
    patience: f64,
    braking: bool,
    foot_free_s: f64,
    intended: VecDeque<(f64, Limbs)>,
    limbs: Limbs,
}

/// First-order Gauss-Markov noise of standard deviation 1.
#[derive(Clone, Copy, Debug, Default)]
struct Drift(f64);

impl Drift {
    fn step(&mut self, rng: &mut Rng, dt_s: f64, correlation_s: f64) -> f64 {
        let kept = exp(-dt_s / correlation_s);
        let normal: f64 = StandardNormal.sample(rng);
        self.0 = kept * self.0 + (1.0 - kept * kept).sqrt() * normal;
        self.0
    }
}

impl Driver {
    /// Someone who stands on a route at `along_m` and wants to go on along it. All chance comes from `rng`.
    #[must_use]
    pub fn new(config: Driving, feel: Feel, route: Route, along_m: f64, mut rng: Rng) -> Self {
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let (mood, wander) = (Drift(normal()), Drift(normal()));
        let mut driver = Self {
            config,
            feel,
            next_stop: 0,
            mind: Mind::Going,
            pose: None,
            last_t_s: 0.0,
            along_m,
            vigour: [1.0; 2],
            mood,
            wander,
            tremor: [Drift::default(); 2],
            patience: 0.0,
            braking: true,
            foot_free_s: 0.0,
            intended: VecDeque::new(),
            limbs: Limbs { brake: 0.3, ..Limbs::default() },
            route,
            rng,
        };
        while driver.stop_m() <= along_m + 1.0 {
            driver.next_stop += 1;
        }
        driver.wait(0.0);
        driver
    }

    /// How far along the route the car is; rounds add up.
    #[must_use]
    pub fn along_m(&self) -> f64 {
        self.along_m
    }

    /// Where the next stop line is, in the measure of [`along_m`](Self::along_m).
    fn stop_m(&self) -> f64 {
        let stops = self.route.stops_m();
        match stops.len() {
            0 => f64::INFINITY,
            n => stops[self.next_stop % n] + (self.next_stop / n) as f64 * self.route.length_m(),
        }
    }

    fn wait(&mut self, t_s: f64) {
        let share: f64 = rand::RngExt::random(&mut self.rng);
        let (least, most) = (self.config.least_wait_s, self.config.most_wait_s);
        self.mind = Mind::Waiting { until_s: t_s + least + share * (most - least).max(0.0) };
        self.vigour = [(); 2].map(|()| {
            let normal: f64 = StandardNormal.sample(&mut self.rng);
            1.0 + self.config.vigour_sd * normal.clamp(-1.5, 1.5)
        });
    }

    /// The acceleration that is wanted now.
    fn wish_m_per_s2(&mut self, t_s: f64, speed_m_per_s: f64, mood: f64) -> Option<f64> {
        let [eager, firm] = self.vigour;
        let to_stop_m = self.stop_m() - self.along_m;
        let (usual, cruise) = (self.config.braking_m_per_s2 * firm, self.config.cruise_m_per_s);
        // Firm at first, easing off with the speed: a(v) = p + q v takes v/q - p/q^2 ln(1 + q v / p) to a stop.
        let (p, q) = (usual * self.config.easing, usual * (1.0 - self.config.easing) / cruise);
        let usual_m = speed_m_per_s / q - p / (q * q) * ln_1p(q * speed_m_per_s.max(0.0) / p);
        // The foot is late, and nobody waits to the last metre.
        let left_m = to_stop_m - 0.3 - speed_m_per_s * if self.braking { 0.0 } else { self.config.change_s };
        let needed = usual_m / left_m.max(0.1);
        match self.mind {
            Mind::Waiting { until_s } if t_s < until_s => return None,
            Mind::Waiting { .. } => self.mind = Mind::Going,
            Mind::Going if needed > 1.0 && to_stop_m < 30.0 => self.mind = Mind::Stopping,
            Mind::Going => {}
            Mind::Stopping => {
                if speed_m_per_s < 0.08 && to_stop_m > 3.0 {
                    self.mind = Mind::Going;
                    return Some(0.3);
                }
                if speed_m_per_s < 0.08 {
                    self.next_stop += 1;
                    self.wait(t_s);
                    return None;
                }
                let eased = (0.4 + speed_m_per_s / 0.8).min(1.0);
                return Some(-needed.clamp(0.7, 1.15) * (p + q * speed_m_per_s) * eased);
            }
        }
        let eager = self.config.acceleration_m_per_s2 * eager;
        let mut wanted = cruise + self.config.cruise_sd_m_per_s * mood.clamp(-1.5, 1.5);
        for step in 0..=24 {
            let ahead_m = f64::from(step);
            let curvature = self.route.at(self.along_m + ahead_m).curvature_per_m.abs();
            if curvature > 0.0 {
                let corner = self.config.corner_yaw_rad_per_s / curvature;
                wanted = wanted.min((corner * corner + 2.0 * 0.5 * usual * (ahead_m - 1.0).max(0.0)).sqrt());
                break;
            }
        }
        Some((1.1 * (wanted - speed_m_per_s)).clamp(-usual, eager))
    }

    /// Feet for a wished acceleration.
    fn feet(&mut self, t_s: f64, wish: Option<f64>, speed_m_per_s: f64, dt_s: f64) -> (f64, f64) {
        let Some(wish) = wish else {
            self.braking = true;
            self.patience = 0.0;
            return (0.0, 0.32);
        };
        // Lifting the foot off the throttle already slows the car: only more than that takes the brake.
        let (press, release) = (-0.7, -0.25);
        let change = if self.braking { wish > release } else { wish < press };
        if change {
            self.braking = !self.braking;
            self.foot_free_s = t_s + self.config.change_s;
            self.patience = 0.0;
        }
        if t_s < self.foot_free_s {
            return (0.0, 0.0);
        }
        let over_m_per_s = speed_m_per_s - self.feel.creep_m_per_s;
        if self.braking {
            // Brakes have to overcome the engine, which pushes on below creeping speed.
            let creeping = self.feel.creeping_s_per_m / self.feel.throttle_s2_per_m * (-over_m_per_s).max(0.0);
            return (0.0, ((creeping - wish) * self.feel.brake_s2_per_m).clamp(0.0, 1.0));
        }
        let error = wish.clamp(-0.6, 0.6);
        self.patience = (self.patience + 0.02 * error * dt_s).clamp(-0.05, 0.08);
        let holding = if over_m_per_s > 0.0 { self.feel.holding_s_per_m } else { self.feel.creeping_s_per_m };
        let throttle = holding * over_m_per_s + wish * self.feel.throttle_s2_per_m + self.patience;
        (throttle.clamp(0.0, 1.0), 0.0)
    }

    /// Steering towards a place ahead on the route (pure pursuit of the rear axle), seen from where the car will be
    /// when the hands have moved.
    fn hands(&self, pose: &TruePose, speed_m_per_s: f64, wander: f64) -> f64 {
        let soon_m = speed_m_per_s * (self.config.dead_time_s + self.config.lag_s + self.feel.late_s);
        let turning_per_m = tan(self.limbs.steering * self.feel.steering_rad) / self.feel.wheelbase_m;
        let (sin, cos) = sin_cos(pose.theta_rad + turning_per_m * soon_m);
        let (ahead, right) = ([-sin, cos], [cos, sin]);
        let soon_m = soon_m - self.feel.before_rear_axle_m;
        let rear = [pose.x_m + soon_m * ahead[0], pose.y_m + soon_m * ahead[1]];
        let look_m = (self.config.look_ahead_s * speed_m_per_s).max(self.config.least_look_ahead_m);
        let aim = self.route.at(self.along_m + soon_m + look_m);
        let aside_m = self.config.wander_m * wander;
        let to = [aim.x_m + aside_m * aim.right()[0] - rear[0], aim.y_m + aside_m * aim.right()[1] - rear[1]];
        let distance_m = hypot(to[0], to[1]).max(1.0);
        let left_m = -(to[0] * right[0] + to[1] * right[1]);
        // kappa = 2 sin(alpha) / l (Coulter, 1992)
        let curvature = 2.0 * left_m / (distance_m * distance_m);
        (atan(curvature * self.feel.wheelbase_m) / self.feel.steering_rad).clamp(-1.0, 1.0)
    }
}

impl Drive for Driver {
    fn localise(&mut self, pose: &TruePose) {
        self.pose = Some(*pose);
    }

    fn act(&mut self, t_s: f64, _seen: &Seen) -> Action {
        let dt_s = (t_s - self.last_t_s).max(0.0);
        self.last_t_s = t_s;
        let config = self.config.clone();
        let mood = self.mood.step(&mut self.rng, dt_s, config.mood_s);
        let wander = self.wander.step(&mut self.rng, dt_s, config.wander_s);
        let foot = self.tremor[0].step(&mut self.rng, dt_s, 0.4);
        let hand = self.tremor[1].step(&mut self.rng, dt_s, 0.5);
        if let Some(pose) = self.pose {
            let speed_m_per_s = pose.v_m_per_s.unwrap_or_default();
            self.along_m = self.route.along_m([pose.x_m, pose.y_m], self.along_m);
            let wish = self.wish_m_per_s2(t_s, speed_m_per_s, mood);
            let (throttle, brake) = self.feet(t_s, wish, speed_m_per_s.max(0.0), dt_s);
            // Nobody turns the wheels of a car that stands.
            let standing = speed_m_per_s < 0.15 && wish.is_none();
            let steering = match self.intended.back() {
                Some((_, last)) if standing => last.steering,
                _ => self.hands(&pose, speed_m_per_s.max(0.0), wander) + config.hand_tremor * hand,
            };
            let shaken = 1.0 + config.foot_tremor * foot;
            let limbs = Limbs { throttle: throttle * shaken, brake: brake * shaken, steering };
            self.intended.push_back((t_s + config.dead_time_s, limbs));
        }
        while self.intended.len() > 1 && self.intended.get(1).is_some_and(|(due_s, _)| *due_s <= t_s + 5e-7) {
            self.intended.pop_front();
        }
        if let Some((due_s, wanted)) = self.intended.front()
            && *due_s <= t_s + 5e-7
        {
            let share = 1.0 - exp(-dt_s / config.lag_s);
            self.limbs.throttle += share * (wanted.throttle - self.limbs.throttle);
            self.limbs.brake += share * (wanted.brake - self.limbs.brake);
            self.limbs.steering += share * (wanted.steering - self.limbs.steering);
        }
        // A foot that has left its pedal does not press it.
        let foot = |value: f64| if value < 0.004 { 0.0 } else { value.min(1.0) };
        Action::Pedals {
            throttle: foot(self.limbs.throttle),
            brake: foot(self.limbs.brake),
            steering: self.limbs.steering.clamp(-1.0, 1.0),
        }
    }
}
