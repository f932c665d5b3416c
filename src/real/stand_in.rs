//! Simulated logs in the place of a recorded one: of a robot among the same landmarks, that starts where the recorded one stood, is told
//! what that was told, and sees something as often.
//!
//! How well a robot learns its sensor hangs on how much it sees, and from where. A simulated camera that looks all day into an arena of
//! another's foretells nothing of one that was near a wall for a minute.

use std::ops::Range;

use asami_dataset::{Action, Beacon, Channel, Command, Dataset, Log, Rng, Seed, Sighting, TruePose};
use asami_sim::scenes::field::{Cylinder, Field, Landmark};
use rand::seq::index::sample;

use crate::scenario::{Placement, Policy, Simulation};
use crate::simulate::CannotSimulate;

/// In each stretch of this length a stand-in sees no more landmarks than the robot did, but for as many again that it saw fewer of before:
/// some pictures long, and shorter than it looks at nothing.
const STRETCH_S: f64 = 2.0;
/// No arena of a scenario is narrower: landmarks in a line leave a robot no way to go.
const NARROWEST_M: f64 = 0.5;

/// What a stand-in has of the robot that it stands in for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Original {
    /// What it was told, whenever it took that up.
    pub told: Vec<Command>,
    /// The landmarks around it.
    landmarks: Vec<Beacon>,
    /// Everything that it saw.
    seen: Channel<Sighting>,
    /// Where it was as it was first told something.
    stood: Option<TruePose>,
}

impl Original {
    /// The robot of a log, what it was told being `told`; where it was, `track` says.
    #[must_use]
    pub fn of(log: &Log, track: &[TruePose], told: Vec<Command>) -> Self {
        let began_s = told.first().map_or(0.0, |first| first.t_s);
        let stood = track.iter().find(|pose| pose.t_s >= began_s).copied();
        Self { told, landmarks: log.known.landmarks.clone(), seen: log.sightings.clone(), stood }
    }

    /// What it was told, by the recording's clock: before anything, to stand.
    fn commands(&self) -> Vec<Command> {
        let stands = Action::Wheels { id: None, v_m_per_s: 0.0, omega_rad_per_s: 0.0 };
        let late = self.told.first().filter(|first| first.t_s > 0.0);
        late.map(|_| Command { t_s: 0.0, action: stands }).into_iter().chain(self.told.iter().copied()).collect()
    }

    /// Its landmarks, its start and its arena, which reaches as far as these do, in the place of a world's own; about the middle of them, as
    /// arenas are. Worlds without a landmark, and logs without a track, stay as they are.
    fn around(&self, world: &Simulation) -> Simulation {
        let (Some(stood), Some(like)) = (self.stood, world.field.beacons.first()) else { return world.clone() };
        let places = || self.landmarks.iter().map(|it| [it.x_m, it.y_m]).chain([[stood.x_m, stood.y_m]]);
        let reach = |axis: usize| {
            let along = || places().map(|it| it[axis]);
            along().fold(f64::INFINITY, f64::min)..along().fold(f64::NEG_INFINITY, f64::max)
        };
        let middle = |reach: &Range<f64>| 0.5 * (reach.start + reach.end);
        let (x, y) = (reach(0), reach(1));
        let [x_m, y_m] = [&x, &y].map(middle);
        let standing = |it: &Beacon| Landmark {
            id: it.id,
            body: Cylinder { x_m: it.x_m - x_m, y_m: it.y_m - y_m, ..like.body.clone() },
        };
        let beacons = self.landmarks.iter().map(standing).collect();
        let mut made = Simulation { field: Field { beacons, ..world.field.clone() }, ..world.clone() };
        made.start =
            Placement { x_m: stood.x_m - x_m, y_m: stood.y_m - y_m, theta_rad: stood.theta_rad, y_spread_m: 0.0 };
        if let Policy::Roam(roams) = &mut made.drive {
            let [x_m, y_m] = [x, y].map(|reach| (reach.end - reach.start).max(NARROWEST_M));
            (roams.roaming.arena_x_m, roams.roaming.arena_y_m) = (x_m, y_m);
        }
        made
    }

    /// A log, in such a world, in its place.
    ///
    /// # Errors
    /// If the robot cannot be built.
    pub fn stand_in(&self, world: &Simulation, seed: Seed) -> Result<Dataset, CannotSimulate> {
        let mut made = self.around(world).replayed(self.commands(), seed)?;
        made.log.sightings = shown(&made.log.sightings, &self.seen, &mut seed.stream("shown")).into();
        Ok(made)
    }
}

/// As many of these sightings as the robot had, stretch by stretch, drawn by `rng`: what a stretch has too few of, later ones make up for.
fn shown(sightings: &Channel<Sighting>, seen: &Channel<Sighting>, rng: &mut Rng) -> Vec<Sighting> {
    let end_s = sightings.last().map_or(0.0, |last| last.t_s);
    let (mut kept, mut owed) = (Vec::new(), 0);
    for stretch in 0..=(end_s / STRETCH_S) as usize {
        let span_s = STRETCH_S * stretch as f64..STRETCH_S * (stretch + 1) as f64;
        let (there, wanted) = (sightings.window(&span_s), seen.window(&span_s).len());
        let shown = there.len().min(wanted + wanted.min(owed));
        owed = owed + wanted - shown;
        let mut drawn = sample(rng, there.len(), shown).into_vec();
        drawn.sort_unstable();
        kept.extend(drawn.into_iter().map(|i| there[i]));
    }
    kept
}

