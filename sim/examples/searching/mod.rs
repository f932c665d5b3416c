//! Random changes of a gait, for the examples that search for one.

use asami_dataset::Rng;
use asami_dataset::parameters::Parameters;
use asami_sim::robots::aibo::config::Gait;
use rand::RngExt;

/// A number of the gait, and the least and greatest that are tried.
pub type Searched = (&'static str, f64, f64);

/// What the `n`-th try makes of the best gait so far: the first takes it as it is.
#[must_use]
pub fn tried(best: &Gait, searched: &[Searched], n: u32, rng: &mut Rng) -> Gait {
    let mut gait = best.clone();
    for &(name, low, high) in searched {
        let at = Gait::table().iter().position(|parameter| parameter.name == name);
        let now = at.map_or(low, |at| gait.values()[at]);
        let (chance, part): (f64, f64) = (rng.random(), rng.random());
        // Small changes of about half the numbers; now and then something else altogether.
        let value = match n {
            0 => now,
            _ if n % 8 == 7 => low + part * (high - low),
            _ if chance < 0.5 => now,
            _ => (now + 0.2 * (part - 0.5) * (high - low)).clamp(low, high),
        };
        gait.set(name, value);
    }
    gait
}
