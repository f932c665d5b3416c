//! The table of section 4.4.3.

use crate::sweep::table::{Plan, column};

/// One: before, after and across.
pub const TABLE: Plan = Plan {
    name: "table_4_1d",
    title: "One dimension",
    caption: "Models learned before or after the robot changed, against the truth before or after: median over the \
              trials that converged, in brackets mean \u{b1} standard deviation. Actions are scored as k A(c), sensors as \
              f(a + b d), with the k, a and b that fit best; the scale ratio |k| |b| is 1 where both models have one \
              unit of length. Good: small errors and a ratio near 1 against the truth of the own era; across, about \
              3/4 and 4/3, since the motors weakened to 3/4.",
    columns: &[
        column("action_rmse_mm_per_s", "action (mm/s)", 2),
        column("action_percent", "% of range", 2),
        column("sensor_rmse_px", "sensor (px)", 3),
        column("sensor_percent", "% of range", 2),
        column("scale_ratio", "scale ratio", 3),
        column("scale_off", "off 1", 3),
        column("iterations", "iterations", 0),
    ],
    start: None,
};