#[cfg(test)]
mod tests {
    use asami_dataset::Size;
    use asami_math::elementary::hypot;

    use super::*;
    use crate::scenario::{self, Origin};
    use crate::sweep::manifest::repository;

    fn seen(t_s: f64, landmark: u16) -> Sighting {
        Sighting { t_s, landmark, size: Size::RangeM(2.0), bearing_rad: 0.0 }
    }

    /// Ten a second there are; the robot saw four a second, none for ten seconds, twenty a second for two, and then two.
    #[test]
    fn as_much_is_shown_as_was_seen_and_no_sooner() {
        let there: Channel<Sighting> = (0..400).map(|i| seen(0.1 * f64::from(i), i as u16)).collect::<Vec<_>>().into();
        let every = |from_s: f64, n: u32, hz: f64| (0..n).map(move |i| from_s + f64::from(i) / hz);
        let times_s = every(0.0, 40, 4.0).chain(every(20.0, 40, 20.0)).chain(every(22.0, 36, 2.0));
        let had: Channel<Sighting> = times_s.map(|t_s| seen(t_s, 6)).collect::<Vec<_>>().into();
        let shown = shown(&there, &had, &mut Seed(1).stream("test"));
        let within = |from_s: f64, to_s: f64| shown.iter().filter(|it| (from_s..to_s).contains(&it.t_s)).count();
        assert_eq!([within(0.0, 10.0), within(10.0, 20.0), within(20.0, 22.0)], [40, 0, 20]);
        // Twenty are owed, and made up for by no more than there would be anyhow.
        assert_eq!([within(22.0, 24.0), within(24.0, 32.0), within(32.0, 40.0)], [8, 32, 16]);
        assert!(shown.windows(2).all(|pair| pair[0].t_s < pair[1].t_s));
        // Which of them is drawn.
        let early = |seed: u64| {
            super::shown(&there, &had, &mut Seed(seed).stream("test")).iter().map(|it| it.landmark).sum::<u16>()
        };
        assert_ne!(early(2), early(3));
    }

    /// Where the robot stood, among landmarks that lie as the recording's do, and told when it was told.
    #[test]
    fn a_stand_in_is_where_the_robot_was() {
        let scenario = scenario::read(&repository().join("scenarios/create.toml")).unwrap();
        let Origin::Simulated(mut world) = scenario.origin else { panic!("create is simulated") };
        world.duration_s = 40.0;
        let beacon = |id: u16, x_m: f64, y_m: f64| Beacon { id, x_m, y_m, height_m: None };
        let landmarks = vec![beacon(6, 10.0, 0.0), beacon(9, 16.0, 2.0), beacon(12, 12.0, 8.0)];
        let known = asami_dataset::Known { landmarks, ..(*Log::default().known).clone() };
        let seen_s = (0..150).map(|i| 0.2 * f64::from(i));
        let log = Log {
            known: known.into(),
            sightings: seen_s.map(|t_s| seen(t_s, 6)).collect::<Vec<_>>().into(),
            ..Log::default()
        };
        let pose = |t_s: f64, x_m: f64| TruePose { t_s, x_m, y_m: 3.0, theta_rad: 0.5, v_m_per_s: None };
        let goes = Action::Wheels { id: None, v_m_per_s: 0.1, omega_rad_per_s: 0.0 };
        let told = vec![Command { t_s: 20.0, action: goes }];
        let original = Original::of(&log, &[pose(0.0, 99.0), pose(20.0, 12.0), pose(30.0, 99.0)], told);
        let made = original.stand_in(&world, Seed(1)).unwrap();
        let at = |t_s: f64| asami_dataset::truth::pose_at(&made.truth.track, t_s).unwrap();
        let known = &made.log.known.landmarks;
        let from =
            |t_s: f64| known.iter().map(|it| hypot(it.x_m - at(t_s).x_m, it.y_m - at(t_s).y_m)).collect::<Vec<_>>();
        let expected = [hypot(2.0, 3.0), hypot(4.0, 1.0), 5.0];
        assert!(from(19.0).iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.02), "{:?}", from(19.0));
        assert!((at(19.0).theta_rad - 0.5).abs() < 0.02);
        let way_m = hypot(at(30.0).x_m - at(20.0).x_m, at(30.0).y_m - at(20.0).y_m);
        assert!((way_m - 1.0).abs() < 0.05, "{way_m}");
        assert!(!made.log.sightings.is_empty() && made.log.sightings.len() <= 150);
        // Landmarks in a line with where it stood leave it some room.
        let in_line = Original { landmarks: vec![beacon(6, 12.0, 0.0)], ..original.clone() };
        let Policy::Roam(roams) = in_line.around(&world).drive else { panic!("it roams") };
        assert_eq!([roams.roaming.arena_x_m, roams.roaming.arena_y_m], [NARROWEST_M, 3.0]);
        // A log without a track has nothing of the kind.
        assert_eq!(Original { stood: None, ..original }.around(&world), *world);
    }
}
