//! Nearest neighbours in the plane, out of a grid of cells.

use std::ops::RangeInclusive;

/// A grid has no more cells than this; cells grow where it would.
const MOST_CELLS: f64 = 1_048_576.0;

/// Points sorted into square cells.
#[derive(Clone, Debug)]
pub struct Neighbours {
    origin: [f64; 2],
    cell: f64,
    /// Columns and rows.
    size: [i64; 2],
    /// Where each cell's points start, and where the last cell's end.
    starts: Vec<u32>,
    points: Vec<[f64; 2]>,
    indices: Vec<u32>,
    /// How many cells away the nearest cell with a point is, at each cell: as the king moves. Empty where it was not measured.
    away: Vec<u16>,
}

impl Neighbours {
    /// Sorts `points` into cells of side `cell`, or larger where they lie far apart. Points that are not finite
    /// are left out.
    #[must_use]
    pub fn new(points: &[[f64; 2]], cell: f64) -> Self {
        let mut grid = Self::near(points, cell);
        grid.measure();
        grid
    }

    /// The same, made in less time, for queries that find a point nearby: those that do not take longer.
    #[must_use]
    pub fn near(points: &[[f64; 2]], cell: f64) -> Self {
        let finite = |p: &[f64; 2]| p[0].is_finite() && p[1].is_finite();
        let kept: Vec<u32> =
            (0..points.len().min(u32::MAX as usize - 1)).filter(|&i| finite(&points[i])).map(|i| i as u32).collect();
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for &i in &kept {
            for (axis, v) in points[i as usize].iter().enumerate() {
                low[axis] = low[axis].min(*v);
                high[axis] = high[axis].max(*v);
            }
        }
        if kept.is_empty() {
            (low, high) = ([0.0; 2], [0.0; 2]);
        }
        let span = [high[0] - low[0], high[1] - low[1]];
        let mut cell = if cell.is_finite() && cell > 0.0 { cell } else { 1.0 };
        while (span[0] / cell + 1.0) * (span[1] / cell + 1.0) > MOST_CELLS {
            cell *= 2.0;
        }
        let size = span.map(|s| (s / cell) as i64 + 1);
        let mut grid = Self {
            origin: low,
            cell,
            size,
            starts: Vec::new(),
            points: Vec::new(),
            indices: Vec::new(),
            away: Vec::new(),
        };
        grid.sort(points, &kept);
        grid
    }

    fn sort(&mut self, points: &[[f64; 2]], kept: &[u32]) {
        let cells = (self.size[0] * self.size[1]) as usize;
        let of: Vec<usize> = kept.iter().map(|&i| self.index(self.cell_of(points[i as usize]))).collect();
        self.starts = vec![0; cells + 1];
        of.iter().for_each(|&cell| self.starts[cell + 1] += 1);
        for cell in 0..cells {
            self.starts[cell + 1] += self.starts[cell];
        }
        let mut next = self.starts.clone();
        self.points = vec![[0.0; 2]; kept.len()];
        self.indices = vec![0; kept.len()];
        for (&i, &cell) in kept.iter().zip(&of) {
            let at = next[cell] as usize;
            next[cell] += 1;
            (self.points[at], self.indices[at]) = (points[i as usize], i);
        }
    }

    /// Two passes of the chessboard distance transform (Rosenfeld and Pfaltz 1968).
    fn measure(&mut self) {
        let [columns, rows] = self.size.map(|n| n as usize);
        // A border of cells that are far from everything spares the edges a case of their own.
        let wide = columns + 2;
        let mut away = vec![u16::MAX - 1; wide * (rows + 2)];
        for y in 0..rows {
            for x in 0..columns {
                let cell = y * columns + x;
                if self.starts[cell + 1] > self.starts[cell] {
                    away[(y + 1) * wide + x + 1] = 0;
                }
            }
        }
        for y in 1..=rows {
            let (above, row) = away[(y - 1) * wide..(y + 1) * wide].split_at_mut(wide);
            for x in 1..=columns {
                let least = row[x - 1].min(above[x - 1]).min(above[x]).min(above[x + 1]);
                row[x] = row[x].min(least.saturating_add(1));
            }
        }
        for y in (1..=rows).rev() {
            let (row, below) = away[y * wide..(y + 2) * wide].split_at_mut(wide);
            for x in (1..=columns).rev() {
                let least = row[x + 1].min(below[x - 1]).min(below[x]).min(below[x + 1]);
                row[x] = row[x].min(least.saturating_add(1));
            }
        }
        self.away = (1..=rows).flat_map(|y| away[y * wide + 1..(y + 1) * wide - 1].iter().copied()).collect();
    }

