//! What a multi-beam laser scanner recorded, firing by firing, with nothing calibrated out of it.

use std::ops::Range;

use asami_math::angle::wrap_rad;

/// One unit of a range: 2 mm, the Velodyne HDL-64E's own.
pub const RANGE_STEP_M: f64 = 0.002;
/// One unit of an encoder angle, hundredths of a degree.
pub const ENCODER_STEP_RAD: f64 = std::f64::consts::PI / 18_000.0;
/// Encoder angles of one turn.
pub const ENCODER_STEPS: u16 = 36_000;

/// The firings of a whole drive: at each, every laser of the bank measures one range.
///
/// Turn the encoder's angle round for the dissertation's theta_r ([`Firings::theta_r_rad`]): the encoder counts
/// clockwise seen from above, theta_r counter-clockwise. A laser whose rotational correction is `rc` looks, at encoder
/// angle `rot`, along `rot - rc` clockwise: with theta_l = `rc`, along `theta_l + theta_r` (eq. 2.35).
///
/// Ranges and intensities lie laser-major, `[laser][firing]`: what one laser saw over time is one slice.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Firings {
    /// Seconds since the log began, one per firing, in order.
    pub t_s: Vec<f64>,
    /// Angle of the unit to its base, clockwise seen from above, in hundredths of a degree, `0..36000`; one per firing.
    pub encoder_cdeg: Vec<u16>,
    /// Measured range in units of 2 mm, 0 for no return: `[laser][firing]`, lasers by increasing vertical angle.
    pub range_2mm: Vec<Vec<u16>>,
    /// Intensity of the return, `[laser][firing]`; empty if none was recorded.
    pub intensity: Vec<Vec<u8>>,
}

/// Columns of [`Firings`] that do not fit together.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Misfit {
    /// A column of another length.
    #[error("{what} has {found} rows, not the {expected} of the firing times")]
    Length {
        /// Which column.
        what: String,
        /// Rows it has.
        found: usize,
        /// Rows of `t_s`.
        expected: usize,
    },
    /// More or fewer lasers with an intensity than with a range.
    #[error("{found} lasers have an intensity, {expected} a range")]
    Lasers {
        /// Lasers with an intensity.
        found: usize,
        /// Lasers with a range.
        expected: usize,
    },
    /// A time that is no number, or before the one ahead of it.
    #[error("firing {firing}: its time {t_s} s does not follow the one before")]
    Time {
        /// Which firing, from 0.
        firing: usize,
        /// Its time.
        t_s: f64,
    },
    /// An angle beyond a full turn.
    #[error("firing {firing}: encoder angle {encoder_cdeg} lies beyond a full turn of 36000 hundredths of a degree")]
    Encoder {
        /// Which firing, from 0.
        firing: usize,
        /// Its angle.
        encoder_cdeg: u16,
    },
}

