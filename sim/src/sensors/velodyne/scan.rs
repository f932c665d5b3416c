//! A drive's worth of firings.

use asami_dataset::{Firings, Seed};
use asami_raycast::{Bundle, Hits};
use rayon::prelude::*;

use super::beams::{self, Base, Clock, FIRINGS, Heads, LASERS, Mount, RUN};
use super::movers::meet;
use super::returns::{Biases, Meter, Readings, draw, light};
use super::track::Track;
use super::{Scenery, SensorPose, TrackError, Unit, VelodyneConfig};
use crate::effect::Stage;
use crate::effects::Effects;
use crate::knobs::{Knobs, LaserKnobs, VelodyneKnobs};
use crate::scenes::town::Traffic;

/// Firings that are worked off, and for which random streams are named, together.
const BLOCK: usize = 512;
/// Units of the encoder's angle in a turn.
const ENCODER_STEPS: f64 = 36_000.0;

/// A scanner on a car's roof.
#[derive(Clone, Debug)]
pub struct Velodyne {
    config: VelodyneConfig,
    unit: Unit,
    knobs: VelodyneKnobs,
    mounts: Vec<Mount>,
    /// For every [`LASERS`] of them.
    biases: Vec<Biases>,
    traffic: Traffic,
}

/// What all blocks of a drive share.
struct Drive<'a> {
    scenery: &'a Scenery,
    track: Track<'a>,
    clock: Clock,
    meter: Meter,
    seed: Seed,
}

/// Where one laser's readings of a block go.
struct Row<'a> {
    /// Number of the first firing.
    first: isize,
    range_2mm: &'a mut [u16],
    intensity: &'a mut [u8],
}

impl Velodyne {
    /// A scanner with the unit's lasers.
    #[must_use]
    pub fn new(config: VelodyneConfig, unit: Unit) -> Self {
        let none = Velodyne {
            config,
            unit,
            knobs: VelodyneKnobs::default(),
            mounts: Vec::new(),
            biases: Vec::new(),
            traffic: Traffic::default(),
        };
        none.departing(VelodyneKnobs::default(), &[])
    }

    /// The same scanner under effects: what its maker says of it stays as it is. `seed` is the drive's.
    #[must_use]
    pub fn under(self, effects: &Effects, seed: Seed) -> Self {
        let mut knobs = Knobs::default();
        let mut lasers = vec![LaserKnobs::default(); self.unit.lasers().len()];
        for effect in effects.iter() {
            effect.tune(0.0, &mut knobs);
            if let Some(Stage::Lasers(stage)) = effect.stage(seed.stream(&format!("effect/{}", effect.about().name))) {
                stage(&mut lasers);
            }
        }
        self.departing(knobs.velodyne, &lasers)
    }

    fn departing(self, knobs: VelodyneKnobs, lasers: &[LaserKnobs]) -> Self {
        let Self { config, unit, traffic, .. } = self;
        let mounts = beams::mounts(&unit, &config, &knobs, lasers);
        let bias_m = |i: usize| lasers.get(i).map_or(0.0, |laser| laser.range_m as f32);
        let bundle = |first: usize| std::array::from_fn(|lane| bias_m(first + lane / RUN % LASERS));
        let biases = (0..mounts.len()).step_by(LASERS).map(bundle).collect();
        Self { config, unit, knobs, mounts, biases, traffic }
    }

    /// The same scanner with cars about it.
    #[must_use]
    pub fn among(self, traffic: Traffic) -> Self {
        Self { traffic, ..self }
    }

    /// What the lasers' angles are counted from, plus the angles: theta_l + theta_b of each laser, by increasing
    /// vertical angle, wrapped to [-pi, pi): what is to be learned.
    #[must_use]
    pub fn horizontal_angles_rad(&self) -> Vec<f64> {
        let angle = |laser: &super::Laser| asami_math::angle::wrap_rad(laser.horizontal_rad + self.config.base_rad);
        self.unit.lasers().iter().map(angle).collect()
    }

