//! Effects on ranges at once: what one makes longer by a share, is longer by that share of what the others make of it.
//!
//! Changes of a size add up as long as they are small. A range that is 3 % too long, and a depth in its place, are not: half a radian off
//! the axis 12 % of a range are gone, and 3 % are added to what is left. Offsets come last, and are no share of anything.

use crate::shape::{Numbers, Shape};

/// Adds to a response, which has an effect's `change` in it beside the `others`' of the nominal `base`, what each makes longer of the
/// other.
pub fn add(shape: &Shape, base: &[f64], others: &[f64], change: &[f64], numbers: &mut [f64]) {
    let Some((whole, proportional)) = shape.proportional() else { return };
    let at = |i: usize| shape.range(Numbers::Size).start + i;
    let nominal = base[at(whole)];
    if nominal.abs() < f64::EPSILON {
        return;
    }
    let [of_others, of_change] = [others, change].map(|it| it[at(whole)] / nominal);
    numbers[at(whole)] += of_change * others[at(whole)];
    for i in proportional.map(at) {
        numbers[i] += of_change * others[i] + of_others * change[i];
    }
}

#[cfg(test)]
mod tests {
    use asami_dataset::{Action, Command};
    use asami_math::elementary::{cos, sin};

    use super::*;
    use crate::columns::Columns;
    use crate::shape::Sight;

    fn shape(ranges: bool) -> Shape {
        let action = Action::Wheels { id: None, v_m_per_s: 0.1, omega_rad_per_s: 0.5 };
        Shape {
            columns: Columns::new([Command { t_s: 0.0, action }].iter(), 9),
            landmarks: 9,
            ranges,
            near_far_m: [0.5, 9.0],
            off_rad: 0.5,
            sizes: [0.5, 9.0],
            reported: 0.5,
        }
    }

    /// The range that these numbers say.
    fn read(shape: &Shape, numbers: &[f64], distance_m: f64, bearing_rad: f64) -> f64 {
        let (mut columns, mut slopes) = (vec![0.0; shape.width(Numbers::Size)], [0.0; 4]);
        let sight = Sight {
            distance_m,
            bearing_rad,
            off_rad: bearing_rad,
            pan_rad_per_s: 0.0,
            theta_rad: 0.0,
            landmark: 0,
            attempt: [0.0; 3],
        };
        shape.size_columns(&sight, &mut columns, &mut slopes);
        columns.iter().zip(&numbers[shape.range(Numbers::Size)]).map(|(column, number)| column * number).sum()
    }

    /// A camera as it is simulated: a depth along an axis that is turned, by how large it is in the image, by a wrong scale, and an
    /// offset on top; in whichever order they are added.
    #[test]
    fn ranges_are_off_by_shares_of_what_is_off() {
        let shape = shape(true);
        let size = shape.range(Numbers::Size).start;
        let (offset, whole, off, skew) = (size, size + 1, size + 3, size + 6);
        let mut base = vec![0.0; shape.len()];
        base[whole] = 1.0;
        let (depth, skewed, focal, ratio, offset_m) = (0.9, -0.04, 0.93, 1.05, 0.1);
        let of = |i: usize, by: f64| {
            let mut change = vec![0.0; base.len()];
            change[i] = by;
            change
        };
        let all = [
            of(off, -0.5 * depth),
            of(skew, skewed),
            of(whole, 1.0 / focal - 1.0),
            of(whole, ratio - 1.0),
            of(offset, offset_m),
        ];
        for order in [[0, 1, 2, 3, 4], [4, 3, 2, 1, 0], [2, 0, 3, 4, 1]] {
            let mut numbers = base.clone();
            for k in order {
                let others: Vec<f64> = numbers.iter().zip(&base).map(|(a, b)| a - b).collect();
                numbers.iter_mut().zip(&all[k]).for_each(|(number, more)| *number += more);
                add(&shape, &base, &others, &all[k], &mut numbers);
            }
            for (distance_m, bearing_rad) in [(0.7, -0.5), (3.0, 0.1), (8.0, 0.5)] {
                let lacks = depth * (1.0 - cos(bearing_rad)) - skewed * sin(bearing_rad);
                let expected = distance_m * (1.0 - lacks) / focal * ratio + offset_m;
                let found = read(&shape, &numbers, distance_m, bearing_rad);
                assert!((found - expected).abs() < 1e-12, "{order:?} {distance_m} {bearing_rad}: {found} {expected}");
            }
        }
    }

    #[test]
    fn heights_add_up_as_they_are() {
        let shape = shape(false);
        let base = vec![1.0; shape.len()];
        let mut numbers = base.clone();
        add(&shape, &base, &vec![0.3; base.len()], &vec![0.2; base.len()], &mut numbers);
        assert_eq!(numbers, base);
    }
}
