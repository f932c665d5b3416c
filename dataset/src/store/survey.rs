//! `survey.toml`: truth about the models.

use std::path::Path;

use super::error::{ReadError, WriteError};
use super::keys::{Keys, Source};
use super::rule::Rule;
use super::toml_text::{Toml, pairs};
use crate::survey::{Height, Speed, Survey, Velocity};

/// Reads a survey.
///
/// # Errors
/// [`ReadError`] where the file is missing or not what the format says.
pub fn read_survey(path: &Path) -> Result<Survey, ReadError> {
    parse(&Source::require(path)?)
}

/// Writes a survey; a file of that name is replaced.
///
/// # Errors
/// [`WriteError`] where the file cannot be written, or the survey holds what the format refuses.
pub fn write_survey(survey: &Survey, path: &Path) -> Result<(), WriteError> {
    super::replace(path, &checked_text(survey, path)?)
}

pub(super) fn parse(source: &Source) -> Result<Survey, ReadError> {
    let root = source.parse()?;
    let mut keys = Keys::of(source, &root);
    let survey = Survey {
        speed_by_command: keys.tables("speed_by_command", |keys| {
            Ok(Speed {
                command_m_per_s: keys.number("command_m_per_s", Rule::Finite)?,
                speed_m_per_s: keys.number("speed_m_per_s", Rule::Finite)?,
                sd_m_per_s: keys.number("sd_m_per_s", Rule::NotNegative)?,
                timings: keys.count("timings")?,
            })
        })?,
        height_by_distance: keys.tables("height_by_distance", |keys| {
            Ok(Height {
                distance_m: keys.number("distance_m", Rule::Positive)?,
                height_px: keys.number("height_px", Rule::Positive)?,
                sd_px: keys.number("sd_px", Rule::NotNegative)?,
                bearing_sd_rad: keys.number("bearing_sd_rad", Rule::NotNegative)?,
                readings: keys.count("readings")?,
            })
        })?,
        velocity_by_action: keys.tables("velocity_by_action", |keys| {
            Ok(Velocity {
                action: keys.id("action")?,
                vx_m_per_s: keys.number("vx_m_per_s", Rule::Finite)?,
                vy_m_per_s: keys.number("vy_m_per_s", Rule::Finite)?,
                vtheta_rad_per_s: keys.number("vtheta_rad_per_s", Rule::Finite)?,
            })
        })?,
        sigma1_px: keys.maybe_number("sigma1_px", Rule::NotNegative)?,
        sigma1_m: keys.maybe_number("sigma1_m", Rule::NotNegative)?,
        sigma2_rad: keys.maybe_number("sigma2_rad", Rule::NotNegative)?,
        motion_sd: keys.maybe_array("motion_sd", Rule::NotNegative)?,
        horizontal_angles_rad: keys.maybe_numbers("horizontal_angles_rad", Rule::Finite)?.unwrap_or_default(),
        theta_b_rad: keys.maybe_number("theta_b_rad", Rule::Finite)?,
    };
    keys.close()?;
    Ok(survey)
}

pub(super) fn checked_text(survey: &Survey, path: &Path) -> Result<String, ReadError> {
    let source = Source { file: path.to_owned(), text: text(survey) };
    parse(&source)?;
    Ok(source.text)
}

fn text(survey: &Survey) -> String {
    let mut toml = Toml::new();
    toml.inline_tables("speed_by_command", &survey.speed_by_command, |row| {
        let numbers = pairs(&[
            ("command_m_per_s", row.command_m_per_s),
            ("speed_m_per_s", row.speed_m_per_s),
            ("sd_m_per_s", row.sd_m_per_s),
        ]);
        format!("{numbers}, timings = {}", row.timings)
    });
    toml.inline_tables("height_by_distance", &survey.height_by_distance, |row| {
        let numbers = pairs(&[
            ("distance_m", row.distance_m),
            ("height_px", row.height_px),
            ("sd_px", row.sd_px),
            ("bearing_sd_rad", row.bearing_sd_rad),
        ]);
        format!("{numbers}, readings = {}", row.readings)
    });
    toml.inline_tables("velocity_by_action", &survey.velocity_by_action, |row| {
        let numbers = pairs(&[
            ("vx_m_per_s", row.vx_m_per_s),
            ("vy_m_per_s", row.vy_m_per_s),
            ("vtheta_rad_per_s", row.vtheta_rad_per_s),
        ]);
        format!("action = {}, {numbers}", row.action)
    });
    toml.maybe_number("sigma1_px", survey.sigma1_px);
    toml.maybe_number("sigma1_m", survey.sigma1_m);
    toml.maybe_number("sigma2_rad", survey.sigma2_rad);
    toml.numbers("motion_sd", survey.motion_sd.as_ref().map_or(&[], <[f64; 3]>::as_slice));
    toml.numbers("horizontal_angles_rad", &survey.horizontal_angles_rad);
    toml.maybe_number("theta_b_rad", survey.theta_b_rad);
    toml.finish()
}
