//! The columns of every CSV file of the format.

use super::rule::Rule;
use crate::log::{Action, Command, Frame, Odometry, Sighting, Size};
use crate::truth::TruePose;

/// One column.
pub(super) struct Column {
    pub(super) name: &'static str,
    pub(super) rule: Rule,
    /// Whether the column may be missing and its fields empty.
    pub(super) may: May,
}

/// What a column may lack.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum May {
    /// Nothing.
    Nothing,
    /// Values: a field may be empty.
    BeEmpty,
    /// Values or itself.
    BeAbsent,
}

/// The columns of one kind of file, and how they make a row.
pub(super) struct Table<T: 'static> {
    pub(super) columns: &'static [Column],
    /// Whether further columns of numbers are allowed, and passed over.
    pub(super) open: bool,
    /// Whether several rows may have one time.
    pub(super) repeats: bool,
    /// A row out of the columns' values, in their order.
    pub(super) take: fn(&Fields) -> T,
    /// The columns' values of a row; `None` if the row is of another kind of file.
    pub(super) give: fn(&T) -> Option<Vec<Option<f64>>>,
}

/// The values of one row, checked: a column that must have a value has one.
pub(super) struct Fields<'a>(pub(super) &'a [Option<f64>]);

impl Fields<'_> {
    fn maybe(&self, i: usize) -> Option<f64> {
        self.0.get(i).copied().flatten()
    }

    fn number(&self, i: usize) -> f64 {
        self.maybe(i).unwrap_or_default()
    }

    fn id(&self, i: usize) -> u16 {
        self.number(i) as u16
    }
}

const fn column(name: &'static str, rule: Rule) -> Column {
    Column { name, rule, may: May::Nothing }
}

const TIME: Column = column("t_s", Rule::Finite);

pub(super) static LEGS: Table<Command> = Table {
    columns: &[
        TIME,
        Column { name: "action", rule: Rule::Id, may: May::BeEmpty },
        column("ax_m_per_s", Rule::Finite),
        column("ay_m_per_s", Rule::Finite),
        column("atheta_rad_per_s", Rule::Finite),
    ],
    open: false,
    repeats: false,
    take: |f| Command {
        t_s: f.number(0),
        action: Action::Legs {
            id: f.maybe(1).map(|id| id as u16),
            ax_m_per_s: f.number(2),
            ay_m_per_s: f.number(3),
            atheta_rad_per_s: f.number(4),
        },
    },
    give: |row| match row.action {
        Action::Legs { id, ax_m_per_s, ay_m_per_s, atheta_rad_per_s } => {
            Some(vec![Some(row.t_s), id.map(f64::from), Some(ax_m_per_s), Some(ay_m_per_s), Some(atheta_rad_per_s)])
        }
        _ => None,
    },
};

pub(super) static PEDALS: Table<Command> = Table {
    columns: &[TIME, column("throttle", Rule::Share), column("brake", Rule::Share), column("steering", Rule::Either)],
    open: false,
    repeats: false,
    take: |f| Command {
        t_s: f.number(0),
        action: Action::Pedals { throttle: f.number(1), brake: f.number(2), steering: f.number(3) },
    },
    give: |row| match row.action {
        Action::Pedals { throttle, brake, steering } => {
            Some(vec![Some(row.t_s), Some(throttle), Some(brake), Some(steering)])
        }
        _ => None,
    },
};

pub(super) static WHEELS: Table<Command> = Table {
    columns: &[
        TIME,
        Column { name: "action", rule: Rule::Id, may: May::BeAbsent },
        column("v_m_per_s", Rule::Finite),
        column("omega_rad_per_s", Rule::Finite),
    ],
    open: false,
    repeats: false,
    take: |f| Command {
        t_s: f.number(0),
        action: Action::Wheels {
            id: f.maybe(1).map(|id| id as u16),
            v_m_per_s: f.number(2),
            omega_rad_per_s: f.number(3),
        },
    },
    give: |row| match row.action {
        Action::Wheels { id, v_m_per_s, omega_rad_per_s } => {
            Some(vec![Some(row.t_s), id.map(f64::from), Some(v_m_per_s), Some(omega_rad_per_s)])
        }
        _ => None,
    },
};

pub(super) static ODOMETRY: Table<Odometry> = Table {
    columns: &[TIME, column("v_m_per_s", Rule::Finite), column("omega_rad_per_s", Rule::Finite)],
    open: false,
    repeats: false,
    take: |f| Odometry { t_s: f.number(0), v_m_per_s: f.number(1), omega_rad_per_s: f.number(2) },
    give: |row| Some(vec![Some(row.t_s), Some(row.v_m_per_s), Some(row.omega_rad_per_s)]),
};

pub(super) static FRAMES: Table<Frame> = Table {
    columns: &[TIME, column("head_pan_rad", Rule::Angle)],
    open: false,
    repeats: false,
    take: |f| Frame { t_s: f.number(0), head_pan_rad: f.number(1) },
    give: |row| Some(vec![Some(row.t_s), Some(row.head_pan_rad)]),
};

pub(super) static HEIGHTS: Table<Sighting> = Table {
    columns: &sighting("height_px"),
    open: false,
    repeats: true,
    take: |f| seen(f, Size::HeightPx),
    give: |row| match row.size {
        Size::HeightPx(height_px) => Some(sighted(row, height_px)),
        Size::RangeM(_) => None,
    },
};

pub(super) static RANGES: Table<Sighting> = Table {
    columns: &sighting("range_m"),
    open: false,
    repeats: true,
    take: |f| seen(f, Size::RangeM),
    give: |row| match row.size {
        Size::RangeM(range_m) => Some(sighted(row, range_m)),
        Size::HeightPx(_) => None,
    },
};

/// The columns of sightings, whose size is told by the column `size`.
const fn sighting(size: &'static str) -> [Column; 4] {
    [TIME, column("landmark", Rule::Id), column(size, Rule::Positive), column("bearing_rad", Rule::Angle)]
}

fn seen(f: &Fields, size: fn(f64) -> Size) -> Sighting {
    Sighting { t_s: f.number(0), landmark: f.id(1), size: size(f.number(2)), bearing_rad: f.number(3) }
}

fn sighted(row: &Sighting, size: f64) -> Vec<Option<f64>> {
    vec![Some(row.t_s), Some(f64::from(row.landmark)), Some(size), Some(row.bearing_rad)]
}

pub(super) static TRUTH: Table<TruePose> = Table {
    columns: &[
        TIME,
        column("x_m", Rule::Finite),
        column("y_m", Rule::Finite),
        column("theta_rad", Rule::Angle),
        Column { name: "v_m_per_s", rule: Rule::Finite, may: May::BeAbsent },
    ],
    open: true,
    repeats: false,
    take: |f| TruePose {
        t_s: f.number(0),
        x_m: f.number(1),
        y_m: f.number(2),
        theta_rad: f.number(3),
        v_m_per_s: f.maybe(4),
    },
    give: |row| Some(vec![Some(row.t_s), Some(row.x_m), Some(row.y_m), Some(row.theta_rad), row.v_m_per_s]),
};
