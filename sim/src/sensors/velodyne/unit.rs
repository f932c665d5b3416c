//! One scanner: where its lasers point.

use rand::RngExt;

use super::art::ART_DEG;

/// The angles of a scanner's lasers, by increasing vertical angle.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    lasers: Vec<Laser>,
}

/// Where a laser points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Laser {
    /// Above the horizon.
    pub vertical_rad: f64,
    /// The rotational correction, the dissertation's theta_l: counter-clockwise from where the encoder is thought to point.
    pub horizontal_rad: f64,
}

impl Unit {
    /// The unit on the dissertation's car.
    #[must_use]
    pub fn art() -> Self {
        let laser = |[vertical, rotational]: [f64; 2]| Laser {
            vertical_rad: vertical.to_radians(),
            horizontal_rad: rotational.to_radians(),
        };
        Self::of(ART_DEG.map(laser).to_vec())
    }

    /// A unit with these lasers, which are put in order of their vertical angles.
    #[must_use]
    pub fn of(mut lasers: Vec<Laser>) -> Self {
        lasers.sort_by(|a, b| a.vertical_rad.total_cmp(&b.vertical_rad));
        Self { lasers }
    }

    /// Another unit of the same make: the rotational corrections are drawn evenly from this one's range.
    #[must_use]
    pub fn redrawn(&self, rng: &mut impl rand::Rng) -> Self {
        let angles = || self.lasers.iter().map(|laser| laser.horizontal_rad);
        let (least, greatest) = angles().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
        let drawn =
            |laser: &Laser| Laser { horizontal_rad: least + (greatest - least) * rng.random::<f64>(), ..*laser };
        Self { lasers: self.lasers.iter().map(drawn).collect() }
    }

    /// The lasers.
    #[must_use]
    pub fn lasers(&self) -> &[Laser] {
        &self.lasers
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use asami_dataset::Seed;

    /// The numbers that Stronger 2008 prints: 18 degrees of horizontal angles (section 5.4), 26.8 of vertical ones (2.5.2), 64 lasers.
    #[test]
    fn the_unit_is_the_dissertations() {
        let unit = Unit::art();
        let lasers = unit.lasers();
        let of = |f: fn(&Laser) -> f64| {
            let angles = lasers.iter().map(f).map(f64::to_degrees);
            angles.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)))
        };
        let (least, greatest) = of(|laser| laser.horizontal_rad);
        assert!((least + 8.0).abs() < 1e-9 && (greatest - 10.0).abs() < 1e-9);
        let (lowest, highest) = of(|laser| laser.vertical_rad);
        assert!((lowest + 24.711).abs() < 1e-9 && (highest - 2.02081).abs() < 1e-9);
        assert!(lasers.len() == 64 && lasers.is_sorted_by(|a, b| a.vertical_rad < b.vertical_rad));
    }

    #[test]
    fn another_unit_has_other_horizontal_angles_in_the_same_range() {
        let (unit, mut rng) = (Unit::art(), Seed(1000).stream("unit"));
        let other = unit.redrawn(&mut rng);
        for (a, b) in unit.lasers().iter().zip(other.lasers()) {
            assert_eq!(a.vertical_rad, b.vertical_rad);
            assert!((-8.0..=10.0).contains(&b.horizontal_rad.to_degrees()));
        }
        let apart = unit.lasers().iter().zip(other.lasers()).filter(|(a, b)| a.horizontal_rad != b.horizontal_rad);
        assert_eq!(apart.count(), 64);
    }
}
