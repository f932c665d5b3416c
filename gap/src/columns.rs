//! What a robot's motion may hang on: the columns of the regression from commands to velocities.
//!
//! A legged or wheeled robot's velocity at a time is a curve in the command in force, plus what still
//! lingers of the commands of the last second, plus what hangs on the heading (slopes), on the time in
//! the log (wear) and, before a single landmark, on where it was last seen (a heading held below the
//! command).

mod times;

use std::collections::BTreeSet;

use asami_dataset::{Action, Command};
use asami_math::elementary::hypot;
use asami_sim::effects::slight_turns::is_slight;
use asami_sim::effects::turn_step::lacks_rad_per_s;
use serde::{Deserialize, Serialize};

use times::Times;
pub(crate) use times::below;

/// Ages of commands between which what lingers of them is averaged, in seconds.
const AGES_S: [f64; 9] = [0.0, 0.05, 0.1, 0.15, 0.2, 0.3, 0.45, 0.7, 1.0];
/// A change of command is answered within about so long, sooner or later by where in its stride it meets a gait.
const ANSWERS_S: f64 = 0.7;
/// Knots of the curve over a velocity that takes any value are at least so many, and more where runs call for them.
const KNOTS: usize = 13;
/// Each time twice as many intervals, at most so often.
const FINER: usize = 2;
/// Speeds, in shares of the greatest, between which the answer to a bearing runs straight.
const SPEED_KNOTS: [f64; 4] = [0.0, 0.15, 0.4, 1.0];
/// Ages of bearings between which they are averaged, in seconds: about a stride, for from frame to frame the body sways, and
/// with it what is seen.
const HELD_AGES_S: [f64; 4] = [0.0, 0.37, 0.74, 1.11];
/// A bearing seen longer ago is held no more, in seconds.
const HELD_S: f64 = 1.0;
/// Of a base on two wheels, so many columns are of turns: its speed times the squared turning rate, its speed where it is told a slight turn, and
/// what such a turn lacks of a whole step.
pub(crate) const OF_TURNS: usize = 3;
/// And along this axis it may start late: forwards.
const STARTED: usize = 1;
/// Columns that grow with time in the log are in units of it.
const WEAR_S: f64 = 100.0;

/// Attempted velocities: right, forward, counter-clockwise.
pub type Attempt = [f64; 3];

/// How commands become columns; found out from the commands of the nominal world's own logs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Columns {
    /// Discrete actions, in order of id; none where commands take any value.
    ids: Vec<u16>,
    /// Greatest attempted velocities; 0 where one is never attempted.
    greatest: Attempt,
    /// Knots of the curve over each velocity.
    knots: usize,
    /// Nominal velocity of each of the curve's columns, in shares of the axis's greatest; none as long as it is not known.
    nominal: Vec<[f64; 3]>,
    /// Whether a heading shows: there is more than one landmark.
    pub heading: bool,
}

/// The columns' groups, in order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// A curve in the command in force.
    Curve,
    /// What lingers of earlier commands.
    Lingering,
    /// Cosine and sine of the heading while moving, and the same times the speed over the ground.
    Heading,
    /// Bearings at which the only landmark was seen last while moving, by age and speed: a robot answers to them as late as
    /// to commands, and feet that are hardly lifted do not turn it.
    Held,
    /// Growing with time in the log: velocities, velocities times speed, moving at all.
    Wear,
    /// Of a base on two wheels, what lingers of turns' own columns.
    Turning,
    /// Of a base on two wheels, its speed where it stood before, by age.
    Starting,
}

impl Group {
    /// All of them, in order.
    pub const ALL: [Self; 7] =
        [Self::Curve, Self::Lingering, Self::Heading, Self::Held, Self::Wear, Self::Turning, Self::Starting];
}

