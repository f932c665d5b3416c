//! Figures to SVG text: one path a series, clipped by a nested `<svg>` (no `url(...)` anywhere), every
//! text a `<text>` element.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::axis::drawable;
use super::figure::{Figure, Mark, Series, Shape, Stroke};
use super::{FAINT, GRID, INK, PALETTE};

const NAME_SPACE: &str = " xmlns=\"http://www.w3.org/2000/svg\"";
const FONT: &str = "font-family=\"system-ui, 'Helvetica Neue', Arial, sans-serif\"";
const LETTER_PX: f64 = 6.6;
const LINE_PX: f64 = 18.0;
const SWATCH_PX: f64 = 24.0;

/// Where things go: the plot's rectangle and the ranges it shows.
struct Layout {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
    x: (f64, f64),
    y: (f64, f64),
    legend: Vec<(usize, f64, f64)>,
}

impl Layout {
    fn of(figure: &Figure) -> Self {
        let (width, height) = (f64::from(figure.size.0), f64::from(figure.size.1));
        let (x, y) = figure.ranges();
        let widest = figure.y.ticks(y, 6).iter().map(|(_, text)| text.chars().count()).max().unwrap_or(1);
        let named = figure.y.names.iter().map(|name| width_px(name)).fold(0.0, f64::max);
        let left = (widest as f64 * LETTER_PX).max(named) + 16.0;
        let left = left.clamp(34.0, 0.5 * width);
        let (legend, rows) = legend(figure, width);
        let top = 26.0 + rows as f64 * LINE_PX + if figure.y.caption().is_empty() { 8.0 } else { 24.0 };
        Self { left, top, width: width - left - 14.0, height: (height - top - 44.0).max(20.0), x, y, legend }
    }

    fn px(&self, x: f64) -> f64 {
        (self.left + (x - self.x.0) / (self.x.1 - self.x.0) * self.width).clamp(-2e4, 2e4)
    }

    fn py(&self, y: f64) -> f64 {
        (self.top + (self.y.1 - y) / (self.y.1 - self.y.0) * self.height).clamp(-2e4, 2e4)
    }
}

/// Places of the legend's entries (series, x, y), wrapped at the figure's width, and its number of rows.
fn legend(figure: &Figure, width: f64) -> (Vec<(usize, f64, f64)>, usize) {
    let named = figure.series.iter().enumerate().filter(|(_, series)| !series.name.is_empty() && !series.is_empty());
    let (mut places, mut x, mut row) = (Vec::new(), 0.0, 0usize);
    for (index, series) in named {
        let takes = SWATCH_PX + 6.0 + width_px(&series.name) + 14.0;
        if x > 0.0 && x + takes > width - 6.0 {
            (x, row) = (0.0, row + 1);
        }
        places.push((index, x, 40.0 + row as f64 * LINE_PX));
        x += takes;
    }
    let rows = if places.is_empty() { 0 } else { row + 1 };
    (places, rows)
}

/// About how wide a text is in a wide sans-serif: which one a reader has is not known.
pub(super) fn width_px(text: &str) -> f64 {
    let letter = |c: char| match c {
        'm' | 'w' | 'M' | 'W' => 12.2,
        'i' | 'j' | 'l' | 't' | 'f' | 'I' | ' ' | ',' | '.' | '\'' | '(' | ')' => 5.0,
        _ => 7.6,
    };
    text.chars().map(letter).sum()
}

