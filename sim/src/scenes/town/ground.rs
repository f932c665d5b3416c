//! Streets, kerbs, pavements, verges and gardens: one closed sheet, cell by cell.
//!
//! A cell is a block with the halves of the streets around it, bounded by their centre lines. Neighbours share the
//! points on those lines, so that the sheet has no cracks.

use super::Surface;
use super::TownConfig;
use super::mesh::{Mesh, Point};
use super::terrain::Waves;
use asami_dataset::Seed;
use asami_math::elementary::sin_cos;

/// From the foot of a kerb to its upper edge, so that its face leans back a little.
const KERB_LEAN_M: f64 = 0.02;
/// Width of a kerb stone.
const KERB_M: f64 = 0.15;
/// Centre line above the gutters.
const CROWN_M: f64 = 0.09;
/// Pavements rise away from the street.
const PAVEMENT_SLOPE: f64 = 0.02;
/// What is left of a kerb where cars drive over it.
const DROPPED: f64 = 0.2;

/// A rectangle: least x and y, greatest x and y.
pub(super) type Rectangle = [f64; 4];

/// What shapes the ground.
#[derive(Clone, Debug)]
pub(super) struct Terrain {
    hills: Waves,
    bumps: Waves,
    banks: Waves,
    street_half_m: f64,
    radius_m: f64,
    kerb_m: f64,
    pavement_m: f64,
    verge_m: f64,
    bank_m: f64,
}

/// A point of a cell's rim: on the street's centre line and at the foot of the kerb.
#[derive(Clone, Copy)]
struct Rim {
    centre: [f64; 2],
    foot: [f64; 2],
    /// Into the block.
    inward: [f64; 2],
    /// 1, less where the kerb is dropped.
    kerb: f64,
}

/// A stretch of kerb that cars may cross, by the world place of its middle.
pub(super) struct Driveway {
    pub at_m: [f64; 2],
    pub half_width_m: f64,
}

impl Terrain {
    pub fn new(config: &TownConfig, seed: Seed) -> Self {
        Self {
            hills: Waves::of_slope(&mut seed.stream("town/hills"), 6, [90.0, 300.0], config.hill_slope),
            bumps: Waves::of_slope(&mut seed.stream("town/bumps"), 24, [2.5, 12.0], config.bump_slope),
            banks: Waves::of_slope(&mut seed.stream("town/banks"), 12, [9.0, 40.0], 0.05),
            street_half_m: 0.5 * config.street_width_m,
            radius_m: config.corner_radius_m,
            kerb_m: config.kerb_height_m,
            pavement_m: config.pavement_m,
            verge_m: config.verge_m,
            bank_m: config.bank_height_m,
        }
    }

    /// Streets' gutters: the level to which all else is added.
    pub fn level_m(&self, x_m: f64, y_m: f64) -> f64 {
        self.hills.at(x_m, y_m) + self.bumps.at(x_m, y_m)
    }

    /// Height of a parked car's or a street lamp's foot on the roadway beside the kerb.
    pub fn roadside_m(&self, [x_m, y_m]: [f64; 2]) -> f64 {
        self.level_m(x_m, y_m) + 0.3 * CROWN_M
    }

    /// Height of the roadway near its middle.
    pub fn roadway_m(&self, [x_m, y_m]: [f64; 2]) -> f64 {
        self.level_m(x_m, y_m) + CROWN_M
    }

    /// From the kerb's foot to the gardens.
    pub fn frontage_m(&self) -> f64 {
        KERB_M + self.pavement_m + self.verge_m
    }

    /// Height of a garden's edge above the gutter.
    fn bank(&self, x_m: f64, y_m: f64) -> f64 {
        let swell = (0.5 + self.banks.at(x_m, y_m) / 0.4).clamp(-0.2, 1.0);
        self.kerb_m + PAVEMENT_SLOPE * self.pavement_m + self.bank_m * swell
    }

    /// Height of the gardens.
    pub fn garden_m(&self, [x_m, y_m]: [f64; 2]) -> f64 {
        self.level_m(x_m, y_m) + self.bank(x_m, y_m)
    }