    /// The unit.
    #[must_use]
    pub fn unit(&self) -> &Unit {
        &self.unit
    }

    /// Records from the first pose of a track to its last. In parallel; the bits do not hang on the number of threads.
    ///
    /// # Errors
    /// If the track has fewer than two poses, times that do not increase, or numbers that are none.
    pub fn scan(&self, scenery: &Scenery, poses: &[SensorPose], seed: Seed) -> Result<Firings, TrackError> {
        let track = Track::new(poses)?;
        let clock = Clock::new(&self.config, &self.knobs, track.span_s()[0]);
        let count = self.count(&track);
        let lasers = self.mounts.len();
        let mut firings = Firings {
            t_s: (0..count as isize).map(|firing| clock.t_s(firing)).collect(),
            encoder_cdeg: (0..count as isize)
                .map(|firing| ((clock.turned(firing) * ENCODER_STEPS).round() % ENCODER_STEPS) as u16)
                .collect(),
            range_2mm: vec![vec![0; count]; lasers],
            intensity: vec![vec![0; count]; lasers],
        };
        let drive = Drive { scenery, track, clock, meter: Meter::new(&self.config, &self.knobs), seed };
        self.rows(&mut firings).into_par_iter().enumerate().for_each(|(block, mut rows)| {
            self.scan_block(&drive, block, &mut rows);
        });
        Ok(firings)
    }

    /// The beams of a track as rays, in the bundles and in the order in which [`Self::scan`] casts them: 4 lasers by 16
    /// firings that look about the same way, groups of 16 rays being 4 by 4.
    ///
    /// # Errors
    /// Those of [`Self::scan`].
    pub fn bundles(&self, poses: &[SensorPose]) -> Result<Vec<Bundle>, TrackError> {
        let track = Track::new(poses)?;
        let clock = Clock::new(&self.config, &self.knobs, track.span_s()[0]);
        let [least, greatest] = self.lags();
        let blocks = (self.count(&track) + (greatest - least) as usize).div_ceil(BLOCK);
        let mut bundles = Vec::new();
        for block in 0..blocks {
            let heads = self.heads(&track, &clock, block);
            self.aim_block(&heads, block, |bundle, _, _| bundles.push(bundle.clone()));
        }
        Ok(bundles)
    }

    /// Firings from the first pose to the last.
    fn count(&self, track: &Track) -> usize {
        let [start_s, end_s] = track.span_s();
        (((end_s - start_s - self.config.bank_s) * self.config.firing_rate_hz).floor() + 1.0).max(0.0) as usize
    }

    fn heads(&self, track: &Track, clock: &Clock, block: usize) -> Heads {
        let ([least, greatest], first) = (self.lags(), self.first_of(block));
        Heads::new(
            track,
            clock,
            &Base::new(&self.config, &self.knobs),
            first + least..first + greatest + BLOCK as isize,
        )
    }

    /// Aims a block's bundles one after another, each at the lasers from the one named and, but for their lags, at the firings from the one named.
    fn aim_block(&self, heads: &Heads, block: usize, mut cast: impl FnMut(&Bundle, usize, isize)) {
        let mut bundle = Bundle::empty();
        for step in (0..BLOCK).step_by(FIRINGS) {
            let at = self.first_of(block) + step as isize;
            for (lasers, mounts) in self.mounts.chunks(LASERS).enumerate() {
                // The last bundle of a unit whose lasers do not come by fours has lanes left over.
                if mounts.len() < LASERS {
                    bundle = Bundle::empty();
                }
                for (slot, mount) in mounts.iter().enumerate() {
                    heads.aim(mount, at + mount.lag, slot, &mut bundle);
                }
                cast(&bundle, LASERS * lasers, at);
            }
        }
    }

