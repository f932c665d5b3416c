//! The catalogue of effects: one file and one row each.

pub mod base_tilt;
pub mod battery_sag;
pub mod bearing_scale;
pub mod brake_fade;
pub mod camera_pitch;
pub mod car_payload;
pub mod clock_offset;
pub mod command_cycle;
pub mod command_delay;
pub mod command_scale;
pub mod depth_for_range;
pub mod drag;
pub mod dropouts;
pub mod encoder_eccentricity;
pub mod engine_torque;
pub mod false_sightings;
pub mod focal_error;
pub mod ground_friction;
pub mod height_bias;
pub mod image_delay;
pub mod joint_backlash;
pub mod landmark_moved;
pub mod laser_origin_offsets;
pub mod late_start;
pub mod lens_distortion;
pub mod missed_sightings;
pub mod motor_weakness;
pub mod moving_traffic;
pub mod pan_offset;
pub mod payload;
pub mod range_bias;
pub mod range_noise;
pub mod range_offset;
pub mod range_scale;
pub mod range_skew;
pub mod road_grade;
pub mod rolling_resistance;
pub mod servo_latency;
pub mod servo_speed_limit;
pub mod short_leg;
pub mod slight_turns;
pub mod slope;
pub mod speed_steps;
pub mod spin_rate_error;
pub mod stale_pictures;
pub mod steering_lag;
pub mod steering_offset;
pub mod steering_ratio;
pub mod sweep_motion;
pub mod throttle_deadband;
pub mod throttle_delay;
pub mod turn_slowing;
pub mod turn_step;
pub mod tyre_slip;
pub mod unequal_wheels;
pub mod vertical_angle_bias;
pub mod vision_noise;
pub mod weak_leg;
pub mod wheel_base;
pub mod wheel_lag;

use asami_dataset::parameters::{Fault, Parameters};

use crate::effect::{About, Effect};

/// Makes the `[effects]` table and everything that walks it out of one list.
macro_rules! effects {
    ($($name:ident => $T:ident),* $(,)?) => {
        /// The `[effects]` table of a scenario: an effect is on where its table stands.
        #[derive(Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields, default)]
        pub struct Effects {
            $(#[doc = concat!("`[effects.", stringify!($name), "]`")]
              #[serde(skip_serializing_if = "Option::is_none")]
              pub $name: Option<$name::$T>,)*
        }

        /// Every effect there is, in the order in which they act.
        #[must_use]
        pub fn catalogue() -> Vec<&'static About> {
            vec![$($name::$T::about()),*]
        }

        impl Effects {
            /// The effects that are on, in the catalogue's order.
            pub fn iter(&self) -> impl Iterator<Item = &dyn Effect> {
                [$(self.$name.as_ref().map(|effect| effect as &dyn Effect)),*].into_iter().flatten()
            }

            /// Sets one parameter, switching its effect on; `false` if there is no such parameter.
            pub fn set(&mut self, name: &str, parameter: &str, value: f64) -> bool {
                match name {
                    $(stringify!($name) => self.$name.get_or_insert_default().set(parameter, value),)*
                    _ => false,
                }
            }

            /// The same effects less one.
            #[must_use]
            pub fn without(&self, name: &str) -> Self {
                let mut rest = self.clone();
                match name { $(stringify!($name) => rest.$name = None,)* _ => {} }
                rest
            }

            /// Adds a fault for every parameter out of range.
            pub fn check(&self, path: &str, faults: &mut Vec<Fault>) {
                $(if let Some(effect) = &self.$name {
                    effect.check(&format!("{path}.{}", stringify!($name)), faults);
                })*
            }
        }
    };
}

/// Those that are on, so that what depends on the text does not change whenever the catalogue grows.
impl std::fmt::Debug for Effects {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let on = self.iter().map(|effect| (effect.about().name, effect.values()));
        f.debug_map().entries(on).finish()
    }
}

effects! {
    command_cycle => CommandCycle,
    command_delay => CommandDelay,
    late_start => LateStart,
    command_scale => CommandScale,
    servo_speed_limit => ServoSpeedLimit,
    servo_latency => ServoLatency,
    joint_backlash => JointBacklash,
    motor_weakness => MotorWeakness,
    weak_leg => WeakLeg,
    battery_sag => BatterySag,
    ground_friction => GroundFriction,
    slight_turns => SlightTurns,
    slope => Slope,
    speed_steps => SpeedSteps,
    turn_slowing => TurnSlowing,
    turn_step => TurnStep,
    unequal_wheels => UnequalWheels,
    wheel_base => WheelBase,
    wheel_lag => WheelLag,
    payload => Payload,
    short_leg => ShortLeg,
    focal_error => FocalError,
    lens_distortion => LensDistortion,
    camera_pitch => CameraPitch,
    pan_offset => PanOffset,
    encoder_eccentricity => EncoderEccentricity,
    bearing_scale => BearingScale,
    image_delay => ImageDelay,
    stale_pictures => StalePictures,
    height_bias => HeightBias,
    range_scale => RangeScale,
    range_skew => RangeSkew,
    range_offset => RangeOffset,
    depth_for_range => DepthForRange,
    vision_noise => VisionNoise,
    missed_sightings => MissedSightings,
    false_sightings => FalseSightings,
    landmark_moved => LandmarkMoved,
    throttle_delay => ThrottleDelay,
    throttle_deadband => ThrottleDeadband,
    engine_torque => EngineTorque,
    brake_fade => BrakeFade,
    steering_offset => SteeringOffset,
    steering_ratio => SteeringRatio,
    steering_lag => SteeringLag,
    tyre_slip => TyreSlip,
    drag => Drag,
    road_grade => RoadGrade,
    rolling_resistance => RollingResistance,
    car_payload => CarPayload,
    vertical_angle_bias => VerticalAngleBias,
    laser_origin_offsets => LaserOriginOffsets,
    range_bias => RangeBias,
    range_noise => RangeNoise,
    base_tilt => BaseTilt,
    clock_offset => ClockOffset,
    spin_rate_error => SpinRateError,
    dropouts => Dropouts,
    sweep_motion => SweepMotion,
    moving_traffic => MovingTraffic,
}
