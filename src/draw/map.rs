//! A map of cells: shares by row and column, as shades with their numbers.

use std::fmt::Write as _;

use super::svg::{self, escape, px, width_px};
use super::{FAINT, GRID, INK, PALETTE};

/// What stands in a cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Patch {
    /// How dark it is, from 0 to 1.
    pub shade: f64,
    /// What is printed on it; lines apart.
    pub lines: Vec<String>,
    /// What is told when it is pointed at.
    pub hint: String,
}

/// Rows and columns of cells, some of them empty.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Map {
    /// Short name, unique in a report.
    pub name: String,
    /// What is seen, in a few words.
    pub title: String,
    /// What it shows, what is good, what to do about it if it is not.
    pub caption: String,
    /// Names of the columns, from left to right.
    pub columns: Vec<String>,
    /// Names of the rows from the top, each with a cell for each column.
    pub rows: Vec<(String, Vec<Option<Patch>>)>,
}

const CELL_PX: f64 = 40.0;
const TOP_PX: f64 = 56.0;
const WIDEST_COLUMN_PX: f64 = 120.0;
/// Between names that stand side by side.
const GAP_PX: f64 = 6.0;
/// Names that find no room side by side rise at 45 degrees: by this share of their length.
const RISE: f64 = std::f64::consts::FRAC_1_SQRT_2;
const DOTS: &str = "\u{2026}";

impl Map {
    /// Width in CSS pixels.
    pub const WIDTH_PX: u32 = 1120;

    /// The map as an element of an HTML page.
    #[must_use]
    pub fn inline_svg(&self) -> String {
        let frame = self.frame();
        let height = frame.top + CELL_PX * self.rows.len().max(1) as f64 + 6.0;
        let mut out = svg::open(Self::WIDTH_PX, height as u32, &format!("{}: {}", self.name, self.title));
        let title = escape(&self.title);
        let _ = write!(out, "<text class=\"ink\" x=\"0\" y=\"17\" font-weight=\"600\" fill=\"{INK}\">{title}</text>");
        let Frame { left, top, column, is_tilted } = frame;
        for (j, name) in self.columns.iter().enumerate() {
            let middle = left + (j as f64 + 0.5) * column;
            if is_tilted {
                tilted(&mut out, [middle, top - 8.0], name);
            } else {
                text(&mut out, middle, top - 8.0, "middle", "faint", FAINT, name);
            }
        }
        for (i, (name, cells)) in self.rows.iter().enumerate() {
            let top = top + i as f64 * CELL_PX;
            text(&mut out, left - 10.0, top + CELL_PX / 2.0 + 4.0, "end", "ink", INK, &shortened(name, left - 16.0));
            for (j, cell) in cells.iter().enumerate().take(self.columns.len()) {
                patch(&mut out, [left + j as f64 * column, top, column, CELL_PX], cell.as_ref());
            }
        }
        if self.rows.is_empty() {
            text(&mut out, f64::from(Self::WIDTH_PX) / 2.0, TOP_PX + 24.0, "middle", "faint", FAINT, "nothing");
        }
        out.push_str("</svg>");
        out
    }

    /// Where cells begin, and how wide they are.
    fn frame(&self) -> Frame {
        let widest = |names: &mut dyn Iterator<Item = &String>| names.map(|name| width_px(name)).fold(0.0, f64::max);
        let width = f64::from(Self::WIDTH_PX);
        let left = (widest(&mut self.rows.iter().map(|(name, _)| name)) + 16.0).clamp(60.0, 0.55 * width);
        let n = self.columns.len().max(1) as f64;
        let column = ((width - left) / n).min(WIDEST_COLUMN_PX);
        let name = widest(&mut self.columns.iter());
        if name + GAP_PX <= column {
            return Frame { left, top: TOP_PX, column, is_tilted: false };
        }
        // The last name ends where the map does.
        let column = ((width - left - RISE * name) / (n - 0.5)).clamp(1.0, column);
        Frame { left, top: TOP_PX + RISE * name, column, is_tilted: true }
    }
}

/// Where a map's cells are.
struct Frame {
    left: f64,
    top: f64,
    column: f64,
    is_tilted: bool,
}

/// A name that rises from where it begins.
fn tilted(out: &mut String, [x, y]: [f64; 2], name: &str) {
    let (x, y, name) = (px(x), px(y), escape(name));
    let _ = write!(
        out,
        "<text class=\"faint\" x=\"{x}\" y=\"{y}\" transform=\"rotate(-45 {x} {y})\" fill=\"{FAINT}\" \
         pointer-events=\"none\">{name}</text>"
    );
}

