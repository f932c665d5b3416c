//! Every constant of a world that an effect may turn, as plain data.
//!
//! Each tick the knobs start at their nominal values, then every effect of the scenario turns them
//! in the catalogue's order. A world writes to its physics engine only where a knob changed.

/// The knobs of all robots, one group per place; a robot turns a deaf ear to those it lacks.
///
/// The groups `body`, `eye`, `scene` and `velodyne`, the size and place of `wheels`, and the slope under an Aibo or a Create
/// are read once, before the log begins.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Knobs {
    /// Between the command and the gait.
    pub command: CommandKnobs,
    /// A legged robot's motors.
    pub motors: MotorKnobs,
    /// A robot's masses and lengths.
    pub body: BodyKnobs,
    /// A wheeled robot's two wheels.
    pub wheels: WheelKnobs,
    /// What the feet or wheels stand on.
    pub ground: GroundKnobs,
    /// Camera, pan encoder and vision.
    pub eye: EyeKnobs,
    /// What stands around the robot.
    pub scene: SceneKnobs,
    /// What a car's mass, engine, brakes and steering are.
    pub vehicle: VehicleKnobs,
    /// How a laser scanner is mounted, timed and read.
    pub velodyne: VelodyneKnobs,
}

/// How a command becomes what the gait generator attempts.
#[derive(Clone, Debug, PartialEq)]
pub struct CommandKnobs {
    /// Factors on the attempted rightward, forward and turning velocity.
    pub scale: [f64; 3],
}

impl Default for CommandKnobs {
    fn default() -> Self {
        Self { scale: [1.0; 3] }
    }
}

/// The servo motors of a legged robot.
#[derive(Clone, Debug, PartialEq)]
pub struct MotorKnobs {
    /// Factors on the torque that the motors of each leg give, for an error and at most: fore left, fore right,
    /// hind left, hind right.
    pub torque_ratio: [f64; 4],
    /// Factor on the greatest speed of all.
    pub speed_ratio: f64,
}

impl Default for MotorKnobs {
    fn default() -> Self {
        Self { torque_ratio: [1.0; 4], speed_ratio: 1.0 }
    }
}

impl MotorKnobs {
    /// Mean factor on the torque.
    #[must_use]
    pub fn mean_torque_ratio(&self) -> f64 {
        0.25 * self.torque_ratio.iter().sum::<f64>()
    }
}

/// The body of a legged or wheeled robot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodyKnobs {
    /// Mass of a load on the torso.
    pub payload_kg: f64,
    /// How far the load is ahead of the body's centre.
    pub payload_ahead_m: f64,
    /// By how much each leg is shorter: fore left, fore right, hind left, hind right.
    pub short_m: [f64; 4],
}

/// The wheels of a robot that turns by driving its two at different speeds.
#[derive(Clone, Debug, PartialEq)]
pub struct WheelKnobs {
    /// Factors on their radii: left, right.
    pub radius_ratio: [f64; 2],
    /// Factor on the distance between them.
    pub base_ratio: f64,
    /// Time constant of their speed's answer to a command on top of its own.
    pub lag_s: f64,
    /// Share of the forward speed that is lost in a turn of 1 rad/s, and with the square of the rate.
    pub turn_loss_s2: f64,
    /// Share by which they go forward faster where a slight turn is told.
    pub slight_gain: f64,
    /// Their tyres turn at multiples of this speed; at any where it is 0.
    pub step_m_per_s: f64,
}

impl Default for WheelKnobs {
    fn default() -> Self {
        Self {
            radius_ratio: [1.0; 2],
            base_ratio: 1.0,
            lag_s: 0.0,
            turn_loss_s2: 0.0,
            slight_gain: 0.0,
            step_m_per_s: 0.0,
        }
    }
}

/// The ground.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundKnobs {
    /// Coulomb friction coefficient between foot or tyre and ground.
    pub friction: f64,
    /// Sine of its slope, times the unit vector uphill in world x and y.
    pub slope: [f64; 2],
}

impl Default for GroundKnobs {
    fn default() -> Self {
        Self { friction: 1.0, slope: [0.0; 2] }
    }
}

/// How the world becomes what the vision reports.
#[derive(Clone, Debug, PartialEq)]
pub struct EyeKnobs {
    /// Factor on the camera's focal length, which the vision takes for the nominal one.
    pub focal_ratio: f64,
    /// Radial distortion of the lens: what is seen at a tangent `r` off the axis comes to stand at
    /// `r (1 + distortion r^2)`.
    pub distortion: f64,
    /// The camera in the head, above where it nominally looks.
    pub pitch_rad: f64,
    /// What the pan's encoder reads while the head looks straight ahead, counter-clockwise.
    pub pan_offset_rad: f64,
    /// What a scanner's bearings read too much at right angles, against those ahead; else by 1 less the bearing's cosine.
    pub eccentricity: f64,
    /// Factor on a scanner's bearings.
    pub bearing_ratio: f64,
    /// By how much an image is older than its time stamp.
    pub delay_s: f64,
    /// Where there are pictures only so often, and each is the newest: how far apart they are.
    pub picture_period_s: f64,
    /// By how much a bright thing is taller, and wider, in the image than it should be.
    pub bloom_px: f64,
    /// Factor on the noise of pixels, or of sizes and bearings where there are no pixels.
    pub noise_ratio: f64,
    /// Factor on ranges.
    pub range_ratio: f64,
    /// What ranges have on top.
    pub range_offset_m: f64,
    /// What ranges have on top at right angles to the left, as a share of them; else by the sine of the bearing.
    pub range_skew: f64,
    /// How much of the way from the range, which is what is asked for, to the depth along the sensor's axis is reported.
    pub depth_share: f64,
}

