//! A log of chapter 3: one landmark straight ahead, commands of forward speed, motion along a line.

use std::ops::Range;

use asami_dataset::{ActionModel, Log, Models, Size};

use crate::learner::{CannotLearn, Lack};

/// A log as chapter 3 sees it: observations `o_t`, and the commands `c(t)` between them.
///
/// The only place in these learners that matches on kinds of commands and sightings.
#[derive(Clone, Debug)]
pub struct Line {
    /// What the observations are.
    pub unit: Unit,
    /// Time of the first command: nothing earlier can be used.
    pub start_s: f64,
    /// The observations from the first command on, in order of time.
    pub rows: Vec<Row>,
    pieces: Vec<Piece>,
    /// Times and values of all commands.
    commands: Vec<(f64, f64)>,
}

/// What an observation is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Height in the image, pixels.
    HeightPx,
    /// Measured distance, metres.
    RangeM,
}

impl Unit {
    /// That of all of a log's sightings.
    pub(crate) fn of(log: &Log) -> Result<Self, CannotLearn> {
        let of = |size: Size| match size {
            Size::HeightPx(_) => Unit::HeightPx,
            Size::RangeM(_) => Unit::RangeM,
        };
        let unit = log.sightings.first().map(|sighting| of(sighting.size)).ok_or(CannotLearn::NoSightings)?;
        let is_other = log.sightings.iter().any(|sighting| of(sighting.size) != unit);
        if is_other { Err(CannotLearn::MixedSightings) } else { Ok(unit) }
    }

    /// Its symbol.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            Unit::HeightPx => "px",
            Unit::RangeM => "m",
        }
    }
}

/// One observation.
#[derive(Clone, Debug)]
pub struct Row {
    /// When, in the log's time.
    pub t_s: f64,
    /// `o_t`, in [`Line::unit`].
    pub o: f64,
    pieces: Range<usize>,
}

/// A stretch of one constant command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// `c`, the commanded forward speed.
    pub c_m_per_s: f64,
    /// How long.
    pub dt_s: f64,
}

impl TryFrom<&Log> for Line {
    type Error = CannotLearn;

    fn try_from(log: &Log) -> Result<Self, CannotLearn> {
        let commands = forward_commands(log)?;
        let (unit, sightings) = sightings(log)?;
        let start_s = commands[0].0;
        let (mut rows, mut pieces) = (Vec::new(), Vec::new());
        let (mut now_s, mut held) = (start_s, 0);
        for (t_s, o) in sightings {
            if t_s < now_s {
                continue;
            }
            let first = pieces.len();
            while let Some(next) = commands.get(held + 1).filter(|next| next.0 <= t_s) {
                pieces.push(Piece { c_m_per_s: commands[held].1, dt_s: next.0 - now_s });
                (now_s, held) = (next.0, held + 1);
            }
            pieces.push(Piece { c_m_per_s: commands[held].1, dt_s: t_s - now_s });
            now_s = t_s;
            rows.push(Row { t_s, o, pieces: first..pieces.len() });
        }
        if rows.is_empty() {
            return Err(CannotLearn::NoSightings);
        }
        Ok(Line { unit, start_s, rows, pieces, commands })
    }
}

/// Times and forward speeds of the commands.
fn forward_commands(log: &Log) -> Result<Vec<(f64, f64)>, CannotLearn> {
    if log.commands.is_empty() {
        return Err(CannotLearn::NoCommands);
    }
    let mut commands: Vec<(f64, f64)> = Vec::new();
    for command in log.commands.iter() {
        let c_m_per_s = command.action.forward_m_per_s().ok_or(CannotLearn::WrongCommands)?;
        let later = commands.last().is_none_or(|last| last.0 <= command.t_s);
        if command.t_s.is_finite() && c_m_per_s.is_finite() && later {
            commands.push((command.t_s, c_m_per_s));
        }
    }
    if commands.is_empty() { Err(CannotLearn::NoCommands) } else { Ok(commands) }
}

/// The unit, times and values of the observations.
fn sightings(log: &Log) -> Result<(Unit, Vec<(f64, f64)>), CannotLearn> {
    let mut ids: Vec<u16> = log.sightings.iter().map(|sighting| sighting.landmark).collect();
    ids.sort_unstable();
    ids.dedup();
    if ids.len() > 1 {
        return Err(CannotLearn::SeveralLandmarks { found: ids.len() });
    }
    let unit = Unit::of(log)?;
    let rows = log.sightings.iter().map(|sighting| (sighting.t_s, sighting.size.value()));
    Ok((unit, rows.filter(|(t_s, o)| t_s.is_finite() && o.is_finite()).collect()))
}

impl Line {
    /// The commands between observation `i - 1` (the start, for the first) and observation `i`.
    #[must_use]
    pub fn pieces(&self, i: usize) -> &[Piece] {
        self.rows.get(i).map_or(&[], |row| &self.pieces[row.pieces.clone()])
    }