    /// The points, in the grid's own order.
    #[must_use]
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// Which of the points given to [`Neighbours::new`] is the one at `place` in the grid's own order.
    #[must_use]
    pub fn index_of(&self, place: usize) -> Option<usize> {
        self.indices.get(place).map(|i| *i as usize)
    }

    /// The point nearest to `query` within `radius`: its place in the grid's own order and its squared distance. The first
    /// in that order of several as near. `hint`, a place where it may be, saves time.
    #[must_use]
    pub fn nearest(&self, query: [f64; 2], radius: f64, hint: Option<usize>) -> Option<(usize, f64)> {
        let (place, distance_sq) = self.search(query, radius, hint)?;
        (distance_sq <= radius * radius).then_some((place, distance_sq))
    }

    fn search(&self, query: [f64; 2], radius: f64, hint: Option<usize>) -> Option<(usize, f64)> {
        if !(query[0].is_finite() && query[1].is_finite() && radius >= 0.0) || self.points.is_empty() {
            return None;
        }
        let mut best = (usize::MAX, radius * radius);
        if let Some((place, point)) = hint.and_then(|place| Some((place, self.points.get(place)?))) {
            let distance_sq = squared_distance(*point, query);
            if distance_sq <= best.1 {
                best = (place, distance_sq);
            }
        }
        let [columns, rows] = self.size;
        let far = columns.max(rows) as f64 + 2.0;
        let place = [(query[0] - self.origin[0]) / self.cell, (query[1] - self.origin[1]) / self.cell];
        // Beyond this a query sees the grid from so far that no radius in cells is worth telling apart.
        if place.iter().any(|p| p.abs() > 1e9) {
            return self.every(query, best);
        }
        let at = place.map(|p| p.floor() as i64);
        let margin = (0..2).map(|k| (place[k] - at[k] as f64).min(1.0 - (place[k] - at[k] as f64))).fold(1.0, f64::min);
        let inside = (0..columns).contains(&at[0]) && (0..rows).contains(&at[1]);
        let outside = |k: usize| (-at[k]).max(at[k] - self.size[k] + 1).max(0);
        let known = || self.away.get(self.index(at)).copied().map_or(0, i64::from);
        let mut ring = if inside { known() } else { outside(0).max(outside(1)) };
        let last = ring + far as i64;
        while ring <= last {
            // All of this ring lies at least so far away; a hair less for the rounding of cells.
            let least = ((ring as f64 - 1.0 + margin) * self.cell * (1.0 - 1e-12)).max(0.0);
            if ring > 0 && least * least > best.1 {
                break;
            }
            let (across, down) = (at[0] - ring..=at[0] + ring, at[1] - ring..=at[1] + ring);
            self.row(at[1] - ring, across.clone(), query, &mut best);
            if ring > 0 {
                self.row(at[1] + ring, across, query, &mut best);
                for x in [at[0] - ring, at[0] + ring].into_iter().filter(|x| (0..columns).contains(x)) {
                    for y in (down.start() + 1).max(0)..=(down.end() - 1).min(rows - 1) {
                        self.row(y, x..=x, query, &mut best);
                    }
                }
            }
            ring += 1;
        }
        (best.0 != usize::MAX).then_some(best)
    }

    fn every(&self, query: [f64; 2], mut best: (usize, f64)) -> Option<(usize, f64)> {
        self.among(0, self.points.len(), query, &mut best);
        (best.0 != usize::MAX).then_some(best)
    }