impl Default for EyeKnobs {
    fn default() -> Self {
        Self {
            focal_ratio: 1.0,
            distortion: 0.0,
            pitch_rad: 0.0,
            pan_offset_rad: 0.0,
            eccentricity: 0.0,
            bearing_ratio: 1.0,
            delay_s: 0.0,
            picture_period_s: 0.0,
            bloom_px: 0.0,
            noise_ratio: 1.0,
            range_ratio: 1.0,
            range_offset_m: 0.0,
            range_skew: 0.0,
            depth_share: 0.0,
        }
    }
}

impl EyeKnobs {
    /// Factor on tangents off the axis, from the true one, given its square, to the one that the vision takes from the
    /// image. Beyond where a barrel would fold back, it opens no further.
    #[must_use]
    pub fn magnification(&self, r2: f64) -> f64 {
        self.focal_ratio * self.bend(r2)
    }

    /// The distortion's part of it.
    #[must_use]
    pub fn bend(&self, r2: f64) -> f64 {
        let turns_r2 = if self.distortion < 0.0 { -1.0 / (3.0 * self.distortion) } else { f64::INFINITY };
        1.0 + self.distortion * r2.min(turns_r2)
    }

    /// When the picture was taken of which a frame at `t_s` reports.
    #[must_use]
    pub fn taken_s(&self, t_s: f64) -> f64 {
        let period_s = self.picture_period_s;
        // A picture that is due now is there.
        let newest_s = if period_s > 0.0 { (t_s / period_s + 1e-9).floor() * period_s } else { t_s };
        newest_s - self.delay_s
    }
}

/// The scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SceneKnobs {
    /// A landmark, counted from the first and round again, and how far it stands from where it is said to, in world x
    /// and y.
    pub moved: Option<(usize, [f64; 2])>,
    /// How many cars come the other way, for each km of the road.
    pub traffic_per_km: f64,
}

/// A car.
#[derive(Clone, Debug, PartialEq)]
pub struct VehicleKnobs {
    /// Factor on mass and moments of inertia.
    pub mass_ratio: f64,
    /// Lies in the luggage space.
    pub luggage_kg: f64,
    /// Factor on the engine's torque before its own friction.
    pub engine_ratio: f64,
    /// Dead time of the throttle's motor on top of its own.
    pub throttle_delay_s: f64,
    /// Share of the throttle's travel that does nothing.
    pub throttle_play: f64,
    /// Factor on the brakes' torque.
    pub brake_ratio: f64,
    /// How much weaker brakes are for the heat in them: their torque is divided by 1 and this times the heat.
    pub brake_fade_per_mj: f64,
    /// Factor on the front wheels' angle.
    pub steering_ratio: f64,
    /// Angle of the front wheels, to the left, while the steering wheel is straight.
    pub steering_offset_rad: f64,
    /// Time constant of the steering's motor on top of its own.
    pub steering_lag_s: f64,
    /// Factors on the stiffness of the tyres' tread, along and across the wheels.
    pub tread_ratio: [f64; 2],
    /// Rolling resistance, as a share of the load, on top of the tyres' own.
    pub rolling_resistance: f64,
    /// Resistance for each m/s on top of the air's.
    pub drag_n_s_per_m: f64,
    /// Resistance for each (m/s)^2 on top of the air's.
    pub drag_n_s2_per_m2: f64,
}

impl Default for VehicleKnobs {
    fn default() -> Self {
        Self {
            mass_ratio: 1.0,
            luggage_kg: 0.0,
            engine_ratio: 1.0,
            throttle_delay_s: 0.0,
            throttle_play: 0.0,
            brake_ratio: 1.0,
            brake_fade_per_mj: 0.0,
            steering_ratio: 1.0,
            steering_offset_rad: 0.0,
            steering_lag_s: 0.0,
            tread_ratio: [1.0; 2],
            rolling_resistance: 0.0,
            drag_n_s_per_m: 0.0,
            drag_n_s2_per_m2: 0.0,
        }
    }
}

/// A laser scanner.
#[derive(Clone, Debug, PartialEq)]
pub struct VelodyneKnobs {
    /// How far its base leans back, its front up.
    pub pitch_rad: f64,
    /// How far its base leans to the right, its left side up.
    pub roll_rad: f64,
    /// Factor on how fast the head turns.
    pub turn_ratio: f64,
    /// How far its clock is ahead of the log's.
    pub ahead_s: f64,
    /// Share of the motion within a turn of the head that is taken out of the turn.
    pub compensated: f64,
    /// Factor on the standard deviation of ranges.
    pub noise_ratio: f64,
    /// Share of returns that get lost on top of its own.
    pub dropouts: f64,
}

impl Default for VelodyneKnobs {
    fn default() -> Self {
        Self {
            pitch_rad: 0.0,
            roll_rad: 0.0,
            turn_ratio: 1.0,
            ahead_s: 0.0,
            compensated: 0.0,
            noise_ratio: 1.0,
            dropouts: 0.0,
        }
    }
}

/// One laser of a scanner, as it departs from what its maker measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LaserKnobs {
    /// Points this much higher.
    pub vertical_rad: f64,
    /// Stands this much farther to the left of where it looks.
    pub left_m: f64,
    /// Stands this much higher.
    pub up_m: f64,
    /// Measures this much too much.
    pub range_m: f64,
}
