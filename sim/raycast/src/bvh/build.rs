//! Building the hierarchy from the top.

use super::cost::{Bounds, Item, divide};
use super::{Bvh, DEEPEST, LEAF, Node, PADDING, Pair};
use crate::facet::Facet;

/// A leaf has at most so many triangles, unless they cannot be told apart.
const LEAF_TRIANGLES: usize = 8;
/// A visit of a box, in tests of triangles.
const VISIT: f32 = 2.0;
/// From this depth on, items are halved: 2^31 of them are then single before [`DEEPEST`].
const DEEP: usize = DEEPEST - 40;

struct Work {
    node: usize,
    items: std::ops::Range<usize>,
    depth: usize,
}

/// Over triangles with an area, `corners` and `numbers` by the triangle.
pub(super) fn build(corners: &[[[f32; 3]; 3]], numbers: &[u32]) -> Bvh {
    let mut items: Vec<Item> = (0..)
        .zip(corners)
        .map(|(place, corners)| {
            let bounds = Bounds::around(corners);
            Item { bounds, centre: bounds.centre(), place }
        })
        .collect();
    let around = items.iter().fold(Bounds::NONE, |bounds, item| bounds.with(&item.bounds));
    let farthest =
        around.lo.iter().chain(&around.hi).filter(|x| x.is_finite()).fold(0.0_f32, |far, x| far.max(x.abs()));
    // A sensor may stand somewhat outside of the scene.
    let bound = 1.25 * farthest + 16.0;
    let pad = PADDING * bound;

    let mut nodes = vec![Node::EMPTY; 2];
    let mut work = vec![Work { node: 0, items: 0..items.len(), depth: 0 }];
    while let Some(Work { node, items: of, depth }) = work.pop() {
        let start = of.start;
        let items = &mut items[of.clone()];
        let bounds = items.iter().fold(Bounds::NONE, |bounds, item| bounds.with(&item.bounds));
        match split(items, &bounds, depth) {
            Some((axis, lower)) => {
                let children = nodes.len();
                nodes.extend([Node::EMPTY; 2]);
                nodes[node] = padded(&bounds, 2.0 * pad, children as u32, axis as u32);
                let [first, second] = [start..start + lower, start + lower..of.end];
                work.push(Work { node: children + 1, items: second, depth: depth + 1 });
                work.push(Work { node: children, items: first, depth: depth + 1 });
            }
            None => nodes[node] = padded(&bounds, pad, start as u32, LEAF | items.len() as u32),
        }
    }
    let (facets, numbers) = items
        .iter()
        .filter_map(|item| Some((Facet::new(corners[item.place as usize])?, numbers[item.place as usize])))
        .unzip();
    let nodes = nodes.chunks_exact(2).map(|pair| Pair([pair[0], pair[1]])).collect();
    Bvh { nodes, facets, numbers, bound, around }
}

/// How many items go to the lower child, and along which axis the children stand; `None` makes a leaf.
fn split(items: &mut [Item], bounds: &Bounds, depth: usize) -> Option<(usize, usize)> {
    if items.len() < 2 {
        return None;
    }
    let halves = (0, items.len() / 2);
    if depth >= DEEP {
        return (items.len() > LEAF_TRIANGLES).then_some(halves);
    }
    match divide(items) {
        Some(division) => {
            let as_leaf = bounds.area() * items.len() as f32;
            let pays = division.cost + VISIT * bounds.area() < as_leaf;
            (items.len() > LEAF_TRIANGLES || pays).then_some((division.axis, division.lower))
        }
        None => (items.len() > LEAF_TRIANGLES).then_some(halves),
    }
}

fn padded(bounds: &Bounds, pad: f32, first: u32, tag: u32) -> Node {
    let [lo, hi] = [bounds.lo.map(|x| (x - pad).to_bits()), bounds.hi.map(|x| (x + pad).to_bits())];
    Node { words: [lo[0], lo[1], lo[2], first, hi[0], hi[1], hi[2], tag] }
}
