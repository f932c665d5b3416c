//! The robot among tubes.

use std::f64::consts::{FRAC_PI_2, PI};

use asami::import::barfoot_2d::read;
use asami_dataset::{CommandsAre, Dataset, Size, store};

use crate::{Source, import, real, refused, refused_when_broken, said, unspaced, write};

/// A robot that drives a circle of 1 m about (3, 0), counter-clockwise, and sees two tubes without noise.
fn source() -> Source {
    let mut track =
        String::from("t_s,v_odometry_m_per_s,omega_odometry_rad_per_s,x_true_m,y_true_m,theta_true_rad,truth_valid\n");
    let mut seen = String::from("t_s,landmark,range_m,bearing_rad\n");
    for n in 0..200 {
        let (t_s, along) = (f64::from(n) * 0.1, f64::from(n) * 0.02);
        let (x, y, theta) = (3.0 + along.cos(), along.sin(), along + FRAC_PI_2);
        track += &format!("{t_s:.1},0.2,0.2,{x},{y},{},{}\n", wrapped(theta), u8::from(n != 7));
        for (landmark, [at_x, at_y]) in TUBES.iter().enumerate() {
            let (dx, dy) = (at_x - x - 0.219016 * theta.cos(), at_y - y - 0.219016 * theta.sin());
            seen += &format!("{t_s:.1},{landmark},{},{}\n", dx.hypot(dy), wrapped(dy.atan2(dx) - theta));
        }
    }
    let landmarks = format!("landmark,x_m,y_m\n0,{},{}\n1,{},{}\n", TUBES[0][0], TUBES[0][1], TUBES[1][0], TUBES[1][1]);
    Source::from([("landmarks.csv", landmarks), ("odometry_and_truth.csv", track), ("sightings.csv", seen)])
}

const TUBES: [[f64; 2]; 2] = [[0.0, 2.0], [5.0, -4.0]];

fn wrapped(angle_rad: f64) -> f64 {
    (angle_rad + PI).rem_euclid(2.0 * PI) - PI
}

#[test]
fn a_made_log_becomes_a_data_set_in_our_frame() {
    let dir = tempfile::tempdir().unwrap();
    write(&source(), dir.path());
    let out = dir.path().join("set");
    let run = import("barfoot-2d", dir.path(), None, &out);
    assert!(run.status.success(), "{run:?}");
    for sentence in [
        "stand in for the command",
        "heading 0 faces +x in the source",
        "200 rows over 19.9 s, 1 of them without truth",
        "rows at 10.000 Hz",
        "0.219016 m ahead",
        "sd 0.0000 m",
        "by 0.000 s",
    ] {
        assert!(said(&run).contains(&unspaced(sentence)), "{sentence}: {run:?}");
    }
    let Dataset { log, truth, .. } = store::read(&out).unwrap();
    assert_eq!((log.commands.len(), log.sightings.len(), truth.track.len()), (200, 400, 199));
    assert_eq!(log.frames.unwrap().len(), 200);
    // At the start the robot faces +y: heading 0 here.
    let start = truth.track[0];
    assert!((start.x_m - 4.0).abs() < 1e-9 && start.y_m.abs() < 1e-9 && start.theta_rad.abs() < 1e-9, "{start:?}");
    // The laser sits ahead, at (4, 0.219016): the first tube is to the left and ahead of it.
    let first = log.sightings[0];
    assert_eq!(log.known.range_bearing.unwrap().sensor_origin_m, [0.0, 0.219016]);
    assert_eq!(log.known.commands_are, CommandsAre::Odometry);
    assert!((first.bearing_rad - (4.0f64).atan2(2.0 - 0.219016)).abs() < 1e-9, "{first:?}");
    assert!(matches!(first.size, Size::RangeM(range_m) if (range_m - 4.0f64.hypot(2.0 - 0.219016)).abs() < 1e-9));
}

