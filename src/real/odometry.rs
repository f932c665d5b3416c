//! Odometry that stands in for commands: its noise is averaged away, and it is dated by when the robot was told; and frames that
//! follow at once, which say little of their own, or are put together.
//!
//! A speed that was measured is off by a noise of its own at every reading. Taken for what was commanded, it would make a
//! robot seem to do less than it is told, the more so the shorter the time over which it is looked at (regression dilution,
//! Spearman 1904); a robot's own speed changes slowly.

use asami_dataset::{Action, Channel, Command, Frame, Log};

use super::clock::dated;
use super::cycle::{dated_like_others, taken_up, taken_up_like_others};
use super::points::put_together;

/// What is made of a real log before it is diagnosed: in this order, where it is said.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Readied {
    /// Over how long commands are [`averaged`].
    pub average_s: Option<f64>,
    /// By how much they are [`earlier`].
    pub earlier_s: Option<f64>,
    /// How many pictures a second the camera takes, by a clock of its own: see [`super::clock`].
    pub camera_hz: Option<f64>,
    /// About how long a cycle is in which commands are taken up once: see [`super::cycle`].
    pub command_cycle_s: Option<f64>,
    /// Over how long what is seen of a landmark is put together: see [`super::points`].
    pub points_s: Option<f64>,
    /// How far apart frames are, [`thinned`].
    pub every_s: Option<f64>,
}

/// What became of the clocks of a robot's own that were asked for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clocks {
    /// In words, of each, and of normal points.
    pub said: Vec<String>,
    /// From each picture to the next, if what was seen was taken back.
    pub picture_period_s: Option<f64>,
    /// From one look for commands to the next, if they are given as they were taken up.
    pub command_cycle_s: Option<f64>,
}

/// What the logs of others of a make tell of such clocks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OfOthers {
    /// From each picture to the next.
    pub picture_s: Option<f64>,
    /// From one look for commands to the next.
    pub cycle_s: Option<f64>,
}

impl Readied {
    /// The same without the robot's own clocks: what it was told, and saw, as it was dated.
    #[must_use]
    pub fn but_for_clocks(self) -> Self {
        Self { camera_hz: None, command_cycle_s: None, ..self }
    }

    /// The log so made, and what became of its clocks.
    #[must_use]
    pub fn of(self, log: &Log) -> (Log, Clocks) {
        self.of_make(log, OfOthers::default())
    }

    /// The same of a robot of a make of which others' logs tell what its own may not.
    #[must_use]
    pub fn of_make(self, log: &Log, others: OfOthers) -> (Log, Clocks) {
        let (mut made, mut clocks) = (log.clone(), Clocks::default());
        if let Some(over_s) = self.average_s {
            made = averaged(&made, over_s);
        }
        if let Some(by_s) = self.earlier_s {
            made = earlier(&made, by_s);
        }
        if let Some(hz) = self.camera_hz {
            let told = dated(&made, hz);
            let both = others.picture_s.zip(others.cycle_s.filter(|_| self.command_cycle_s.is_some()));
            let like_others = both.filter(|_| told.period_s.is_none());
            let told = like_others
                .and_then(|(picture_s, cycle_s)| dated_like_others(&made, picture_s, cycle_s))
                .unwrap_or(told);
            (made, clocks.picture_period_s) = (told.log, told.period_s);
            clocks.said.push(told.said);
        }
        if let Some(about_s) = self.command_cycle_s {
            let told = taken_up(&made, about_s);
            let like_others = others.cycle_s.filter(|_| told.period_s.is_none());
            let told = like_others.and_then(|cycle_s| taken_up_like_others(&made, cycle_s)).unwrap_or(told);
            (made, clocks.command_cycle_s) = (told.log, told.period_s);
            clocks.said.push(told.said);
        }
        if let Some(over_s) = self.points_s {
            let (points, said) = put_together(&made, over_s);
            made = points;
            clocks.said.push(said);
        }
        if let Some(every_s) = self.every_s {
            made = thinned(&made, every_s);
        }
        (made, clocks)
    }

    /// What means nothing, by its key.
    #[must_use]
    pub fn faults(self) -> Vec<(&'static str, String)> {
        let keys = [
            ("average_s", self.average_s, 0.01..=10.0, "s"),
            ("earlier_s", self.earlier_s, 0.001..=1.0, "s"),
            ("camera_hz", self.camera_hz, 0.5..=200.0, "Hz"),
            ("command_cycle_s", self.command_cycle_s, 0.02..=2.0, "s"),
            ("points_s", self.points_s, 0.01..=5.0, "s"),
            ("every_s", self.every_s, 0.001..=10.0, "s"),
        ];
        let out_of_range = keys.into_iter().filter_map(|(key, value, range, unit)| {
            let value = value.filter(|value| !range.contains(value))?;
            Some((key, format!("{key} must lie in {}..={} {unit}, not {value}", range.start(), range.end())))
        });
        out_of_range.collect()
    }
}

