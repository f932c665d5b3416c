//! A figure: series over two axes, with a title, a legend and a caption.

use super::axis::{Axis, drawable};
use super::svg;

/// The mark of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// +
    Plus,
    /// x
    Cross,
    /// A filled dot.
    Dot,
}

/// The stroke of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stroke {
    /// Unbroken.
    Solid,
    /// Dashed.
    Dashed,
}

/// How a series is drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A mark at each point.
    Points(Mark, Vec<[f64; 2]>),
    /// A line through the points; broken where a coordinate is not finite.
    Line(Stroke, Vec<[f64; 2]>),
    /// A mark with a vertical bar: x, y, the bar's lower and its upper end.
    ErrorBars(Vec<[f64; 4]>),
    /// The area between two curves: x, lower and upper.
    Band(Vec<[f64; 3]>),
    /// A horizontal line across the figure.
    Level(f64),
    /// Thick horizontal bars: from x, to x, at y.
    Bars(Vec<[f64; 3]>),
}

/// A named series.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Name in the legend; none if empty.
    pub name: String,
    /// What is drawn.
    pub shape: Shape,
    /// Index into the palette.
    pub colour: usize,
}

impl Series {
    /// The points by which axes are ranged.
    fn extent(&self) -> Vec<[f64; 2]> {
        match &self.shape {
            Shape::Points(_, points) | Shape::Line(_, points) => points.clone(),
            Shape::ErrorBars(bars) => {
                bars.iter().flat_map(|[x, y, low, high]| [[*x, *low], [*x, *high], [*x, *y]]).collect()
            }
            Shape::Band(band) => band.iter().flat_map(|[x, low, high]| [[*x, *low], [*x, *high]]).collect(),
            Shape::Level(y) => vec![[f64::NAN, *y]],
            Shape::Bars(bars) => bars.iter().flat_map(|[from, to, y]| [[*from, *y], [*to, *y]]).collect(),
        }
    }

    /// Whether there is nothing of it to draw.
    pub(crate) fn is_empty(&self) -> bool {
        // A level has no x of its own.
        !self.extent().iter().any(|[_, y]| drawable(*y))
    }

    /// The points that a reader may ask for by pointing at them.
    pub(crate) fn told(&self) -> Vec<[f64; 2]> {
        match &self.shape {
            Shape::Points(_, points) | Shape::Line(_, points) => points.clone(),
            Shape::ErrorBars(bars) => bars.iter().map(|[x, y, ..]| [*x, *y]).collect(),
            Shape::Band(_) | Shape::Level(_) | Shape::Bars(_) => Vec::new(),
        }
    }
}

/// Series over two axes. Built up by value; [`Figure::svg`] draws it.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// Short name, unique in a report: `3.5a`.
    pub name: String,
    /// What is drawn, in a few words.
    pub title: String,
    /// What it shows, what is good, what to do about it if it is not.
    pub caption: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// In order of drawing.
    pub series: Vec<Series>,
    /// Width and height in CSS pixels.
    pub size: (u32, u32),
}

impl Figure {
    /// An empty figure.
    #[must_use]
    pub fn new(name: &str, title: &str) -> Self {
        Self {
            name: name.to_owned(),
            title: title.to_owned(),
            caption: String::new(),
            x: Axis::default(),
            y: Axis::default(),
            series: Vec::new(),
            size: (560, 380),
        }
    }

    /// Names the horizontal axis.
    #[must_use]
    pub fn x(mut self, label: &str, unit: &str) -> Self {
        (self.x.label, self.x.unit) = (label.to_owned(), unit.to_owned());
        self
    }

    /// Names the vertical axis.
    #[must_use]
    pub fn y(mut self, label: &str, unit: &str) -> Self {
        (self.y.label, self.y.unit) = (label.to_owned(), unit.to_owned());
        self
    }

    /// Says what the figure shows, what is good, what to do.
    #[must_use]
    pub fn caption(mut self, caption: impl Into<String>) -> Self {
        self.caption = caption.into();
        self
    }

    /// Sets width and height in CSS pixels.
    #[must_use]
    pub fn size(mut self, width: u32, height: u32) -> Self {
        self.size = (width.max(160), height.max(120));
        self
    }

    /// Fixes the vertical range; what lies outside is cut off.
    #[must_use]
    pub fn y_range(mut self, low: f64, high: f64) -> Self {
        self.y.range = Some((low, high));
        self
    }

