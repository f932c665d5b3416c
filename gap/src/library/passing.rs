//! Effects on wheels one after another: what one of them makes of a command, another passes on late.
//!
//! Changes of a response add up as long as they are small. A lag of a fifth of a second is not: behind it, what a second effect
//! takes from the speed in a turn is taken a fifth of a second later, too, and a delay behind it delays what it lets linger. What
//! lingers is linear in velocities at their ages, so that one effect passes through another by putting these operators one after
//! another: beside both changes there is their product. Gaits, which answer from stride to stride, are no such operators.

use std::ops::Range;
use std::sync::LazyLock;

use crate::columns::{Columns, Group, OF_TURNS, below};

/// What velocities come from: each axis's nominal one, and what is of turns alone.
const SOURCES: usize = IN_TURNS + OF_TURNS;
const IN_TURNS: usize = 3;

/// How effects pass through one another in a world of wheels.
pub struct Passing<'a> {
    /// Of each of the curve's columns the nominal velocity, in shares of each axis's greatest.
    nominal: &'a [[f64; 3]],
    /// Greatest nominal velocities, by axis.
    greatest: [f64; 3],
    /// How many columns each axis has, counted once: asked for at every number they are a third of a diagnosis.
    width: usize,
    /// The curve's among them.
    curve: Range<usize>,
    /// Where those of what lingers begin: of velocities, and of turns alone.
    lingering: [usize; 2],
    /// Of the curve's columns the first that is of turns alone, after all others.
    last: usize,
}

/// Shares of what is delayed by two ages one after another, by the age that both are together.
static BOTH: LazyLock<Vec<Vec<Vec<f64>>>> = LazyLock::new(|| both(Columns::ages_s()));

impl<'a> Passing<'a> {
    /// Of motion with these columns and, nominally, these numbers; `None` where it is not of wheels.
    #[must_use]
    pub fn new(columns: &'a Columns, base: &[f64]) -> Option<Self> {
        let in_turns = columns.in_turns().filter(|_| !columns.nominal().is_empty())?;
        let (width, curve) = (columns.len(), columns.range(Group::Curve));
        let most =
            |axis: usize| base[axis * width..][curve.clone()].iter().fold(0.0, |most, it| f64::max(most, it.abs()));
        Some(Self {
            nominal: columns.nominal(),
            greatest: std::array::from_fn(most),
            width,
            lingering: [Group::Lingering, Group::Turning].map(|group| columns.range(group).start),
            last: in_turns.start - curve.start,
            curve,
        })
    }

    /// Adds to a response, which has an effect's `change` in it beside the `others`', what comes of one passing through the other.
    pub fn add(&self, others: &[f64], change: &[f64], numbers: &mut [f64]) {
        // What is seen otherwise is passed on by nothing.
        if [others, change].iter().any(|it| it[..3 * self.width].iter().all(|number| *number == 0.0)) {
            return;
        }
        let mut at_once = vec![0.0; change.len()];
        self.at_once(others, change, &mut at_once);
        self.at_once(change, others, &mut at_once);
        let whole: Vec<f64> = change.iter().zip(&at_once).map(|(a, b)| a + b).collect();
        numbers.iter_mut().zip(at_once).for_each(|(number, more)| *number += more);
        self.late(others, &whole, numbers);
        self.late(&whole, others, numbers);
        self.later(others, &whole, numbers);
    }

    /// The number that says how much of a source's velocity at an age an axis has.
    fn at(&self, axis: usize, age: usize, source: usize) -> usize {
        let [of_velocities, of_turns] = self.lingering;
        let column = match source {
            IN_TURNS.. => of_turns + OF_TURNS * age + source - IN_TURNS,
            _ => of_velocities + 3 * age + source,
        };
        axis * self.width + column
    }

    fn ages() -> usize {
        BOTH.len()
    }