#[test]
fn broken_sources_are_refused_with_their_line() {
    let cases = [
        ["landmarks.csv", "\n1,", "\n0,", "landmarks.csv:3: landmark must increase, not 0"],
        ["landmarks.csv", "\n1,", "\n1.5,", "landmarks.csv:3: landmark must be a whole number in 0..=65535, not 1.5"],
        ["landmarks.csv", "x_m", "x", "landmarks.csv:1: the header must have a column x_m; it has landmark,x,y_m"],
        ["odometry_and_truth.csv", "\n0.1,", "\n0.0,", "odometry_and_truth.csv:3: t_s must increase, not 0 after 0"],
        ["odometry_and_truth.csv", "\n0.1,0.2", "\n0.1,", "v_odometry_m_per_s must be a finite number, not empty"],
        [
            "odometry_and_truth.csv",
            "0,1.5707963267948966",
            "0,90.0",
            "theta_true_rad must be an angle of at most a turn, 2 pi rad (is the column in degrees?), not 90",
        ],
        ["sightings.csv", "\n0.0,1", "\n0.0,2", "sightings.csv:3: landmark must be one of landmarks.csv, not 2"],
        ["sightings.csv", "\n0.1,0", "\n0.15,0", "t_s must be the time of a row of odometry_and_truth.csv, not 0.15"],
        ["sightings.csv", "\n0.1,0,", "\n0.1,0,-", "sightings.csv:4: range_m must be greater than 0, not -"],
        ["sightings.csv", "\n0.1,0", "\n0.3,0", "sightings.csv:5: t_s must not decrease, not 0.1 after 0.3"],
    ];
    refused_when_broken("barfoot-2d", &source(), None, &cases);
    let dir = tempfile::tempdir().unwrap();
    write(&source(), dir.path());
    refused("barfoot-2d", dir.path(), Some(1), "robot must be left out");
    std::fs::remove_file(dir.path().join("sightings.csv")).unwrap();
    refused("barfoot-2d", dir.path(), None, "sightings.csv: no such file");
    refused("barfoot-2d", dir.path(), None, "Lost in the Woods");
}

#[test]
fn milliseconds_and_millimetres_are_suspected() {
    let dir = tempfile::tempdir().unwrap();
    let mut files = source();
    let thousandfold = |text: &str, column: usize| -> String {
        let line = |(n, line): (usize, &str)| {
            let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
            if n > 0 {
                fields[column] = (fields[column].parse::<f64>().unwrap() * 1000.0).to_string();
            }
            fields.join(",") + "\n"
        };
        text.lines().enumerate().map(line).collect()
    };
    for (file, column) in
        [("odometry_and_truth.csv", 0), ("odometry_and_truth.csv", 1), ("sightings.csv", 0), ("sightings.csv", 2)]
    {
        let text = thousandfold(&files[file], column);
        files.insert(file, text);
    }
    write(&files, dir.path());
    let notes = read(dir.path()).unwrap().notes.join("\n");
    for hint in ["times milliseconds", "wheel speeds exceed 200 m/s", "half of the ranges exceed"] {
        assert!(notes.contains(hint), "{hint}: {notes}");
    }
}

#[test]
fn the_real_log_is_read_whole() {
    let Some(source) = real("barfoot_2d") else { return };
    let imported = read(&source).unwrap();
    let Dataset { log, truth, .. } = &imported.dataset;
    assert_eq!((log.commands.len(), log.sightings.len(), truth.track.len()), (6300, 31280, 6128));
    assert!(!imported.notes.join("\n").contains("look like depths"), "a laser measures ranges");
    let dir = tempfile::tempdir().unwrap();
    store::write(&imported.dataset, dir.path()).unwrap();
    assert_eq!(store::read(dir.path()).unwrap(), imported.dataset);

    // The data set's documentation gives the variances over twice as long a log.
    let survey = truth.survey.as_ref().unwrap();
    let (sigma1_m, sigma2_rad) = (survey.sigma1_m.unwrap(), survey.sigma2_rad.unwrap());
    assert!((0.75..1.25).contains(&(sigma1_m.powi(2) / 9.0e-4)), "{sigma1_m}");
    assert!((0.75..1.25).contains(&(sigma2_rad.powi(2) / 6.71e-4)), "{sigma2_rad}");
}
