//! One HTML file that says what was asked, what came out and how it was made: style, script, figures
//! and data are all inside, so that it opens offline and can be mailed, archived or printed.

pub mod blind;
pub mod both_at_once;
pub mod car;
pub mod chapter4;
pub mod diagnosis;
pub mod exhibits;
mod html;
pub mod one_at_a_time;
pub mod plane;
pub mod scans;
pub mod stride;
pub mod sweep;
pub mod table;

use std::io;
use std::path::{Path, PathBuf};

use crate::draw::map::Map;
use crate::draw::svg::standalone;
use crate::draw::walk::Strip;
use crate::draw::{Figure, Picture};

pub use table::{Cell, Row, RowKind, Table};

/// A report could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write the report {path}: {source}")]
pub struct CannotWrite {
    /// Where to.
    pub path: PathBuf,
    /// What the system said.
    pub source: io::Error,
}

/// Something drawn, as a report shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Plate {
    name: String,
    caption: String,
    inline_svg: String,
    width_px: u32,
    data: Option<serde_json::Value>,
}

impl Plate {
    /// Whether it takes a row of the page for itself.
    #[must_use]
    pub fn is_wide(&self) -> bool {
        self.width_px > 700
    }

    /// What is drawn, as a file of its own.
    #[must_use]
    pub fn svg(&self) -> String {
        standalone(&self.inline_svg)
    }
}

impl From<&Figure> for Plate {
    fn from(figure: &Figure) -> Self {
        let (name, caption) = (figure.name.clone(), figure.caption.clone());
        Self { name, caption, inline_svg: figure.inline_svg(), width_px: figure.size.0, data: Some(figure.data()) }
    }
}

impl From<&Picture> for Plate {
    fn from(picture: &Picture) -> Self {
        let (name, caption) = (picture.name.clone(), picture.caption.clone());
        Self { name, caption, inline_svg: picture.inline_svg(), width_px: picture.shown_width_px(), data: None }
    }
}

impl From<&Strip> for Plate {
    fn from(strip: &Strip) -> Self {
        let (name, caption) = (strip.name.clone(), strip.caption.clone());
        Self { name, caption, inline_svg: strip.inline_svg(), width_px: Strip::WIDTH_PX, data: None }
    }
}

impl From<&Map> for Plate {
    fn from(map: &Map) -> Self {
        let (name, caption) = (map.name.clone(), map.caption.clone());
        Self { name, caption, inline_svg: map.inline_svg(), width_px: Map::WIDTH_PX, data: None }
    }
}

#[derive(Clone, Debug)]
enum Block {
    Text(String),
    Lines(String),
    Table(Table),
    Plates(Vec<Plate>),
}

/// A part of a report under a heading of its own.
#[derive(Clone, Debug)]
pub struct Section {
    title: String,
    blocks: Vec<Block>,
    folded: bool,
}

impl Section {
    /// A section with nothing in it.
    #[must_use]
    pub fn new(title: &str) -> Self {
        Self { title: title.to_owned(), blocks: Vec::new(), folded: false }
    }

    /// Shows only the heading until a reader opens it: for long tables.
    #[must_use]
    pub fn folded(mut self) -> Self {
        self.folded = true;
        self
    }

    /// Adds a paragraph of plain text; between `backquotes` it is set as code.
    #[must_use]
    pub fn text(mut self, text: impl Into<String>) -> Self {
        self.blocks.push(Block::Text(text.into()));
        self
    }

    /// Adds what a program prints, line by line as it prints it.
    #[must_use]
    pub fn lines(mut self, printed: impl Into<String>) -> Self {
        self.blocks.push(Block::Lines(printed.into()));
        self
    }

    /// Adds a table.
    #[must_use]
    pub fn table(mut self, table: Table) -> Self {
        self.blocks.push(Block::Table(table));
        self
    }

    /// Adds a figure, a picture or a strip.
    #[must_use]
    pub fn figure(mut self, plate: impl Into<Plate>) -> Self {
        self.blocks.push(Block::Plates(vec![plate.into()]));
        self
    }

    /// Adds several beside each other, as far as the page is wide.
    #[must_use]
    pub fn figures(mut self, plates: impl IntoIterator<Item = Plate>) -> Self {
        let plates: Vec<Plate> = plates.into_iter().collect();
        if !plates.is_empty() {
            self.blocks.push(Block::Plates(plates));
        }
        self
    }
}

/// A report, built up by value; [`Report::write`] writes it.
#[derive(Clone, Debug)]
pub struct Report {
    title: String,
    question: String,
    answer: Option<String>,
    as_expected: Option<bool>,
    sections: Vec<Section>,
    footnotes: Vec<String>,
    manifest: Vec<(String, String)>,
}

impl Report {
    /// A report that answers one question.
    #[must_use]
    pub fn new(title: &str, question: &str) -> Self {
        Self {
            title: title.to_owned(),
            question: question.to_owned(),
            answer: None,
            as_expected: None,
            sections: Vec::new(),
            footnotes: Vec::new(),
            manifest: Vec::new(),
        }
    }

    /// Says in a sentence or two what came out.
    #[must_use]
    pub fn answer(mut self, answer: impl Into<String>) -> Self {
        self.answer = Some(answer.into());
        self
    }

    /// Says whether the answer is the expected one; `None` where nothing was expected.
    #[must_use]
    pub fn as_expected(mut self, is_expected: Option<bool>) -> Self {
        self.as_expected = is_expected;
        self
    }

    /// Adds a section.
    #[must_use]
    pub fn section(mut self, section: Section) -> Self {
        self.sections.push(section);
        self
    }

    /// Adds a numbered footnote at the end.
    #[must_use]
    pub fn footnote(mut self, text: impl Into<String>) -> Self {
        self.footnotes.push(text.into());
        self
    }

    /// Adds a line on how the report was made: scenario hash, commit, compiler.
    #[must_use]
    pub fn made_with(mut self, what: impl Into<String>, value: impl Into<String>) -> Self {
        self.manifest.push((what.into(), value.into()));
        self
    }

    /// The whole page.
    #[must_use]
    pub fn html(&self) -> String {
        html::page(self)
    }

    /// Writes the page aside and renames it, so that a reader never opens half a report.
    ///
    /// # Errors
    /// [`CannotWrite`] with what the system said.
    pub fn write(&self, path: &Path) -> Result<(), CannotWrite> {
        let failed = |source| CannotWrite { path: path.to_owned(), source };
        let aside = path.with_extension("html.part");
        std::fs::write(&aside, self.html()).map_err(failed)?;
        std::fs::rename(&aside, path).map_err(failed)
    }
}
