//! How well a size could be known.

use asami::blind::referee::judge;
use asami_gap::{Likelihood, Planted, Variant};

use super::{ASKED, blind};

/// So many frames, of each of which a landmark is missed as often as an effect's size says.
struct Misses(f64);

impl Likelihood for Misses {
    fn blocks(&self, effects: &[Planted]) -> Vec<f64> {
        vec![effects.iter().map(|it| it.size).sum()]
    }

    fn observations(&self) -> usize {
        self.0 as usize
    }

    /// Variances of shares are equal on the scale of the angle arcsin(sqrt p), 1/4n.
    fn apart(&self, one: &[Planted], other: &[Planted]) -> f64 {
        let angle = |effects: &[Planted]| effects.iter().map(|it| it.size.sqrt().asin()).sum::<f64>();
        0.5 * 4.0 * self.0 * (angle(one) - angle(other)).powi(2)
    }
}

/// A share's standard error is `sqrt(p (1 - p) / n)`; of two effects at once nothing is said.
#[test]
fn a_share_is_known_as_well_as_so_many_frames_count_it() {
    let variants = Variant::all("plain", 4, &[]);
    let asked = blind(ASKED).asked;
    let of = |name: &str, size: f64| {
        let variant = variants.iter().find(|it| it.about.name == name).expect("in the catalogue").clone();
        Planted { variant, size }
    };
    let n = 3000.0;
    for share in [0.02, 0.1, 0.4, 0.6] {
        let found = judge(&Misses(n), &[of("missed_sightings", share)], &variants, &asked).least_error.expect("of one");
        let expected = 0.67 * (share * (1.0 - share) / n).sqrt() / share;
        // The slope of a curve at a size for that between sizes a tenth to both sides, or at the end of the law to one.
        assert!((found / expected - 1.0).abs() < 0.06, "{share}: {found} {expected}");
    }
    // No frame at all says nothing.
    assert_eq!(judge(&Misses(0.0), &[of("missed_sightings", 0.1)], &variants, &asked).least_error, None);
    // Nor do so few that the share may as well be twice what it is.
    assert_eq!(judge(&Misses(3.0), &[of("missed_sightings", 0.1)], &variants, &asked).least_error, None);
    let both = [of("missed_sightings", 0.1), of("command_scale", 0.1)];
    assert_eq!(judge(&Misses(n), &both, &variants, &asked).least_error, None);
}
