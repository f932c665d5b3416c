//! A robot that changes while a log is recorded (Stronger 2008, section 4.4.3).

use asami_dataset::{Action, Known, TruePose};

use crate::world::{Record, World};

asami_dataset::parameters! {
    /// Motors that weaken: "multiplying the attempted velocities by 3/4 before they were converted into
    /// low-level motions".
    pub struct Change {
        /// When.
        at_s: f64 = 480.0, "s", 0.0..=3600.0;
        /// Factor on all attempted velocities from then on.
        ratio: f64 = 0.75, "1", 0.1..=1.5;
    }
}

/// A world whose robot attempts a multiple of what it is commanded, from some time on. The log has the
/// commands.
pub struct Changing {
    world: Box<dyn World>,
    change: Change,
}

impl Changing {
    /// `world`, but for the change.
    #[must_use]
    pub fn new(world: Box<dyn World>, change: Change) -> Self {
        Self { world, change }
    }
}

impl World for Changing {
    fn known(&self) -> Known {
        self.world.known()
    }

    fn t_s(&self) -> f64 {
        self.world.t_s()
    }

    fn pose(&self) -> TruePose {
        self.world.pose()
    }

    fn tick(&mut self, action: Action, record: &mut Record) {
        let attempted = match action {
            // Half a microsecond of slack: times are rounded multiples of the period.
            Action::Legs { id, ax_m_per_s, ay_m_per_s, atheta_rad_per_s } if self.t_s() >= self.change.at_s - 5e-7 => {
                let [ax_m_per_s, ay_m_per_s, atheta_rad_per_s] =
                    [ax_m_per_s, ay_m_per_s, atheta_rad_per_s].map(|velocity| velocity * self.change.ratio);
                Action::Legs { id, ax_m_per_s, ay_m_per_s, atheta_rad_per_s }
            }
            as_before => as_before,
        };
        self.world.tick(attempted, record);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Keeps the forward speeds that it was asked for.
    struct Obeying {
        t_s: f64,
        asked: std::sync::mpsc::Sender<(f64, f64)>,
    }

    impl World for Obeying {
        fn known(&self) -> Known {
            Known::default()
        }
        fn t_s(&self) -> f64 {
            self.t_s
        }
        fn pose(&self) -> TruePose {
            TruePose { t_s: self.t_s, x_m: 0.0, y_m: 0.0, theta_rad: 0.0, v_m_per_s: None }
        }
        fn tick(&mut self, action: Action, _: &mut Record) {
            let _ = self.asked.send((self.t_s, action.forward_m_per_s().unwrap_or(f64::NAN)));
            self.t_s += 0.1;
        }
    }

    #[test]
    fn the_robot_attempts_less_from_then_on_and_the_log_does_not_say_so() {
        let (asked, heard) = std::sync::mpsc::channel();
        let change = Change { at_s: 0.5, ratio: 0.75 };
        let mut world = Changing::new(Box::new(Obeying { t_s: 0.0, asked }), change);
        let set = crate::world::run(&mut world, &mut crate::drives::hold::Hold::forward(0.2), 1.0);
        assert_eq!(set.log.commands.len(), 1);
        assert_eq!(set.log.commands[0].action.forward_m_per_s(), Some(0.2));
        drop(world);
        let heard: Vec<(f64, f64)> = heard.iter().collect();
        assert_eq!(heard.len(), 10);
        for (t_s, speed) in heard {
            assert!((speed - if t_s < 0.499 { 0.2 } else { 0.15 }).abs() < 1e-12, "{t_s} {speed}");
        }
    }
}
