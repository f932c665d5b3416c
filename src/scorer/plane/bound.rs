//! The least that an unbiased learner can err, given a log (Cramer and Rao).

use asami_dataset::models::Entry;
use asami_dataset::{ActionModel, Log, Models, Noise, Seed, Survey};
use asami_learners::em::{Em, Expectation, Outliers};

use super::Yardstick;

/// The models as they are, where the truth has all of them: velocities, noise of sightings and of motion; f is the
/// best cubic.
fn truth(yardstick: &Yardstick, survey: &Survey) -> Option<Models> {
    let entry = |velocity: &asami_dataset::survey::Velocity| Entry {
        action: velocity.action,
        vx_m_per_s: velocity.vx_m_per_s,
        vy_m_per_s: velocity.vy_m_per_s,
        vtheta_rad_per_s: velocity.vtheta_rad_per_s,
        se: None,
    };
    let noise = Noise {
        sigma1_px: Some(survey.sigma1_px?),
        sigma2_rad: Some(survey.sigma2_rad?),
        motion_sd: Some(survey.motion_sd?),
        ..Noise::default()
    };
    let action = Some(ActionModel::Table(survey.velocity_by_action.iter().map(entry).collect()));
    Some(Models { action, sensor: Some(yardstick.best_sensor(3)?), noise })
}

/// Root mean squares of the velocities' standard errors: the Fisher information of the log's innovations,
/// linearised about the trajectory smoothed with the true models. f is learned with the velocities, the noise is
/// known. `None` where the truth does not have all models.
#[must_use]
pub fn bound(yardstick: &Yardstick, log: &Log, survey: &Survey) -> Option<[f64; 3]> {
    let models = truth(yardstick, survey)?;
    // One E-step at the truth: no parameter moves, errors are computed.
    let em =
        Em { expectation: Expectation::Rts, exact: true, outliers: Outliers::None, max_iterations: 1, ..Em::default() };
    let learned = em.in_plane(log, &models, &mut Seed(0).stream("bound")).ok()?;
    let Some(ActionModel::Table(entries)) = learned.models.action else { return None };
    let errors: Option<Vec<[f64; 3]>> = entries.iter().map(|entry| entry.se).collect();
    let errors = errors.filter(|errors| !errors.is_empty())?;
    let rms = |i: usize| (errors.iter().map(|se| se[i] * se[i]).sum::<f64>() / errors.len() as f64).sqrt();
    Some([rms(0), rms(1), rms(2)])
}
