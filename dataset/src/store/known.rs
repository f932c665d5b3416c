//! `dataset.toml`: what the robot knows before it moves, and where the data set came from.

use super::error::{ReadError, Wrong};
use super::keys::{Keys, Source};
use super::rule::Rule;
use super::toml_text::{Toml, quoted};
use crate::log::{Beacon, Camera, CommandsAre, Known, RangeBearing, Velodyne};
use crate::truth::Provenance;

const LASERS: usize = 64;
/// What commands may be.
const COMMANDED: [(&str, CommandsAre); 2] = [("told", CommandsAre::Told), ("odometry", CommandsAre::Odometry)];

pub(super) fn parse(source: &Source) -> Result<(Known, Option<Provenance>), ReadError> {
    let root = source.parse()?;
    let mut keys = Keys::of(source, &root);
    let robots = ["aibo", "car", "create", "plain"];
    let robot = keys.word("robot", &robots, "must be one of \"aibo\", \"car\", \"create\", \"plain\"")?.to_owned();
    let nominal = keys.maybe_text("nominal")?;
    let command_rate_hz = keys.maybe_number("command_rate_hz", Rule::Positive)?;
    let word = keys.maybe_word("commands_are", &COMMANDED.map(|it| it.0), "must be \"told\" or \"odometry\"")?;
    let commands_are = COMMANDED.iter().find(|it| Some(it.0) == word).map_or_else(CommandsAre::default, |it| it.1);
    let camera = keys.maybe_table("camera")?.map(camera).transpose()?;
    let range_bearing = keys.maybe_table("range_bearing")?.map(range_bearing).transpose()?;
    if camera.is_some() && range_bearing.is_some() {
        return Err(keys.wrong_at("range_bearing", Wrong::MixedSightings));
    }
    let landmarks = landmarks(&mut keys)?;
    let velodyne = keys.maybe_table("velodyne")?.map(velodyne).transpose()?;
    let full_scale = match keys.maybe_table("full_scale")? {
        Some(table) => table.all_numbers(Rule::Positive)?,
        None => Vec::new(),
    };
    let provenance = keys.maybe_table("provenance")?.map(provenance).transpose()?;
    keys.close()?;
    let known =
        Known { robot, nominal, command_rate_hz, commands_are, camera, range_bearing, landmarks, velodyne, full_scale };
    Ok((known, provenance))
}

fn camera(mut keys: Keys<'_>) -> Result<Camera, ReadError> {
    let camera = Camera {
        width_px: keys.count("width_px")?,
        height_px: keys.count("height_px")?,
        focal_px: keys.number("focal_px", Rule::Positive)?,
        frame_rate_hz: keys.number("frame_rate_hz", Rule::Positive)?,
    };
    keys.close()?;
    Ok(camera)
}

fn range_bearing(mut keys: Keys<'_>) -> Result<RangeBearing, ReadError> {
    let max_range_m = keys.number("max_range_m", Rule::Positive)?;
    let sensor_origin_m = keys.maybe_array("sensor_origin_m", Rule::Finite)?;
    let sensor_origin_m = sensor_origin_m.ok_or_else(|| keys.wrong(Wrong::MissingKey { name: "sensor_origin_m" }))?;
    keys.close()?;
    Ok(RangeBearing { max_range_m, sensor_origin_m })
}

/// In order of id, in whatever order they stand.
fn landmarks(keys: &mut Keys<'_>) -> Result<Vec<Beacon>, ReadError> {
    let mut landmarks = keys.tables("landmarks", |keys| {
        Ok(Beacon {
            id: keys.id("id")?,
            x_m: keys.number("x_m", Rule::Finite)?,
            y_m: keys.number("y_m", Rule::Finite)?,
            height_m: keys.maybe_number("height_m", Rule::Positive)?,
        })
    })?;
    landmarks.sort_by_key(|landmark| landmark.id);
    match landmarks.windows(2).find(|pair| pair[0].id == pair[1].id) {
        Some(pair) => {
            let wrong = Wrong::Twice { name: "landmark ids", found: pair[0].id.to_string() };
            Err(keys.wrong_at("landmarks", wrong))
        }
        None => Ok(landmarks),
    }
}

