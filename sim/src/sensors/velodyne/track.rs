//! Where the sensor is at any time, and how it moves: between poses evenly.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};

use super::SensorPose;

/// A track that says too little.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TrackError {
    /// Nothing lies between fewer than two poses.
    #[error("a track has two poses or more, not {0}")]
    Short(usize),
    /// A time that is no later than the one before, or a pose that is no number.
    #[error("pose {pose} of the track, at {t_s} s, is no later than the one before, or no number")]
    Pose {
        /// Which pose, from 0.
        pose: usize,
        /// Its time.
        t_s: f64,
    },
}

/// A sensor's poses over time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Track<'a> {
    poses: &'a [SensorPose],
}

/// Where the sensor is, and how it moves on from there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    pub position_m: [f64; 3],
    pub world_from_sensor: Matrix3<f64>,
    pub velocity_m_per_s: [f64; 3],
    /// Rotation vector per second, in the world's axes.
    pub spin_rad_per_s: [f64; 3],
}

impl<'a> Track<'a> {
    pub fn new(poses: &'a [SensorPose]) -> Result<Self, TrackError> {
        if poses.len() < 2 {
            return Err(TrackError::Short(poses.len()));
        }
        let mut before_s = f64::NEG_INFINITY;
        for (pose, SensorPose { t_s, position_m, world_from_sensor }) in poses.iter().enumerate() {
            let numbers = position_m.iter().chain(world_from_sensor.coords.iter());
            if !t_s.is_finite() || *t_s <= before_s || numbers.into_iter().any(|x| !x.is_finite()) {
                return Err(TrackError::Pose { pose, t_s: *t_s });
            }
            before_s = *t_s;
        }
        Ok(Self { poses })
    }

    /// Of the first and of the last pose.
    pub fn span_s(&self) -> [f64; 2] {
        [self.poses[0].t_s, self.poses[self.poses.len() - 1].t_s]
    }

    /// Before which pose `t_s` lies; the second at the earliest, the last at the latest.
    pub fn find(&self, t_s: f64) -> usize {
        self.poses.partition_point(|pose| pose.t_s <= t_s).clamp(1, self.poses.len() - 1)
    }

    /// The motion at `t_s`; `hint` is where it was last found, and times do not go back. Beyond the ends it goes on as it was.
    pub fn at(&self, t_s: f64, hint: &mut usize) -> Motion {
        while *hint + 1 < self.poses.len() && self.poses[*hint].t_s <= t_s {
            *hint += 1;
        }
        let [a, b] = [&self.poses[*hint - 1], &self.poses[*hint]];
        let step_s = b.t_s - a.t_s;
        let share = (t_s - a.t_s) / step_s;
        let moved: [f64; 3] = std::array::from_fn(|k| b.position_m[k] - a.position_m[k]);
        // Both q and -q are the same turn: take the shorter way.
        let from = *a.world_from_sensor.quaternion();
        let to = *b.world_from_sensor.quaternion();
        let to = if from.dot(&to) < 0.0 { -to } else { to };
        // Physics steps turn by so little that the chord is as even as the arc.
        let between = UnitQuaternion::new_normalize(from * (1.0 - share) + to * share);
        let turned: Quaternion<f64> = to * from.conjugate();
        let vector: Vector3<f64> = turned.imag() * (2.0 / step_s);
        Motion {
            position_m: std::array::from_fn(|k| a.position_m[k] + share * moved[k]),
            world_from_sensor: *between.to_rotation_matrix().matrix(),
            velocity_m_per_s: moved.map(|x| x / step_s),
            spin_rad_per_s: [vector.x, vector.y, vector.z],
        }
    }
}
