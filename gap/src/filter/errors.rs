//! Whose errors a state holds: those of the few landmarks that were seen last.

use crate::state::{ERRORS, State};

/// So many landmarks' errors are held.
const HELD: usize = ERRORS.end - ERRORS.start;

/// The landmarks, the one that was seen last first, and where in the state each is.
#[derive(Clone, Debug)]
pub(super) struct Held([(Option<usize>, usize); HELD]);

impl Default for Held {
    fn default() -> Self {
        Self(std::array::from_fn(|i| (None, ERRORS.start + i)))
    }
}

impl Held {
    /// Where the state holds the error of a landmark that is seen now: in the place of the one that was not seen for longest if it
    /// was not held. `None` of a state that holds none.
    pub(super) fn of<const N: usize>(&mut self, landmark: usize, state: &mut State<N>) -> Option<usize> {
        if State::<N>::errors().is_empty() {
            return None;
        }
        let before = self.0.iter().position(|(whose, _)| *whose == Some(landmark));
        self.0[..=before.unwrap_or(HELD - 1)].rotate_right(1);
        let (whose, at) = &mut self.0[0];
        if before.is_none() {
            *whose = Some(landmark);
            state.forget_error(*at);
        }
        Some(*at)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, Vector3};

    use super::*;
    use crate::state::{Belief, LASTING, STEADY, SWAYING};

    fn nowhere() -> Belief {
        Belief { mean: Vector3::zeros(), covariance: Matrix3::identity() }
    }

    /// One more landmark takes the place of the one that was not seen for longest, and nothing is known of its error; what is known
    /// of the others' stays.
    #[test]
    fn the_one_that_was_not_seen_for_longest_makes_room() {
        let (mut held, mut state) = (Held::default(), State::<LASTING>::new(&nowhere()));
        let places: Vec<usize> = (0..HELD).map(|landmark| held.of(landmark, &mut state).unwrap()).collect();
        places.iter().for_each(|at| state.mean[*at] = 1.0);
        assert_eq!(held.of(0, &mut state), Some(places[0]), "it is held");
        assert_eq!(held.of(HELD, &mut state), Some(places[1]));
        assert_eq!((state.mean[places[1]], state.covariance[(places[1], places[1])]), (0.0, 1.0));
        assert_eq!(state.mean.rows(ERRORS.start, HELD).sum(), HELD as f64 - 1.0);
        assert_eq!(held.of(1, &mut state), Some(places[2]), "it is held no more");
    }

    #[test]
    fn a_state_that_holds_no_errors_has_no_place_for_them() {
        assert_eq!(Held::default().of(3, &mut State::<STEADY>::new(&nowhere())), None);
        assert_eq!(Held::default().of(3, &mut State::<SWAYING>::new(&nowhere())), None);
    }
}
