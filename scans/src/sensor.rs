//! The lasers' relative angles, out of what they see alone (section 5.1).

use std::f64::consts::TAU;

use asami_math::correlation::ABSENT;

use crate::CannotScan;
use crate::angles::{Angles, chain, graph};
use crate::drive::Drive;
use crate::offsets::{Offsets, from_slopes, slopes};
use crate::pairs::{PairLag, pair_lags, pairs};
use crate::signal::{Shaping, Signal};

/// How the relative angles are learned.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    /// What is correlated.
    pub shaping: Shaping,
    /// Lags up to this angle to both sides are tried.
    pub most_lag_rad: f64,
    /// Lags at which fewer than this share of the most firings overlap are passed over.
    pub least_share: f64,
    /// Whether a parabola through the peak finds it between the steps of the firings.
    pub sub_step: bool,
    /// How lags become angles.
    pub layout: Layout,
    /// What is taken for known of the lasers' offsets off the axis.
    pub offsets: Offsets,
    /// Of a longer drive so many single turns are used, spread evenly over it; 0: all of it. Turns of one place would see the
    /// same edges again, and repeat each other's errors.
    pub most_turns: usize,
}

/// How far apart lasers are whose lags tell their offsets.
const OFFSET_REACH: usize = 3;

/// How the lags of pairs become angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Layout {
    /// Differences of adjacent lasers, added up.
    Chain,
    /// Least squares over all pairs up to `reach` lasers apart, with robust weights.
    Graph {
        /// How far apart.
        reach: usize,
        /// Residual of a pair that counts a quarter.
        scale_rad: f64,
    },
}

impl Sensor {
    /// Section 5.1: adjacent lasers over a half turn to both sides, the range itself, to a step of the firings, added up.
    #[must_use]
    pub fn published() -> Self {
        Self {
            shaping: Shaping::published(),
            most_lag_rad: std::f64::consts::PI,
            least_share: 0.1,
            sub_step: false,
            layout: Layout::Chain,
            offsets: Offsets::None,
            most_turns: 0,
        }
    }

    /// High-passed logarithms of ranges, lags between the steps of the firings, and pairs up to six lasers apart in place of the chain.
    #[must_use]
    pub fn graph(most_lag_deg: f64, high_pass_deg: f64, near_m: f64) -> Self {
        Self {
            shaping: Shaping {
                signal: Signal::LogRange,
                high_pass_rad: high_pass_deg.to_radians(),
                clip_nat: 0.5,
                near_m,
                window_m: None,
            },
            most_lag_rad: most_lag_deg.to_radians(),
            sub_step: true,
            ..Self::published()
        }
        .over(6, 0.1, 0)
    }

    /// With pairs up to `reach` lasers apart, a residual of `scale_deg` counting a quarter, out of `most_turns` turns (0: all).
    #[must_use]
    pub fn over(self, reach: u32, scale_deg: f64, most_turns: u32) -> Self {
        let layout = Layout::Graph { reach: reach as usize, scale_rad: scale_deg.to_radians() };
        Self { layout, most_turns: most_turns as usize, ..self }
    }

    /// The angles, their mean 0; places of lasers that are known are not looked for.
    ///
    /// # Errors
    /// [`CannotScan::Undetermined`] where the pairs' lags do not hold all lasers together.
    pub fn learn(&self, drive: &Drive<'_>) -> Result<Angles, CannotScan> {
        if drive.places_m.iter().any(|[left_m, _]| *left_m != 0.0) {
            return self.with_offsets(drive, &drive.places_m.iter().map(|it| it[0]).collect::<Vec<f64>>());
        }
        let angles = self.solve(drive, &self.signals(drive, &self.shaping, &[]))?;
        if self.offsets == Offsets::None {
            return Ok(angles);
        }
        let slopes = slopes(self, drive, &angles.angle_rad, OFFSET_REACH);
        let offsets_m = from_slopes(drive.lasers(), &slopes, self.offsets);
        self.with_offsets(drive, &offsets_m)
    }

    /// The angles, their mean 0, where each laser sits so far to the counter-clockwise side of its ray (0 where none is given).
    ///
    /// # Errors
    /// As [`Sensor::learn`].
    pub fn with_offsets(&self, drive: &Drive<'_>, offsets_m: &[f64]) -> Result<Angles, CannotScan> {
        self.solve(drive, &self.signals(drive, &self.shaping, offsets_m))
    }

    /// The signal of each laser; lateral offsets are 0 where none are given.
    pub(crate) fn signals(&self, drive: &Drive<'_>, shaping: &Shaping, offsets_m: &[f64]) -> Vec<Vec<i16>> {
        let offset_m = |laser: usize| offsets_m.get(laser).copied().unwrap_or(0.0);
        let signal = |laser: usize| self.sampled(drive, &shaping.of(drive, laser, offset_m(laser)), ABSENT);
        (0..drive.lasers()).map(signal).collect()
    }

    /// The turns of a column that are used, one after another, lags' lengths of `absent` between them.
    pub(crate) fn sampled<T: Copy>(&self, drive: &Drive<'_>, column: &[T], absent: T) -> Vec<T> {
        let (turn, turns) = (drive.firings_in(TAU).max(1), self.most_turns);
        if turns == 0 || turns * turn >= column.len() {
            return column.to_vec();
        }
        let gap = drive.firings_in(self.most_lag_rad);
        let mut used = Vec::with_capacity(turns * (turn + gap));
        for i in 0..turns {
            let first = (column.len() - turn) * i / (turns - 1).max(1);
            used.extend_from_slice(&column[first..first + turn]);
            used.resize(used.len() + gap, absent);
        }
        used
    }

    pub(crate) fn solve(&self, drive: &Drive<'_>, signals: &[Vec<i16>]) -> Result<Angles, CannotScan> {
        let reach = match self.layout {
            Layout::Chain => 1,
            Layout::Graph { reach, .. } => reach,
        };
        let lags = pair_lags(
            drive,
            signals,
            &pairs(drive.lasers(), reach),
            self.most_lag_rad,
            self.least_share,
            self.sub_step,
        );
        match self.layout {
            Layout::Chain => {
                let angle = |lag: &PairLag| if self.sub_step { lag.angle_rad } else { lag.step_angle_rad };
                Ok(chain(&lags.iter().map(|lag| lag.as_ref().map(angle)).collect::<Vec<_>>(), drive.step_rad))
            }
            Layout::Graph { scale_rad, .. } => graph(drive.lasers(), &lags, scale_rad).ok_or_else(|| {
                CannotScan::Undetermined("the lasers' ranges do not vary together enough to hold their angles".into())
            }),
        }
    }
}
