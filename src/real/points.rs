//! Normal points: of what is seen of a landmark within a short time one sighting, the mean of all of it.
//!
//! What a robot goes and turns meanwhile is taken from its commands, and each sighting to where the landmark would have been seen in the
//! middle of them. There, at the mean of their times, what the robot goes and turns faster or slower than it is told is gone from their mean,
//! so that nothing is taken for granted that is to be found; and noise is that of a mean. Ranging to satellites has its normal points so (Sinclair
//! 1997, *Data screening and normal point formation*). Where commands change a robot does not at once what it is told, and sightings from
//! before and after are not put together.

use std::collections::BTreeMap;

use asami_dataset::{Action, Channel, Command, Frame, Log, Sighting, Size};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, hypot, sin_cos};

use super::commanded::Commanded;

/// A robot does what it is told by then: a rule of thumb, for cycles of 0.2 s and motors that lag by as much.
const SETTLES_S: f64 = 0.4;
/// What it is told changes by more, in m/s and rad/s: a rule of thumb, more than a robot that steers straight on corrects by.
const CHANGES: [f64; 2] = [0.03, 0.1];

/// The log with what is seen of each landmark in each stretch of this length put together, but for what is seen before or after commands
/// change; and in words how much is left, or why all is. What was missed no longer shows: a mean is of no frame.
#[must_use]
pub fn put_together(log: &Log, over_s: f64) -> (Log, String) {
    if let Some(lacks) = lacks(log) {
        return (log.clone(), format!("nothing that is seen is put together without {lacks}: it stays as it was"));
    }
    let sightings = normal_points(log, over_s);
    let said = format!(
        "what is seen of a landmark within {over_s} s is put together where commands do not change: of {} sightings {} are left, each \
         the mean of some, or one that stands alone",
        log.sightings.len(),
        sightings.len()
    );
    (Log { frames: None, sightings: sightings.into(), ..log.clone() }, said)
}

/// What it takes to say where a landmark is seen from a little later, and the log has not.
fn lacks(log: &Log) -> Option<&'static str> {
    let looks_ahead = |frames: &Channel<Frame>| frames.iter().all(|frame| frame.head_pan_rad == 0.0);
    let needs = [
        ("ranges in metres", log.sightings.iter().all(|seen| matches!(seen.size, Size::RangeM(_)))),
        ("commands to wheels", log.commands.iter().all(|told| matches!(told.action, Action::Wheels { .. }))),
        ("a sensor that keeps looking ahead", log.frames.as_ref().is_none_or(looks_ahead)),
    ];
    needs.into_iter().find(|(_, there)| !there).map(|(what, _)| what)
}

fn normal_points(log: &Log, over_s: f64) -> Vec<Sighting> {
    let told = Commanded::new(&log.commands, 0.0, over_s);
    let changes_s = changes_s(&log.commands);
    let frames = in_frames(&log.sightings);
    let mut points: Vec<Sighting> = Vec::new();
    let mut rest = &frames[..];
    while let Some(first) = rest.first() {
        let end_s = first[0].t_s + over_s;
        // Clocks are written to a few digits.
        let (stretch, later) = rest.split_at(rest.partition_point(|it| it[0].t_s < end_s - 1e-6 * over_s));
        points.extend(together(steady(stretch, &changes_s), &told));
        rest = later;
    }
    points.sort_by(|a, b| a.t_s.total_cmp(&b.t_s).then(a.landmark.cmp(&b.landmark)));
    points
}

/// Sightings by when they were.
fn in_frames(sightings: &[Sighting]) -> Vec<&[Sighting]> {
    sightings.chunk_by(|a, b| a.t_s == b.t_s).collect()
}

/// When what is told changes.
fn changes_s(commands: &[Command]) -> Vec<f64> {
    let velocity = |command: &Command| command.action.velocity().unwrap_or_default();
    let mut since = commands.first().map_or([0.0; 2], velocity);
    let changed = commands.iter().filter(|command| {
        let now = velocity(command);
        let changes = (0..2).any(|k| (now[k] - since[k]).abs() > CHANGES[k]);
        if changes {
            since = now;
        }
        changes
    });
    changed.map(|command| command.t_s).collect()
}

/// Most frames that follow one another while a robot does one thing.
fn steady<'a, 'b>(frames: &'b [&'a [Sighting]], changes_s: &[f64]) -> &'b [&'a [Sighting]] {
    let goes_on = |a: &&[Sighting], b: &&[Sighting]| {
        let next = changes_s.partition_point(|t_s| *t_s < a[0].t_s - SETTLES_S);
        changes_s.get(next).is_none_or(|change_s| *change_s >= b[0].t_s)
    };
    let runs = frames.chunk_by(goes_on);
    runs.reduce(|most, run| if run.len() > most.len() { run } else { most }).unwrap_or_default()
}

