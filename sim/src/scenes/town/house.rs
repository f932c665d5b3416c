//! Houses: walls with windows set back, bays, steps to the door, gabled and hipped roofs, chimneys.

use asami_dataset::Rng;
use rand::RngExt;

use super::Surface;
use super::mesh::{Mesh, Place, Point};
use super::terrain::{between, chance};

/// Foundations reach this far below the ground at the house's middle.
const FOUNDATION_M: f64 = 0.8;
/// Roofs stand out over walls.
const EAVES_M: f64 = 0.4;
const STOREY_M: f64 = 2.7;
/// Panes behind the wall's face.
const RECESS_M: f64 = 0.18;

/// What a house is, drawn before any triangle, so that detail changes no draw.
pub(super) struct House {
    width_m: f64,
    depth_m: f64,
    storeys: usize,
    /// Ground floor above the ground.
    floor_m: f64,
    pitch: f64,
    /// Ridge along the street rather than across it.
    ridge_along: bool,
    hipped: bool,
    bay: bool,
    chimney: bool,
    /// Share of the width at which the door stands.
    door: f64,
    wing: bool,
}

/// A hole in a wall: left, right, lower and upper edge.
type Opening = [f64; 4];

impl House {
    pub fn draw(rng: &mut Rng, most_width_m: f64) -> Self {
        Self {
            width_m: between(rng, 7.5, 11.0).min(most_width_m),
            depth_m: between(rng, 7.0, 10.0),
            storeys: 1 + usize::from(chance(rng, 0.65)),
            floor_m: 0.18 * (1 + (3.0 * rng.random::<f64>()) as usize) as f64,
            pitch: between(rng, 0.45, 0.95),
            ridge_along: chance(rng, 0.5),
            hipped: chance(rng, 0.2),
            bay: chance(rng, 0.5),
            chimney: chance(rng, 0.7),
            door: between(rng, 0.15, 0.85),
            wing: chance(rng, 0.4),
        }
    }

    /// Half its width, its depth and the height of its walls: what a body can run into.
    pub fn hull_m(&self) -> [f64; 3] {
        [0.5 * self.width_m, self.depth_m, self.eaves_m()]
    }

    fn eaves_m(&self) -> f64 {
        self.floor_m + STOREY_M * self.storeys as f64
    }

    /// Builds it behind the place's x axis, its front wall on it.
    pub fn build(&self, mesh: &mut Mesh, place: &Place, detail: f64) {
        let (half_m, depth_m, eaves_m) = (0.5 * self.width_m, self.depth_m, self.eaves_m());
        mesh.object();
        let corners = [[-half_m, 0.0], [half_m, 0.0], [half_m, depth_m], [-half_m, depth_m]];
        for side in 0..4 {
            let (a, b) = (corners[side], corners[(side + 1) % 4]);
            let length_m = if side.is_multiple_of(2) { self.width_m } else { depth_m };
            let along = [0, 1].map(|axis| (b[axis] - a[axis]) / length_m);
            let wall = place.within([a[0], a[1], 0.0], along);
            let shown = if side == 0 { detail > 0.08 } else { detail > 0.35 };
            let openings = if shown { self.openings(length_m, side == 0, detail) } else { Vec::new() };
            face(mesh, &wall, [length_m, eaves_m], &openings, detail);
        }
        let walls = [-half_m, 0.0, half_m, depth_m];
        self.roof(mesh, place, walls, eaves_m);
        if detail > 0.0 {
            self.steps(mesh, place);
        }
        if self.bay && detail > 0.04 {
            self.bay_window(mesh, place);
        }
        if self.wing && detail > 0.02 {
            mesh.object();
            let wing = [half_m, 0.3 * depth_m, half_m + 3.0, 0.95 * depth_m];
            place.cuboid(
                mesh,
                [wing[0], wing[1], -FOUNDATION_M],
                [wing[2], wing[3], self.floor_m + 2.4],
                Surface::Wall,
            );
        }
        if self.chimney && detail > 0.0 {
            mesh.object();
            let (x, y, top_m) = (-0.3 * half_m, 0.6 * depth_m, eaves_m + self.pitch * 0.5 * depth_m + 0.6);
            place.cuboid(mesh, [x - 0.3, y - 0.3, eaves_m], [x + 0.3, y + 0.3, top_m], Surface::Wall);
        }
    }

