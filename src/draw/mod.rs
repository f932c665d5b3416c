//! Drawing: figures as SVG text, with no fonts, no display and nothing to install.
//!
//! Colours are the eight of Okabe and Ito (2008), which people with any form of colour blindness can
//! tell apart; they are given as attributes, so that a page's style sheet may override them (the
//! report does at night).

pub mod axis;
pub mod blind;
pub mod chapter3;
pub mod chapter4;
pub mod chapter5;
pub mod figure;
pub mod map;
pub mod picture;
pub(crate) mod svg;
pub mod walk;

pub use figure::{Figure, Mark, Stroke};
pub use picture::Picture;
pub(crate) use svg::escape;

/// Text that is not a series: titles, labels, ticks.
pub const INK: &str = "#1b1f24";
/// Axes, captions of axes, reference lines.
pub const FAINT: &str = "#6b7280";
/// Grid lines.
pub const GRID: &str = "#e3e6ea";

/// Series colours in the order of use: Okabe and Ito's, without black and yellow.
pub const PALETTE: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];