/// The log with each wheel command the mean of those in force within `over_s` about it.
#[must_use]
pub fn averaged(log: &Log, over_s: f64) -> Log {
    let given = &log.commands;
    let velocity = |row: &Command| row.action.velocity().unwrap_or_default();
    // Way and turn commanded until each row.
    let mut sums = vec![[0.0; 2]];
    for pair in given.windows(2) {
        let (last, held_s) = (sums[sums.len() - 1], pair[1].t_s - pair[0].t_s);
        let [v, omega] = velocity(&pair[0]);
        sums.push([last[0] + held_s * v, last[1] + held_s * omega]);
    }
    let until = |t_s: f64| {
        let i = given.partition_point(|row| row.t_s <= t_s).saturating_sub(1);
        let ([v, omega], held_s) = (velocity(&given[i]), t_s - given[i].t_s);
        [sums[i][0] + held_s * v, sums[i][1] + held_s * omega]
    };
    let (Some(first), Some(last)) = (given.first(), given.last()) else { return log.clone() };
    let mean = |row: &Command| {
        let ends_s = [row.t_s - 0.5 * over_s, row.t_s + 0.5 * over_s].map(|t_s| t_s.clamp(first.t_s, last.t_s));
        let ([a, b], length_s) = (ends_s.map(until), ends_s[1] - ends_s[0]);
        match row.action {
            Action::Wheels { id, .. } if length_s > 0.0 => {
                let [v_m_per_s, omega_rad_per_s] = [0, 1].map(|k| (b[k] - a[k]) / length_s);
                Command { t_s: row.t_s, action: Action::Wheels { id, v_m_per_s, omega_rad_per_s } }
            }
            _ => *row,
        }
    };
    Log { commands: given.iter().map(mean).collect::<Vec<_>>().into(), ..log.clone() }
}

/// The log with its commands given earlier. What was measured at a time is the mean of the time since the reading before: taken
/// for a command that holds from then on, it comes a reading too late, and no robot in the list of effects answers early.
#[must_use]
pub fn earlier(log: &Log, by_s: f64) -> Log {
    let Some(began_s) = log.commands.first().map(|first| first.t_s) else { return log.clone() };
    let moved: Vec<Command> = log.commands.iter().map(|row| Command { t_s: row.t_s - by_s, ..*row }).collect();
    // What is in force when the log begins is given then.
    let in_force = moved.partition_point(|row| row.t_s <= began_s).max(1) - 1;
    let first = Command { t_s: began_s, ..moved[in_force] };
    Log {
        commands: std::iter::once(first).chain(moved[in_force + 1..].iter().copied()).collect::<Vec<_>>().into(),
        ..log.clone()
    }
}

/// The log with at most one frame in so long, and what was seen in it. What is read in frames that follow at once is off alike, a
/// clock that jitters, a scan that is told twice; taken for errors of each frame's own, it makes a robot seem to do less than it
/// does.
#[must_use]
pub fn thinned(log: &Log, every_s: f64) -> Log {
    let frames = log.frames.iter().flat_map(|frames| frames.iter()).map(|frame| frame.t_s);
    let mut times_s: Vec<f64> = frames.chain(log.sightings.iter().map(|seen| seen.t_s)).collect();
    times_s.sort_by(f64::total_cmp);
    // Clocks are written to a few digits.
    let far = |kept: Option<&f64>, t_s: f64| kept.is_none_or(|kept| t_s - kept > (1.0 - 1e-6) * every_s);
    let mut kept_s: Vec<f64> = Vec::new();
    for t_s in times_s {
        if far(kept_s.last(), t_s) {
            kept_s.push(t_s);
        }
    }
    let kept = |t_s: f64| kept_s.binary_search_by(|it| it.total_cmp(&t_s)).is_ok();
    let of_frames = |frames: &Channel<Frame>| -> Channel<Frame> {
        frames.iter().filter(|frame| kept(frame.t_s)).copied().collect::<Vec<_>>().into()
    };
    let sightings = log.sightings.iter().filter(|seen| kept(seen.t_s)).copied();
    Log { frames: log.frames.as_ref().map(of_frames), sightings: sightings.collect::<Vec<_>>().into(), ..log.clone() }
}

#[cfg(test)]
mod tests {
    use asami_dataset::Sighting;

    use super::*;

    fn log(speeds: impl Iterator<Item = f64>) -> Log {
        let row = |(i, v): (i32, f64)| Command {
            t_s: 0.1 * f64::from(i),
            action: Action::Wheels { id: None, v_m_per_s: v, omega_rad_per_s: -2.0 * v },
        };
        Log { commands: (0..).zip(speeds).map(row).collect::<Vec<_>>().into(), ..Log::default() }
    }