    /// Axes that move.
    fn axes(&self) -> impl Iterator<Item = usize> + '_ {
        (0..3).filter(|axis| self.greatest[*axis] > 0.0)
    }

    /// What `then` makes at once of what `first` changes of velocities. Of two effects that scale, whose order does not matter, this
    /// is half of what comes of both; what is lost in a turn is lost of what was told, and only before.
    fn at_once(&self, then: &[f64], first: &[f64], numbers: &mut [f64]) {
        for from in self.axes() {
            let sources = self.sources(first, from);
            for axis in self.axes() {
                let share = self.sources(then, axis)[from] / self.greatest[from];
                let of_axis = axis * self.width + self.curve.start;
                for (i, scaled) in self.nominal[..self.last].iter().enumerate() {
                    let of = self.axes().fold(0.0, |sum, source| sum + sources[source] * scaled[source]);
                    numbers[of_axis + i] += 0.5 * share * of;
                }
                for (number, source) in numbers[of_axis + self.last..].iter_mut().zip(&sources[IN_TURNS..]) {
                    *number += share * source;
                }
            }
        }
    }

    /// What `curved` changes of velocities, as late as `lingering` is.
    fn late(&self, lingering: &[f64], curved: &[f64], numbers: &mut [f64]) {
        for from in self.axes() {
            let sources = self.sources(curved, from).map(|it| it / self.greatest[from]);
            for axis in self.axes() {
                for age in 0..Self::ages() {
                    let share = lingering[self.at(axis, age, from)];
                    for (source, of) in sources.iter().enumerate() {
                        numbers[self.at(axis, age, source)] += share * of;
                    }
                }
            }
        }
    }

    /// What an axis's curve changes by, as so much of each source: the least squares over the curve's columns.
    fn sources(&self, change: &[f64], axis: usize) -> [f64; SOURCES] {
        let (curve, last) = (&change[axis * self.width..][self.curve.clone()], self.last);
        let mut sources = [0.0; SOURCES];
        // Axes have columns of their own, but for what a wheel makes of both.
        for source in self.axes() {
            let of = |i: &usize| self.nominal[*i][source];
            let within = (0..last).filter(|i| of(i) != 0.0);
            let (product, square) =
                within.fold((0.0, 0.0), |(product, square), i| (product + curve[i] * of(&i), square + of(&i) * of(&i)));
            sources[source] = product / f64::max(square, 1e-12);
        }
        sources[IN_TURNS..].copy_from_slice(&curve[last..]);
        sources
    }

    /// What `first` lets linger, as late as `then` is: older than either.
    fn later(&self, then: &[f64], first: &[f64], numbers: &mut [f64]) {
        let ages = Self::ages();
        for from in self.axes() {
            for source in self.axes().chain(IN_TURNS..SOURCES) {
                let lets: Vec<f64> =
                    (0..ages).map(|age| first[self.at(from, age, source)] / self.greatest[from]).collect();
                for axis in self.axes() {
                    for i in 0..ages {
                        let share = then[self.at(axis, i, from)];
                        for (j, of) in lets.iter().enumerate() {
                            let product = share * of;
                            for (m, both) in BOTH[i][j].iter().enumerate() {
                                numbers[self.at(axis, m, source)] += product * both;
                            }
                            // Each says how a velocity differs from now, so that what is new there is so from its own age on.
                            numbers[self.at(axis, i, source)] -= product;
                            numbers[self.at(axis, j, source)] -= product;
                        }
                    }
                }
            }
        }
    }
}

/// Of a delay that is anywhere between two ages behind one that is between two others, the share of each age's; what is older
/// than all of them counts as the oldest.
fn both(ages_s: &[f64]) -> Vec<Vec<Vec<f64>>> {
    let pairs: Vec<[f64; 2]> = ages_s.windows(2).map(|pair| [pair[0], pair[1]]).collect();
    let shares = |a: [f64; 2], b: [f64; 2]| -> Vec<f64> {
        let until = |m: usize| if m + 1 == pairs.len() { 1.0 } else { below(pairs[m][1], a, b) };
        (0..pairs.len()).map(|m| until(m) - m.checked_sub(1).map_or(0.0, until)).collect()
    };
    pairs.iter().map(|a| pairs.iter().map(|b| shares(*a, *b)).collect()).collect()
}

