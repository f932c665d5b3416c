//! `models.toml`: what a learner learned. Any program may write one and have it scored.
//!
//! Beside the kinds of the format's description, an action model may be of kind `sign`: Table 3.1's
//! second starting model as it is. `centre` is 0 and `scale` 1 where they are not given.

use std::path::Path;

use super::error::{ReadError, WriteError, Wrong};
use super::keys::{Keys, Source};
use super::rule::Rule;
use super::toml_text::{Toml, list, pairs};
use crate::models::{ActionModel, Curve, Entry, Models, Noise, NoiseErrors, SensorModel};
use asami_math::polynomial::Polynomial;

/// More coefficients than any model here has.
const MOST_COEFFICIENTS: usize = 64;

/// Reads models, and the name of the learner that learned them.
///
/// # Errors
/// [`ReadError`] where the file is missing or not what the format says.
pub fn read_models(path: &Path) -> Result<(String, Models), ReadError> {
    parse(&Source::require(path)?)
}

/// Writes models with the name of the learner that learned them; a file of that name is replaced.
///
/// # Errors
/// [`WriteError`] where the file cannot be written, or the models hold what the format refuses.
pub fn write_models(learner: &str, models: &Models, path: &Path) -> Result<(), WriteError> {
    let source = Source { file: path.to_owned(), text: text(learner, models) };
    parse(&source)?;
    super::replace(path, &source.text)
}

/// What [`write_models`] would write.
///
/// # Errors
/// Where the models hold what the format refuses.
pub fn models_text(learner: &str, models: &Models) -> Result<String, ReadError> {
    let source = Source { file: "models.toml".into(), text: text(learner, models) };
    parse(&source)?;
    Ok(source.text)
}

/// Reads models out of the text of a `models.toml`.
///
/// # Errors
/// [`ReadError`] where it is not what the format says.
pub fn parse_models(text: String) -> Result<(String, Models), ReadError> {
    parse(&Source { file: "models.toml".into(), text })
}

fn parse(source: &Source) -> Result<(String, Models), ReadError> {
    let root = source.parse()?;
    let mut keys = Keys::of(source, &root);
    let learner = keys.text("learner")?;
    let models = Models {
        action: keys.maybe_table("action")?.map(action).transpose()?,
        sensor: keys.maybe_table("sensor")?.map(sensor).transpose()?,
        noise: keys.maybe_table("noise")?.map(noise).transpose()?.unwrap_or_default(),
    };
    keys.close()?;
    Ok((learner, models))
}

fn action(mut keys: Keys<'_>) -> Result<ActionModel, ReadError> {
    let kinds = ["polynomial", "table", "car", "sign"];
    let model = match keys.word("kind", &kinds, "must be one of \"polynomial\", \"table\", \"car\", \"sign\"")? {
        "polynomial" => ActionModel::Polynomial(curve(&mut keys)?),
        "table" => ActionModel::Table(entries(&mut keys)?),
        "car" => {
            let mut c = [0.0; 6];
            for (value, key) in c.iter_mut().zip(CAR_KEYS) {
                *value = keys.number(key, Rule::Finite)?;
            }
            let se = keys.maybe_array("se", Rule::NotNegative)?;
            ActionModel::Car { c, se, delay_s: keys.number("delay_s", Rule::Finite)? }
        }
        _ => ActionModel::Sign,
    };
    keys.close()?;
    Ok(model)
}

const CAR_KEYS: [&str; 6] = ["c5", "c6", "c7", "c8", "c9", "c10"];

fn entries(keys: &mut Keys<'_>) -> Result<Vec<Entry>, ReadError> {
    let entries = keys.tables("entries", |keys| {
        Ok(Entry {
            action: keys.id("action")?,
            vx_m_per_s: keys.number("vx_m_per_s", Rule::Finite)?,
            vy_m_per_s: keys.number("vy_m_per_s", Rule::Finite)?,
            vtheta_rad_per_s: keys.number("vtheta_rad_per_s", Rule::Finite)?,
            se: keys.maybe_array("se", Rule::NotNegative)?,
        })
    })?;
    let mut seen = std::collections::BTreeSet::new();
    match entries.iter().find(|entry| !seen.insert(entry.action)) {
        Some(entry) => Err(keys.wrong_at("entries", Wrong::Twice { name: "actions", found: entry.action.to_string() })),
        None => Ok(entries),
    }
}

fn sensor(mut keys: Keys<'_>) -> Result<SensorModel, ReadError> {
    let kinds = ["height_of_distance", "distance_of_height", "range_of_distance", "angles"];
    let rule = "must be one of \"height_of_distance\", \"distance_of_height\", \"range_of_distance\", \"angles\"";
    let model = match keys.word("kind", &kinds, rule)? {
        "height_of_distance" => SensorModel::HeightOfDistance(curve(&mut keys)?),
        "distance_of_height" => SensorModel::DistanceOfHeight(curve(&mut keys)?),
        "range_of_distance" => SensorModel::RangeOfDistance(curve(&mut keys)?),
        _ => {
            let horizontal_angles_rad = keys.numbers("horizontal_angles_rad", Rule::Finite)?;
            let se_rad = keys.maybe_numbers("se_rad", Rule::NotNegative)?.unwrap_or_default();
            same_length(&keys, "se_rad", horizontal_angles_rad.len(), se_rad.len())?;
            SensorModel::Angles { horizontal_angles_rad, se_rad }
        }
    };
    keys.close()?;
    Ok(model)
}

