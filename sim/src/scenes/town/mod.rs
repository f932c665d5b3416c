//! A town out of a seed: streets with kerbs and verges, houses, parked cars, trees, fences; and a round through it.
//!
//! All draws are made whatever the detail, from named streams: a town of more detail is the same town.

mod block;
mod greenery;
mod ground;
mod house;
mod mesh;
mod parked;
mod route;
mod terrain;
mod traffic;

use asami_dataset::Seed;
use asami_dataset::parameters::{Fault, Parameters};

pub use route::{Route, Waypoint};
pub use traffic::Traffic;

use super::solid::{Ground, Solid};
use crate::effects::Effects;
use crate::knobs::Knobs;
use block::Block;
use mesh::{Mesh, Place};
use terrain::between;

asami_dataset::parameters! {
    /// How a town is built.
    pub struct TownConfig {
        /// Mean distance from junction to junction.
        street_length_m: f64 = 112.0, "m", 70.0..=200.0;
        /// How much single distances differ from it.
        street_length_spread_m: f64 = 6.0, "m", 0.0..=15.0;
        /// From kerb to kerb.
        street_width_m: f64 = 8.4, "m", 6.5..=14.0;
        /// Radius of the kerbs at corners.
        corner_radius_m: f64 = 14.0, "m", 5.0..=15.0;
        /// The route runs this far to the right of the centre line.
        lane_m: f64 = 0.9, "m", 0.0..=3.0;
        /// Kerbs above the gutter.
        kerb_height_m: f64 = 0.13, "m", 0.0..=0.25;
        /// Width of the pavements.
        pavement_m: f64 = 1.3, "m", 0.5..=3.0;
        /// Width of the grass banks behind them.
        verge_m: f64 = 1.8, "m", 0.5..=3.0;
        /// Greatest height of those banks.
        bank_height_m: f64 = 0.7, "m", 0.0..=1.5;
        /// Root-mean-square slope of the hills.
        hill_slope: f64 = 0.008, "1", 0.0..=0.05;
        /// Root-mean-square slope of the bumps in the road.
        bump_slope: f64 = 0.002, "1", 0.0..=0.02;
        /// Share of lots with a house.
        house_density: f64 = 0.9, "1", 0.0..=1.0;
        /// Share of parking places taken.
        parked: f64 = 0.4, "1", 0.0..=1.0;
        /// Share of places for trees taken.
        trees: f64 = 0.5, "1", 0.0..=1.0;
        /// From about 30 thousand triangles at 0 to about 700 thousand at 1.
        detail: f64 = 0.1, "1", 0.0..=1.0;
    }
}

/// What a triangle is made of, as far as a laser sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Surface {
    /// Roadways.
    Asphalt,
    /// Paving slabs.
    Pavement,
    /// Kerbs, steps, sills.
    Concrete,
    /// Verges and gardens.
    Grass,
    /// Render and brick.
    Wall,
    /// Tiles.
    Roof,
    /// Windows.
    Glass,
    /// Fences, frames.
    Wood,
    /// Trunks.
    Bark,
    /// Crowns, hedges.
    Leaves,
    /// Painted or galvanised metal.
    Metal,
    /// Tyres.
    Rubber,
}

impl Surface {
    /// Diffuse reflectivity near 905 nm, 0 to 1: round numbers for materials of the kind.
    #[must_use]
    pub fn reflectivity(self) -> f64 {
        match self {
            Surface::Asphalt => 0.17,
            Surface::Pavement => 0.3,
            Surface::Concrete => 0.35,
            Surface::Grass => 0.5,
            Surface::Wall => 0.45,
            Surface::Roof => 0.3,
            Surface::Glass => 0.08,
            Surface::Wood => 0.4,
            Surface::Bark => 0.3,
            Surface::Leaves => 0.45,
            Surface::Metal => 0.4,
            Surface::Rubber => 0.05,
        }
    }
}

/// A town.
#[derive(Clone, Debug)]
pub struct Town {
    /// x, y, z in metres; z is up.
    pub vertices: Vec<[f32; 3]>,
    /// Corners.
    pub triangles: Vec<[u32; 3]>,
    /// One per triangle.
    pub surface: Vec<Surface>,
    /// A closed round along its streets, with left turns only.
    pub route: Route,
    /// What bodies run into, the ground apart.
    pub solids: Vec<Solid>,
    /// The ground's vertices and triangles come first: how many there are.
    ground: [usize; 2],
    terrain: ground::Terrain,
    /// How far the route runs to the right of the middle of the road.
    lane_m: f64,
}

/// Cars that come the other way drive this far to their right of the middle of the road.
const ONCOMING_M: f64 = 1.1;

/// Blocks along either side of the town. The round goes about all but the outer ones.
const BLOCKS: usize = 4;