/// Of each landmark one sighting.
fn together(frames: &[&[Sighting]], told: &Commanded) -> Vec<Sighting> {
    let mut of: BTreeMap<u16, Vec<Sighting>> = BTreeMap::new();
    frames.iter().flat_map(|frame| frame.iter()).for_each(|seen| of.entry(seen.landmark).or_default().push(*seen));
    of.into_values().map(|all| point(&all, told)).collect()
}

/// The mean of sightings of a landmark, at the mean of their times.
fn point(all: &[Sighting], told: &Commanded) -> Sighting {
    // As it was read, to the last digit.
    if let [alone] = all {
        return *alone;
    }
    let n = all.len() as f64;
    // From the first on, so that times are exact to the last digit.
    let t_s = all[0].t_s + all.iter().map(|seen| seen.t_s - all[0].t_s).sum::<f64>() / n;
    let seen: Vec<[f64; 2]> = all.iter().map(|seen| seen_at(seen, t_s, told)).collect();
    let about_rad = seen[0][1];
    let mean = |of: &dyn Fn(&[f64; 2]) -> f64| seen.iter().map(of).sum::<f64>() / n;
    let range_m = mean(&|it| it[0]);
    let bearing_rad = wrap_rad(about_rad + mean(&|it| wrap_rad(it[1] - about_rad)));
    Sighting { t_s, size: Size::RangeM(range_m), bearing_rad, ..all[0] }
}

/// Range and bearing of what was seen from where the robot is at another time, if it does what it is told.
fn seen_at(seen: &Sighting, t_s: f64, told: &Commanded) -> [f64; 2] {
    let [way_m, turn_rad, ..] = told.over(seen.t_s, t_s - seen.t_s);
    let (sin, cos) = sin_cos(seen.bearing_rad);
    let (sin_halfway, cos_halfway) = sin_cos(0.5 * turn_rad);
    let range_m = seen.size.value();
    // To the right and ahead of where it was seen from.
    let (right_m, ahead_m) = (-range_m * sin + way_m * sin_halfway, range_m * cos - way_m * cos_halfway);
    [hypot(right_m, ahead_m), wrap_rad(atan2(-right_m, ahead_m) - turn_rad)]
}

#[cfg(test)]
mod tests {
    use asami_dataset::Seed;
    use rand::RngExt;
    use rand_distr::StandardNormal;

    use super::*;

    fn command(t_s: f64, v_m_per_s: f64, omega_rad_per_s: f64) -> Command {
        Command { t_s, action: Action::Wheels { id: None, v_m_per_s, omega_rad_per_s } }
    }

    /// What a robot sees of a landmark that lies 1 m to the right and 4 m ahead of where it began, 4 times a second, if from a time on it
    /// turns and goes as fast as said.
    fn seen_on_the_way(from_s: f64, [v, omega]: [f64; 2], seconds: f64, landmark: u16) -> Vec<Sighting> {
        let seen = |i: i32| {
            let t_s = 0.25 * f64::from(i);
            let gone_s = (t_s - from_s).max(0.0);
            // On a circle to the left; straight on as it is infinitely wide.
            let (sin, cos) = sin_cos(omega * gone_s);
            let [x, y] = if omega == 0.0 { [0.0, v * gone_s] } else { [-v / omega * (1.0 - cos), v / omega * sin] };
            let (right, ahead) = (1.0 - x, 4.0 - y);
            let bearing_rad = wrap_rad(atan2(-right, ahead) - omega * gone_s);
            Sighting { t_s, landmark, size: Size::RangeM(hypot(right, ahead)), bearing_rad }
        };
        (0..(4.0 * seconds) as i32).map(seen).collect()
    }

    /// A robot that goes a tenth faster than told, and turns a tenth less, is seen to: normal points are where it was.
    #[test]
    fn what_a_robot_does_otherwise_than_told_is_not_lost() {
        let log = Log {
            commands: vec![command(0.0, 0.1, 0.05), command(100.0, 0.0, 0.0)].into(),
            sightings: seen_on_the_way(0.0, [0.11, 0.045], 20.0, 6).into(),
            ..Log::default()
        };
        let points = normal_points(&log, 1.0);
        assert_eq!(points.len(), 20);
        for point in points.iter() {
            // In the middle of four sightings is none: of the two next to it the mean, which is off by their second difference alone.
            let after = log.sightings.partition_point(|seen| seen.t_s < point.t_s);
            let [a, b] = [after - 1, after].map(|i| log.sightings[i]);
            assert!((point.t_s - 0.5 * (a.t_s + b.t_s)).abs() < 1e-9, "{point:?}");
            let off_m = point.size.value() - 0.5 * (a.size.value() + b.size.value());
            let off_rad = point.bearing_rad - 0.5 * (a.bearing_rad + b.bearing_rad);
            assert!(off_m.abs() < 2e-4 && off_rad.abs() < 1e-4, "{off_m} {off_rad}");
        }
    }