    /// Fixes the horizontal range; what lies outside is cut off.
    #[must_use]
    pub fn x_range(mut self, low: f64, high: f64) -> Self {
        self.x.range = Some((low, high));
        self
    }

    /// Starts the vertical axis at zero.
    #[must_use]
    pub fn y_from_zero(mut self) -> Self {
        self.y.zero = true;
        self
    }

    /// Adds marks at points.
    #[must_use]
    pub fn points(self, name: &str, mark: Mark, points: impl Into<Vec<[f64; 2]>>) -> Self {
        self.series(name, Shape::Points(mark, points.into()))
    }

    /// Adds a line.
    #[must_use]
    pub fn line(self, name: &str, stroke: Stroke, points: impl Into<Vec<[f64; 2]>>) -> Self {
        self.series(name, Shape::Line(stroke, points.into()))
    }

    /// Adds a line of `f` over `n` points from `from` to `to`.
    #[must_use]
    pub fn curve(self, name: &str, stroke: Stroke, (from, to): (f64, f64), f: impl Fn(f64) -> f64) -> Self {
        const N: usize = 120;
        let at = |i: usize| from + (to - from) * i as f64 / N as f64;
        self.line(name, stroke, (0..=N).map(|i| [at(i), f(at(i))]).collect::<Vec<_>>())
    }

    /// Adds points with vertical bars: x, y, a bar's lower and its upper end.
    #[must_use]
    pub fn error_bars(self, name: &str, bars: impl Into<Vec<[f64; 4]>>) -> Self {
        self.series(name, Shape::ErrorBars(bars.into()))
    }

    /// Adds a shaded band: x, lower and upper end.
    #[must_use]
    pub fn band(self, name: &str, band: impl Into<Vec<[f64; 3]>>) -> Self {
        self.series(name, Shape::Band(band.into()))
    }

    /// Adds a horizontal reference line.
    #[must_use]
    pub fn level(self, name: &str, y: f64) -> Self {
        self.series(name, Shape::Level(y))
    }

    /// Adds named rows of horizontal bars, each from x to x; the first row is the lowest.
    #[must_use]
    pub fn rows<'a>(mut self, rows: impl IntoIterator<Item = (&'a str, Vec<[f64; 2]>)>) -> Self {
        for (name, bars) in rows {
            let y = self.y.names.len() as f64;
            self.y.names.push(name.to_owned());
            let colour = self.y.names.len() - 1;
            self.series.push(Series {
                name: String::new(),
                shape: Shape::Bars(bars.into_iter().map(|[from, to]| [from, to, y]).collect()),
                colour,
            });
        }
        self
    }

    /// Gives the last series the colour of another, counted from 0.
    #[must_use]
    pub fn coloured_as(mut self, colour: usize) -> Self {
        if let Some(last) = self.series.last_mut() {
            last.colour = colour;
        }
        self
    }

    fn series(mut self, name: &str, shape: Shape) -> Self {
        let colour = self.series.len();
        self.series.push(Series { name: name.to_owned(), shape, colour });
        self
    }

    /// Ranges of the two axes as drawn.
    #[must_use]
    pub fn ranges(&self) -> ((f64, f64), (f64, f64)) {
        let extent: Vec<[f64; 2]> = self.series.iter().flat_map(Series::extent).collect();
        let x = self.x.range_over(extent.iter().map(|point| point[0]));
        // Of a fixed horizontal range, only what is inside it sets the vertical one.
        let inside = |at: f64| !drawable(at) || (x.0 <= at && at <= x.1);
        let y = self.y.range_over(extent.iter().filter(|point| inside(point[0])).map(|point| point[1]));
        (x, y)
    }

    /// Whether there is anything to draw.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        !self.series.iter().flat_map(Series::extent).any(|[x, y]| drawable(x) && drawable(y))
    }

    /// The figure as a file of its own.
    #[must_use]
    pub fn svg(&self) -> String {
        svg::standalone(&svg::draw(self))
    }

    /// The figure as an element of an HTML page, where SVG needs no name space.
    #[must_use]
    pub fn inline_svg(&self) -> String {
        svg::draw(self)
    }

    /// What a page needs to tell the points pointed at.
    #[must_use]
    pub fn data(&self) -> serde_json::Value {
        svg::data(self)
    }
}