    /// Windows in columns, and the door in front.
    fn openings(&self, length_m: f64, front: bool, detail: f64) -> Vec<Opening> {
        let columns = if detail < 0.2 { 2 } else { ((length_m - 1.0) / 2.4) as usize };
        let pitch_m = length_m / columns.max(1) as f64;
        let door = (self.door * columns as f64) as usize;
        let mut openings = Vec::new();
        for column in 0..columns {
            let middle_m = (column as f64 + 0.5) * pitch_m;
            for storey in 0..self.storeys {
                let floor_m = self.floor_m + STOREY_M * storey as f64;
                if front && storey == 0 && column == door.min(columns - 1) {
                    openings.push([middle_m - 0.5, middle_m + 0.5, floor_m, floor_m + 2.1]);
                } else {
                    openings.push([middle_m - 0.55, middle_m + 0.55, floor_m + 0.85, floor_m + 2.15]);
                }
            }
        }
        openings
    }

    fn door_m(&self) -> f64 {
        let columns = ((self.width_m - 1.0) / 2.4) as usize;
        let column = ((self.door * columns as f64) as usize).min(columns.saturating_sub(1));
        (column as f64 + 0.5) * self.width_m / columns.max(1) as f64 - 0.5 * self.width_m
    }

    fn steps(&self, mesh: &mut Mesh, place: &Place) {
        mesh.object();
        let steps = (self.floor_m / 0.18).round() as usize;
        for step in 0..steps {
            let reach_m = 0.3 * (steps - step) as f64 + 0.5;
            let x_m = self.door_m();
            let low = [x_m - 0.75, -reach_m, if step == 0 { -FOUNDATION_M } else { 0.18 * step as f64 }];
            place.cuboid(mesh, low, [x_m + 0.75, 0.0, 0.18 * (step + 1) as f64], Surface::Concrete);
        }
    }

    fn bay_window(&self, mesh: &mut Mesh, place: &Place) {
        mesh.object();
        let side = if self.door > 0.5 { -1.0 } else { 1.0 };
        let (x_m, top_m) = (side * 0.25 * self.width_m, self.floor_m + 2.3);
        let outline = [[x_m + 1.3, 0.0], [x_m + 0.8, -0.8], [x_m - 0.8, -0.8], [x_m - 1.3, 0.0]];
        let ring = |z: f64| -> Vec<Point> { outline.iter().rev().map(|&[x, y]| place.at([x, y, z])).collect() };
        let rows = [ring(-FOUNDATION_M), ring(self.floor_m + 0.8), ring(top_m)];
        mesh.band(&rows[0], &rows[1], Surface::Wall);
        mesh.band(&rows[1], &rows[2], Surface::Glass);
        let apex = place.at([x_m, 0.0, top_m + 0.6]);
        for pair in rows[2].windows(2) {
            mesh.triangle([pair[0], pair[1], apex], Surface::Roof);
        }
    }

