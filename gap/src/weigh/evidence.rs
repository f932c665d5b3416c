//! How much a log speaks for each effect: likelihood times prior, integrated over sizes and kinds.
//!
//! The prior of sizes is the law by which cases are planted: log-uniform from the least to the greatest.

use asami_math::elementary::{exp, ln};

use super::cores::on_free_cores;
use crate::judge::Judge;
use crate::plant::{Planted, Variant};
use crate::race::Pace;

/// How closely effects are looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Sizes at which every kind is tried.
    pub sizes: usize,
    /// Kinds less than this below the best of all are looked at again about their peak, in nats.
    pub within_nats: f64,
    /// Kinds that gain less than this are not, in nats.
    pub least_nats: f64,
    /// Whether every other size is enough of a kind that gains nothing at any of these: what rises before it falls gains something
    /// at the last of them below its top, unless it rises in the very last digits of what a log says.
    pub passes_over: bool,
}

/// At the effects of a log that may have any.
pub const CLOSE: Look = Look { sizes: 8, within_nats: 25.0, least_nats: 1.0, passes_over: false };
/// The same, and no closer than need be.
pub const QUICK: Look = Look { passes_over: true, ..CLOSE };
/// At what may stand beside an effect.
pub const PASSING: Look = Look { sizes: 4, within_nats: 8.0, least_nats: 2.0, passes_over: false };

/// One effect, weighed.
#[derive(Clone, Debug, PartialEq)]
pub struct Weighed {
    /// The effect.
    pub effect: &'static str,
    /// Logarithm of its evidence over that of *none*.
    pub evidence_nats: f64,
    /// The most likely kind and size.
    pub best: Planted,
    /// Logarithm of its likelihood over that of *none* there.
    pub gain_nats: f64,
    /// 90 % interval of the size, for the most likely kind.
    pub interval: [f64; 2],
}

/// A kind of effect tried at several sizes: pairs of the size's logarithm and the log-likelihood's gain, in
/// order of size.
struct Tried {
    variant: Variant,
    points: Vec<(f64, f64)>,
}

impl Tried {
    fn best(&self) -> (f64, f64) {
        let best = self.points.iter().copied().reduce(|a, b| if b.1 > a.1 { b } else { a });
        best.unwrap_or((0.0, f64::NEG_INFINITY))
    }

    /// The best point between its neighbours; at an end of the law the three at that end.
    fn about_the_top(&self) -> Option<[(f64, f64); 3]> {
        let top = self.best().0;
        let i = self.points.iter().position(|it| it.0 == top)?;
        let middle = i.clamp(1, self.points.len().checked_sub(2)?.max(1));
        self.points.get(middle - 1..=middle + 1)?.try_into().ok()
    }

    /// Puts a point where it belongs.
    fn add(&mut self, at: f64, nats: f64) {
        let place = self.points.partition_point(|it| it.0 < at);
        if self.points.get(place).is_none_or(|it| it.0 - at > 1e-9) {
            self.points.insert(place, (at, nats));
        }
    }

    /// Logarithm of the mean likelihood ratio over the law's sizes; between the points it is taken to be
    /// exponential in the size's logarithm.
    fn evidence(&self) -> f64 {
        let (Some(first), Some(last)) = (self.points.first(), self.points.last()) else { return f64::NEG_INFINITY };
        let top = self.best().1;
        let piece = |pair: &[(f64, f64)]| {
            let (width, a, b) = (pair[1].0 - pair[0].0, pair[0].1 - top, pair[1].1 - top);
            width * between(a, b)
        };
        let sum = self.points.windows(2).map(piece).fold(0.0, |sum, it| sum + it);
        top + ln((sum / (last.0 - first.0)).max(1e-300))
    }

    /// Sizes between which the middle 90 % of the posterior lie.
    fn interval(&self) -> [f64; 2] {
        let top = self.best().1;
        let mut so_far = vec![0.0];
        for pair in self.points.windows(2) {
            let sum = so_far.last().copied().unwrap_or(0.0);
            so_far.push(sum + (pair[1].0 - pair[0].0) * between(pair[0].1 - top, pair[1].1 - top));
        }
        let all = so_far.last().copied().unwrap_or(0.0);
        [0.05, 0.95].map(|share| {
            let wanted = share * all;
            let i = so_far.partition_point(|it| *it < wanted).clamp(1, so_far.len().max(2) - 1);
            let within = (wanted - so_far[i - 1]) / (so_far[i] - so_far[i - 1]).max(1e-300);
            exp(self.points[i - 1].0 + within * (self.points[i].0 - self.points[i - 1].0))
        })
    }
}