fn curve(keys: &mut Keys<'_>) -> Result<Curve, ReadError> {
    let coefficients = keys.numbers("coefficients", Rule::Finite)?;
    let found = coefficients.len();
    if !(1..=MOST_COEFFICIENTS).contains(&found) {
        let expected = format!("1 to {MOST_COEFFICIENTS}");
        return Err(keys.wrong_at("coefficients", Wrong::Length { name: "coefficients", expected, found }));
    }
    let centre = keys.maybe_number("centre", Rule::Finite)?.unwrap_or(0.0);
    let scale = keys.maybe_number("scale", Rule::Finite)?.unwrap_or(1.0);
    if scale == 0.0 {
        return Err(keys.wrong_at("scale", Wrong::value("scale", "must not be 0", "0")));
    }
    let se = keys.maybe_numbers("se", Rule::NotNegative)?.unwrap_or_default();
    same_length(keys, "se", found, se.len())?;
    Ok(Curve { polynomial: Polynomial { coefficients, centre, scale }, se })
}

fn same_length(keys: &Keys<'_>, name: &'static str, expected: usize, found: usize) -> Result<(), ReadError> {
    match found == 0 || found == expected {
        true => Ok(()),
        false => Err(keys.wrong_at(name, Wrong::Length { name, expected: expected.to_string(), found })),
    }
}

fn noise(mut keys: Keys<'_>) -> Result<Noise, ReadError> {
    let noise = Noise {
        sigma1_px: keys.maybe_number("sigma1_px", Rule::NotNegative)?,
        sigma1_m: keys.maybe_number("sigma1_m", Rule::NotNegative)?,
        sigma2_rad: keys.maybe_number("sigma2_rad", Rule::NotNegative)?,
        motion_sd: keys.maybe_array("motion_sd", Rule::NotNegative)?,
        se: NoiseErrors {
            sigma1: keys.maybe_number("sigma1_se", Rule::NotNegative)?,
            sigma2_rad: keys.maybe_number("sigma2_rad_se", Rule::NotNegative)?,
            motion_sd: keys.maybe_array("motion_sd_se", Rule::NotNegative)?,
        },
    };
    keys.close()?;
    Ok(noise)
}

fn text(learner: &str, models: &Models) -> String {
    let mut toml = Toml::new();
    toml.text("learner", learner);
    if let Some(action) = &models.action {
        toml.head("[action]");
        push_action(&mut toml, action);
    }
    if let Some(sensor) = &models.sensor {
        toml.head("[sensor]");
        push_sensor(&mut toml, sensor);
    }
    if models.noise != Noise::default() {
        toml.head("[noise]");
        toml.maybe_number("sigma1_px", models.noise.sigma1_px);
        toml.maybe_number("sigma1_m", models.noise.sigma1_m);
        toml.maybe_number("sigma2_rad", models.noise.sigma2_rad);
        if let Some(motion_sd) = &models.noise.motion_sd {
            toml.numbers("motion_sd", motion_sd);
        }
        let se = &models.noise.se;
        toml.maybe_number("sigma1_se", se.sigma1);
        toml.maybe_number("sigma2_rad_se", se.sigma2_rad);
        if let Some(motion_sd) = &se.motion_sd {
            toml.numbers("motion_sd_se", motion_sd);
        }
    }
    toml.finish()
}

fn push_action(toml: &mut Toml, action: &ActionModel) {
    match action {
        ActionModel::Polynomial(curve) => push_curve(toml, "polynomial", curve),
        ActionModel::Sign => toml.text("kind", "sign"),
        ActionModel::Table(entries) => {
            toml.text("kind", "table");
            toml.inline_tables("entries", entries, |entry| {
                let numbers = pairs(&[
                    ("vx_m_per_s", entry.vx_m_per_s),
                    ("vy_m_per_s", entry.vy_m_per_s),
                    ("vtheta_rad_per_s", entry.vtheta_rad_per_s),
                ]);
                let se = entry.se.map_or(String::new(), |se| format!(", se = {}", list(&se)));
                format!("action = {}, {numbers}{se}", entry.action)
            });
        }
        ActionModel::Car { c, se, delay_s } => {
            toml.text("kind", "car");
            for (key, value) in CAR_KEYS.iter().zip(c) {
                toml.number(key, *value);
            }
            toml.number("delay_s", *delay_s);
            toml.numbers("se", se.as_ref().map_or(&[], |se| se));
        }
    }
}

fn push_sensor(toml: &mut Toml, sensor: &SensorModel) {
    match sensor {
        SensorModel::HeightOfDistance(curve) => push_curve(toml, "height_of_distance", curve),
        SensorModel::DistanceOfHeight(curve) => push_curve(toml, "distance_of_height", curve),
        SensorModel::RangeOfDistance(curve) => push_curve(toml, "range_of_distance", curve),
        SensorModel::Angles { horizontal_angles_rad, se_rad } => {
            toml.text("kind", "angles");
            toml.numbers("horizontal_angles_rad", horizontal_angles_rad);
            toml.numbers("se_rad", se_rad);
        }
    }
}

fn push_curve(toml: &mut Toml, kind: &str, curve: &Curve) {
    toml.text("kind", kind);
    toml.numbers("coefficients", &curve.polynomial.coefficients);
    toml.number("centre", curve.polynomial.centre);
    toml.number("scale", curve.polynomial.scale);
    toml.numbers("se", &curve.se);
}