#[cfg(test)]
mod tests {
    use asami_dataset::{Action, Command};

    use super::*;

    const FORWARD: usize = 1;
    const DT_S: f64 = 0.01;

    fn wheels(t_s: f64, v_m_per_s: f64, omega_rad_per_s: f64) -> Command {
        Command { t_s, action: Action::Wheels { id: None, v_m_per_s, omega_rad_per_s } }
    }

    /// Straight on, then turns of either side and of several speeds.
    fn commands() -> Vec<Command> {
        let told = [(0.2, 0.0), (0.2, 0.5), (0.1, -0.3), (0.0, 0.4), (0.15, 0.5), (0.15, 0.0)];
        told.iter().enumerate().map(|(k, (v, omega))| wheels(4.0 * k as f64, *v, *omega)).collect()
    }

    /// Wheels that do at once what they are told, at most 0.2 m/s and 0.5 rad/s.
    fn prompt() -> (Columns, Vec<f64>) {
        let columns = Columns::new(commands().iter(), 3);
        let width = columns.len();
        let (curve, mut base) = (columns.range(Group::Curve), vec![0.0; 3 * width]);
        let knots = (curve.len() - 1 - OF_TURNS) / 2;
        for knot in 0..knots {
            let u = 2.0 * knot as f64 / (knots - 1) as f64 - 1.0;
            base[width + curve.start + knot] = 0.2 * u;
            base[2 * width + curve.start + knots + knot] = 0.5 * u;
        }
        (columns.knowing(&base), base)
    }

    /// The speed forward between two times.
    fn speed(columns: &Columns, numbers: &[f64], from_s: f64, to_s: f64) -> f64 {
        let mut row = vec![0.0; columns.len()];
        columns.fill(&commands(), from_s, to_s, &[], &mut row);
        let of_axis = &numbers[FORWARD * columns.len()..][..columns.len()];
        row.iter().zip(of_axis).map(|(column, number)| column * number).sum()
    }

    /// The speed that was forward between 0.3 and 0.2 s before each time of a step.
    fn late_speed(columns: &Columns, numbers: &[f64], from_s: f64) -> f64 {
        let within = (0..50).map(|i| from_s + DT_S * (f64::from(i) + 0.5) / 50.0);
        within.map(|t_s| speed(columns, numbers, t_s - 0.3, t_s - 0.2) / 50.0).sum()
    }

    /// A change by which so much of every axis's velocity comes later, by age.
    fn late(passing: &Passing<'_>, by_age: &[(usize, f64)]) -> Vec<f64> {
        let mut change = vec![0.0; 3 * passing.width];
        for (age, share) in by_age {
            for axis in passing.axes() {
                change[passing.at(axis, *age, axis)] = share * passing.greatest[axis];
            }
        }
        change
    }

    fn plus(numbers: &[f64], change: &[f64]) -> Vec<f64> {
        numbers.iter().zip(change).map(|(a, b)| a + b).collect()
    }

    /// Behind a delay, what a turn takes from the speed is taken later as well; whichever of the two is added first.
    #[test]
    fn what_is_lost_in_turns_is_as_late_as_the_motors_are() {
        let (columns, base) = prompt();
        let passing = Passing::new(&columns, &base).unwrap();
        // Of ages from 0.2 to 0.3 s.
        let delay = late(&passing, &[(4, 1.0)]);
        let mut loss = vec![0.0; base.len()];
        loss[FORWARD * columns.len() + passing.curve.start + passing.last] = -0.08;
        let slow = plus(&base, &loss);
        let both = plus(&slow, &delay);
        let mut passed = both.clone();
        passing.add(&loss, &delay, &mut passed);
        let mut other_way = both.clone();
        passing.add(&delay, &loss, &mut other_way);
        let mut off = 0.0_f64;
        for step in 200..2300 {
            let from_s = DT_S * f64::from(step);
            let to_s = from_s + DT_S;
            let expected = late_speed(&columns, &slow, from_s);
            let [passed, other_way] = [&passed, &other_way].map(|it| speed(&columns, it, from_s, to_s));
            assert!(
                (passed - expected).abs() < 1e-6 && (other_way - passed).abs() < 1e-12,
                "{from_s}: {passed} {expected}"
            );
            off = off.max((speed(&columns, &both, from_s, to_s) - expected).abs());
        }
        assert!(off > 0.03, "added up they are off by {off} m/s");
    }

