//! Where the robot was a moment ago.

use std::collections::VecDeque;

use asami_dataset::TruePose;
use asami_math::angle::wrap_rad;

/// The latest poses, as far back as they are asked for.
#[derive(Clone, Debug, Default)]
pub struct Past {
    poses: VecDeque<TruePose>,
}

impl Past {
    /// Takes note of the latest pose; nothing from before `from_s` will be asked for any more.
    pub fn note(&mut self, pose: TruePose, from_s: f64) {
        self.poses.push_back(pose);
        while self.poses.get(1).is_some_and(|second| second.t_s <= from_s) {
            self.poses.pop_front();
        }
    }

    /// Where the robot was at `t_s`, as if it moved evenly between steps; at the beginning, it stood.
    #[must_use]
    pub fn at(&self, t_s: f64) -> Option<TruePose> {
        let (first, last) = (self.poses.front()?, self.poses.back()?);
        if t_s >= last.t_s {
            return Some(*last);
        }
        let second = self.poses.get(1)?;
        let part = ((t_s - first.t_s) / (second.t_s - first.t_s)).max(0.0);
        Some(TruePose {
            t_s,
            x_m: first.x_m + part * (second.x_m - first.x_m),
            y_m: first.y_m + part * (second.y_m - first.y_m),
            theta_rad: first.theta_rad + part * wrap_rad(second.theta_rad - first.theta_rad),
            v_m_per_s: None,
        })
    }
}