    /// Four sightings are half as noisy together as one, of each landmark by itself.
    #[test]
    fn noise_is_that_of_a_mean() {
        let mut rng = Seed(4).stream("points");
        let mut noisy = |mut seen: Sighting| {
            seen.size = Size::RangeM(seen.size.value() + 0.02 * rng.sample::<f64, _>(StandardNormal));
            seen.bearing_rad += 0.01 * rng.sample::<f64, _>(StandardNormal);
            seen
        };
        let mut sightings: Vec<Sighting> =
            [6, 7].iter().flat_map(|id| seen_on_the_way(1e9, [0.0; 2], 400.0, *id)).map(&mut noisy).collect();
        sightings.sort_by(|a, b| a.t_s.total_cmp(&b.t_s));
        let log = Log { commands: vec![command(0.0, 0.0, 0.0)].into(), sightings: sightings.into(), ..Log::default() };
        let points = normal_points(&log, 1.0);
        assert_eq!(points.len(), 800);
        let rms =
            |off: &dyn Fn(&Sighting) -> f64| (points.iter().map(|it| off(it).powi(2)).sum::<f64>() / 800.0).sqrt();
        let [range_m, bearing_rad] =
            [rms(&|it| it.size.value() - hypot(1.0, 4.0)), rms(&|it| it.bearing_rad - atan2(-1.0, 4.0))];
        // A tenth: four standard errors of a root mean square of 800.
        assert!(
            (range_m / 0.01 - 1.0).abs() < 0.1 && (bearing_rad / 0.005 - 1.0).abs() < 0.1,
            "{range_m} {bearing_rad}"
        );
    }

    /// Where a robot is told to go on, what it saw before stays by itself, and so does what it sees until it has settled.
    #[test]
    fn nothing_is_put_together_over_a_change_of_commands() {
        let commands =
            vec![command(0.0, 0.0, 0.0), command(2.05, 0.1, 0.0), command(4.0, 0.1, 0.02), command(8.0, 0.1, 0.4)];
        let log = Log {
            commands: commands.into(),
            sightings: seen_on_the_way(2.05, [0.1, 0.0], 9.0, 6).into(),
            ..Log::default()
        };
        let points = normal_points(&log, 1.0);
        let times_s: Vec<f64> = points.iter().map(|it| it.t_s).collect();
        // From 2.45 s on it has settled; a turn that is hardly one is none; before 8.4 s it has not.
        assert_eq!(times_s, [0.375, 1.375, 2.625, 3.375, 4.375, 5.375, 6.375, 7.375, 8.625]);
    }

    /// Neither heights, nor pedals, nor a head that turns say where a landmark is seen from a little later.
    #[test]
    fn what_cannot_be_put_together_stays_and_says_why() {
        let near = Sighting { t_s: 0.1, landmark: 6, size: Size::RangeM(2.0), bearing_rad: 0.0 };
        let tall = Sighting { size: Size::HeightPx(40.0), ..near };
        let pedals = Command { t_s: 0.0, action: Action::Pedals { throttle: 0.5, brake: 0.0, steering: 0.0 } };
        let aside = Frame { t_s: 0.1, head_pan_rad: 0.1 };
        let of = |sighting: Sighting| Log { sightings: vec![sighting; 2].into(), ..Log::default() };
        for (log, lacks) in [
            (of(tall), "ranges in metres"),
            (Log { commands: vec![pedals].into(), ..of(near) }, "commands to wheels"),
            (Log { frames: Some(vec![aside].into()), ..of(near) }, "a sensor that keeps looking ahead"),
        ] {
            let (left, said) = put_together(&log, 1.0);
            assert!(left == log && said.contains(lacks), "{said}");
        }
        assert_eq!(put_together(&Log::default(), 1.0).0, Log::default());
    }

    /// A mean of some frames is of none: had each of them a frame of its own, all other landmarks would seem to be missed in it.
    #[test]
    fn what_was_missed_no_longer_shows() {
        let frames: Vec<Frame> = (0..40).map(|i| Frame { t_s: 0.25 * f64::from(i), head_pan_rad: 0.0 }).collect();
        let sightings = seen_on_the_way(1e9, [0.0; 2], 10.0, 6).into();
        let log = Log { frames: Some(frames.into()), sightings, ..Log::default() };
        let (made, said) = put_together(&log, 1.0);
        assert!(made.frames.is_none() && made.sightings.len() == 10, "{made:?}");
        assert!(said.contains("of 40 sightings 10 are left"), "{said}");
    }
}