/// `<svg>` of a figure, without a name space.
pub(super) fn draw(figure: &Figure) -> String {
    let layout = Layout::of(figure);
    let (width, height) = figure.size;
    let title = escape(&figure.title);
    let mut out = open(width, height, &format!("{}: {}", figure.name, figure.title));
    let _ = write!(out, "<text class=\"ink\" x=\"0\" y=\"17\" font-weight=\"600\" fill=\"{INK}\">{title}</text>");
    axes(figure, &layout, &mut out);
    let Layout { left, top, width, height, .. } = layout;
    let (l, t, w, h) = (px(left), px(top), px(width), px(height));
    let _ = write!(out, "<svg x=\"{l}\" y=\"{t}\" width=\"{w}\" height=\"{h}\" viewBox=\"{l} {t} {w} {h}\">");
    for series in &figure.series {
        series_into(series, &layout, &mut out);
    }
    out.push_str("</svg>");
    for &(index, x, y) in &layout.legend {
        let series = &figure.series[index];
        swatch(series, x, y, &mut out);
        let (x, name) = (px(x + SWATCH_PX + 6.0), escape(&series.name));
        let _ = write!(out, "<text class=\"ink\" x=\"{x}\" y=\"{}\" fill=\"{INK}\">{name}</text>", px(y));
    }
    if figure.is_empty() {
        let (x, y) = (px(left + width / 2.0), px(top + height / 2.0));
        let _ = write!(
            out,
            "<text class=\"faint\" x=\"{x}\" y=\"{y}\" text-anchor=\"middle\" fill=\"{FAINT}\">no data</text>"
        );
    }
    out.push_str("</svg>");
    out
}

/// The opening tag of an SVG of this size in CSS pixels, with what screen readers say.
pub(super) fn open(width: u32, height: u32, label: &str) -> String {
    let label = escape(label);
    format!(
        "<svg viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" role=\"img\" aria-label=\"{label}\" {FONT} font-size=\"12.5\">"
    )
}

/// An inline SVG as a file of its own: with its name space, on white.
pub(crate) fn standalone(inline: &str) -> String {
    match inline.strip_prefix("<svg").and_then(|rest| rest.split_once('>')) {
        Some((attributes, inside)) => {
            format!("<svg{NAME_SPACE}{attributes}><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>{inside}\n")
        }
        None => inline.to_owned(),
    }
}

fn axes(figure: &Figure, layout: &Layout, out: &mut String) {
    let Layout { left, top, width, height, .. } = *layout;
    let bottom = top + height;
    let tick = |out: &mut String, x: f64, y: f64, anchor: &str, text: &str| {
        let (x, y, text) = (px(x), px(y), escape(text));
        let _ = write!(
            out,
            "<text class=\"faint\" x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\" fill=\"{FAINT}\">{text}</text>"
        );
    };
    let mut grid = String::new();
    for (at, text) in figure.x.ticks(layout.x, (width / 75.0) as usize) {
        let x = layout.px(at);
        let _ = write!(grid, "M{} {}V{}", px(x), px(top), px(bottom));
        tick(out, x, bottom + 17.0, "middle", &text);
    }
    for (at, text) in figure.y.ticks(layout.y, (height / 42.0) as usize) {
        let y = layout.py(at);
        if figure.y.names.is_empty() {
            let _ = write!(grid, "M{} {}H{}", px(left), px(y), px(left + width));
        }
        tick(out, left - 7.0, y + 4.0, "end", &text);
    }
    let _ = write!(out, "<path class=\"grid\" d=\"{grid}\" stroke=\"{GRID}\" fill=\"none\"/>");
    let frame = format!("M{} {}V{}H{}", px(left), px(top), px(bottom), px(left + width));
    let _ = write!(out, "<path class=\"frame\" d=\"{frame}\" stroke=\"{FAINT}\" fill=\"none\"/>");
    tick(out, left + width / 2.0, bottom + 36.0, "middle", &figure.x.caption());
    tick(out, 0.0, top - 10.0, "start", &figure.y.caption());
}