    /// Two or four slopes over a rectangle, standing out over it, and the walls' gables under them.
    fn roof(&self, mesh: &mut Mesh, place: &Place, walls: [f64; 4], eaves_m: f64) {
        mesh.object();
        let [x0, y0, x1, y1] = walls;
        // As if the ridge ran along x: other ridges are turned by a quarter.
        let (place, [a, b]) = if self.ridge_along {
            (place.within([0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.0], [1.0, 0.0]), [0.5 * (x1 - x0), 0.5 * (y1 - y0)])
        } else {
            (place.within([0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.0], [0.0, 1.0]), [0.5 * (y1 - y0), 0.5 * (x1 - x0)])
        };
        let (ridge_m, low_m) = (eaves_m + self.pitch * b, eaves_m - self.pitch * EAVES_M);
        let (ao, bo) = (a + EAVES_M, b + EAVES_M);
        let ridge = if self.hipped { (a - b).max(0.0) } else { ao };
        let at = |x: f64, y: f64, z: f64| place.at([x, y, z]);
        let tops = [at(-ridge, 0.0, ridge_m), at(ridge, 0.0, ridge_m)];
        let feet = [at(-ao, -bo, low_m), at(ao, -bo, low_m), at(ao, bo, low_m), at(-ao, bo, low_m)];
        mesh.quad([feet[0], feet[1], tops[1], tops[0]], Surface::Roof);
        mesh.quad([feet[2], feet[3], tops[0], tops[1]], Surface::Roof);
        if self.hipped {
            mesh.triangle([feet[1], feet[2], tops[1]], Surface::Roof);
            mesh.triangle([feet[3], feet[0], tops[0]], Surface::Roof);
            // Eaves seen from below.
            mesh.quad([feet[3], feet[2], feet[1], feet[0]], Surface::Roof);
        } else {
            for side in [-1.0, 1.0] {
                let gable = [at(side * a, -side * b, eaves_m), at(side * a, side * b, eaves_m)];
                mesh.triangle([gable[0], gable[1], at(side * a, 0.0, ridge_m)], Surface::Wall);
            }
        }
    }
}

/// A wall along the place's x axis with holes whose panes are set back.
fn face(mesh: &mut Mesh, wall: &Place, [length_m, height_m]: [f64; 2], openings: &[Opening], detail: f64) {
    let cuts = |edges: [f64; 2], pick: [usize; 2]| {
        let mut cuts: Vec<f64> = openings.iter().flat_map(|it| pick.map(|i| it[i])).chain(edges).collect();
        cuts.sort_by(f64::total_cmp);
        cuts.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
        cuts
    };
    let (xs, zs) = (cuts([0.0, length_m], [0, 1]), cuts([-FOUNDATION_M, height_m], [2, 3]));
    for x in xs.windows(2) {
        for z in zs.windows(2) {
            let (xm, zm) = (0.5 * (x[0] + x[1]), 0.5 * (z[0] + z[1]));
            let hole = openings.iter().find(|it| it[0] < xm && xm < it[1] && it[2] < zm && zm < it[3]);
            let corner = |x: f64, y: f64, z: f64| wall.at([x, y, z]);
            if hole.is_none() {
                let flat = [
                    corner(x[0], 0.0, z[0]),
                    corner(x[1], 0.0, z[0]),
                    corner(x[1], 0.0, z[1]),
                    corner(x[0], 0.0, z[1]),
                ];
                mesh.quad(flat, Surface::Wall);
            }
        }
    }
    for &[x0, x1, z0, z1] in openings {
        let ring = |y: f64| [[x0, z0], [x1, z0], [x1, z1], [x0, z1], [x0, z0]].map(|[x, z]| wall.at([x, y, z]));
        let (outer, inner) = (ring(0.0), ring(RECESS_M));
        mesh.band(&outer, &inner, Surface::Wall);
        mesh.fan(&inner[..4], Surface::Glass);
        if detail > 0.3 {
            wall.cuboid(mesh, [x0 - 0.08, -0.07, z0 - 0.08], [x1 + 0.08, 0.03, z0], Surface::Concrete);
        }
        if detail > 0.6 {
            let (xm, zm) = (0.5 * (x0 + x1), z0 + 0.6 * (z1 - z0));
            wall.cuboid(mesh, [xm - 0.03, RECESS_M - 0.06, z0], [xm + 0.03, RECESS_M, z1], Surface::Wood);
            wall.cuboid(mesh, [x0, RECESS_M - 0.06, zm - 0.03], [x1, RECESS_M, zm + 0.03], Surface::Wood);
        }
    }
}