    /// Every stretch of constant command up to the last observation, cut at the observations.
    #[must_use]
    pub fn all_pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// Seconds from the start to the last observation.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.rows.last().map_or(0.0, |row| row.t_s - self.start_s)
    }

    /// The integrals of `(c / scale)^j`, j from 0 to `degree`, from observation `i - 1` to `i`.
    #[must_use]
    pub fn powers(&self, i: usize, degree: usize, scale: f64) -> Vec<f64> {
        let mut sums = vec![0.0; degree + 1];
        for piece in self.pieces(i) {
            let (u, mut power) = (piece.c_m_per_s / scale, piece.dt_s);
            for sum in &mut sums {
                *sum += power;
                power *= u;
            }
        }
        sums
    }

    /// For every observation in turn: [`powers`](Line::powers) as if commands took effect `delay_s` late,
    /// `degree + 1` numbers each; and the commands then in force.
    #[must_use]
    pub fn delayed_powers(&self, degree: usize, scale: f64, delay_s: f64) -> (Vec<f64>, Vec<f64>) {
        let width = degree + 1;
        let (mut sums, mut in_force) = (vec![0.0; self.rows.len() * width], Vec::with_capacity(self.rows.len()));
        let (mut held, mut now_s) = (0, self.start_s - delay_s);
        for (row, sums) in self.rows.iter().zip(sums.chunks_mut(width)) {
            let until_s = row.t_s - delay_s;
            loop {
                let next_s = self.commands.get(held + 1).map_or(f64::INFINITY, |next| next.0);
                let end_s = if next_s < until_s { next_s } else { until_s };
                let (u, mut power) = (self.commands[held].1 / scale, end_s - now_s);
                for sum in sums.iter_mut() {
                    *sum += power;
                    power *= u;
                }
                now_s = end_s;
                if next_s > until_s {
                    break;
                }
                held += 1;
            }
            in_force.push(self.commands[held].1);
        }
        (sums, in_force)
    }

    /// The same without delay, from the start up to each observation.
    #[must_use]
    pub fn cumulated_powers(&self, degree: usize, scale: f64) -> Vec<Vec<f64>> {
        let mut sums = vec![0.0; degree + 1];
        (0..self.rows.len())
            .map(|i| {
                for (sum, power) in sums.iter_mut().zip(self.powers(i, degree, scale)) {
                    *sum += power;
                }
                sums.clone()
            })
            .collect()
    }

    /// `w_a`: the place at each observation by an action model, 0 at the start.
    #[must_use]
    pub fn places(&self, action: &ActionModel) -> Vec<f64> {
        let mut place = 0.0;
        (0..self.rows.len())
            .map(|i| {
                for piece in self.pieces(i) {
                    place += action.forward_at(piece.c_m_per_s).unwrap_or(0.0) * piece.dt_s;
                }
                place
            })
            .collect()
    }

    /// Times and values as the points of a trace.
    #[must_use]
    pub fn trace(&self, values: &[f64]) -> Vec<[f64; 2]> {
        self.rows.iter().zip(values).map(|(row, value)| [row.t_s, *value]).collect()
    }

    /// Greatest commanded speed either way while something was observed; 1 if there was no motion.
    #[must_use]
    pub fn command_scale(&self) -> f64 {
        let greatest = self.pieces.iter().fold(0.0, |most: f64, piece| most.max(piece.c_m_per_s.abs()));
        if greatest > 0.0 { greatest } else { 1.0 }
    }

    /// Least and greatest observation.
    #[must_use]
    pub fn observed(&self) -> (f64, f64) {
        self.rows.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), row| (a.min(row.o), b.max(row.o)))
    }

    /// Centre and scale under which the observations lie in -1 to 1.
    #[must_use]
    pub fn observation_scaling(&self) -> (f64, f64) {
        let (least, greatest) = self.observed();
        let half = 0.5 * greatest - 0.5 * least;
        (0.5 * greatest + 0.5 * least, if half > 0.0 { half } else { 1.0 })
    }

    /// Standard deviation of the observations' noise if it is white, out of second differences from
    /// row to row: steady motion cancels.
    #[must_use]
    pub fn local_noise(&self) -> f64 {
        let second = |three: &[Row]| three[0].o - 2.0 * three[1].o + three[2].o;
        let sum = self.rows.windows(3).fold(0.0, |sum, three| sum + second(three) * second(three));
        let n = self.rows.len().saturating_sub(2);
        if n == 0 { 0.0 } else { (sum / (6.0 * n as f64)).sqrt() }
    }

    /// How many different commands there are.
    #[must_use]
    pub fn distinct_commands(&self) -> usize {
        let mut commands: Vec<f64> = self.pieces.iter().filter(|p| p.dt_s > 0.0).map(|p| p.c_m_per_s).collect();
        commands.sort_by(f64::total_cmp);
        commands.dedup_by(|a, b| a == b);
        commands.len()
    }

    /// What this log cannot tell about an action model of some degree and about the sensor model.
    #[must_use]
    pub fn lacks(&self, action_degree: usize) -> Vec<Lack> {
        let (found, needed) = (self.distinct_commands(), action_degree + 1);
        let mut lacks = Vec::new();
        if found < needed {
            lacks.push(Lack::FewSpeeds { found, needed });
        }
        let (least, greatest) = self.observed();
        // White noise alone spans 7 to 8 standard deviations in some thousand observations.
        if greatest - least <= 10.0 * self.local_noise() {
            lacks.push(Lack::NarrowObservations { span: greatest - least, unit: self.unit.symbol() });
        }
        lacks
    }

    /// Refuses logs with fewer observations than unknowns.
    ///
    /// # Errors
    /// [`CannotLearn::TooShort`].
    pub fn require(&self, needed: usize) -> Result<(), CannotLearn> {
        let found = self.rows.len();
        if found < needed { Err(CannotLearn::TooShort { found, needed }) } else { Ok(()) }
    }
}

/// The action model of forward speed in `given`.
///
/// # Errors
/// [`CannotLearn::NotGiven`].
pub fn given_action(given: &Models) -> Result<&ActionModel, CannotLearn> {
    let action = given.action.as_ref().filter(|action| action.forward_at(0.0).is_some());
    action.ok_or(CannotLearn::NotGiven("an action model of forward speed"))
}