impl Firings {
    /// How many firings there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.t_s.len()
    }

    /// Whether there is no firing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.t_s.is_empty()
    }

    /// How many lasers there are.
    #[must_use]
    pub fn lasers(&self) -> usize {
        self.range_2mm.len()
    }

    /// The dissertation's theta_r at a firing: minus the encoder's angle, in `[-pi, pi)`; `None` beyond the last.
    #[must_use]
    pub fn theta_r_rad(&self, firing: usize) -> Option<f64> {
        self.encoder_cdeg.get(firing).map(|encoder| wrap_rad(-f64::from(*encoder) * ENCODER_STEP_RAD))
    }

    /// What a laser measured at a firing, in metres; `None` where it had no return, or where there is no such firing.
    #[must_use]
    pub fn range_m(&self, laser: usize, firing: usize) -> Option<f64> {
        let steps = *self.range_2mm.get(laser)?.get(firing)?;
        (steps > 0).then(|| f64::from(steps) * RANGE_STEP_M)
    }

    /// Whether all columns fit together: lengths, order of time, angles within a turn.
    ///
    /// # Errors
    /// The first [`Misfit`].
    pub fn check(&self) -> Result<(), Misfit> {
        let length = |what: &dyn Fn() -> String, found: usize| {
            let expected = self.len();
            if found == expected { Ok(()) } else { Err(Misfit::Length { what: what(), found, expected }) }
        };
        length(&|| "the encoder".into(), self.encoder_cdeg.len())?;
        for (laser, ranges) in self.range_2mm.iter().enumerate() {
            length(&|| format!("the range of laser {laser}"), ranges.len())?;
        }
        if !self.intensity.is_empty() && self.intensity.len() != self.lasers() {
            return Err(Misfit::Lasers { found: self.intensity.len(), expected: self.lasers() });
        }
        for (laser, intensities) in self.intensity.iter().enumerate() {
            length(&|| format!("the intensity of laser {laser}"), intensities.len())?;
        }
        let mut before_s = f64::NEG_INFINITY;
        for (firing, (&t_s, &encoder_cdeg)) in self.t_s.iter().zip(&self.encoder_cdeg).enumerate() {
            if !t_s.is_finite() || t_s < before_s {
                return Err(Misfit::Time { firing, t_s });
            }
            if encoder_cdeg >= ENCODER_STEPS {
                return Err(Misfit::Encoder { firing, encoder_cdeg });
            }
            before_s = t_s;
        }
        Ok(())
    }

    /// Which firings have `span_s.start <= t < span_s.end`.
    #[must_use]
    pub fn within(&self, span_s: &Range<f64>) -> Range<usize> {
        let index = |t_s: f64| self.t_s.partition_point(|t| *t < t_s);
        let start = index(span_s.start);
        start..index(span_s.end).max(start)
    }

    /// A copy of some firings, times unchanged; what lies beyond a column's end is left out.
    #[must_use]
    pub fn part(&self, firings: Range<usize>) -> Self {
        fn cut<T: Copy>(column: &[T], of: &Range<usize>) -> Vec<T> {
            let end = of.end.min(column.len());
            column[of.start.min(end)..end].to_vec()
        }
        Self {
            t_s: cut(&self.t_s, &firings),
            encoder_cdeg: cut(&self.encoder_cdeg, &firings),
            range_2mm: self.range_2mm.iter().map(|ranges| cut(ranges, &firings)).collect(),
            intensity: self.intensity.iter().map(|intensities| cut(intensities, &firings)).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Log;
    use proptest::prelude::*;
    use std::sync::Arc;

    fn drive(n: usize) -> Firings {
        Firings {
            t_s: (0..n).map(|i| i as f64 * 0.25).collect(),
            encoder_cdeg: (0..n).map(|i| (i * 9000 % 36_000) as u16).collect(),
            range_2mm: (0..3).map(|laser| (0..n).map(|i| (100 * laser + i) as u16).collect()).collect(),
            intensity: vec![vec![7; n]; 3],
        }
    }

    #[test]
    fn a_quarter_turn_of_the_encoder_is_a_quarter_turn_clockwise() {
        let firings = drive(4);
        assert_eq!(firings.check(), Ok(()));
        assert!((firings.theta_r_rad(1).unwrap() + std::f64::consts::FRAC_PI_2).abs() < 1e-15);
        assert!((firings.theta_r_rad(3).unwrap() - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert_eq!((firings.range_m(0, 0), firings.range_m(1, 2)), (None, Some(102.0 * RANGE_STEP_M)));
        assert_eq!((firings.range_m(3, 0), firings.range_m(0, 4), firings.theta_r_rad(4)), (None, None, None));
    }

    #[test]
    fn a_log_cuts_its_firings_and_counts_them_in_its_span() {
        let log = Log { firings: Some(Arc::new(drive(9))), ..Log::default() };
        assert_eq!(log.span_s(), Some((0.0, 2.0)));
        let part = log.window(0.5..1.5);
        assert_eq!(part.span_s(), Some((0.5, 1.25)));
        let firings = part.firings.unwrap();
        assert_eq!((firings.len(), firings.lasers(), firings.check()), (4, 3, Ok(())));
        assert_eq!(firings.range_2mm[2], [202, 203, 204, 205]);
        assert!(log.window(5.0..9.0).firings.is_some_and(|firings| firings.is_empty() && firings.lasers() == 3));
        // The whole is shared, not copied.
        let whole = log.window(-1.0..10.0).firings.unwrap();
        assert!(Arc::ptr_eq(&whole, log.firings.as_ref().unwrap()));
    }

    #[test]
    fn what_does_not_fit_together_is_named() {
        let spoilt = |spoil: &dyn Fn(&mut Firings)| {
            let mut firings = drive(5);
            spoil(&mut firings);
            firings.check().unwrap_err().to_string()
        };
        assert_eq!(
            spoilt(&|f| f.range_2mm[1].truncate(2)),
            "the range of laser 1 has 2 rows, not the 5 of the firing times"
        );
        assert_eq!(spoilt(&|f| f.intensity.truncate(2)), "2 lasers have an intensity, 3 a range");
        assert_eq!(spoilt(&|f| f.t_s[3] = 0.1), "firing 3: its time 0.1 s does not follow the one before");
        assert_eq!(spoilt(&|f| f.t_s[0] = f64::NAN), "firing 0: its time NaN s does not follow the one before");
        assert!(spoilt(&|f| f.encoder_cdeg[2] = 36_000).starts_with("firing 2: encoder angle 36000 lies beyond"));
    }

    proptest! {
        #[test]
        fn no_window_of_any_columns_panics(
            times in proptest::collection::vec(proptest::num::f64::ANY, 0..20),
            lengths in proptest::collection::vec(0..20usize, 0..4),
            span in (proptest::num::f64::ANY, proptest::num::f64::ANY),
        ) {
            let firings = Firings {
                t_s: times,
                encoder_cdeg: vec![65_535; 5],
                range_2mm: lengths.iter().map(|n| vec![1; *n]).collect(),
                intensity: lengths.iter().rev().map(|n| vec![1; *n]).collect(),
            };
            let _ = firings.check();
            let log = Log { firings: Some(Arc::new(firings)), ..Log::default() };
            let _ = log.span_s();
            let part = log.window(span.0..span.1).firings.unwrap();
            prop_assert!(part.len() <= 20);
        }
    }
}