impl Town {
    /// Builds it.
    #[must_use]
    pub fn new(config: &TownConfig, seed: Seed) -> Self {
        let [xs, ys] = lines(config, seed);
        let terrain = ground::Terrain::new(config, seed);
        let blocks: Vec<Block> = (0..BLOCKS * BLOCKS)
            .map(|i| {
                let (column, row) = (i % BLOCKS, i / BLOCKS);
                let cell = [xs[column], ys[row], xs[column + 1], ys[row + 1]];
                Block::draw(config, cell, &mut seed.stream(&format!("town/block/{column}/{row}")))
            })
            .collect();

        let mut mesh = Mesh::default();
        let spacing_m = 10.0 / (1.0 + 7.0 * config.detail.sqrt());
        mesh.object();
        for block in &blocks {
            terrain.cell(&mut mesh, block.cell, &block.driveways, spacing_m, config.detail);
        }
        let ground = [mesh.vertices.len(), mesh.triangles.len()];
        let mut solids = Vec::new();
        for block in &blocks {
            block.build(&mut mesh, &mut solids, &terrain, config.detail);
        }
        let route = Route::around(
            [xs[1], ys[1], xs[BLOCKS - 1], ys[BLOCKS - 1]],
            [&xs[2..BLOCKS - 1], &ys[2..BLOCKS - 1]],
            config,
        );
        for at in route.stops() {
            let right_m = 0.5 * config.street_width_m - config.lane_m + 0.5;
            let [sin, cos] = at.right();
            let (x, y) = (at.x_m + right_m * sin, at.y_m + right_m * cos);
            let place = Place { origin_m: [x, y, terrain.level_m(x, y) + config.kerb_height_m], along: at.ahead() };
            greenery::stop_sign(&mut mesh, &place);
            solids.push(block::post(&place, 0.04, 2.5));
        }
        let Mesh { vertices, triangles, surface, .. } = mesh;
        Self { vertices, triangles, surface, route, solids, ground, terrain, lane_m: config.lane_m }
    }

    /// Cars that go round the route the other way, between those who follow it and those who park, as many as the
    /// effects say.
    #[must_use]
    pub fn traffic(&self, effects: &Effects, seed: Seed) -> Traffic {
        let mut knobs = Knobs::default();
        effects.iter().for_each(|effect| effect.tune(0.0, &mut knobs));
        let aside_m = self.lane_m + ONCOMING_M;
        let place = |metre: usize| {
            let at = self.route.at(-(metre as f64));
            let [x, y] = at.right();
            let (x_m, y_m) = (at.x_m - aside_m * x, at.y_m - aside_m * y);
            [x_m, y_m, self.terrain.roadway_m([x_m, y_m])]
        };
        let way = (0..self.route.length_m() as usize).map(place).collect();
        Traffic::new(way, knobs.scene.traffic_per_km, &mut seed.stream("effect/moving_traffic"))
    }

    /// What wheels and bodies meet.
    #[must_use]
    pub fn ground(&self) -> Ground {
        let [vertices, triangles] = self.ground;
        Ground {
            vertices: self.vertices[..vertices].to_vec(),
            triangles: self.triangles[..triangles].to_vec(),
            solids: self.solids.clone(),
        }
    }
}

/// The streets' centre lines, x and y, about the origin.
fn lines(config: &TownConfig, seed: Seed) -> [Vec<f64>; 2] {
    let mut rng = seed.stream("town/streets");
    [(); 2].map(|()| {
        let spread_m = config.street_length_spread_m;
        let mut lines = vec![0.0];
        for _ in 0..BLOCKS {
            let last = lines.last().copied().unwrap_or_default();
            lines.push(last + config.street_length_m + between(&mut rng, -spread_m, spread_m));
        }
        let middle = lines[BLOCKS / 2];
        lines.iter().map(|line| line - middle).collect()
    })
}

impl TownConfig {
    /// Adds a fault for every value out of range, and where the parts of a street do not fit; `path` is the table's
    /// own place in the file.
    pub fn check_fit(&self, path: &str, faults: &mut Vec<Fault>) {
        self.check(path, faults);
        let frontage_m = self.pavement_m + self.verge_m + 0.3;
        if frontage_m > self.corner_radius_m {
            let message = format!("pavement and verge ({frontage_m} m with kerbs) must fit into the corner_radius_m");
            faults.push(Fault { path: format!("{path}.corner_radius_m"), message });
        }
        // Half the street, less the widest parked car off the kerb and half of the one that passes it.
        let room_m = 0.5 * self.street_width_m - 0.15 - 1.82 - 0.9 - self.lane_m;
        if self.parked > 0.0 && room_m < 0.3 {
            let message =
                format!("beside a lane_m of {} m cars pass parked ones by {room_m:.2} m, not 0.3", self.lane_m);
            faults.push(Fault { path: format!("{path}.street_width_m"), message });
        }
    }
}

#[cfg(test)]
mod tests;
