//! Columns of motion by which an effect that is in nobody's list may show.

use asami_dataset::{Action, Command};
use asami_math::elementary::sin_cos;

use super::motion::Step;

/// A column: what is added to a motion, step by step, for a weight of 1.
#[derive(Clone, Debug)]
pub struct Flexible {
    /// 0: speed; 1: turning rate.
    pub axis: usize,
    /// The flexible block that it is of.
    pub block: &'static str,
    /// Prior standard deviation of its weight.
    pub unit: f64,
    /// By step.
    pub values: Vec<f64>,
}

/// All columns of a drive.
#[must_use]
pub fn columns(steps: &[Step], commands: &[Command]) -> Vec<Flexible> {
    let each = |of: &dyn Fn(&Step) -> f64| -> Vec<f64> { steps.iter().map(of).collect() };
    let pedals: Vec<[f64; 3]> = steps.iter().map(|step| pedals(commands, step)).collect();
    let of_pedal = |k: usize| pedals.iter().map(|it| it[k]).collect::<Vec<f64>>();
    let moving = each(&|step| f64::from(u8::from(step.v_m_per_s > 0.5)));
    let v = each(&|step| step.v_m_per_s / 5.0);
    let omega = each(&|step| step.omega_rad_per_s);
    let mut heading_rad = -std::f64::consts::FRAC_PI_2;
    let headings: Vec<(f64, f64)> = steps
        .iter()
        .map(|step| {
            heading_rad += step.omega_rad_per_s * step.dt_s;
            sin_cos(heading_rad)
        })
        .collect();
    let times = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).collect::<Vec<f64>>();
    let length_s = steps.last().map_or(1.0, |last| last.t_s - steps[0].t_s).max(1.0);
    let so_far = each(&|step| (step.t_s - steps[0].t_s) / length_s);
    let slope = |of: &dyn Fn(&Step) -> f64, lag: usize| -> Vec<f64> {
        let at = |i: usize| of(&steps[i.min(steps.len() - 1)]);
        let gain = |i: usize| (at(i + 1) - at(i.saturating_sub(1))) / (2.0 * steps[i].dt_s);
        (0..steps.len()).map(|i| if i < lag { 0.0 } else { gain(i - lag) }).collect()
    };
    let (gain, turning) = (&|step: &Step| step.v_m_per_s, &|step: &Step| step.omega_rad_per_s);
    let (sines, cosines): (Vec<f64>, Vec<f64>) = headings.into_iter().unzip();
    let column = |axis, block, unit, values| Flexible { axis, block, unit, values };
    vec![
        column(0, "static_motion", 0.1, moving.clone()),
        column(0, "static_motion", 0.1, v.clone()),
        column(0, "static_motion", 1.0, of_pedal(0)),
        column(0, "static_motion", 1.0, of_pedal(1)),
        column(0, "static_motion", 0.2, times(&moving, &sines)),
        column(0, "static_motion", 0.2, times(&moving, &cosines)),
        column(1, "static_motion", 0.1, omega.clone()),
        column(1, "static_motion", 0.01, v.clone()),
        column(1, "static_motion", 0.1, times(&omega, &v)),
        column(0, "timing", 0.1, slope(gain, 0)),
        column(0, "timing", 0.1, slope(gain, 1)),
        column(1, "timing", 0.1, slope(turning, 0)),
        column(1, "timing", 0.1, slope(turning, 1)),
        column(0, "drift", 0.1, times(&moving, &so_far)),
        column(0, "drift", 1.0, times(&of_pedal(0), &so_far)),
        column(0, "drift", 1.0, times(&of_pedal(1), &so_far)),
        column(1, "drift", 0.1, times(&omega, &so_far)),
    ]
}

/// Throttle, brake and steering in force in the middle of a step.
fn pedals(commands: &[Command], step: &Step) -> [f64; 3] {
    let after = commands.partition_point(|command| command.t_s <= step.t_s + 0.5 * step.dt_s);
    match after.checked_sub(1).map(|i| commands[i].action) {
        Some(Action::Pedals { throttle, brake, steering }) => [throttle, brake, steering],
        _ => [0.0; 3],
    }
}
