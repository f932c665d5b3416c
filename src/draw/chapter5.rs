//! Figures 5.3 to 5.5 of Stronger (2008): learned angles of the lasers, speed and yaw rate of the action model.

use super::{Figure, Mark, Stroke};

/// Figure 5.3: true and learned angles in degrees, by laser from 0 in order of vertical angle.
#[must_use]
pub fn angles(name: &str, truth_deg: &[f64], learned_deg: &[f64]) -> Figure {
    let by_laser = |angles: &[f64]| angles.iter().enumerate().map(|(i, angle)| [i as f64, *angle]).collect::<Vec<_>>();
    Figure::new(name, "Angles of the lasers")
        .x("laser, by vertical angle", "")
        .y("horizontal angle", "deg")
        .line("true", Stroke::Solid, by_laser(truth_deg))
        .points("learned", Mark::Plus, by_laser(learned_deg))
        .caption(
            "From the first log, as they are. Good: every mark on the line. Marks that are off by the same are one unit \
             turned on its base; marks that drift away along the axis are errors that a chain of pairs adds up.",
        )
}

/// Figures 5.4 and 5.5: a motion over time as the reference measured it and as action models say, rolled out open-loop
/// from the first speed.
#[must_use]
pub fn rolled(
    name: &str,
    title: &str,
    (label, unit): (&str, &str),
    truth: &[[f64; 2]],
    models: &[(String, Vec<[f64; 2]>)],
) -> Figure {
    let figure =
        Figure::new(name, title).x("time", "s").y(label, unit).size(1120, 360).line("reference", Stroke::Solid, truth);
    let figure =
        models.iter().fold(figure, |figure, (learner, points)| figure.line(learner, Stroke::Dashed, points.as_slice()));
    figure.caption(
        "The first log: what the reference measured, and what learned action models make of the pedals alone. Good: curves \
         that stay together; the error of an earlier speed is carried on.",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_without_data_are_empty_figures() {
        for figure in [angles("a", &[], &[]), rolled("b", "", ("", ""), &[], &[])] {
            assert!(figure.svg().contains("no data"), "{}", figure.name);
        }
    }
}
