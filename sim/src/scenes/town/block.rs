//! A block: its lots with houses and fences, and what stands along its kerbs.

use asami_dataset::Rng;
use rand::RngExt;

use super::TownConfig;
use super::greenery::{Border, Tree, pole};
use super::ground::{Driveway, Rectangle, Terrain};
use super::house::House;
use super::mesh::{Mesh, Place, Point};
use super::parked::Parked;
use super::terrain::{between, chance};
use crate::scenes::solid::Solid;

/// Front of a lot, as far as the sides divide evenly.
const LOT_M: f64 = 15.0;
/// Length of a parking place.
const PLACE_M: f64 = 6.3;
/// No car is parked so near to a corner's arc.
const CORNER_M: f64 = 8.0;
const DRIVEWAY_M: f64 = 3.2;
/// Sides of a block end this far from the corner where those across begin at once.
const DEPTH_M: f64 = 27.0;

/// A lot: its front's middle on the edge of the verge.
struct Lot {
    /// Which side of the block, and how far along it.
    side: usize,
    along_m: f64,
    width_m: f64,
    house: Option<House>,
    setback_m: f64,
    border: Border,
    /// Side of the house on which the driveway runs.
    driveway: f64,
    garden_trees: Vec<(Tree, [f64; 2])>,
}

/// Something beside the kerb.
enum Roadside {
    Car(Parked, f64),
    Tree(Tree),
    Pole(f64),
}

/// A block.
pub(super) struct Block {
    pub cell: Rectangle,
    pub driveways: Vec<Driveway>,
    street_half_m: f64,
    lots: Vec<Lot>,
    /// Side, distance along it, thing.
    roadside: Vec<(usize, f64, Roadside)>,
}

impl Block {
    /// All that is random about it.
    pub fn draw(config: &TownConfig, cell: Rectangle, rng: &mut Rng) -> Self {
        let street_half_m = 0.5 * config.street_width_m;
        let reach_m = street_half_m + config.corner_radius_m;
        let mut block = Self { cell, driveways: Vec::new(), street_half_m, lots: Vec::new(), roadside: Vec::new() };
        for side in 0..4 {
            let kerb = block.side(side);
            let length_m = block.length_m(side);
            let ends_m = if side.is_multiple_of(2) { reach_m } else { DEPTH_M };
            let lots = ((length_m - 2.0 * ends_m) / LOT_M).max(0.0) as usize;
            let width_m = (length_m - 2.0 * ends_m) / lots.max(1) as f64;
            for i in 0..lots {
                let lot = Lot::draw(config, rng, side, ends_m + (i as f64 + 0.5) * width_m, width_m);
                let driveway = kerb.at([lot.along_m + lot.driveway_m(), 0.0, 0.0]);
                let half_width_m = 0.5 * DRIVEWAY_M + 0.3;
                block.driveways.push(Driveway { at_m: [driveway[0], driveway[1]], half_width_m });
                block.lots.push(lot);
            }
            block.draw_roadside(config, rng, side, reach_m);
        }
        block
    }

    fn draw_roadside(&mut self, config: &TownConfig, rng: &mut Rng, side: usize, reach_m: f64) {
        let kerb = self.side(side);
        let length_m = self.length_m(side);
        let free = length_m - 2.0 * (reach_m + CORNER_M);
        let places = (free / PLACE_M).max(0.0) as usize;
        for i in 0..places {
            let along_m = reach_m + CORNER_M + (i as f64 + 0.5) * free / places as f64 + between(rng, -0.4, 0.4);
            let (car, askew, taken) = (Parked::draw(rng), between(rng, -0.025, 0.025), chance(rng, config.parked));
            let at = kerb.at([along_m, 0.0, 0.0]);
            let clear = self.driveways.iter().all(|it| {
                let (dx, dy) = (it.at_m[0] - at[0], it.at_m[1] - at[1]);
                (dx * dx + dy * dy).sqrt() > 0.5 * (DRIVEWAY_M + car.length_m())
            });
            if taken && clear {
                self.roadside.push((side, along_m, Roadside::Car(car, askew)));
            }
        }
        let trees = ((length_m - 2.0 * reach_m) / 9.0) as usize;
        for i in 0..trees {
            let along_m =
                reach_m + (i as f64 + 0.5) * (length_m - 2.0 * reach_m) / trees as f64 + between(rng, -1.5, 1.5);
            let (tree, taken) = (Tree::draw(rng), chance(rng, config.trees));
            if taken {
                self.roadside.push((side, along_m, Roadside::Tree(tree)));
            }
        }
        for along_m in [reach_m + 1.0, 0.5 * length_m + between(rng, -3.0, 3.0), length_m - reach_m - 1.0] {
            self.roadside.push((side, along_m, Roadside::Pole(between(rng, 5.0, 8.0))));
        }
    }

    fn length_m(&self, side: usize) -> f64 {
        let [x0, y0, x1, y1] = self.cell;
        if side.is_multiple_of(2) { x1 - x0 } else { y1 - y0 }
    }

    /// A side's place: x along it from the cell's corner, counter-clockwise, y into the block from the kerb's foot.
    fn side(&self, side: usize) -> Place {
        let [x0, y0, x1, y1] = self.cell;
        let sides = [([x0, y0], [1.0, 0.0]), ([x1, y0], [0.0, 1.0]), ([x1, y1], [-1.0, 0.0]), ([x0, y1], [0.0, -1.0])];
        let (corner, along) = sides[side % 4];
        let centre = Place { origin_m: [corner[0], corner[1], 0.0], along };
        centre.within([0.0, self.street_half_m, 0.0], [1.0, 0.0])
    }

