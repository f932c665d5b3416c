//! What a robot was told, and whether an effect on that would have made anything else of it: where it would not, no log shows it, and what
//! of its response a library learned from other commands fits is of something else. Where odometry stands in for commands, nobody knows what
//! the robot was told, and what its wheels made of that is in the odometry.

use asami_dataset::{Command, CommandsAre, Known, Seed};
use asami_sim::effect::Stage;
use asami_sim::effects::Effects;

use crate::plant::Variant;

/// Commands in force are looked at so often, in seconds.
const TICK_S: f64 = 0.01;

/// What a robot and its wheels make of what they are told.
const OF_TOLD: [&str; 6] = ["command_cycle", "late_start", "slight_turns", "speed_steps", "turn_slowing", "turn_step"];

/// Whether commands are such that an effect of this kind would show in what becomes of them.
pub(super) fn shows_beside(variant: &Variant, known: &Known) -> bool {
    known.commands_are == CommandsAre::Told || !OF_TOLD.contains(&variant.about.name)
}

/// Whether an effect of this kind, at its greatest, makes anything else of these commands. What does not act on commands is not asked.
pub(super) fn acts(variant: &Variant, commands: &[Command]) -> bool {
    let mut effects = Effects::default();
    variant.plant(variant.sizes().1, &mut effects);
    let stages = effects.iter().filter_map(|effect| effect.stage(Seed(0).stream(variant.about.name)));
    let of_commands = stages.filter_map(|stage| if let Stage::Command(of) = stage { Some(of) } else { None });
    let mut asked = of_commands.peekable();
    asked.peek().is_none()
        || asked.any(|mut of| in_force(commands).any(|(t_s, told)| of(t_s, told.action) != told.action))
}

/// The command in force at each moment.
fn in_force(commands: &[Command]) -> impl Iterator<Item = (f64, &Command)> {
    commands.iter().enumerate().flat_map(|(i, told)| {
        let until_s = commands.get(i + 1).map_or(told.t_s + TICK_S, |next| next.t_s);
        let moments = ((until_s - told.t_s) / TICK_S).ceil() as usize;
        (0..moments).map(move |tick| (told.t_s + tick as f64 * TICK_S, told))
    })
}

#[cfg(test)]
mod tests {
    use asami_dataset::Action;
    use asami_sim::effects::catalogue;

    use super::*;

    fn kind(name: &str) -> Variant {
        let about = catalogue().into_iter().find(|about| about.name == name).unwrap();
        Variant::of(about, 10).swap_remove(0)
    }

    /// Twice a second, with a speed for each.
    fn told(speeds_m_per_s: &[f64]) -> Vec<Command> {
        let wheels = |v_m_per_s: f64| Action::Wheels { id: None, v_m_per_s, omega_rad_per_s: 0.0 };
        let command = |(i, v): (usize, &f64)| Command { t_s: 0.5 * i as f64, action: wheels(*v) };
        speeds_m_per_s.iter().enumerate().map(command).collect()
    }

    #[test]
    fn a_robot_that_never_rests_never_starts_late() {
        let late = kind("late_start");
        assert!(!acts(&late, &told(&[0.1, 0.05, 0.1, 0.07])));
        // Never told to go again.
        assert!(!acts(&late, &told(&[0.1, 0.05, 0.0])));
        assert!(acts(&late, &told(&[0.1, 0.0, 0.1])));
    }

    /// What scales, slips and comes late is between the wheels and the ground, or in the clocks: it is there beside odometry as well.
    #[test]
    fn odometry_has_what_wheels_made_of_commands() {
        let [told, odometry] =
            [CommandsAre::Told, CommandsAre::Odometry].map(|commands_are| Known { commands_are, ..Known::default() });
        let all: Vec<&str> = catalogue().into_iter().map(|about| about.name).collect();
        assert!(all.iter().all(|name| shows_beside(&kind(name), &told)));
        let hidden: Vec<&str> = all.into_iter().filter(|name| !shows_beside(&kind(name), &odometry)).collect();
        assert_eq!(hidden, OF_TOLD, "they are in the catalogue, in its order");
        for name in ["wheel_base", "command_scale", "unequal_wheels", "wheel_lag", "range_scale"] {
            assert!(shows_beside(&kind(name), &odometry), "{name}");
        }
    }

    /// Whatever acts on commands before wheels do hides there, but for a delay, which may as well be of a clock.
    #[test]
    fn odometry_hides_all_that_acts_on_commands() {
        let of_commands = |variant: &Variant| {
            let mut effects = Effects::default();
            variant.plant(variant.sizes().1, &mut effects);
            let mut stages = effects.iter().filter_map(|effect| effect.stage(Seed(0).stream("acts/test")));
            stages.any(|stage| matches!(stage, Stage::Command(_)))
        };
        let names = catalogue().into_iter().map(|about| about.name).filter(|name| of_commands(&kind(name)));
        let shown: Vec<&str> = names.filter(|name| !OF_TOLD.contains(name)).collect();
        assert_eq!(shown, ["command_delay"]);
    }

    #[test]
    fn what_is_late_always_acts_and_what_acts_elsewhere_is_not_asked() {
        for name in ["command_delay", "wheel_base", "wheel_lag", "slight_turns", "range_scale"] {
            assert!(acts(&kind(name), &told(&[0.1, 0.05, 0.1])), "{name}");
        }
    }
}