impl Columns {
    /// Columns for commands like these.
    #[must_use]
    pub fn new<'a>(commands: impl Iterator<Item = &'a Command>, landmarks: usize) -> Self {
        let (mut ids, mut any, mut greatest) = (BTreeSet::new(), false, [0.0_f64; 3]);
        for command in commands {
            let (id, attempt) = attempt(&command.action);
            let moves = attempt != [0.0; 3];
            match id {
                Some(id) if moves => drop(ids.insert(id)),
                Some(_) => {}
                None => any |= moves,
            }
            for (greatest, attempt) in greatest.iter_mut().zip(attempt) {
                *greatest = greatest.max(attempt.abs());
            }
        }
        let ids = if any { Vec::new() } else { ids.into_iter().collect() };
        Self { ids, greatest, knots: KNOTS, nominal: Vec::new(), heading: landmarks > 1 }
    }

    /// The same and ones whose curves have knots between those, from the coarsest on.
    #[must_use]
    pub fn finer(&self) -> Vec<Self> {
        let times = if self.ids.is_empty() { FINER } else { 0 };
        (0..=times).map(|n| Self { knots: (KNOTS - 1) * (1 << n) + 1, ..self.clone() }).collect()
    }

    /// The same with the nominal velocities known, of which `numbers` hold a curve for each axis: what lingers, and what
    /// wears, is a velocity, not the attempt at one.
    #[must_use]
    pub fn knowing(&self, numbers: &[f64]) -> Self {
        let of = |axis: usize| &numbers[axis * self.len()..][self.range(Group::Curve)];
        let greatest: [f64; 3] =
            std::array::from_fn(|axis| of(axis).iter().fold(0.0, |most, it| f64::max(most, it.abs())));
        let share = |i: usize, axis: usize| if greatest[axis] > 0.0 { of(axis)[i] / greatest[axis] } else { 0.0 };
        let nominal = (0..self.width(Group::Curve)).map(|i| std::array::from_fn(|axis| share(i, axis))).collect();
        Self { nominal, ..self.clone() }
    }

    /// How many columns each group has.
    #[must_use]
    pub fn width(&self, group: Group) -> usize {
        let varying = self.greatest.iter().filter(|greatest| **greatest > 0.0).count();
        match group {
            Group::Curve if self.ids.is_empty() => {
                let in_turns = if self.rolls() { OF_TURNS } else { 0 };
                varying * self.knots + varying * varying.saturating_sub(1) / 2 + in_turns
            }
            Group::Curve => self.ids.len(),
            Group::Lingering => 3 * (AGES_S.len() - 1),
            Group::Heading => 4,
            Group::Held if self.heading => 0,
            Group::Held => SPEED_KNOTS.len() * (HELD_AGES_S.len() - 1),
            Group::Wear => 7,
            Group::Turning if self.rolls() => OF_TURNS * (AGES_S.len() - 1),
            Group::Starting if self.rolls() => AGES_S.len() - 1,
            Group::Turning | Group::Starting => 0,
        }
    }

    /// Where a group's columns are.
    #[must_use]
    pub fn range(&self, group: Group) -> std::ops::Range<usize> {
        let start = Group::ALL.iter().take_while(|it| **it != group).map(|it| self.width(*it)).sum::<usize>();
        start..start + self.width(group)
    }

    /// Whether any forward speed and turning rate may be commanded, and nothing sideways: a base on two wheels, whose speed in a
    /// turn is of neither alone.
    pub(crate) fn rolls(&self) -> bool {
        self.ids.is_empty() && self.greatest[0] == 0.0 && self.greatest[1..].iter().all(|it| *it > 0.0)
    }

    /// Of a base on two wheels, the curve's columns that are of turns alone.
    #[must_use]
    pub fn in_turns(&self) -> Option<std::ops::Range<usize>> {
        let end = self.range(Group::Curve).end;
        self.rolls().then(|| end - OF_TURNS..end)
    }

    /// Of a base on two wheels, the axis along which it starts, and the column that is its speed where it stood so long ago.
    pub fn started(&self, age: usize) -> Option<(usize, usize)> {
        self.range(Group::Starting).nth(age).map(|column| (STARTED, column))
    }

    /// The curve as coarsely as effects bend it: what each of its parts is made of, columns with their shares.
    #[must_use]
    pub fn bends(&self) -> Vec<Vec<(usize, f64)>> {
        let curve = self.range(Group::Curve);
        let every = (self.knots - 1) / (KNOTS - 1);
        let curves = if self.ids.is_empty() { self.greatest.iter().filter(|it| **it > 0.0).count() } else { 0 };
        let hats = (0..curves * KNOTS).map(|hat| {
            let (start, at) = (curve.start + hat / KNOTS * self.knots, hat % KNOTS * every);
            let near = at.saturating_sub(every - 1)..(at + every).min(self.knots);
            near.map(|knot| (start + knot, 1.0 - knot.abs_diff(at) as f64 / every as f64)).collect()
        });
        let rest = curve.start + curves * self.knots..curve.end;
        hats.chain(rest.map(|column| vec![(column, 1.0)])).collect()
    }

    /// Ages between which what lingers is averaged, in seconds.
    #[must_use]
    pub fn ages_s() -> &'static [f64] {
        &AGES_S
    }

    /// Of each of the curve's columns the nominal velocity, in shares of each axis's greatest; none where it is not known.
    #[must_use]
    pub fn nominal(&self) -> &[[f64; 3]] {
        &self.nominal
    }

    /// How many columns there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.range(Group::Starting).end
    }

    /// Whether nothing is ever commanded.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.greatest == [0.0; 3]
    }

    /// Discrete actions of `commands` that these columns do not know.
    #[must_use]
    pub fn unknown(&self, commands: &[Command]) -> Vec<u16> {
        let known = |id: &u16| self.ids.contains(id);
        let of = |command: &Command| attempt(&command.action);
        let ids = commands.iter().map(of).filter(|(_, attempt)| *attempt != [0.0; 3]).filter_map(|(id, _)| id);
        let unknown: BTreeSet<u16> = ids.filter(|id| !self.ids.is_empty() && !known(id)).collect();
        unknown.into_iter().collect()
    }

    /// Fills the row of the interval from `from_s` to `to_s` (of the heading's columns the first, with the
    /// share of the interval in which the robot attempts to move), and gives the velocities attempted, in
    /// shares of the greatest. `held` are the times and bearings of what was seen before.
    pub fn fill(&self, commands: &[Command], from_s: f64, to_s: f64, held: &[(f64, f64)], row: &mut [f64]) -> Attempt {
        row.fill(0.0);
        let (mut now, mut moving) = ([0.0; 3], 0.0);
        let times = Times::between(from_s, to_s);
        times.each(commands, |share, action| {
            let attempt = attempt(action).1;
            for (now, u) in now.iter_mut().zip(self.normalised(attempt)) {
                *now += share * u;
            }
            if attempt != [0.0; 3] {
                moving += share;
            }
        });
        let mut scratch = vec![0.0; self.width(Group::Curve)];
        let velocity = self.velocity(commands, times, &mut scratch);
        row[self.range(Group::Curve)].copy_from_slice(&scratch);
        let middle_s = 0.5 * (from_s + to_s);
        let (lingering, turning) = (self.range(Group::Lingering).start, self.range(Group::Turning));
        let starting = self.range(Group::Starting).start;
        let in_turns: Vec<f64> = scratch.iter().rev().take(OF_TURNS).rev().copied().collect();
        for (age, ages_s) in AGES_S.windows(2).enumerate() {
            // A turn of wheels may be over between the middles of two steps; legs are looked at more often.
            let earlier = if self.rolls() {
                times.earlier([ages_s[0], ages_s[1]])
            } else {
                Times::between(middle_s - ages_s[1], middle_s - ages_s[0])
            };
            let then = self.velocity(commands, earlier, &mut scratch);
            for ((column, then), now) in row[lingering + 3 * age..].iter_mut().zip(then).zip(velocity) {
                *column = then - now;
            }
            let then = &scratch[scratch.len().saturating_sub(OF_TURNS)..];
            for ((column, then), now) in row[turning.clone()].iter_mut().skip(OF_TURNS * age).zip(then).zip(&in_turns) {
                *column = then - now;
            }
            if self.rolls() {
                let mut stood = 0.0;
                earlier
                    .each(commands, |share, action| stood += if attempt(action).1 == [0.0; 3] { share } else { 0.0 });
                row[starting + age] = stood * velocity[STARTED];
            }
        }
        let heading = self.range(Group::Heading).start;
        row[heading] = moving;
        row[heading + 2] = hypot(velocity[0], velocity[1]);
        let speed = now.iter().fold(0.0, |sum, u| sum + u * u).sqrt();
        let (knot, share) = speed_knot(speed);
        let held_columns = row[self.range(Group::Held)].chunks_exact_mut(SPEED_KNOTS.len());
        for (ages_s, columns) in HELD_AGES_S.windows(2).zip(held_columns) {
            let held_rad = held_rad(held, middle_s - ages_s[1], middle_s - ages_s[0]);
            columns[knot] = moving * (1.0 - share) * held_rad;
            columns[knot + 1] = moving * share * held_rad;
        }
        let wear = &mut row[self.range(Group::Wear)];
        let worn = velocity.into_iter().chain(velocity.map(|it| speed * it)).chain([moving]);
        for (column, value) in wear.iter_mut().zip(worn) {
            *column = value * middle_s / WEAR_S;
        }
        now
    }

    /// How much commands change at a filled row: how far, on average over what a gait's answer takes, the velocity was from
    /// what it is.
    #[must_use]
    pub fn changing(&self, row: &[f64]) -> f64 {
        let lingering = row[self.range(Group::Lingering)].chunks_exact(3);
        let of = |(ages_s, then): (&[f64], &[f64])| {
            let width_s = (ages_s[1].min(ANSWERS_S) - ages_s[0]).max(0.0);
            width_s / ANSWERS_S * then.iter().fold(0.0, |sum, it| sum + it * it).sqrt()
        };
        AGES_S.windows(2).zip(lingering).map(of).fold(0.0, |sum, it| sum + it)
    }

    /// The mean nominal velocity at some times, in shares of the greatest, and the curve's columns.
    fn velocity(&self, commands: &[Command], times: Times, curve: &mut [f64]) -> [f64; 3] {
        curve.fill(0.0);
        let mut attempted = [0.0; 3];
        times.each(commands, |share, action| {
            let (id, attempt) = attempt(action);
            let u = self.normalised(attempt);
            for (attempted, u) in attempted.iter_mut().zip(u) {
                *attempted += share * u;
            }
            self.curve(id, u, share, curve);
        });
        if self.nominal.is_empty() {
            return attempted;
        }
        let of = |axis: usize| curve.iter().zip(&self.nominal).fold(0.0, |sum, (column, v)| sum + column * v[axis]);
        std::array::from_fn(of)
    }

    fn normalised(&self, attempt: Attempt) -> Attempt {
        std::array::from_fn(|i| if self.greatest[i] > 0.0 { attempt[i] / self.greatest[i] } else { 0.0 })
    }

    fn curve(&self, id: Option<u16>, u: Attempt, share: f64, columns: &mut [f64]) {
        if !self.ids.is_empty() {
            if let Some(column) = id.and_then(|id| self.ids.binary_search(&id).ok()) {
                columns[column] += share;
            }
            return;
        }
        let varying: Vec<f64> = (0..3).filter(|i| self.greatest[*i] > 0.0).map(|i| u[i]).collect();
        for (u, hats) in varying.iter().zip(columns.chunks_exact_mut(self.knots)) {
            let at = (u.clamp(-1.0, 1.0) + 1.0) * 0.5 * (self.knots - 1) as f64;
            let knot = (at.floor() as usize).min(self.knots - 2);
            hats[knot] += share * (knot as f64 + 1.0 - at);
            hats[knot + 1] += share * (at - knot as f64);
        }
        let pairs = (0..varying.len()).flat_map(|i| (i + 1..varying.len()).map(move |j| (i, j)));
        for ((i, j), column) in pairs.zip(&mut columns[varying.len() * self.knots..]) {
            *column += share * varying[i] * varying[j];
        }
        if self.rolls() {
            let omega_rad_per_s = u[2] * self.greatest[2];
            let of_turns = [
                u[1] * u[2] * u[2],
                if is_slight(omega_rad_per_s) { u[1] } else { 0.0 },
                lacks_rad_per_s(u[1], omega_rad_per_s) / self.greatest[2],
            ];
            let start = columns.len() - OF_TURNS;
            columns[start..].iter_mut().zip(of_turns).for_each(|(column, of)| *column += share * of);
        }
    }
}