fn series_into(series: &Series, layout: &Layout, out: &mut String) {
    let at = |[x, y]: [f64; 2]| (drawable(x) && drawable(y)).then(|| (layout.px(x), layout.py(y)));
    match &series.shape {
        Shape::Points(mark, points) => marks(*mark, points.iter().filter_map(|point| at(*point)), series.colour, out),
        Shape::Line(stroke, points) => line(*stroke, points.iter().map(|point| at(*point)), series.colour, out),
        Shape::ErrorBars(bars) => {
            let mut path = String::new();
            for [x, _, low, high] in bars {
                if let (Some((x, low)), Some((_, high))) = (at([*x, *low]), at([*x, *high])) {
                    let _ = write!(path, "M{} {}h6m-3 0V{}m-3 0h6", px(x - 3.0), px(low), px(high));
                }
            }
            stroked(&path, series.colour, "stroke-width=\"1.2\"", out);
            marks(Mark::Dot, bars.iter().filter_map(|[x, y, ..]| at([*x, *y])), series.colour, out);
        }
        Shape::Band(band) => {
            let lower = band.iter().filter_map(|[x, low, _]| at([*x, *low]));
            let upper = band.iter().rev().filter_map(|[x, _, high]| at([*x, *high]));
            let points: Vec<String> = lower.chain(upper).map(|(x, y)| format!("{} {}", px(x), px(y))).collect();
            filled(&format!("M{}Z", points.join("L")), series.colour, "fill-opacity=\"0.18\"", !points.is_empty(), out);
        }
        Shape::Level(y) => {
            if let Some((_, y)) = at([layout.x.0, *y]) {
                let path = format!("M{} {}h{}", px(layout.left), px(y), px(layout.width));
                stroked(&path, series.colour, "stroke-width=\"1.4\" stroke-dasharray=\"2 3\"", out);
            }
        }
        Shape::Bars(bars) => {
            let mut path = String::new();
            let half = 0.33 * layout.height / (layout.y.1 - layout.y.0);
            for [from, to, y] in bars {
                if let (Some((from, y)), Some((to, _))) = (at([*from, *y]), at([*to, *y])) {
                    let _ = write!(path, "M{} {}H{}V{}H{}Z", px(from), px(y - half), px(to), px(y + half), px(from));
                }
            }
            filled(&path, series.colour, "", !path.is_empty(), out);
        }
    }
}

fn marks(mark: Mark, places: impl Iterator<Item = (f64, f64)>, colour: usize, out: &mut String) {
    let mut path = String::new();
    for (x, y) in places {
        let _ = match mark {
            Mark::Plus => write!(path, "M{} {}h6m-3 -3v6", px(x - 3.0), px(y)),
            Mark::Cross => write!(path, "M{} {}l5 5m0 -5l-5 5", px(x - 2.5), px(y - 2.5)),
            Mark::Dot => write!(path, "M{} {}a2.6 2.6 0 1 0 5.2 0a2.6 2.6 0 1 0 -5.2 0", px(x - 2.6), px(y)),
        };
    }
    match mark {
        Mark::Dot => filled(&path, colour, "", !path.is_empty(), out),
        _ => stroked(&path, colour, "stroke-width=\"1.1\"", out),
    }
}

fn line(stroke: Stroke, places: impl Iterator<Item = Option<(f64, f64)>>, colour: usize, out: &mut String) {
    let mut path = String::new();
    let mut broken = true;
    for place in places {
        if let Some((x, y)) = place {
            let _ = write!(path, "{}{} {}", if broken { 'M' } else { 'L' }, px(x), px(y));
        }
        broken = place.is_none();
    }
    let dashes = if stroke == Stroke::Dashed { " stroke-dasharray=\"7 4\"" } else { "" };
    stroked(&path, colour, &format!("stroke-width=\"1.8\" stroke-linejoin=\"round\"{dashes}"), out);
}

fn stroked(path: &str, colour: usize, more: &str, out: &mut String) {
    if !path.is_empty() {
        let (index, colour) = of_palette(colour);
        let _ = write!(out, "<path class=\"s{index}\" d=\"{path}\" stroke=\"{colour}\" fill=\"none\" {more}/>");
    }
}

fn filled(path: &str, colour: usize, more: &str, any: bool, out: &mut String) {
    if any {
        let (index, colour) = of_palette(colour);
        let _ = write!(out, "<path class=\"f{index}\" d=\"{path}\" fill=\"{colour}\" {more}/>");
    }
}

