//! Which of the unit's lasers is which.

/// Lasers of a unit.
pub(super) const LASERS: usize = 64;

/// The unit's number of each laser, lasers by increasing vertical angle. The unit numbers the upper bank's lasers 0 to
/// 31 and the lower bank's 32 to 63, in the order in which they stand in a block.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Order([u8; LASERS]);

impl Order {
    /// Units whose upper bank looks above its lower one: the S2 of the KITTI car and the S3, by the vertical angles of
    /// their calibration tables (`64e_utexas.yaml` and `64e_s3-xiesc.yaml` of ros-drivers/velodyne, KITTI's factory
    /// table).
    pub const UPPER_ABOVE: Self = Self([
        38, 39, 42, 43, 32, 33, 36, 37, 40, 41, 46, 47, 50, 51, 54, 55, //
        44, 45, 48, 49, 52, 53, 58, 59, 62, 63, 34, 35, 56, 57, 60, 61, //
        6, 7, 10, 11, 0, 1, 4, 5, 8, 9, 14, 15, 18, 19, 22, 23, //
        12, 13, 16, 17, 20, 21, 26, 27, 30, 31, 2, 3, 24, 25, 28, 29,
    ]);

    /// The dissertation's unit as its makers' tables number it, the banks the other way about (`LASER_SEQUENCE` in
    /// `ring_sequence.h` of ros-drivers/velodyne; the vertical angles of `art_2007-2010_angles.config`).
    pub const ART: Self = Self([
        6, 7, 10, 11, 0, 1, 4, 5, 8, 9, 14, 15, 18, 19, 22, 23, //
        12, 13, 16, 17, 20, 21, 26, 27, 30, 31, 2, 3, 24, 25, 28, 29, //
        38, 39, 42, 43, 32, 33, 36, 37, 40, 41, 46, 47, 50, 51, 54, 55, //
        44, 45, 48, 49, 52, 53, 58, 59, 62, 63, 34, 35, 56, 57, 60, 61,
    ]);

    /// The order of a unit by its calibration table: the vertical angles of its lasers 0 to 63. `None` if an angle is no
    /// number.
    #[must_use]
    pub fn of_vertical_angles(angles: &[f64; LASERS]) -> Option<Self> {
        let mut order: [u8; LASERS] = std::array::from_fn(|laser| laser as u8);
        order.sort_by(|a, b| angles[usize::from(*a)].total_cmp(&angles[usize::from(*b)]));
        angles.iter().all(|angle| !angle.is_nan()).then_some(Self(order))
    }

    /// The unit's numbers, lasers by increasing vertical angle: each of 0 to 63 once.
    #[must_use]
    pub fn numbers(&self) -> &[u8; LASERS] {
        &self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_has_every_laser_once_and_a_bank_is_above_the_other() {
        for (order, lowest) in [(Order::UPPER_ABOVE, 32..64), (Order::ART, 0..32)] {
            let mut numbers = order.numbers().to_vec();
            assert!(numbers[..32].iter().all(|number| lowest.contains(number)));
            numbers.sort_unstable();
            assert_eq!(numbers, (0..64).collect::<Vec<u8>>());
        }
    }

    /// Within a bank both kinds of unit stand in the same order: `UPPER_ABOVE` is `ART` with the banks exchanged.
    #[test]
    fn the_banks_are_alike() {
        for (a, b) in Order::UPPER_ABOVE.numbers().iter().zip(Order::ART.numbers()) {
            assert_eq!((a + 32) % 64, *b);
        }
    }

    #[test]
    fn a_calibration_table_gives_the_order() {
        let mut angles = [0.0; 64];
        for (rank, number) in Order::ART.numbers().iter().enumerate() {
            angles[usize::from(*number)] = -24.711 + 0.4 * rank as f64;
        }
        assert_eq!(Order::of_vertical_angles(&angles), Some(Order::ART));
        angles[9] = f64::NAN;
        assert_eq!(Order::of_vertical_angles(&angles), None);
    }
}