    /// Least and greatest lag of a laser.
    fn lags(&self) -> [isize; 2] {
        let lags = || self.mounts.iter().map(|mount| mount.lag);
        [lags().min().unwrap_or(0), lags().max().unwrap_or(0)]
    }

    /// First firing of a block, for a laser without lag. Blocks begin so early that the lasers of the greatest lag miss nothing.
    fn first_of(&self, block: usize) -> isize {
        (block * BLOCK) as isize - self.lags()[1]
    }

    /// Rows, block by block and laser by laser: a block's lasers look the same way, at firings of their own.
    fn rows<'a>(&self, firings: &'a mut Firings) -> Vec<Vec<Row<'a>>> {
        let count = firings.t_s.len();
        let [least, greatest] = self.lags();
        let blocks = (count + (greatest - least) as usize).div_ceil(BLOCK);
        let mut rows: Vec<Vec<Row>> = (0..blocks).map(|_| Vec::with_capacity(self.mounts.len())).collect();
        let lasers = firings.range_2mm.iter_mut().zip(&mut firings.intensity).zip(&self.mounts);
        for ((mut ranges, mut intensities), mount) in
            lasers.map(|((a, b), mount)| ((a.as_mut_slice(), b.as_mut_slice()), mount))
        {
            let within = |firing: isize| firing.clamp(0, count as isize);
            for (block, rows) in rows.iter_mut().enumerate() {
                let first = within(self.first_of(block) + mount.lag);
                let length = (within(self.first_of(block + 1) + mount.lag) - first) as usize;
                let (range_2mm, intensity);
                (range_2mm, ranges) = ranges.split_at_mut(length);
                (intensity, intensities) = intensities.split_at_mut(length);
                rows.push(Row { first, range_2mm, intensity });
            }
        }
        rows
    }

    fn scan_block(&self, drive: &Drive, block: usize, rows: &mut [Row]) {
        let Drive { scenery, track, clock, meter, seed } = drive;
        let mut noise = seed.stream(&format!("velodyne/range/{block}"));
        let mut chance = seed.stream(&format!("velodyne/loss/{block}"));
        let mut hits = Hits::none();
        let (mut solids, mut solids_at) = (Vec::new(), None);
        self.aim_block(&self.heads(track, clock, block), block, |bundle, laser, at| {
            scenery.caster().cast(bundle, meter.reach_m(), &mut hits);
            let mut light = light(scenery, bundle, &hits);
            if !self.traffic.is_empty() {
                if solids_at != Some(at) {
                    (solids, solids_at) = (self.traffic.solids(clock.seen_s(at)), Some(at));
                }
                meet(&solids, bundle, &mut hits, &mut light);
            }
            let draws = [&draw(&mut noise), &draw(&mut chance)];
            let readings = meter.read(&hits, &light, draws, &self.biases[laser / LASERS]);
            for (slot, (mount, row)) in self.mounts.iter().zip(&mut *rows).skip(laser).take(LASERS).enumerate() {
                row.take(&readings, slot, at + mount.lag);
            }
        });
    }
}

impl Row<'_> {
    /// Takes a laser's readings out of a bundle's, from firing `first` on.
    fn take(&mut self, readings: &Readings, slot: usize, first: isize) {
        for run in 0..FIRINGS / RUN {
            let lane = RUN * LASERS * run + RUN * slot;
            let (ranges, intensities) = (&readings.range_2mm[lane..lane + RUN], &readings.intensity[lane..lane + RUN]);
            let place = first + (RUN * run) as isize - self.first;
            // Firings before the start and after the end are nobody's.
            let skip = usize::try_from(-place).unwrap_or(0).min(RUN);
            let place = usize::try_from(place).unwrap_or(0).min(self.range_2mm.len());
            let count = (RUN - skip).min(self.range_2mm.len() - place);
            self.range_2mm[place..place + count].copy_from_slice(&ranges[skip..skip + count]);
            self.intensity[place..place + count].copy_from_slice(&intensities[skip..skip + count]);
        }
    }
}
