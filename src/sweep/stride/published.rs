//! What section 4.4.3 prints: D. Stronger, *Autonomous Sensor and Action Model Learning for Mobile
//! Robots*, University of Texas at Austin, 2008.

use crate::scenario::{Era, Start};
use crate::sweep::table::Published;

const EM: Published = Published {
    learner: "em_1d_published",
    start: Some(Start::Published),
    era: Some(Era::Before),
    truth: Some(Era::Before),
    values: &[],
    place: "section 4.4.3",
};

/// Of a robot that `changes`, both eras' models against the truth of either era; else those of the first eight minutes.
#[must_use]
pub fn section_4_4_3(changes: bool) -> &'static [Published] {
    if changes { SECTION_4_4_3 } else { &SECTION_4_4_3[..1] }
}

/// Both models against the truth of their own era, then across.
const SECTION_4_4_3: &[Published] = &[
    Published {
        values: &[
            ("action_rmse_mm_per_s", 22.1),
            ("action_percent", 2.80),
            ("sensor_rmse_px", 0.83),
            ("sensor_percent", 2.52),
            ("scale_ratio", 0.91),
            ("iterations", 639.0),
        ],
        ..EM
    },
    Published {
        era: Some(Era::After),
        truth: Some(Era::After),
        values: &[
            ("action_rmse_mm_per_s", 16.53),
            ("action_percent", 2.78),
            ("sensor_rmse_px", 0.72),
            ("sensor_percent", 2.18),
            ("scale_ratio", 1.03),
            ("iterations", 2906.0),
        ],
        ..EM
    },
    Published { truth: Some(Era::After), values: &[("action_rmse_mm_per_s", 33.9), ("scale_ratio", 0.65)], ..EM },
    Published {
        era: Some(Era::After),
        values: &[("action_rmse_mm_per_s", 43.3), ("action_percent", 5.48), ("scale_ratio", 1.42)],
        ..EM
    },
];