/// The knot below a speed, and how far it is towards the next.
fn speed_knot(speed: f64) -> (usize, f64) {
    let last = SPEED_KNOTS.len() - 2;
    let knot = SPEED_KNOTS[1..=last].partition_point(|it| *it <= speed);
    let share = (speed - SPEED_KNOTS[knot]) / (SPEED_KNOTS[knot + 1] - SPEED_KNOTS[knot]);
    (knot, share.clamp(0.0, 1.0))
}

/// The bearing that a robot holds its heading by between two times: the mean of those seen, or the last seen before,
/// unless that is long ago.
fn held_rad(held: &[(f64, f64)], from_s: f64, to_s: f64) -> f64 {
    let clamped = |(_, bearing_rad): &(f64, f64)| bearing_rad.clamp(-0.4, 0.4);
    let [from, to] = [from_s, to_s].map(|t_s| held.partition_point(|(seen_s, _)| *seen_s <= t_s));
    if from < to {
        return held[from..to].iter().map(clamped).sum::<f64>() / (to - from) as f64;
    }
    held[..from].last().filter(|(seen_s, _)| to_s - seen_s <= HELD_S).map_or(0.0, clamped)
}

/// The velocities that an action attempts, and its id. Pedals attempt none.
fn attempt(action: &Action) -> (Option<u16>, Attempt) {
    match *action {
        Action::Legs { id, ax_m_per_s, ay_m_per_s, atheta_rad_per_s } => {
            (id, [ax_m_per_s, ay_m_per_s, atheta_rad_per_s])
        }
        Action::Wheels { id, v_m_per_s, omega_rad_per_s } => (id, [0.0, v_m_per_s, omega_rad_per_s]),
        Action::Pedals { .. } => (None, [0.0; 3]),
    }
}

#[cfg(test)]
mod tests;
