//! What lasers disagree by, second by second, and how much of that is chance.

use asami_dataset::Log;

use crate::drive::ground::Ground;
use crate::drive::motion::Moved;
use crate::drive::scanner::speed;
use crate::drive::walls::Walls;
use crate::view::CannotSee;

/// Scans are matched to so many others, where they follow that closely.
const SCANS: f64 = 40.0;
/// And this far apart at least and at most.
const APART_S: [f64; 2] = [0.1, 0.5];
/// A log is cut into so many blocks.
const BLOCKS: f64 = 16.0;
/// Of this length at least and at most.
const BLOCK_S: [f64; 2] = [1.0, 10.0];
/// Returns of a block that make a mean: from the road, and of a pair from walls.
const LEAST: [f64; 2] = [60.0, 120.0];
/// Blocks in which something is seen before it counts.
const LEAST_BLOCKS: usize = 3;
/// Nothing is seen better than this, in metres: the road, walls, sides.
const LEAST_SD_M: [f64; 3] = [0.001, 0.001, 0.002];
/// What a handful of blocks say of the scatter of one mean is shrunk to that of all of its kind, as if those were so many more.
const PRIOR_BLOCKS: f64 = 4.0;

/// What was measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum What {
    /// How high a laser sees the road over the surface of all.
    Road(usize),
    /// How much farther a laser sees walls than the one above it.
    Wall(usize),
    /// How much farther to the left of where it looks it stands than that one.
    Side(usize),
}

impl What {
    /// 0: road; 1: walls; 2: sides.
    #[must_use]
    pub fn kind(self) -> usize {
        match self {
            What::Road(_) => 0,
            What::Wall(_) => 1,
            What::Side(_) => 2,
        }
    }
}

/// A mean of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mean {
    /// Of what.
    pub what: What,
    /// In metres.
    pub value_m: f64,
    /// Variance of chance, without that of the road's shape.
    pub variance_m2: f64,
    /// How well it shows in this block, beside others of the same.
    pub shows: f64,
    /// How far away the road is, on the ground.
    pub flat_m: f64,
}

/// A block of a log.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// When its first scan begins.
    pub t_s: f64,
    /// The means, in order of what they are of.
    pub means: Vec<Mean>,
}

/// A scanner's log, seen.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// In order of time.
    pub blocks: Vec<Block>,
    /// Length of a block.
    pub block_s: f64,
    /// From the first firing to the last.
    pub length_s: f64,
    /// Sine and cosine of each laser's vertical angle, as the table has it.
    pub elevation: Vec<(f64, f64)>,
}

impl Seen {
    /// Reads a log.
    ///
    /// # Errors
    /// [`CannotSee`] where its scans cannot be followed, or too little of road and walls is seen.
    pub fn read(log: &Log) -> Result<Self, CannotSee> {
        let length_s = length_s(log);
        let moved = Moved::read_every(log, apart_s(log))?;
        let block_s = (length_s / BLOCKS).clamp(BLOCK_S[0], BLOCK_S[1]);
        let height_m = log.known.velodyne.as_ref().map_or(2.0, |unit| unit.sensor_height_m);
        let mut blocks = means(&moved, block_s, height_m);
        often(&mut blocks);
        scatter(&mut blocks);
        let seen: usize = blocks.iter().map(|block| block.means.len()).sum();
        if blocks.len() < LEAST_BLOCKS || seen == 0 {
            return Err(CannotSee::TooShort { frames: moved.scans.len(), seen: blocks.len(), least: LEAST_BLOCKS });
        }
        Ok(Self { blocks, block_s, length_s, elevation: moved.drive.elevation.clone() })
    }
}

fn length_s(log: &Log) -> f64 {
    let times = log.firings.as_deref().map_or(&[][..], |firings| &firings.t_s);
    times.first().zip(times.last()).map_or(0.0, |(first_s, last_s)| last_s - first_s)
}

/// How far apart the scans are that are matched.
#[must_use]
pub fn apart_s(log: &Log) -> f64 {
    (length_s(log) / SCANS).clamp(APART_S[0], APART_S[1])
}

/// The blocks' means, their variances not known yet.
fn means(moved: &Moved<'_>, block_s: f64, height_m: f64) -> Vec<Block> {
    let began_s = moved.scans.first().map_or(0.0, |scan| scan.t_s);
    let number = |t_s: f64| ((t_s - began_s) / block_s) as usize;
    let parts = moved.scans.chunk_by(|a, b| number(a.t_s) == number(b.t_s));
    let block = |scans: &[asami_scans::Scan]| {
        let (mut ground, mut walls) = (Ground::new(&moved.drive, height_m), Walls::new(&moved.drive));
        for scan in scans {
            ground.take(moved, scan);
            walls.take(moved, scan, speed(&moved.steps, scan.t_s));
        }
        let mean = |what, value_m, flat_m| Mean { what, value_m, variance_m2: 0.0, shows: 1.0, flat_m };
        let mut means = Vec::new();
        for (laser, seen) in ground.by_laser(LEAST[0]).into_iter().enumerate() {
            means.extend(seen.map(|[_, off_m, flat_m]| mean(What::Road(laser), off_m, flat_m)));
        }
        let pairs = walls.by_pair(LEAST[1]);
        for (pair, seen) in pairs.iter().enumerate() {
            means.extend(seen.map(|[off_m, ..]| mean(What::Wall(pair), off_m, 0.0)));
        }
        for (pair, seen) in pairs.iter().enumerate() {
            means.extend(seen.map(|[_, aside_m, shows]| Mean { shows, ..mean(What::Side(pair), aside_m, 0.0) }));
        }
        Block { t_s: scans[0].t_s, means }
    };
    parts.map(block).collect()
}