fn of_palette(colour: usize) -> (usize, &'static str) {
    let index = colour % PALETTE.len();
    (index, PALETTE[index])
}

fn swatch(series: &Series, x: f64, baseline: f64, out: &mut String) {
    let (y, middle) = (baseline - 4.0, x + SWATCH_PX / 2.0);
    match &series.shape {
        Shape::Points(mark, _) => marks(*mark, std::iter::once((middle, y)), series.colour, out),
        Shape::Line(stroke, _) => {
            line(*stroke, [Some((x, y)), Some((x + SWATCH_PX, y))].into_iter(), series.colour, out)
        }
        Shape::ErrorBars(_) => {
            let path = format!("M{} {}h6m-3 0V{}m-3 0h6", px(middle - 3.0), px(y + 6.0), px(y - 6.0));
            stroked(&path, series.colour, "stroke-width=\"1.2\"", out);
            marks(Mark::Dot, std::iter::once((middle, y)), series.colour, out);
        }
        Shape::Level(_) => {
            let path = format!("M{} {}h{SWATCH_PX}", px(x), px(y));
            stroked(&path, series.colour, "stroke-width=\"1.4\" stroke-dasharray=\"2 3\"", out);
        }
        Shape::Band(_) | Shape::Bars(_) => {
            let path = format!("M{} {}h{SWATCH_PX}v10h-{SWATCH_PX}Z", px(x), px(y - 5.0));
            filled(&path, series.colour, "fill-opacity=\"0.3\"", true, out);
        }
    }
}

/// The plot's rectangle in CSS pixels, its ranges, and the points of each series by name.
pub(super) fn data(figure: &Figure) -> Value {
    let layout = Layout::of(figure);
    let short = |value: f64| format!("{value:.5e}").parse::<f64>().unwrap_or(value);
    let finite = |points: Vec<[f64; 2]>| -> Vec<[f64; 2]> {
        let drawn = points.into_iter().filter(|[x, y]| drawable(*x) && drawable(*y));
        drawn.map(|point| point.map(short)).collect()
    };
    let series: Vec<Value> = (figure.series.iter())
        .map(|series| (series, finite(series.told())))
        .filter(|(_, points)| !points.is_empty())
        .map(|(series, points)| json!({ "name": series.name, "points": points }))
        .collect();
    json!({
        "plot": [layout.left, layout.top, layout.width, layout.height],
        "x": { "caption": figure.x.caption(), "range": [layout.x.0, layout.x.1] },
        "y": { "caption": figure.y.caption(), "range": [layout.y.0, layout.y.1] },
        "series": series,
    })
}

/// A coordinate to a tenth of a pixel, without a needless `.0`.
pub(super) fn px(value: f64) -> String {
    let text = format!("{value:.1}");
    match text.strip_suffix(".0") {
        Some("-0") => "0".to_owned(),
        Some(whole) => whole.to_owned(),
        None => text,
    }
}

