//! Parked cars: a hull lofted over cross-sections, on four wheels.

use asami_dataset::Rng;
use rand::RngExt;

use super::Surface;
use super::mesh::{Mesh, Place, Point, circle};
use super::terrain::between;

/// What a parked car is.
pub(super) struct Parked {
    length_m: f64,
    width_m: f64,
    height_m: f64,
    /// Windscreen's and rear window's share of the length: foot and top of each, front first.
    cabin: [f64; 4],
}

/// A van, an estate, a saloon: shares of the length at which the cabin's slopes begin and end.
const KINDS: [[f64; 4]; 3] = [[0.08, 0.2, 0.97, 0.99], [0.27, 0.42, 0.88, 0.99], [0.3, 0.44, 0.74, 0.88]];

impl Parked {
    pub fn draw(rng: &mut Rng) -> Self {
        let kind = (3.0 * rng.random::<f64>()) as usize;
        let tall_m = [0.5, 0.05, 0.0][kind.min(2)];
        Self {
            length_m: between(rng, 3.8, 4.8),
            width_m: between(rng, 1.62, 1.82),
            height_m: between(rng, 1.38, 1.52) + tall_m,
            cabin: KINDS[kind.min(2)],
        }
    }

    pub fn length_m(&self) -> f64 {
        self.length_m
    }

    pub fn width_m(&self) -> f64 {
        self.width_m
    }

    pub fn height_m(&self) -> f64 {
        self.height_m
    }

    /// The roof's or bonnet's height at a share of the length.
    fn top_m(&self, share: f64) -> f64 {
        let [foot, front, back, end] = self.cabin;
        let belt_m = 0.62 * self.height_m;
        let rise = if share < front { (share - foot) / (front - foot) } else { (end - share) / (end - back) };
        // Bumpers round off the ends.
        let nose = (share.min(1.0 - share) / 0.06).min(1.0);
        belt_m * (0.72 + 0.28 * nose) + (self.height_m - belt_m) * rise.clamp(0.0, 1.0)
    }

    /// Its middle on the place's origin, its front towards the place's x axis.
    pub fn build(&self, mesh: &mut Mesh, place: &Place, detail: f64) {
        mesh.object();
        if detail == 0.0 {
            return self.boxes(mesh, place);
        }
        let stations = 4 + (22.0 * detail) as usize;
        let mut shares: Vec<f64> = (0..=stations).map(|i| i as f64 / stations as f64).chain(self.cabin).collect();
        shares.sort_by(f64::total_cmp);
        shares.dedup_by(|a, b| (*a - *b).abs() < 0.01);
        let belt_m = 0.62 * self.height_m;
        let section = |share: f64| -> Vec<Point> {
            let top_m = self.top_m(share);
            // Seen from above the ends are round too.
            let end = (share.min(1.0 - share) / 0.1).min(1.0);
            let half_m = 0.5 * self.width_m * (0.86 + 0.14 * (2.0 * end - end * end));
            let roof_m = half_m * if top_m > belt_m { 0.82 } else { 0.94 };
            let x = self.length_m * (0.5 - share);
            let waist_m = belt_m.min(top_m - 0.02);
            [[half_m * 0.94, 0.22], [half_m, 0.5 * waist_m], [half_m * 0.98, waist_m], [roof_m, top_m]]
                .into_iter()
                .chain([[-roof_m, top_m], [-half_m * 0.98, waist_m], [-half_m, 0.5 * waist_m], [-half_m * 0.94, 0.22]])
                .map(|[y, z]| place.at([x, y, z]))
                .collect()
        };
        let sections: Vec<Vec<Point>> = shares.iter().map(|&share| section(share)).collect();
        for pair in sections.windows(2) {
            for (i, (ahead, behind)) in pair[0].windows(2).zip(pair[1].windows(2)).enumerate() {
                let of = if i == 2 || i == 4 { Surface::Glass } else { Surface::Metal };
                mesh.quad([behind[0], ahead[0], ahead[1], behind[1]], of);
            }
            let (ahead, behind) = (&pair[0], &pair[1]);
            mesh.quad([ahead[0], behind[0], behind[7], ahead[7]], Surface::Metal);
        }
        if let [first, .., last] = sections.as_slice() {
            mesh.fan(first, Surface::Metal);
            let last: Vec<Point> = last.iter().rev().copied().collect();
            mesh.fan(&last, Surface::Metal);
        }
        let sides = 6 + (10.0 * detail) as usize;
        for x in [-0.29 * self.length_m, 0.31 * self.length_m] {
            for side in [-1.0, 1.0] {
                self.wheel(mesh, place, [x, side * 0.5 * self.width_m], side, sides);
            }
        }
    }

    /// A body and a cabin.
    fn boxes(&self, mesh: &mut Mesh, place: &Place) {
        let (x, y, belt_m) = (0.5 * self.length_m, 0.5 * self.width_m, 0.62 * self.height_m);
        place.cuboid(mesh, [-x, -y, 0.15], [x, y, belt_m], Surface::Metal);
        mesh.object();
        let [front, back] = [self.cabin[1], self.cabin[2]].map(|share| self.length_m * (0.5 - share));
        place.cuboid(mesh, [back, -0.84 * y, belt_m], [front, 0.84 * y, self.height_m], Surface::Glass);
    }

    fn wheel(&self, mesh: &mut Mesh, place: &Place, [x, y]: [f64; 2], side: f64, sides: usize) {
        mesh.object();
        let radius_m = 0.31;
        let ring = |y: f64| -> Vec<Point> {
            circle(sides).map(|[c, s]| place.at([x + side * radius_m * c, y, radius_m + radius_m * s])).collect()
        };
        let (outer, inner) = (ring(y + 0.01 * side), ring(y - 0.19 * side));
        mesh.band(&inner, &outer, Surface::Rubber);
        let cap: Vec<Point> = outer[..sides].iter().rev().copied().collect();
        mesh.fan(&cap, Surface::Rubber);
    }
}
