//! What a way of dividing triangles among two boxes costs.

/// An axis-parallel box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    pub(crate) lo: [f32; 3],
    pub(crate) hi: [f32; 3],
}

impl Bounds {
    /// Inside out: grows to whatever it is grown by.
    pub(crate) const NONE: Self = Self { lo: [f32::INFINITY; 3], hi: [f32::NEG_INFINITY; 3] };

    pub(crate) fn around(points: &[[f32; 3]]) -> Self {
        points.iter().fold(Self::NONE, |bounds, point| bounds.with(&Self { lo: *point, hi: *point }))
    }

    pub(crate) fn with(&self, other: &Self) -> Self {
        let pick = |a: &[f32; 3], b: &[f32; 3], f: fn(f32, f32) -> f32| std::array::from_fn(|k| f(a[k], b[k]));
        Self { lo: pick(&self.lo, &other.lo, f32::min), hi: pick(&self.hi, &other.hi, f32::max) }
    }

    /// Half the surface: chances that a ray meets one box on its way through another are as these.
    pub(crate) fn area(&self) -> f32 {
        let [x, y, z] = self.size();
        if x < 0.0 { 0.0 } else { x * y + y * z + z * x }
    }

    pub(crate) fn size(&self) -> [f32; 3] {
        std::array::from_fn(|k| self.hi[k] - self.lo[k])
    }

    pub(crate) fn centre(&self) -> [f32; 3] {
        std::array::from_fn(|k| 0.5 * (self.lo[k] + self.hi[k]))
    }
}

/// A triangle on its way into the hierarchy.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Item {
    pub(crate) bounds: Bounds,
    pub(crate) centre: [f32; 3],
    pub(crate) place: u32,
}

/// A way of dividing items.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Division {
    pub(crate) axis: usize,
    /// Items in the lower part, once they are in order.
    pub(crate) lower: usize,
    /// Both parts' areas times their counts: the tests of triangles to be expected, times the parent's area.
    pub(crate) cost: f32,
}

/// Boxes into which centres are sorted along an axis.
const BINS: usize = 32;
/// Up to so many items, every division is tried.
const FEW: usize = 24;

/// Puts the items in order for the cheapest division by the surface area heuristic (Goldsmith and Salmon 1987; binned as by
/// Wald 2007), and gives it; `None` if all centres are in one place.
pub(crate) fn divide(items: &mut [Item]) -> Option<Division> {
    if items.len() <= FEW { divide_few(items) } else { divide_many(items) }
}

fn divide_few(items: &mut [Item]) -> Option<Division> {
    let mut best: Option<Division> = None;
    let mut below = [0.0; FEW];
    let mut last_axis = usize::MAX;
    let sort = |items: &mut [Item], axis: usize| {
        items.sort_unstable_by(|a, b| a.centre[axis].total_cmp(&b.centre[axis]).then(a.place.cmp(&b.place)));
    };
    for axis in 0..3 {
        sort(items, axis);
        last_axis = axis;
        let mut bounds = Bounds::NONE;
        for (i, item) in items.iter().enumerate() {
            bounds = bounds.with(&item.bounds);
            below[i] = bounds.area() * (i + 1) as f32;
        }
        let mut bounds = Bounds::NONE;
        for lower in (1..items.len()).rev() {
            bounds = bounds.with(&items[lower].bounds);
            let cost = below[lower - 1] + bounds.area() * (items.len() - lower) as f32;
            if best.is_none_or(|best| cost < best.cost) {
                best = Some(Division { axis, lower, cost });
            }
        }
    }
    let best = best?;
    if best.axis != last_axis {
        sort(items, best.axis);
    }
    Some(best)
}

fn divide_many(items: &mut [Item]) -> Option<Division> {
    let centres = items.iter().fold(Bounds::NONE, |bounds, item| bounds.with(&Bounds::around(&[item.centre])));
    let size = centres.size();
    let scale = size.map(|size| BINS as f32 * 0.9999 / size);
    let bin = |item: &Item, axis: usize| ((item.centre[axis] - centres.lo[axis]) * scale[axis]) as usize;
    let mut bins = [[(Bounds::NONE, 0_usize); BINS]; 3];
    for item in items.iter() {
        for axis in 0..3 {
            // A size of zero puts all into the first: infinity times zero is no number, and becomes 0.
            let (bounds, count) = &mut bins[axis][bin(item, axis).min(BINS - 1)];
            *bounds = bounds.with(&item.bounds);
            *count += 1;
        }
    }
    let mut best: Option<(Division, usize)> = None;
    for (axis, bins) in bins.iter().enumerate() {
        if !(size[axis] > 0.0 && scale[axis].is_finite()) {
            continue;
        }
        let mut above = [0.0; BINS];
        let (mut bounds, mut count) = (Bounds::NONE, 0);
        for k in (1..BINS).rev() {
            bounds = bounds.with(&bins[k].0);
            count += bins[k].1;
            above[k] = bounds.area() * count as f32;
        }
        let (mut bounds, mut lower) = (Bounds::NONE, 0);
        for k in 1..BINS {
            bounds = bounds.with(&bins[k - 1].0);
            lower += bins[k - 1].1;
            let cost = bounds.area() * lower as f32 + above[k];
            if lower > 0 && lower < items.len() && best.is_none_or(|(best, _)| cost < best.cost) {
                best = Some((Division { axis, lower, cost }, k));
            }
        }
    }
    let (best, first_upper) = best?;
    let mut end = items.len();
    let mut i = 0;
    while i < end {
        if bin(&items[i], best.axis).min(BINS - 1) < first_upper {
            i += 1;
        } else {
            end -= 1;
            items.swap(i, end);
        }
    }
    Some(best)
}
