//! Effects as they are planted: which kinds there are by the catalogue's laws, and cases drawn from them.

use asami_dataset::Rng;
use asami_sim::effect::{About, Block, Draw, Place, Way};
use asami_sim::effects::{Effects, catalogue};
use rand::RngExt;

/// One kind of an effect: all that its law draws but the size.
#[derive(Clone, Debug)]
pub struct Variant {
    /// The effect.
    pub about: &'static About,
    /// `1` where the sized parameter lies above its null value, `-1` below.
    pub sign: f64,
    /// Parameters that are drawn from a choice.
    pub choices: Vec<(&'static str, f64)>,
    /// From which share of the least size that the law draws sizes are thought of.
    pub(crate) from: f64,
}

/// Kinds are the same whatever sizes of them are thought of.
impl PartialEq for Variant {
    fn eq(&self, other: &Self) -> bool {
        self.about == other.about && self.sign == other.sign && self.choices == other.choices
    }
}

impl Variant {
    /// The same, of sizes from such a share of the least on that the law draws.
    #[must_use]
    pub fn of_sizes_from(self, share: f64) -> Self {
        Self { from: share, ..self }
    }

    /// All kinds of one effect in a world of so many landmarks, each as likely.
    #[must_use]
    pub fn of(about: &'static About, landmarks: usize) -> Vec<Self> {
        let signs: &[f64] = match about.law.iter().find_map(|(_, draw)| way(draw)) {
            Some(Way::Up) => &[1.0],
            Some(Way::Down) => &[-1.0],
            Some(Way::Either) => &[-1.0, 1.0],
            None => return Vec::new(),
        };
        let mut choices = vec![Vec::new()];
        for (name, draw) in about.law {
            let values = match *draw {
                Draw::Choice(values) => values,
                Draw::Landmark(numbers) => &numbers[..landmarks.clamp(1, numbers.len())],
                Draw::Size { .. } | Draw::Same => continue,
            };
            choices = choices
                .into_iter()
                .flat_map(|so_far| values.iter().map(move |value| [so_far.clone(), vec![(*name, *value)]].concat()))
                .collect();
        }
        let with = |sign: &f64| {
            let sign = *sign;
            choices
                .iter()
                .map(move |choices| Self { about, sign, choices: choices.clone(), from: 1.0 })
                .collect::<Vec<_>>()
        };
        signs.iter().flat_map(with).collect()
    }

    /// All kinds of all effects that fit `robot` among so many landmarks, less those of the names left out.
    #[must_use]
    pub fn all(robot: &str, landmarks: usize, without: &[String]) -> Vec<Self> {
        let fits = |about: &&'static About| about.fits.contains(&robot) && !without.iter().any(|it| it == about.name);
        catalogue().into_iter().filter(fits).flat_map(|about| Self::of(about, landmarks)).collect()
    }

    /// Least and greatest size that is thought of: those that the law draws, or from less on.
    #[must_use]
    pub fn sizes(&self) -> (f64, f64) {
        let size = |draw: &Draw| match *draw {
            Draw::Size { least, greatest, .. } => Some((least, greatest)),
            Draw::Same | Draw::Choice(_) | Draw::Landmark(_) => None,
        };
        let (least, greatest) = self.about.law.iter().find_map(|(_, draw)| size(draw)).unwrap_or((1.0, 1.0));
        (self.from * least, greatest)
    }

    /// The sized parameter's name and null value.
    #[must_use]
    pub fn sized(&self) -> (&'static str, f64) {
        let sized = self.about.law.iter().find(|(_, draw)| way(draw).is_some());
        sized.map_or(("", 0.0), |(name, _)| (name, self.null(name)))
    }

    fn null(&self, name: &str) -> f64 {
        let parameters = self.about.parameters.iter();
        parameters.into_iter().find(|parameter| parameter.name == name).map_or(0.0, |parameter| parameter.default)
    }

    /// Values of the parameters at a size.
    #[must_use]
    pub fn values(&self, size: f64) -> Vec<(&'static str, f64)> {
        let moved = |(name, draw): &(&'static str, Draw)| match draw {
            Draw::Size { .. } | Draw::Same => Some((*name, self.null(name) + self.sign * size)),
            Draw::Choice(_) | Draw::Landmark(_) => None,
        };
        self.choices.iter().copied().chain(self.about.law.iter().filter_map(moved)).collect()
    }

    /// Switches it on in `effects`.
    pub fn plant(&self, size: f64, effects: &mut Effects) {
        for (parameter, value) in self.values(size) {
            effects.set(self.about.name, parameter, value);
        }
    }

    /// Its name in files: the effect's, its side of the null value, its choices.
    #[must_use]
    pub fn name(&self) -> String {
        let side = if self.sign < 0.0 { "-" } else { "+" };
        let choices: String = self.choices.iter().map(|(name, value)| format!(",{name}={value}")).collect();
        format!("{}{side}{choices}", self.about.name)
    }

    /// Which flexible block it would show in, were it unknown.
    #[must_use]
    pub fn block(&self) -> Block {
        self.about.block
    }

    /// Where it acts.
    #[must_use]
    pub fn place(&self) -> Place {
        self.about.place
    }
}

fn way(draw: &Draw) -> Option<Way> {
    match draw {
        Draw::Size { way, .. } => Some(*way),
        Draw::Same | Draw::Choice(_) | Draw::Landmark(_) => None,
    }
}

/// One planted effect: a kind at a size.
#[derive(Clone, Debug, PartialEq)]
pub struct Planted {
    /// The kind.
    pub variant: Variant,
    /// Distance from the null value.
    pub size: f64,
}

impl Planted {
    /// Draws a kind of `about` in a world of so many landmarks, and a size, by its law; `None` for an effect that has no law.
    #[must_use]
    pub fn draw(about: &'static About, landmarks: usize, rng: &mut Rng) -> Option<Self> {
        let mut variants = Variant::of(about, landmarks);
        if variants.is_empty() {
            return None;
        }
        let variant = variants.swap_remove(rng.random_range(0..variants.len()));
        let (least, greatest) = variant.sizes();
        let size =
            least * asami_math::elementary::exp(rng.random::<f64>() * asami_math::elementary::ln(greatest / least));
        Some(Self { variant, size })
    }
}
