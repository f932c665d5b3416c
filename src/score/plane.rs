//! Chapter 4's models in the plane, as they are.

use asami_dataset::{Dataset, Log, Models};
use asami_learners::em::consistency::nis_in_plane;
use asami_learners::line::Unit;

use super::{HEADS, NotScored, row, verdict};
use crate::scenario::Divergence;
use crate::scorer::plane::Yardstick;

/// As [`table`](super::table).
pub(super) fn table(learner: &str, models: &Models, log: &Log, dataset: &Dataset) -> Result<String, NotScored> {
    let yardstick = Yardstick::of(log, &dataset.truth);
    if yardstick.is_empty() {
        let message = "the data set has no truth about the models: neither velocities and heights in survey.toml \
                       nor a truth.csv that covers the log";
        return Err(NotScored(message.to_owned()));
    }
    let scores = yardstick.score(models);
    if scores.velocity_rmse.is_none() && scores.sensor_rmse.is_none() {
        let message = "nothing to score: models.toml has neither velocities of actions nor a function of the \
                       distance that the data set's truth measures";
        return Err(NotScored(message.to_owned()));
    }
    let ranges = yardstick.velocity_ranges();
    let mut text = HEADS.to_owned();
    let directions = [("v_x", "mm/s", 1e3, 1), ("v_y", "mm/s", 1e3, 1), ("v_theta", "rad/s", 1.0, 4)];
    for (i, (name, unit, factor, digits)) in directions.into_iter().enumerate() {
        let in_unit = |values: Option<[f64; 3]>| values.map(|values| factor * values[i]);
        let r2 = scores.velocity_r2.map(|r2| r2[i]);
        text += &row(name, in_unit(scores.velocity_rmse), digits, unit, in_unit(ranges), r2);
    }
    let (unit, factor) = if yardstick.unit == Unit::RangeM { ("mm", 1e3) } else { ("px", 1.0) };
    let in_unit = |value: Option<f64>| value.map(|value| factor * value);
    text += &row("f", in_unit(scores.sensor_rmse), 3, unit, in_unit(yardstick.size_range()), scores.sensor_r2);
    let pairs = [
        (format!("sigma_1 ({unit})"), in_unit(scores.sigma1), in_unit(yardstick.sigma1)),
        ("sigma_2 (rad)".to_owned(), scores.sigma2_rad, yardstick.sigma2_rad),
    ];
    for (name, learned, truth) in pairs {
        if let (Some(learned), Some(truth)) = (learned, truth) {
            text += &format!("{name}: {learned:.4}, true {truth:.4}\n");
        }
    }
    if let Some([inside, of]) = scores.covered {
        text += &format!("95 % intervals hold {inside} of {of} true velocities\n");
    }
    if let Some(nis) = nis_in_plane(log, models) {
        text += &format!("normalised innovations squared: {nis:.3} (1 where the models know their own noise)\n");
    }
    Ok(text + &verdict(learner, &yardstick.faults(models, &scores, Divergence::default().r2_min)))
}
