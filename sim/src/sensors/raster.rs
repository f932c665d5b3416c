//! How much of each pixel a moving quadrilateral covers.

/// Corners in pixels from the image's top left corner (x right, y down), in order around the outline.
pub(super) type Quad = [[f64; 2]; 4];

/// Coverage of a fully covered pixel.
pub(super) const FULL: i32 = 1 << 12;
/// Vertical lines through a pixel's width, shared out among the poses; what each line crosses is exact.
const LINES: u32 = 8;

/// A box of pixels: columns `x0..x1`, rows `y0..y1`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Window {
    pub x0: usize,
    pub x1: usize,
    pub y0: usize,
    pub y1: usize,
}

impl Window {
    /// The pixels of a `width_px` by `height_px` image that the points may touch, if any.
    pub fn around(points: impl Iterator<Item = [f64; 2]>, width_px: usize, height_px: usize) -> Option<Self> {
        let mut low = [f64::INFINITY; 2];
        let mut high = [f64::NEG_INFINITY; 2];
        for point in points {
            for axis in 0..2 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        // Casts saturate, NaN gives 0: an empty window.
        let range = |axis: usize, size: usize| {
            (low[axis].floor().max(0.0) as usize, (high[axis].ceil().max(0.0) as usize).min(size))
        };
        let ((x0, x1), (y0, y1)) = (range(0, width_px), range(1, height_px));
        (x0 < x1 && y0 < y1).then_some(Self { x0, x1, y0, y1 })
    }

    pub fn width(&self) -> usize {
        self.x1 - self.x0
    }

    pub fn height(&self) -> usize {
        self.y1 - self.y0
    }
}

/// Coverage of the pixels of a window, kept between frames for its memory.
#[derive(Clone, Debug, Default)]
pub(super) struct Coverage {
    /// Change of coverage from the row above, row after row, and one row beyond.
    steps: Vec<i32>,
    width: usize,
}

impl Coverage {
    /// The coverage of `window` by a quadrilateral that moves from `open` to `close` at constant speed.
    pub fn draw(&mut self, window: &Window, open: &Quad, close: &Quad) {
        self.width = window.width();
        self.steps.clear();
        self.steps.resize(self.width * (window.height() + 2), 0);
        let travel_px =
            open.iter().zip(close).flat_map(|(a, b)| [(a[0] - b[0]).abs(), (a[1] - b[1]).abs()]).fold(0.0, f64::max);
        let poses = (2.0 * travel_px).ceil().clamp(1.0, f64::from(LINES)) as u32;
        let poses = poses.next_power_of_two();
        for pose in 0..poses {
            let part = (f64::from(pose) + 0.5) / f64::from(poses);
            let quad: Quad = std::array::from_fn(|i| {
                std::array::from_fn(|axis| open[i][axis] + part * (close[i][axis] - open[i][axis]))
            });
            // Successive poses have their lines far from each other's: van der Corput's order.
            let order = pose.reverse_bits() >> (32 - LINES.ilog2());
            self.add(window, &quad, LINES / poses, (f64::from(order) + 0.5) / f64::from(LINES));
        }
    }

    /// Adds `lines` evenly spaced lines per pixel of one still quadrilateral, the first at `first_px`.
    fn add(&mut self, window: &Window, quad: &Quad, lines: u32, first_px: f64) {
        let (weight, spacing_px) = (FULL / LINES as i32, 1.0 / f64::from(lines));
        let least = quad.iter().fold(f64::INFINITY, |least, corner| least.min(corner[0]));
        let greatest = quad.iter().fold(f64::NEG_INFINITY, |greatest, corner| greatest.max(corner[0]));
        let from_left = |x_px: f64| ((x_px - window.x0 as f64 - first_px) / spacing_px).ceil().max(0.0) as usize;
        let sides = Sides::of(quad);
        for index in from_left(least)..from_left(greatest).min(self.width * lines as usize) {
            let x_px = window.x0 as f64 + first_px + index as f64 * spacing_px;
            if let Some((top_px, bottom_px)) = sides.span(x_px) {
                let column = index / lines as usize;
                self.edge(window, column, top_px, weight);
                self.edge(window, column, bottom_px, -weight);
            }
        }
    }