    /// Puts up all that stands on it.
    pub fn build(&self, mesh: &mut Mesh, solids: &mut Vec<Solid>, terrain: &Terrain, detail: f64) {
        for lot in &self.lots {
            let kerb = self.side(lot.side);
            let front = kerb.within([lot.along_m, terrain.frontage_m(), 0.0], [1.0, 0.0]);
            lot.build(mesh, solids, &front, terrain, detail);
        }
        for (side, along_m, thing) in &self.roadside {
            let kerb = self.side(*side);
            let ground = |x: f64, y: f64, height: &dyn Fn([f64; 2]) -> f64| {
                let [wx, wy, _] = kerb.at([x, y, 0.0]);
                [x, y, height([wx, wy])]
            };
            match thing {
                Roadside::Car(car, askew) => {
                    let at = ground(*along_m, -(0.15 + 0.5 * car.width_m()), &|at| terrain.roadside_m(at));
                    // Traffic next to the kerb runs the other way round the block.
                    let place = kerb.within(at, [-(1.0 - askew * askew).sqrt(), *askew]);
                    car.build(mesh, &place, detail);
                    let half_m = [0.5 * car.length_m(), 0.5 * car.width_m(), 0.5 * car.height_m()];
                    solids.push(cuboid(&place, [0.0, 0.0, half_m[2]], half_m));
                }
                Roadside::Tree(tree) => {
                    let at = ground(*along_m, terrain.frontage_m() - 0.7, &|at| terrain.garden_m(at));
                    let place = kerb.within(at, [1.0, 0.0]);
                    tree.build(mesh, &place, detail);
                    solids.push(post(&place, tree.trunk_m(), 0.5 * tree.height_m()));
                }
                Roadside::Pole(height_m) => {
                    let at = ground(*along_m, 0.45, &|at| terrain.roadside_m(at) + 0.1);
                    let place = kerb.within(at, [1.0, 0.0]);
                    pole(mesh, &place, *height_m, detail);
                    solids.push(post(&place, 0.1, *height_m));
                }
            }
        }
    }
}

impl Lot {
    fn draw(config: &TownConfig, rng: &mut Rng, side: usize, along_m: f64, width_m: f64) -> Self {
        let house = House::draw(rng, width_m - DRIVEWAY_M - 0.5);
        let built = chance(rng, config.house_density);
        let setback_m = between(rng, 2.8, 6.5);
        let border = [Border::Picket, Border::Hedge, Border::Wall][((3.0 * rng.random::<f64>()) as usize).min(2)];
        let driveway = if chance(rng, 0.5) { 1.0 } else { -1.0 };
        let mut garden_trees = Vec::new();
        for _ in 0..2 {
            let tree = Tree::draw(rng);
            let at = [between(rng, -0.5, 0.5) * width_m, between(rng, 19.0, 30.0)];
            if chance(rng, config.trees) {
                garden_trees.push((tree, at));
            }
        }
        let house = built.then_some(house);
        Self { side, along_m, width_m, house, setback_m, border, driveway, garden_trees }
    }

    /// The driveway's middle from the lot's.
    fn driveway_m(&self) -> f64 {
        self.driveway * 0.5 * (self.width_m - DRIVEWAY_M)
    }

    fn build(&self, mesh: &mut Mesh, solids: &mut Vec<Solid>, front: &Place, terrain: &Terrain, detail: f64) {
        let garden_m = |at: [f64; 2]| {
            let [x, y, _] = front.at([at[0], at[1], 0.0]);
            terrain.garden_m([x, y])
        };
        let on_ground = |at: [f64; 2]| [at[0], at[1], garden_m(at)];
        let middle_m = -self.driveway * 0.5 * DRIVEWAY_M;
        if let Some(house) = &self.house {
            let [half_m, depth_m, height_m] = house.hull_m();
            let foot = on_ground([middle_m, self.setback_m + 0.5 * depth_m]);
            let place = front.within([foot[0], self.setback_m, foot[2]], [1.0, 0.0]);
            house.build(mesh, &place, detail);
            let half = [half_m, 0.5 * depth_m, 0.5 * height_m];
            solids.push(cuboid(&place, [0.0, half[1], half[2]], half));
        }
        let edge = 0.5 * self.width_m;
        let gap = DRIVEWAY_M;
        let span = if self.driveway > 0.0 { [-edge, edge - gap] } else { [-edge + gap, edge] };
        // A gate before the house.
        for span in [[span[0], middle_m - 0.7], [middle_m + 0.7, span[1]]] {
            if span[1] - span[0] > 0.5 {
                self.border.build(
                    mesh,
                    &front.within([0.0, 0.1, 0.0], [1.0, 0.0]),
                    span,
                    &|x| garden_m([x, 0.1]),
                    detail,
                );
            }
        }
        for (tree, at) in &self.garden_trees {
            tree.build(mesh, &front.within(on_ground(*at), [1.0, 0.0]), detail);
        }
    }
}

fn cuboid(place: &Place, centre: Point, half_m: [f64; 3]) -> Solid {
    Solid { centre_m: place.at(centre), half_m, along: place.along }
}

/// An upright post at a place's origin.
pub(super) fn post(place: &Place, radius_m: f64, height_m: f64) -> Solid {
    cuboid(place, [0.0, 0.0, 0.5 * height_m], [radius_m, radius_m, 0.5 * height_m])
}