    fn row(&self, y: i64, across: RangeInclusive<i64>, query: [f64; 2], best: &mut (usize, f64)) {
        let (from, to) = ((*across.start()).max(0), (*across.end()).min(self.size[0] - 1));
        if from <= to && (0..self.size[1]).contains(&y) {
            let (first, last) = (self.index([from, y]), self.index([to, y]));
            self.among(self.starts[first] as usize, self.starts[last + 1] as usize, query, best);
        }
    }

    fn among(&self, from: usize, to: usize, query: [f64; 2], best: &mut (usize, f64)) {
        for (i, point) in self.points[from..to].iter().enumerate() {
            let distance_sq = squared_distance(*point, query);
            if distance_sq < best.1 || (distance_sq == best.1 && from + i < best.0) {
                *best = (from + i, distance_sq);
            }
        }
    }

    /// Calls `with` for the points of the cells within `radius` of `point`, in the grid's order: for all of a row of cells, or evenly for
    /// about `most` where there are more.
    pub fn around(&self, point: [f64; 2], radius: f64, most: usize, mut with: impl FnMut([f64; 2])) {
        if !(point[0].is_finite() && point[1].is_finite() && radius >= 0.0 && radius.is_finite()) {
            return;
        }
        let cell =
            |axis: usize, v: f64| (((v - self.origin[axis]) / self.cell).floor() as i64).clamp(0, self.size[axis] - 1);
        let (from, to) = (cell(0, point[0] - radius), cell(0, point[0] + radius));
        for y in cell(1, point[1] - radius)..=cell(1, point[1] + radius) {
            let (first, last) = (self.index([from, y]), self.index([to, y]));
            let row = &self.points[self.starts[first] as usize..self.starts[last + 1] as usize];
            row.iter().step_by(row.len() / most.max(1) + 1).for_each(|p| with(*p));
        }
    }

    fn cell_of(&self, point: [f64; 2]) -> [i64; 2] {
        [0, 1].map(|k| (((point[k] - self.origin[k]) / self.cell) as i64).clamp(0, self.size[k] - 1))
    }

    fn index(&self, [x, y]: [i64; 2]) -> usize {
        (y * self.size[0] + x) as usize
    }
}

fn squared_distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    let (dx, dy) = (a[0] - b[0], a[1] - b[1]);
    dx * dx + dy * dy
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn brute_force(points: &[[f64; 2]], query: [f64; 2], radius: f64) -> Option<f64> {
        let all = points.iter().map(|p| squared_distance(*p, query)).filter(|d| *d <= radius * radius);
        all.fold(None, |best, d| Some(best.map_or(d, |b: f64| b.min(d))))
    }

    proptest! {
        #[test]
        fn the_nearest_is_that_of_brute_force(
            points in proptest::collection::vec(proptest::array::uniform2(-20.0..20.0f64), 0..60),
            queries in proptest::collection::vec(proptest::array::uniform2(-60.0..60.0f64), 1..20),
            cell in 0.1..30.0f64, radius in 0.0..50.0f64, hint in 0..80usize,
        ) {
            let grid = Neighbours::new(&points, cell);
            for query in queries {
                let found = grid.nearest(query, radius, Some(hint));
                prop_assert_eq!(found.map(|f| f.1), brute_force(&points, query, radius));
                prop_assert_eq!(grid.nearest(query, radius, None), found);
                prop_assert_eq!(Neighbours::near(&points, cell).nearest(query, radius, None), found);
                if let Some((place, _)) = found {
                    prop_assert_eq!(points[grid.index_of(place).unwrap()], grid.points()[place]);
                }
                let mut within = 0;
                grid.around(query, radius, usize::MAX, |p| within += usize::from(squared_distance(p, query) <= radius * radius));
                prop_assert_eq!(within, points.iter().filter(|p| squared_distance(**p, query) <= radius * radius).count());
            }
        }

        #[test]
        fn no_points_panic(
            points in proptest::collection::vec(proptest::array::uniform2(proptest::num::f64::ANY), 0..20),
            query in proptest::array::uniform2(proptest::num::f64::ANY),
            cell in proptest::num::f64::ANY, radius in proptest::num::f64::ANY,
        ) {
            let grid = Neighbours::new(&points, cell);
            let _ = grid.nearest(query, radius, None);
            grid.around(query, radius, 3, |_| ());
        }
    }
}