fn patch(out: &mut String, [x, y, width, height]: [f64; 4], cell: Option<&Patch>) {
    let (x_px, y_px, w, h) = (px(x + 1.0), px(y + 1.0), px(width - 2.0), px(height - 2.0));
    let _ = write!(
        out,
        "<rect class=\"grid\" x=\"{x_px}\" y=\"{y_px}\" width=\"{w}\" height=\"{h}\" fill=\"none\" stroke=\"{GRID}\"/>"
    );
    let Some(cell) = cell else { return };
    // A cell that is there at all is told from an empty one.
    let shade = if cell.shade.is_finite() { cell.shade.clamp(0.0, 1.0) } else { 0.0 };
    let opacity = 0.12 + 0.6 * shade;
    let _ = write!(
        out,
        "<rect class=\"f1\" x=\"{x_px}\" y=\"{y_px}\" width=\"{w}\" height=\"{h}\" fill=\"{}\" fill-opacity=\"{opacity:.2}\">\
         <title>{}</title></rect>",
        PALETTE[1],
        escape(&cell.hint)
    );
    let first = y + height / 2.0 + 4.0 - 7.0 * (cell.lines.len().saturating_sub(1)) as f64;
    for (k, line) in cell.lines.iter().enumerate() {
        text(out, x + width / 2.0, first + 14.0 * k as f64, "middle", "ink", INK, line);
    }
}

fn text(out: &mut String, x: f64, y: f64, anchor: &str, class: &str, colour: &str, text: &str) {
    let (x, y, text) = (px(x), px(y), escape(text));
    let _ = write!(
        out,
        "<text class=\"{class}\" x=\"{x}\" y=\"{y}\" text-anchor=\"{anchor}\" fill=\"{colour}\" pointer-events=\"none\">{text}</text>"
    );
}

/// A text no wider than this, with dots for what is left out.
fn shortened(text: &str, most_px: f64) -> String {
    if width_px(text) <= most_px {
        return text.to_owned();
    }
    let mut short: String = text.to_owned();
    while short.pop().is_some() && width_px(&short) + width_px(DOTS) > most_px {}
    short + DOTS
}

#[cfg(test)]
mod tests {
    use super::*;

    fn opacities(svg: &str) -> Vec<f64> {
        let after = svg.split("fill-opacity=\"").skip(1).filter_map(|rest| rest.split('"').next());
        after.map(|text| text.parse().unwrap()).collect()
    }

    fn map(shades: &[Option<f64>]) -> Map {
        let cell = |shade: &Option<f64>| {
            shade.map(|shade| Patch { shade, lines: vec!["<1 %".into()], hint: "a \"hint\"".into() })
        };
        Map {
            name: "m".into(),
            columns: shades.iter().map(|_| "forward".into()).collect(),
            rows: vec![("standing & walking".into(), shades.iter().map(cell).collect())],
            ..Map::default()
        }
    }

    #[test]
    fn greater_shares_are_darker_and_empty_cells_have_no_shade() {
        let found = opacities(&map(&[Some(0.1), None, Some(0.7), Some(1.0)]).inline_svg());
        assert_eq!(found.len(), 3);
        assert!(found.is_sorted_by(|a, b| a < b), "{found:?}");
    }

    #[test]
    fn names_are_as_wide_as_there_is_room() {
        assert_eq!(shortened("forward commands", 1000.0), "forward commands");
        for most_px in [20.0, 60.0, 90.0] {
            let short = shortened("forward commands", most_px);
            assert!(short.ends_with(DOTS) && width_px(&short) <= most_px, "{short}");
            assert!(width_px(&short) > most_px - 13.0, "{short}: no letter more would fit");
        }
    }

    /// Names of columns never lie over one another: where there is no room they rise, within the map.
    #[test]
    fn names_of_columns_have_room() {
        for columns in [1, 3, 8, 17, 40] {
            let names = ["forward", "near ranges laser by laser"];
            for name in names {
                let map = Map { columns: vec![name.to_owned(); columns], ..map(&[Some(0.5)]) };
                let Frame { left, top, column, is_tilted } = map.frame();
                let (width, end) = (width_px(name), left + columns as f64 * column);
                assert_eq!(map.inline_svg().matches("rotate(-45").count(), if is_tilted { columns } else { 0 });
                if is_tilted {
                    assert!(end - 0.5 * column + RISE * width <= f64::from(Map::WIDTH_PX) + 1e-9, "{columns} {name}");
                    assert!(top - 8.0 - RISE * width >= 20.0, "a name is in the title");
                } else {
                    assert!(width <= column && end <= f64::from(Map::WIDTH_PX) + 1e-9, "{columns} {name}");
                }
            }
        }
    }

    #[test]
    fn hostile_values_draw_something_finite() {
        for shade in [f64::NAN, f64::INFINITY, -3.0, 1e300] {
            let svg = map(&[Some(shade)]).inline_svg();
            assert!(!svg.contains("NaN") && !svg.contains("inf") && svg.contains("&lt;1 %"), "{svg}");
            assert!(opacities(&svg).iter().all(|it| (0.0..=1.0).contains(it)));
        }
        assert!(Map::default().inline_svg().contains("nothing"));
    }
}