    /// The sheet of one cell.
    pub fn cell(&self, mesh: &mut Mesh, cell: Rectangle, driveways: &[Driveway], spacing_m: f64, detail: f64) {
        let rim = self.rim(cell, driveways, spacing_m);
        let row = |place: &dyn Fn(&Rim) -> Point| -> Vec<Point> { rim.iter().map(place).collect() };
        let lift = |[x, y]: [f64; 2], above_m: f64| [x, y, self.level_m(x, y) + above_m];

        let lanes = if detail > 0.0 { 2 + (2.0 * detail) as usize } else { 1 };
        let mut outer = row(&|it| lift(it.centre, CROWN_M));
        for lane in (0..lanes).rev() {
            let share = lane as f64 / lanes as f64;
            let inner = row(&|it| {
                let at = [0, 1].map(|axis| it.foot[axis] + share * (it.centre[axis] - it.foot[axis]));
                // A crowned road, level along its centre line.
                lift(at, CROWN_M * share * (2.0 - share))
            });
            mesh.band(&outer, &inner, Surface::Asphalt);
            outer = inner;
        }

        let inward = |it: &Rim, by_m: f64| [0, 1].map(|axis| it.foot[axis] + by_m * it.inward[axis]);
        let slope_m = PAVEMENT_SLOPE * self.pavement_m;
        let mut strip = |mesh: &mut Mesh, inner: Vec<Point>, surface: Surface| {
            mesh.band(&outer, &inner, surface);
            outer = inner;
        };
        strip(mesh, row(&|it| lift(inward(it, KERB_LEAN_M), it.kerb * self.kerb_m)), Surface::Concrete);
        if detail > 0.0 {
            strip(mesh, row(&|it| lift(inward(it, KERB_M), it.kerb * self.kerb_m)), Surface::Concrete);
        }
        let paved_m = KERB_M + self.pavement_m;
        strip(mesh, row(&|it| lift(inward(it, paved_m), self.kerb_m + slope_m)), Surface::Pavement);
        let steps = if detail > 0.0 { 2 + (2.0 * detail) as usize } else { 1 };
        for step in 1..=steps {
            let share = step as f64 / steps as f64;
            let place = |it: &Rim| {
                let at = inward(it, paved_m + share * self.verge_m);
                let flat_m = self.kerb_m + slope_m;
                // Grass banks begin and end level.
                let rise = share * share * (3.0 - 2.0 * share);
                lift(at, flat_m + rise * (self.bank(at[0], at[1]) - flat_m))
            };
            strip(mesh, row(&place), Surface::Grass);
        }
        // Gardens narrow towards their middle: a point in four is enough.
        let sparse: Vec<Rim> = rim.iter().take(rim.len() - 1).step_by(4).chain(rim.last()).copied().collect();
        let middle = [0.5 * (cell[0] + cell[2]), 0.5 * (cell[1] + cell[3])];
        let rings = 2 + (6.0 * detail) as usize;
        for ring in 1..=rings {
            let share = ring as f64 / rings as f64;
            let place = |it: &Rim| {
                let edge = inward(it, self.frontage_m());
                let at = [0, 1].map(|axis| edge[axis] + share * (middle[axis] - edge[axis]));
                lift(at, self.bank(at[0], at[1]))
            };
            let inner: Vec<Point> = sparse.iter().map(place).collect();
            if ring == 1 {
                mesh.stitch(&outer, &inner, 4, Surface::Grass);
            } else {
                mesh.band(&outer, &inner, Surface::Grass);
            }
            outer = inner;
        }
    }

    /// The rim of a cell, counter-clockwise from its least corner, the first point again at the end.
    fn rim(&self, cell: Rectangle, driveways: &[Driveway], spacing_m: f64) -> Vec<Rim> {
        let [x0, y0, x1, y1] = cell;
        let corners = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
        let mut rim = Vec::new();
        for side in 0..4 {
            let (from, to) = (corners[side], corners[(side + 1) % 4]);
            let length_m = (to[0] - from[0]).abs() + (to[1] - from[1]).abs();
            let along = [0, 1].map(|axis| (to[axis] - from[axis]) / length_m);
            let pieces = (length_m / spacing_m).ceil() as usize;
            for piece in 0..pieces {
                // Measured from the nearer junction: whichever way a neighbour runs, it finds the same points.
                let back = 2 * piece > pieces;
                let nearer = if back { pieces - piece } else { piece };
                let s_m = length_m * nearer as f64 / pieces as f64;
                let (at, along) = if back { (to, along.map(|it| -it)) } else { (from, along) };
                rim.push(self.rim_point(at, along, back, s_m, driveways));
            }
        }
        rim.extend(rim.first().copied());
        rim
    }

    /// `s_m` along a centre line from a junction; the block is to the left, or to the right if `back`.
    fn rim_point(&self, at: [f64; 2], along: [f64; 2], back: bool, s_m: f64, driveways: &[Driveway]) -> Rim {
        let left = if back { [along[1], -along[0]] } else { [-along[1], along[0]] };
        let centre = [0, 1].map(|axis| at[axis] + s_m * along[axis]);
        let reach_m = self.street_half_m + self.radius_m;
        let place =
            |ahead_m: f64, aside_m: f64| [0, 1].map(|axis| at[axis] + ahead_m * along[axis] + aside_m * left[axis]);
        if s_m >= reach_m {
            let foot = place(s_m, self.street_half_m);
            let dropped = driveways.iter().any(|it| {
                let (dx, dy) = (it.at_m[0] - foot[0], it.at_m[1] - foot[1]);
                (dx * dx + dy * dy).sqrt() < it.half_width_m
            });
            return Rim { centre, foot, inward: left, kerb: if dropped { DROPPED } else { 1.0 } };
        }
        // Half of the corner's arc belongs to either street.
        let angle_rad = std::f64::consts::FRAC_PI_4 * (1.0 + s_m / reach_m);
        let (sin, cos) = sin_cos(angle_rad);
        let foot = place(reach_m - self.radius_m * cos, reach_m - self.radius_m * sin);
        let inward = [0, 1].map(|axis| cos * along[axis] + sin * left[axis]);
        Rim { centre, foot, inward, kerb: 1.0 }
    }
}
