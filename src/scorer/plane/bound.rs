//! The least that an unbiased learner can err, given a log (Cramer and Rao).

use asami_dataset::models::Entry;
use asami_dataset::truth::pose_at;
use asami_dataset::{ActionModel, Log, Models, Noise, Survey, Truth};
use asami_learners::batch::plane_bound;

use super::Yardstick;

/// The models as they are, where the truth has all of them: velocities, noise of sightings and of motion; f is the
/// best cubic.
fn models(yardstick: &Yardstick, survey: &Survey) -> Option<Models> {
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

/// Root mean squares of the least standard errors of the velocities, along the true track. `None` where the truth does
/// not have all models.
#[must_use]
pub fn bound(yardstick: &Yardstick, log: &Log, truth: &Truth) -> Option<[f64; 3]> {
    let models = models(yardstick, truth.survey.as_ref()?)?;
    let pose_at = |t_s: f64| pose_at(&truth.track, t_s).map(|pose| [pose.x_m, pose.y_m, pose.theta_rad]);
    Some(plane_bound(log, pose_at, &models).ok()?.velocity_rms())
}
