//! Sizes at which the law of an effect plants it.

use asami_sim::effect::{About, Draw, Way};
use asami_sim::effects::Effects;

/// Sizes from a tenth of the law's least to its greatest by half a decade, each way.
pub fn sizes(about: &About) -> Vec<(f64, Effects)> {
    let sized = about.law.iter().find_map(|(name, draw)| match draw {
        Draw::Size { way, least, greatest } => Some((*name, *way, *least, *greatest)),
        _ => None,
    });
    let Some((_, way, least, greatest)) = sized else { return Vec::new() };
    let mut distances: Vec<f64> =
        (-2..).map(|k| least * 10_f64.powf(0.5 * f64::from(k))).take_while(|d| *d < 0.9 * greatest).collect();
    distances.push(greatest);
    let signs: &[f64] = match way {
        Way::Up => &[1.0],
        Way::Down => &[-1.0],
        Way::Either => &[1.0, -1.0],
    };
    let at = |distance: f64| {
        let mut effects = Effects::default();
        for (name, draw) in about.law {
            let null = about.parameters.iter().find(|it| it.name == *name).map_or(0.0, |it| it.default);
            if matches!(draw, Draw::Size { .. } | Draw::Same) {
                effects.set(about.name, name, null + distance);
            }
        }
        (distance, effects)
    };
    signs.iter().flat_map(|sign| distances.iter().map(|it| at(sign * it)).collect::<Vec<_>>()).collect()
}