/// Leaves away what is hardly ever seen.
fn often(blocks: &mut [Block]) {
    let mut count = std::collections::BTreeMap::new();
    for mean in blocks.iter().flat_map(|block| &block.means) {
        *count.entry(mean.what).or_insert(0_usize) += 1;
    }
    for block in &mut *blocks {
        block.means.retain(|mean| count[&mean.what] >= LEAST_BLOCKS);
    }
}

/// Fills in the variances of chance: by how much a mean differs from block to block once the road's shape is taken away, more of it
/// where it lasts from one block to the next.
fn scatter(blocks: &mut [Block]) {
    let mut all = std::collections::BTreeMap::<What, (f64, f64)>::new();
    for mean in blocks.iter().flat_map(|block| &block.means) {
        let (sum, shows) = all.entry(mean.what).or_default();
        (*sum, *shows) = (*sum + mean.shows * mean.value_m, *shows + mean.shows);
    }
    let usual = |what: &What| all[what].0 / all[what].1;
    let mut left = std::collections::BTreeMap::<What, Vec<f64>>::new();
    for block in &*blocks {
        let off = |mean: &Mean| mean.value_m - usual(&mean.what);
        let shape =
            road_shape(block.means.iter().filter(|mean| mean.what.kind() == 0).map(|mean| (mean.flat_m, off(mean))));
        for mean in &block.means {
            let road = if mean.what.kind() == 0 { height_m(shape, mean.flat_m) } else { 0.0 };
            left.entry(mean.what).or_default().push(mean.shows.sqrt() * (off(mean) - road));
        }
    }
    let squares = |values: &[f64]| values.iter().fold(0.0, |sum, it| sum + it * it);
    for (kind, least_m) in LEAST_SD_M.into_iter().enumerate() {
        let of_kind = || left.iter().filter(|(what, _)| what.kind() == kind).map(|(_, values)| values);
        let freedom: f64 = of_kind().map(|values| values.len() as f64 - 1.0).sum();
        let sum: f64 = of_kind().map(|values| squares(values)).sum();
        let of_all = sum / freedom.max(1.0);
        let lasts = {
            let products: f64 = of_kind().flat_map(|it| it.windows(2)).map(|pair| pair[0] * pair[1]).sum();
            // The mean that was taken away makes neighbours differ.
            let n = (freedom / of_kind().count().max(1) as f64 + 1.0).max(2.0);
            (products / sum.max(1e-12) + 1.0 / n).clamp(0.0, 0.8)
        };
        let least = least_m * least_m;
        for mean in blocks.iter_mut().flat_map(|block| &mut block.means).filter(|mean| mean.what.kind() == kind) {
            let own = &left[&mean.what];
            let n = own.len() as f64 - 1.0;
            let variance = (squares(own) + PRIOR_BLOCKS * of_all) / (n + PRIOR_BLOCKS);
            mean.variance_m2 = (variance / mean.shows * (1.0 + lasts) / (1.0 - lasts)).max(least);
        }
    }
}

/// Standard deviations of the road's shape about the surface that was fitted: of a cubic in the distance, in its powers of 10 m.
pub const SHAPE_M: [f64; 4] = [0.2, 0.4, 0.4, 0.4];

/// A distance's powers.
#[must_use]
pub fn powers(flat_m: f64) -> [f64; 4] {
    let x = flat_m / 10.0;
    [1.0, x, x * x, x * x * x]
}

/// Height of a shape at a distance.
#[must_use]
pub fn height_m(shape: [f64; 4], flat_m: f64) -> f64 {
    shape.iter().zip(powers(flat_m)).fold(0.0, |sum, (weight, power)| sum + weight * power)
}

/// The road's shape by least squares, as likely as it is to begin with.
#[must_use]
pub fn road_shape(points: impl Iterator<Item = (f64, f64)>) -> [f64; 4] {
    let mut normal = nalgebra::Matrix4::<f64>::zeros();
    let mut right = nalgebra::Vector4::<f64>::zeros();
    let precision = 1.0 / (0.005 * 0.005);
    for (flat_m, off_m) in points {
        let row = nalgebra::Vector4::from(powers(flat_m));
        normal += precision * row * row.transpose();
        right += precision * off_m * row;
    }
    for (k, sd) in SHAPE_M.iter().enumerate() {
        normal[(k, k)] += 1.0 / (sd * sd);
    }
    normal.cholesky().map_or([0.0; 4], |it| it.solve(&right).into())
}
