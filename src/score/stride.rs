//! Chapter 4's models along a line, after section 4.4.3's scaling.

use asami_dataset::{Dataset, Models};

use super::{HEADS, NotScored, row, verdict};
use crate::scenario::Divergence;
use crate::scorer::stride::Yardstick;

/// As [`table`](super::table).
pub(super) fn table(
    learner: &str,
    models: &Models,
    strides: &[(u16, f64)],
    dataset: &Dataset,
) -> Result<String, NotScored> {
    let survey = dataset.truth.survey.clone().unwrap_or_default();
    let yardstick = Yardstick::surveyed(&survey, strides);
    let scores = yardstick.score(models);
    if scores.action_rmse_m_per_s.is_none() && scores.sensor_rmse_px.is_none() {
        let message = "nothing to score: models.toml has neither velocities of actions nor heights as a function of \
                       the distance that the data set's truth measures";
        return Err(NotScored(message.to_owned()));
    }
    let mm = |metres: Option<f64>| metres.map(|metres| 1e3 * metres);
    let (speeds, heights) = (mm(yardstick.speed_range_m_per_s()), yardstick.height_range_px());
    let mut text = HEADS.to_owned();
    text += &row("action", mm(scores.action_rmse_m_per_s), 1, "mm/s", speeds, scores.action_r2);
    text += &row("sensor", scores.sensor_rmse_px, 3, "px", heights, scores.sensor_r2);
    if let Some(ratio) = scores.scale_ratio() {
        text += &format!("scale ratio |k| |b|: {ratio:.3}\n");
    }
    Ok(text + &verdict(learner, &yardstick.faults(models, &scores, Divergence::default().r2_min)))
}