    /// From row `y_px` down, the column is covered by `weight` more.
    fn edge(&mut self, window: &Window, column: usize, y_px: f64, weight: i32) {
        let y_px = (y_px - window.y0 as f64).clamp(0.0, window.height() as f64);
        let row = y_px as usize;
        let in_row = (f64::from(weight) * (1.0 - (y_px - row as f64))).round() as i32;
        self.steps[row * self.width + column] += in_row;
        self.steps[(row + 1) * self.width + column] += weight - in_row;
    }

    /// Change of coverage from the row above to row `row` of the window.
    pub fn step(&self, row: usize) -> &[i32] {
        &self.steps[row * self.width..(row + 1) * self.width]
    }
}

/// The sides of a convex quadrilateral, to be crossed by vertical lines.
struct Sides([Side; 4]);

/// From the left end to the right one; a vertical side spans no line.
struct Side {
    left_px: f64,
    right_px: f64,
    y_px: f64,
    slope: f64,
}

impl Sides {
    fn of(quad: &Quad) -> Self {
        Self(std::array::from_fn(|i| {
            let (a, b) = (quad[i], quad[(i + 1) % 4]);
            let (left, right) = if a[0] <= b[0] { (a, b) } else { (b, a) };
            let slope = (right[1] - left[1]) / (right[0] - left[0]);
            Side { left_px: left[0], right_px: right[0], y_px: left[1], slope }
        }))
    }

    /// Top and bottom on the vertical line at `x_px`.
    fn span(&self, x_px: f64) -> Option<(f64, f64)> {
        let (mut top, mut bottom) = (f64::INFINITY, f64::NEG_INFINITY);
        for side in &self.0 {
            if side.left_px <= x_px && x_px < side.right_px {
                let y_px = side.y_px + side.slope * (x_px - side.left_px);
                top = top.min(y_px);
                bottom = bottom.max(y_px);
            }
        }
        (top < bottom).then_some((top, bottom))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area_px(open: &Quad, close: &Quad) -> f64 {
        let window = Window::around(open.iter().chain(close).copied(), 60, 50).expect("inside");
        let mut coverage = Coverage::default();
        coverage.draw(&window, open, close);
        let mut row = vec![0; window.width()];
        let mut sum = 0;
        for y in 0..window.height() {
            for (cover, step) in row.iter_mut().zip(coverage.step(y)) {
                *cover += step;
                assert!((0..=FULL).contains(cover));
                sum += *cover;
            }
        }
        f64::from(sum) / f64::from(FULL)
    }

    #[test]
    fn coverage_adds_up_to_the_area() {
        let quad = [[10.3, 5.2], [20.8, 6.1], [20.1, 30.7], [9.6, 29.8]];
        // The shoelace formula.
        let twice: f64 = (0..4).map(|i| (quad[i], quad[(i + 1) % 4])).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum();
        // Either side may be off by half a line of 24 px: 1/16 px of width, twice.
        assert!((area_px(&quad, &quad) - 0.5 * twice).abs() < 24.0 / 8.0);
        let moved = quad.map(|[x, y]| [x + 3.0, y - 1.0]);
        assert!((area_px(&quad, &moved) - area_px(&quad, &quad)).abs() < 24.0 / 8.0, "blur moves light, it makes none");
    }

    #[test]
    fn heights_are_exact() {
        for shift in 0..20 {
            let (top, height) = (3.0 + 0.05 * f64::from(shift), 12.34);
            let quad = [[4.0, top], [8.0, top], [8.0, top + height], [4.0, top + height]];
            assert!((area_px(&quad, &quad) - 4.0 * height).abs() < 4.0 * 2.0 * 4.0 / f64::from(FULL));
        }
    }
}