/// Text as it may stand between tags and in attributes.
pub(crate) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // Not allowed in XML at all, not even escaped.
            control if control < ' ' && !"\n\t".contains(control) => out.push('\u{fffd}'),
            other => out.push(other),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn coordinates(svg: &str) -> Vec<f64> {
        let paths = svg.split(" d=\"").skip(1).filter_map(|rest| rest.split('"').next());
        paths
            .flat_map(|path| path.split(|c: char| !(c.is_ascii_digit() || c == '.' || c == '-')))
            .filter_map(|n| n.parse().ok())
            .collect()
    }

    #[test]
    fn points_land_where_the_axes_say() {
        let figure =
            Figure::new("a", "b").x("t", "s").y("o", "px").points("p", Mark::Plus, [[0.0, 0.0], [10.0, 100.0]]);
        let layout = Layout::of(&figure);
        let (x, y) = figure.ranges();
        assert!(
            (layout.px(x.0) - layout.left).abs() < 1e-9 && (layout.py(y.0) - layout.top - layout.height).abs() < 1e-9
        );
        assert!(layout.px(5.0) > layout.px(0.0) && layout.py(100.0) < layout.py(0.0));
        let expected = format!("M{} {}h6m-3 -3v6", px(layout.px(10.0) - 3.0), px(layout.py(100.0)));
        assert!(figure.svg().contains(&expected));
    }

    #[test]
    fn hostile_data_draw_something_finite() {
        let odd = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -0.0, 1e308, -1e308, 5e-324, 1.0];
        let pairs: Vec<[f64; 2]> = odd.iter().flat_map(|x| odd.iter().map(move |y| [*x, *y])).collect();
        let triples: Vec<[f64; 3]> = pairs.iter().flat_map(|[x, y]| odd.iter().map(move |z| [*x, *y, *z])).collect();
        let bars: Vec<[f64; 4]> =
            triples.iter().flat_map(|[x, y, z]| odd.iter().map(move |high| [*x, *y, *z, *high])).collect();
        let figures = [
            Figure::new("empty", ""),
            Figure::new("none", "")
                .points("p", Mark::Dot, [])
                .line("l", Stroke::Solid, [])
                .band("b", [])
                .error_bars("e", []),
            Figure::new("odd", "<&\"\u{1}").points("p", Mark::Cross, pairs.clone()).line("<", Stroke::Dashed, pairs),
            Figure::new("odd", "").error_bars("e", bars).band("b", triples).level("l", f64::NAN),
            Figure::new("range", "").y_range(f64::NAN, 1.0).x_range(3.0, 3.0).points("p", Mark::Dot, [[1.0, 1.0]]),
            Figure::new("bars", "").rows([("a", vec![[0.0, f64::NAN], [1.0, 2.0]]), ("b", vec![])]),
        ];
        for figure in figures {
            let svg = figure.svg();
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
            assert!(!svg.contains('\u{1}') && !svg.contains("<<"));
            assert!(coordinates(&svg).iter().all(|value| value.abs() <= 4.1e4), "{svg}");
            assert_eq!(svg.matches("<svg").count(), svg.matches("</svg>").count());
        }
        assert!(Figure::new("empty", "").svg().contains("no data"));
    }

    #[test]
    fn a_line_breaks_where_a_value_is_missing() {
        let whole = Figure::new("a", "").line("", Stroke::Solid, [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 3.0]]);
        let gap = Figure::new("a", "").line("", Stroke::Solid, [[0.0, 0.0], [1.0, 1.0], [2.0, f64::NAN], [3.0, 3.0]]);
        let strokes = |figure: &Figure| {
            let svg = figure.svg();
            let path = svg.split("class=\"s0\" d=\"").nth(1).and_then(|rest| rest.split('"').next()).map(str::to_owned);
            path.map(|path| path.matches('M').count())
        };
        assert_eq!((strokes(&whole), strokes(&gap)), (Some(1), Some(2)));
    }

    #[test]
    fn a_series_without_points_is_not_in_the_legend() {
        let figure =
            Figure::new("a", "b").points("none", Mark::Dot, []).line("some", Stroke::Solid, [[0.0, 1.0], [1.0, 2.0]]);
        assert!(!figure.svg().contains("none</text>") && figure.svg().contains("some</text>"));
    }

    #[test]
    fn every_named_series_is_in_the_legend_inside_the_figure() {
        let mut figure = Figure::new("a", "b").size(300, 200);
        for i in 0..9 {
            figure = figure.level(&format!("a series with a name {i}"), f64::from(i));
        }
        let layout = Layout::of(&figure);
        assert_eq!(layout.legend.len(), 9);
        assert!(layout.legend.iter().all(|(_, x, _)| *x < 300.0));
        assert!(layout.legend.iter().all(|(_, _, y)| *y < layout.top));
    }
}
