//! Motion by a car's odometry, in steps.

use asami_dataset::Channel;
use asami_dataset::log::Odometry;

use crate::drive::motion::Step;

/// Length of a step.
const STEP_S: f64 = 0.2;
/// Readings farther apart say nothing of what was between them.
const MOST_GAP_S: f64 = 0.25;

/// Mean speed and turning rate over steps one after another, of readings that change evenly from one to the next; steps with a gap
/// in them are left out.
#[must_use]
pub fn steps(odometry: &Channel<Odometry>) -> Vec<Step> {
    let (Some(first), Some(last)) = (odometry.first(), odometry.last()) else { return Vec::new() };
    let n = ((last.t_s - first.t_s) / STEP_S) as usize;
    (0..n).filter_map(|i| step(odometry, first.t_s + i as f64 * STEP_S)).collect()
}

fn step(odometry: &[Odometry], from_s: f64) -> Option<Step> {
    let to_s = from_s + STEP_S;
    let first = odometry.partition_point(|row| row.t_s <= from_s).checked_sub(1)?;
    let mut sums = [0.0; 2];
    for pair in odometry[first..].windows(2).take_while(|pair| pair[0].t_s < to_s) {
        let [a, b] = [&pair[0], &pair[1]];
        if b.t_s - a.t_s > MOST_GAP_S {
            return None;
        }
        let (begin_s, end_s) = (a.t_s.max(from_s), b.t_s.min(to_s));
        let middle = (0.5 * (begin_s + end_s) - a.t_s) / (b.t_s - a.t_s).max(1e-9);
        let mean = |a: f64, b: f64| a + middle * (b - a);
        sums[0] += (end_s - begin_s) * mean(a.v_m_per_s, b.v_m_per_s);
        sums[1] += (end_s - begin_s) * mean(a.omega_rad_per_s, b.omega_rad_per_s);
    }
    Some(Step { t_s: from_s, dt_s: STEP_S, v_m_per_s: sums[0] / STEP_S, omega_rad_per_s: sums[1] / STEP_S })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_means_of_what_was_read_and_a_gap_is_none() {
        let row = |i: i32| {
            let t_s = 0.04 * f64::from(i);
            Odometry { t_s, v_m_per_s: 2.0 * t_s, omega_rad_per_s: 0.3 }
        };
        let all: Channel<Odometry> = (0..=100).map(row).collect::<Vec<_>>().into();
        let found = steps(&all);
        // The last one may end behind the last reading by a rounding.
        assert!((19..=20).contains(&found.len()), "{}", found.len());
        for step in &found {
            assert!((step.v_m_per_s - 2.0 * (step.t_s + 0.1)).abs() < 1e-9, "{step:?}");
            assert!((step.omega_rad_per_s - 0.3).abs() < 1e-9, "{step:?}");
        }
        let with_gap: Channel<Odometry> =
            (0..=100).filter(|i| !(30..40).contains(i)).map(row).collect::<Vec<_>>().into();
        let rest = steps(&with_gap);
        assert!(rest.len() < found.len() && rest.iter().all(|step| !(1.0..1.4).contains(&step.t_s)), "{rest:?}");
        assert!(steps(&Channel::default()).is_empty());
    }
}