fn velodyne(mut keys: Keys<'_>) -> Result<Velodyne, ReadError> {
    const ANGLES: &str = "vertical_angles_rad";
    let vertical_angles_rad = keys.numbers(ANGLES, Rule::Elevation)?;
    let found = vertical_angles_rad.len();
    if !(1..=LASERS).contains(&found) {
        return Err(keys.wrong_at(ANGLES, Wrong::Length { name: ANGLES, expected: format!("1 to {LASERS}"), found }));
    }
    if let Some(pair) = vertical_angles_rad.windows(2).find(|pair| pair[0] >= pair[1]) {
        let found = format!("{:?} followed by {:?}", pair[0], pair[1]);
        return Err(keys.wrong_at(ANGLES, Wrong::value(ANGLES, "must increase from laser to laser", &found)));
    }
    let mut places = |key: &'static str| {
        let places = keys.maybe_numbers(key, Rule::Finite)?.unwrap_or_default();
        if places.is_empty() || places.len() == found {
            return Ok(places);
        }
        let expected = format!("{found}, as there are lasers, or no");
        Err(keys.wrong_at(key, Wrong::Length { name: key, expected, found: places.len() }))
    };
    let (left_m, up_m) = (places("left_m")?, places("up_m")?);
    let velodyne = Velodyne {
        left_m,
        up_m,
        vertical_angles_rad,
        firing_rate_hz: keys.number("firing_rate_hz", Rule::Positive)?,
        turn_rate_hz: keys.number("turn_rate_hz", Rule::Positive)?,
        sensor_height_m: keys.number("sensor_height_m", Rule::Finite)?,
    };
    keys.close()?;
    Ok(velodyne)
}

fn provenance(mut keys: Keys<'_>) -> Result<Provenance, ReadError> {
    let provenance = Provenance {
        scenario: keys.text("scenario")?,
        scenario_hash: keys.text("scenario_hash")?,
        seed: keys.seed("seed")?,
        version: keys.text("version")?,
    };
    keys.close()?;
    Ok(provenance)
}

pub(super) fn text(known: &Known, provenance: Option<&Provenance>) -> String {
    let mut toml = Toml::new();
    toml.text("robot", &known.robot);
    if let Some(nominal) = &known.nominal {
        toml.text("nominal", nominal);
    }
    toml.maybe_number("command_rate_hz", known.command_rate_hz);
    if known.commands_are != CommandsAre::default() {
        COMMANDED.iter().filter(|it| it.1 == known.commands_are).for_each(|it| toml.text("commands_are", it.0));
    }
    if let Some(camera) = &known.camera {
        toml.head("[camera]");
        toml.whole("width_px", camera.width_px.into());
        toml.whole("height_px", camera.height_px.into());
        toml.number("focal_px", camera.focal_px);
        toml.number("frame_rate_hz", camera.frame_rate_hz);
    }
    if let Some(sensor) = &known.range_bearing {
        toml.head("[range_bearing]");
        toml.number("max_range_m", sensor.max_range_m);
        toml.numbers("sensor_origin_m", &sensor.sensor_origin_m);
    }
    for landmark in &known.landmarks {
        toml.head("[[landmarks]]");
        toml.whole("id", landmark.id.into());
        toml.number("x_m", landmark.x_m);
        toml.number("y_m", landmark.y_m);
        toml.maybe_number("height_m", landmark.height_m);
    }
    if let Some(velodyne) = &known.velodyne {
        toml.head("[velodyne]");
        toml.numbers("vertical_angles_rad", &velodyne.vertical_angles_rad);
        toml.number("firing_rate_hz", velodyne.firing_rate_hz);
        toml.number("turn_rate_hz", velodyne.turn_rate_hz);
        toml.number("sensor_height_m", velodyne.sensor_height_m);
        for (key, places) in [("left_m", &velodyne.left_m), ("up_m", &velodyne.up_m)] {
            if !places.is_empty() {
                toml.numbers(key, places);
            }
        }
    }
    if !known.full_scale.is_empty() {
        toml.head("[full_scale]");
        for (name, value) in &known.full_scale {
            toml.number(&quoted(name), *value);
        }
    }
    if let Some(provenance) = provenance {
        toml.head("[provenance]");
        toml.text("scenario", &provenance.scenario);
        toml.text("scenario_hash", &provenance.scenario_hash);
        toml.whole("seed", provenance.seed);
        toml.text("version", &provenance.version);
    }
    toml.finish()
}