    /// Motors that are told more lose more in a turn, as much later as they are late; in whichever order the three are added.
    #[test]
    fn what_is_lost_in_turns_is_of_what_motors_are_told() {
        let (columns, base) = prompt();
        let passing = Passing::new(&columns, &base).unwrap();
        let of_forward = columns.len()..2 * columns.len();
        let mut loss = vec![0.0; base.len()];
        loss[of_forward.start + passing.curve.start + passing.last] = -0.08;
        let scaled: Vec<f64> = base.iter().map(|number| 0.25 * number).collect();
        let slow = plus(&base, &loss);
        let truth: Vec<f64> = slow.iter().map(|number| 1.25 * number).collect();
        let delay = late(&passing, &[(4, 1.0)]);
        for order in [[&scaled, &loss, &delay], [&loss, &delay, &scaled], [&delay, &loss, &scaled]] {
            let mut others = vec![0.0; base.len()];
            for (k, change) in order.into_iter().enumerate() {
                let mut numbers = plus(&plus(&base, &others), change);
                if k > 0 {
                    passing.add(&others, change, &mut numbers);
                }
                others = numbers.iter().zip(&base).map(|(a, b)| a - b).collect();
            }
            let found = plus(&base, &others);
            for step in 200..2300 {
                let from_s = DT_S * f64::from(step);
                let expected = late_speed(&columns, &truth, from_s);
                let found = speed(&columns, &found, from_s, from_s + DT_S);
                assert!((found - expected).abs() < 1e-6, "{from_s}: {found} {expected}");
            }
        }
    }

    /// A delay behind a lag is as late as both are one after the other, and what is steady stays what it is.
    #[test]
    fn a_delay_behind_a_lag_is_as_late_as_both() {
        let (columns, base) = prompt();
        let passing = Passing::new(&columns, &base).unwrap();
        let delay = late(&passing, &[(3, 1.0)]);
        let lag = late(&passing, &[(0, 0.3), (1, 0.2), (3, 0.1), (5, 0.1)]);
        let mut numbers = plus(&plus(&base, &delay), &lag);
        passing.add(&delay, &lag, &mut numbers);
        // From the change at 8 s on, of half of the speed straight on.
        let lateness_s = |numbers: &[f64]| {
            let steps = (0..200).map(|step| 8.0 + DT_S * f64::from(step));
            let speeds = steps.map(|from_s| speed(&columns, numbers, from_s, from_s + DT_S));
            speeds.map(|v| (v - 0.1) / 0.1 * DT_S).sum::<f64>()
        };
        let [alone, behind] = [&delay, &lag].map(|change| lateness_s(&plus(&base, change)));
        let together = lateness_s(&numbers);
        assert!((alone - 0.175).abs() < 0.01 && behind > 0.06, "{alone} {behind}");
        assert!((together - alone - behind).abs() < 0.02, "{together}, not {alone} and {behind}");
        assert!((speed(&columns, &numbers, 11.0, 11.01) - 0.1).abs() < 1e-12);
        for pair in BOTH.iter().flatten() {
            assert!((pair.iter().sum::<f64>() - 1.0).abs() < 1e-12 && pair.iter().all(|it| *it > -1e-12), "{pair:?}");
        }
    }

    #[test]
    fn what_can_go_sideways_is_not_on_wheels() {
        let legs = Action::Legs { id: None, ax_m_per_s: 0.1, ay_m_per_s: 0.3, atheta_rad_per_s: 0.5 };
        let columns = Columns::new([Command { t_s: 0.0, action: legs }].iter(), 3);
        let columns = columns.knowing(&vec![1.0; 3 * columns.len()]);
        assert!(Passing::new(&columns, &vec![1.0; 3 * columns.len()]).is_none());
    }
}