    /// What alternates is gone; what is steady, or grows evenly but for half a reading's hold, stays.
    #[test]
    fn noise_is_averaged_away_and_speed_is_not() {
        let noisy = averaged(&log((0..100).map(|i| 0.3 + if i % 2 == 0 { 0.1 } else { -0.1 })), 1.0);
        for row in &noisy.commands[5..95] {
            let [v, omega] = row.action.velocity().unwrap();
            assert!((v - 0.3).abs() < 1e-9 && (omega + 0.6).abs() < 1e-9, "{row:?}");
        }
        let growing = averaged(&log((0..100).map(|i| 0.01 * f64::from(i))), 1.0);
        for (i, row) in (0..).zip(growing.commands.iter()).skip(6).take(88) {
            assert!((row.action.velocity().unwrap()[0] - (0.01 * f64::from(i) - 0.005)).abs() < 1e-9, "{row:?}");
        }
        let empty = Log::default();
        assert_eq!(averaged(&empty, 1.0), empty);
    }

    /// One after the other, as the functions by themselves; what is not said is left as it is.
    #[test]
    fn a_log_is_readied_step_by_step() {
        let given = log((0..50).map(|i| 0.01 * f64::from(i * i % 7)));
        assert_eq!(Readied::default().of(&given), (given.clone(), Clocks::default()));
        let all = Readied { average_s: Some(0.5), earlier_s: Some(0.1), every_s: Some(0.3), ..Readied::default() };
        assert_eq!(all.of(&given).0, thinned(&earlier(&averaged(&given, 0.5), 0.1), 0.3));
        let points = Readied { points_s: Some(0.5), ..Readied::default() }.of(&given);
        assert_eq!((points.0, points.1.said.len()), (given.clone(), 1));
        let clocks = Readied { camera_hz: Some(10.0), command_cycle_s: Some(0.2), ..Readied::default() };
        let (left, Clocks { said, picture_period_s: None, command_cycle_s: None }) = clocks.of(&given) else {
            panic!("a log without sightings tells no clock")
        };
        let few = |said: &String| said.contains("too few landmarks are seen in turns");
        assert!(left == given && said.len() == 2 && said.iter().all(few), "{said:?}");
        assert_eq!(Readied { average_s: Some(0.5), ..clocks }.but_for_clocks().of(&given).0, averaged(&given, 0.5));
        assert_eq!(all.faults(), []);
        let wrong = Readied {
            average_s: Some(f64::NAN),
            earlier_s: Some(2.0),
            camera_hz: Some(0.0),
            command_cycle_s: Some(9.0),
            points_s: Some(6.0),
            every_s: Some(0.0),
        };
        let faults = wrong.faults();
        assert_eq!(
            faults.iter().map(|it| it.0).collect::<Vec<_>>(),
            ["average_s", "earlier_s", "camera_hz", "command_cycle_s", "points_s", "every_s"]
        );
        assert_eq!(faults[1].1, "earlier_s must lie in 0.001..=1 s, not 2");
        assert_eq!(faults[2].1, "camera_hz must lie in 0.5..=200 Hz, not 0");
        assert_eq!(faults[3].1, "command_cycle_s must lie in 0.02..=2 s, not 9");
    }

    /// At every time what was read a reading later is in force.
    #[test]
    fn what_was_read_was_commanded_before() {
        let given = log((0..50).map(|i| 0.01 * f64::from(i)));
        let moved = earlier(&given, 0.1);
        let at = |log: &Log, t_s: f64| {
            log.commands[log.commands.partition_point(|row| row.t_s <= t_s) - 1].action.forward_m_per_s().unwrap()
        };
        for i in 0..48 {
            let t_s = 0.1 * f64::from(i) + 0.05;
            assert_eq!(at(&moved, t_s), at(&given, t_s + 0.1), "{t_s}");
        }
        assert_eq!((moved.commands.len(), moved.commands[0].t_s), (49, 0.0));
        assert_eq!(earlier(&Log::default(), 0.1), Log::default());
    }

    /// Of frames at ten a second one in half a second stays, with all that was seen in it; commands stay.
    #[test]
    fn one_frame_in_so_long_is_left() {
        let t_s = |i: u16| f64::from(i) / 10.0;
        let seen = |i: u16| {
            let size = asami_dataset::Size::RangeM(1.0);
            (0..2).map(move |landmark| Sighting { t_s: t_s(i), landmark, size, bearing_rad: 0.0 })
        };
        let given = Log {
            frames: Some((0..31).map(|i| Frame { t_s: t_s(i), head_pan_rad: 0.0 }).collect::<Vec<_>>().into()),
            // In one that would stay nothing is seen.
            sightings: (0..31).filter(|i| *i != 10).flat_map(seen).collect::<Vec<_>>().into(),
            ..log((0..30).map(f64::from))
        };
        let left = thinned(&given, 0.5);
        let frames: Vec<f64> = left.frames.iter().flat_map(|it| it.iter()).map(|it| it.t_s).collect();
        assert_eq!(frames, (0..7).map(|i| t_s(5 * i)).collect::<Vec<_>>());
        assert_eq!((left.sightings.len(), left.commands.len()), (12, 30));
        assert!(left.sightings.iter().all(|it| frames.contains(&it.t_s)));
        assert_eq!(thinned(&given, 0.1), given);
        assert_eq!(thinned(&Log::default(), 0.5), Log::default());
    }
}