/// Mean over the unit interval of what runs exponentially from `exp(a)` to `exp(b)`.
fn between(a: f64, b: f64) -> f64 {
    if (a - b).abs() < 1e-9 { exp(a) } else { (exp(a) - exp(b)) / (a - b) }
}

/// Weighs every effect of which `variants` has kinds, in the order of their first kind. `with` is what else is in
/// the world.
#[must_use]
pub fn weigh(judge: &dyn Judge, variants: &[Variant], with: &[Planted], look: Look) -> Vec<Weighed> {
    let pace = Pace::of(&judge.read(&judge.numbers(with)));
    let gain = |variant: &Variant, ln_size: f64| {
        let planted = Planted { variant: variant.clone(), size: exp(ln_size) };
        let likely = judge.beside(&judge.numbers(&[with, &[planted]].concat()), &pace) - pace.total();
        if likely.is_finite() { likely } else { f64::NEG_INFINITY }
    };
    let known: Vec<&Variant> = variants.iter().filter(|variant| judge.knows(variant)).collect();
    let tried = on_free_cores(known, |variant| {
        let (least, greatest) = variant.sizes();
        let at = |i: usize| ln(least) + ln(greatest / least) * i as f64 / (look.sizes - 1) as f64;
        let gain_at = |i: usize| (at(i), gain(variant, at(i)));
        let mut points: Vec<(f64, f64)> = (0..look.sizes).step_by(2).map(gain_at).collect();
        if !look.passes_over || points.iter().any(|it| it.1 > 0.0) {
            points.extend((1..look.sizes).step_by(2).map(gain_at));
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
        }
        Tried { variant: variant.clone(), points }
    });
    let mut effects: Vec<(&'static str, Vec<Tried>)> = Vec::new();
    for tried in tried {
        match effects.iter_mut().find(|(name, _)| *name == tried.variant.about.name) {
            Some((_, kinds)) => kinds.push(tried),
            None => effects.push((tried.variant.about.name, vec![tried])),
        }
    }
    let top = effects.iter().flat_map(|(_, kinds)| kinds).map(|kind| kind.best().1).fold(f64::NEG_INFINITY, f64::max);
    let promises = |kind: &&mut Tried| kind.best().1 > (top - look.within_nats).max(look.least_nats);
    let promising: Vec<&mut Tried> = effects.iter_mut().flat_map(|(_, kinds)| kinds).filter(promises).collect();
    on_free_cores(promising, |kind| refine(kind, &gain));
    effects.into_iter().filter_map(|(effect, kinds)| summary(effect, &kinds)).collect()
}

/// The peak is looked for until a parabola promises less than this, in nats.
const PROMISES_NOTHING_NATS: f64 = 0.02;
/// At most so often.
const MOST_PARABOLAS: usize = 8;
/// A point beside the peak that is higher than it by so much, in nats, is climbed from again.
const STILL_CLIMBS_NATS: f64 = 0.5;
/// At most so often.
const MOST_CLIMBS: usize = 3;
/// Flanks, in standard deviations: from here on there is nothing left to integrate.
const FLANKS: [f64; 6] = [-4.0, -2.5, -1.5, 1.5, 2.5, 4.0];

/// Finds the peak and its flanks.
fn refine(kind: &mut Tried, gain: &impl Fn(&Variant, f64) -> f64) {
    let (Some(&(least, _)), Some(&(greatest, _))) = (kind.points.first(), kind.points.last()) else { return };
    let look = |kind: &mut Tried, at: f64| {
        let within = (least..=greatest).contains(&at);
        within.then(|| {
            let nats = gain(&kind.variant, at);
            kind.add(at, nats);
            nats
        })
    };
    let mut flanks = (0.0, 1.0);
    for _ in 0..MOST_CLIMBS {
        climb(kind, gain);
        let (at, peak_nats) = kind.best();
        let bend = kind.about_the_top().and_then(|about| vertex(&about)).map_or(1.0, |top| top.bend).max(1.0);
        let h = 1.0 / bend.sqrt();
        // A parabola through points far apart says little of a narrow peak: these are one standard deviation off it by now.
        let sides = [at - h, at + h].map(|side| look(kind, side));
        let falls = sides.into_iter().flatten().filter(|nats| nats.is_finite()).map(|nats| peak_nats - nats);
        flanks = (at, falls.fold(0.0, |most, fall| f64::max(most, 2.0 * fall / (h * h))).max(1.0));
        if kind.best().1 - peak_nats < STILL_CLIMBS_NATS {
            break;
        }
    }
    let (at, bend) = flanks;
    for share in FLANKS {
        look(kind, at + share / bend.sqrt());
    }
}

/// Looks for the peak by parabolas through the three best points about it (Brent 1973, chapter 5).
fn climb(kind: &mut Tried, gain: &impl Fn(&Variant, f64) -> f64) {
    let (Some(&(least, _)), Some(&(greatest, _))) = (kind.points.first(), kind.points.last()) else { return };
    for _ in 0..MOST_PARABOLAS {
        let Some(top) = kind.about_the_top().and_then(|about| vertex(&about)) else { break };
        let at = top.at.clamp(least, greatest);
        let known = kind.points.iter().any(|it| (it.0 - at).abs() < 1e-6);
        if known || top.promises_nats < PROMISES_NOTHING_NATS {
            break;
        }
        kind.add(at, gain(&kind.variant, at));
    }
}

/// Where a parabola has its top.
struct Vertex {
    at: f64,
    /// By how much it is higher there than at the middle one of its points.
    promises_nats: f64,
    /// Its curvature, positive.
    bend: f64,
}

/// That of the parabola through three points in order; `None` where it has no top.
fn vertex([a, b, c]: &[(f64, f64); 3]) -> Option<Vertex> {
    let slopes = [(b.1 - a.1) / (b.0 - a.0), (c.1 - b.1) / (c.0 - b.0)];
    let bend = -2.0 * (slopes[1] - slopes[0]) / (c.0 - a.0);
    // Its slope at the middle point.
    let slope = slopes[0] - 0.5 * bend * (b.0 - a.0);
    let found = Vertex { at: b.0 + slope / bend, promises_nats: 0.5 * slope * slope / bend, bend };
    (bend > 0.0 && found.at.is_finite()).then_some(found)
}

fn summary(effect: &'static str, kinds: &[Tried]) -> Option<Weighed> {
    let evidences: Vec<f64> = kinds.iter().map(Tried::evidence).collect();
    let top = evidences.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mean = evidences.iter().map(|it| exp(it - top)).fold(0.0, |sum, it| sum + it) / evidences.len() as f64;
    let best = kinds.iter().reduce(|a, b| if b.best().1 > a.best().1 { b } else { a })?;
    let (ln_size, gain_nats) = best.best();
    Some(Weighed {
        effect,
        evidence_nats: top + ln(mean),
        best: Planted { variant: best.variant.clone(), size: exp(ln_size) },
        gain_nats,
        interval: holding(best.interval(), exp(ln_size)),
    })
}

/// An interval widened to hold a value: at an end of the law the most likely size lies outside the middle 90 %.
fn holding([low, high]: [f64; 2], value: f64) -> [f64; 2] {
    [low.min(value), high.max(value)]
}

#[cfg(test)]
mod tests {
    use asami_dataset::Seed;

    use super::*;
    use crate::straight::Straight;

    fn tried(points: Vec<(f64, f64)>) -> Tried {
        let about = asami_sim::effects::catalogue()[0];
        Tried { variant: Variant::of(about, 4).remove(0), points }
    }

    /// A Gaussian peak of standard deviation 0.1 over a prior of width 3.
    #[test]
    fn evidence_and_interval_of_a_gaussian_peak_are_its_own() {
        let peak = |x: f64| 20.0 - 0.5 * ((x - 0.3) / 0.1_f64).powi(2);
        let kind = tried((0..=600).map(|i| -1.0 + 0.005 * f64::from(i)).map(|x| (x, peak(x))).collect());
        let expected = 20.0 + (0.1 * std::f64::consts::TAU.sqrt() / 3.0_f64).ln();
        assert!((kind.evidence() - expected).abs() < 1e-3, "{} {expected}", kind.evidence());
        let [low, high] = kind.interval().map(f64::ln);
        assert!((low - (0.3 - 0.16449)).abs() < 2e-3 && (high - (0.3 + 0.16449)).abs() < 2e-3, "{low} {high}");
    }

    /// However narrow the peak, and wherever between the sizes that are tried first, its height and its mass are found.
    #[test]
    fn a_peak_is_found_and_integrated_in_a_score_of_looks() {
        for (sd, at) in [(0.6, 0.1), (0.3, -0.35), (0.05, 0.7), (0.03, 0.77)] {
            // Of a linear effect: a parabola in the size, so no parabola in its logarithm.
            let peak = |x: f64| 0.5 * (1.0 - ((x - at).exp() - 1.0).powi(2)) / (sd * sd);
            let looks = std::cell::Cell::new(0);
            let mut kind = tried((0..8).map(|i| -1.5 + 3.0 * f64::from(i) / 7.0).map(|x| (x, peak(x))).collect());
            refine(&mut kind, &|_, x| {
                looks.set(looks.get() + 1);
                peak(x)
            });
            assert!(looks.get() <= 16, "{sd} {at}: {}", looks.get());
            assert!((kind.best().1 - peak(at)).abs() < 0.05, "{sd} {at}: {:?}", kind.best());
            let all = tried((0..=60_000).map(|i| -1.5 + 5e-5 * f64::from(i)).map(|x| (x, peak(x))).collect());
            // Straight lines between flanks cut corners off a round peak.
            assert!(
                (kind.evidence() - all.evidence()).abs() < 0.1,
                "{sd} {at}: {} {}",
                kind.evidence(),
                all.evidence()
            );
        }
    }

    /// Between the two greatest sizes that are tried first, where a parabola through these and one far below has its top beyond
    /// them.
    #[test]
    fn a_narrow_peak_next_to_the_greatest_size_is_climbed() {
        for (sd, at) in [(0.03, 1.45), (0.05, 1.4), (0.02, 1.35)] {
            let peak = |x: f64| 0.5 * (1.0 - ((x - at) / sd).powi(2)) / (sd * sd) * 0.1;
            let mut kind = tried((0..8).map(|i| -1.5 + 3.0 * f64::from(i) / 7.0).map(|x| (x, peak(x))).collect());
            refine(&mut kind, &|_, x| peak(x));
            assert!((kind.best().1 - peak(at)).abs() < 0.5, "{sd} {at}: {:?} {}", kind.best(), peak(at));
        }
    }

    /// Of effects with tops anywhere, some of them narrow, what is passed over are those whose every size makes a log less likely, and nothing
    /// else: the others are as evident, and as large, as without.
    #[test]
    fn what_gains_nothing_is_passed_over_and_nothing_else() {
        let kinds = ["command_scale", "wheel_base"].map(Straight::kind).map(|it| it.of_sizes_from(0.1));
        let (a, b) = (|t: usize| 60.0 * (0.37 * t as f64).sin(), |t: usize| 20.0 * (0.91 * t as f64).sin());
        let mut passed_over = 0;
        for (i, share) in [-0.5, -0.05, 0.001, 0.01, 0.04, 0.1, 0.3, 0.6, 0.97].into_iter().enumerate() {
            let sized = kinds.iter().zip([share, 0.2]);
            let truth: Vec<Planted> =
                sized.map(|(kind, share)| Planted { variant: kind.clone(), size: share * kind.sizes().1 }).collect();
            let log = Straight::new(&truth, &[&a, &b], Seed(i as u64));
            let [close, quick] = [CLOSE, QUICK].map(|look| weigh(&log, &kinds[..1], &truth[1..], look));
            let [closely, quickly] = [&close, &quick].map(|it| &it[0]);
            if closely.gain_nats > 0.0 {
                assert_eq!(closely, quickly, "{share}");
            } else {
                passed_over += 1;
                assert!(quickly.gain_nats <= 0.0 && quickly.evidence_nats < 0.0, "{share}: {quickly:?}");
            }
        }
        assert_eq!(passed_over, 3);
    }

    #[test]
    fn an_effect_that_changes_nothing_has_no_evidence_for_or_against() {
        let kind = tried(vec![(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)]);
        assert!(kind.evidence().abs() < 1e-12);
    }
}
