//! A robot of one's own, in the units and the frame of another house: the table of the docs, and logs made for it.

use asami_dataset::{Action, CommandsAre, Size, store};

use crate::{Source, import, refused_when_broken, said, unspaced, write};

/// The table that the docs show.
fn table() -> String {
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/your-own-log.md")).unwrap();
    let (_, from) = page.split_once("```toml\n").unwrap();
    from.split_once("```").unwrap().0.to_owned()
}

/// A robot that drives along +x at 0.2 m/s from the origin, for 20 s, and sees tags 7 (ahead) and 9 (to its left).
fn source() -> Source {
    let stamp = |n: u32| 1_700_000_000_000_u64 + 100 * u64::from(n);
    let mut wheels = String::from("stamp,speed,yaw_rate,battery\n");
    let mut tags = String::from("stamp,tag,distance,angle\n");
    let mut images = String::from("stamp\n");
    let mut mocap = String::from("stamp,x,y,heading\n");
    for n in 0..200 {
        let x_m = 0.02 * f64::from(n) - 2.5;
        wheels += &format!("{},200,0,{}\n", stamp(n), 100 - n / 4);
        images += &format!("{}\n", stamp(n));
        mocap += &format!("{},{},0,0\n", stamp(n), 1000.0 * x_m);
        // The sensor looks from 0.1 m ahead; clockwise angles of what is to the left are negative.
        let seen_from_m = x_m + 0.1;
        tags += &format!("{},7,{},0\n", stamp(n), 100.0 * (2.0 - seen_from_m));
        if n % 50 == 0 {
            tags += &format!("{},63,120,10\n", stamp(n));
        }
        let (ahead_m, left_m): (f64, f64) = (-seen_from_m, 3.0);
        let angle = -left_m.atan2(ahead_m).to_degrees();
        tags += &format!("{},9,{},{angle}\n", stamp(n), 100.0 * ahead_m.hypot(left_m));
    }
    let files = [("columns.toml", table()), ("wheels.csv", wheels), ("tags.csv", tags)];
    files.into_iter().chain([("images.csv", images), ("mocap.csv", mocap)]).collect()
}

#[test]
fn units_clocks_and_frames_become_ours() {
    let dir = tempfile::tempdir().unwrap();
    write(&source(), dir.path());
    let run = import("csv", dir.path(), None, &dir.path().join("set"));
    assert!(run.status.success(), "{run:?}");
    let said = said(&run);
    for sentence in [
        "the clock is set to 0 at the first, 1700000000 s",
        "commands at 10.000 Hz",
        "400 sightings of 2 landmarks; 4 of what is no landmark, left out",
        "heading 0 faces +x in the source",
    ] {
        assert!(said.contains(&unspaced(sentence)), "{sentence}: {said}");
    }
    let dataset = store::read(&dir.path().join("set")).unwrap();
    let log = &dataset.log;
    assert_eq!((log.known.landmarks.len(), log.frames.as_ref().unwrap().len()), (2, 200));
    let sensor = log.known.range_bearing.unwrap();
    assert_eq!((sensor.max_range_m, sensor.sensor_origin_m), (6.0, [0.0, 0.1]));
    let speeds = log.commands.iter().all(|it| {
        matches!(it.action, Action::Wheels { v_m_per_s, omega_rad_per_s, .. } if (v_m_per_s - 0.2).abs() < 1e-12 && omega_rad_per_s == 0.0)
    });
    assert!(speeds);
    // Where each tag is seen, by the true pose in our frame, is where it stands.
    for seen in log.sightings.iter() {
        let pose = dataset.truth.track.iter().find(|pose| (pose.t_s - seen.t_s).abs() < 1e-6).unwrap();
        let beacon = log.known.landmarks.iter().find(|it| it.id == seen.landmark).unwrap();
        // Our headings: 0 faces +y, counter-clockwise.
        let (sin, cos) = pose.theta_rad.sin_cos();
        let at = [pose.x_m - 0.1 * sin, pose.y_m + 0.1 * cos];
        let towards = pose.theta_rad + seen.bearing_rad;
        let Size::RangeM(range_m) = seen.size else { panic!("{seen:?}") };
        let found = [at[0] - range_m * towards.sin(), at[1] + range_m * towards.cos()];
        assert!((found[0] - beacon.x_m).abs() < 1e-6 && (found[1] - beacon.y_m).abs() < 1e-6, "{found:?} {beacon:?}");
    }
}

/// The table as the docs show it, with the line that they leave out.
#[test]
fn odometry_may_stand_in_for_commands() {
    let dir = tempfile::tempdir().unwrap();
    let mut files = source();
    files.insert("columns.toml", table().replace("# are = ", "are = "));
    write(&files, dir.path());
    let run = import("csv", dir.path(), None, &dir.path().join("set"));
    assert!(said(&run).contains(&unspaced("the wheels' speeds stand in for the command")), "{run:?}");
    assert_eq!(store::read(&dir.path().join("set")).unwrap().log.known.commands_are, CommandsAre::Odometry);
}

#[test]
fn what_is_wrong_is_refused_in_words() {
    refused_when_broken(
        "csv",
        &source(),
        None,
        &[
            [
                "columns.toml",
                "unit = \"mm/s\"",
                "unit = \"mm\"",
                "the unit of column speed must be one of m/s, cm/s, mm/s, km/h, not \"mm\"",
            ],
            ["columns.toml", "column = \"speed\"", "column = \"v\"", "wheels.csv:1: the header must have a column v"],
            ["columns.toml", "max_range_m = 6.0", "max_rang_m = 6.0", "unknown field `max_rang_m`"],
            ["columns.toml", "max_range_m = 6.0", "max_range_m = -6.0", "max_range_m must be greater than 0, not -6"],
            ["columns.toml", "[0.0, 0.10]", "[0.0, inf]", "sensor_origin_m must be two finite numbers, not [0.0, inf]"],
            [
                "columns.toml",
                "# are = \"odometry\"",
                "are = \"wishes\"",
                "unknown variant `wishes`, expected `told` or `odometry`",
            ],
            ["columns.toml", "id = 9", "id = 7", "landmark 7 must be there once, not twice"],
            ["columns.toml", "x_m = 2.0", "x_m = nan", "landmark 7 must stand somewhere"],
            ["columns.toml", "file = \"mocap.csv\"", "file = \"vicon.csv\"", "vicon.csv: no such file or folder"],
            [
                "columns.toml",
                "column = \"angle\", unit = \"deg\"",
                "column = \"angle\", unit = \"rad\"",
                "is the column in degrees?",
            ],
            [
                "wheels.csv",
                "1700000000200,200",
                "1700000000200,fast",
                "wheels.csv:4: speed must be a finite number or empty, not fast",
            ],
            ["wheels.csv", "1700000000200,200", "1700000000100,200", "wheels.csv:4: stamp must increase"],
            [
                "wheels.csv",
                "1700000000200,200",
                "1700000000200,",
                "wheels.csv:4: speed must be a finite number, not empty",
            ],
            ["tags.csv", "1700000000100,7", "1700000000100,7.5", "tags.csv:5: tag must be a whole number"],
        ],
    );
}

#[test]
fn a_folder_without_a_table_is_told_what_it_lacks() {
    let dir = tempfile::tempdir().unwrap();
    crate::refused("csv", dir.path(), None, "columns.toml says which column of which file holds what");
}

/// What the table may leave out: the sensor's reach, frames and truth.
#[test]
fn commands_and_sightings_are_enough() {
    let dir = tempfile::tempdir().unwrap();
    let mut files = source();
    let text = table().replace("max_range_m = 6.0", "");
    let (before, from) = text.split_once("[frames]").unwrap();
    let (_, landmarks) = from.split_once("[[landmarks]]").unwrap();
    files.insert("columns.toml", format!("{before}\n[[landmarks]]{landmarks}"));
    write(&files, dir.path());
    let run = import("csv", dir.path(), None, &dir.path().join("set"));
    assert!(run.status.success(), "{run:?}");
    assert!(said(&run).contains(&unspaced("the sensor's reach is the longest range in the log")));
    assert_eq!(store::read(&dir.path().join("set")).unwrap().log.known.commands_are, CommandsAre::Told);
    let dataset = store::read(&dir.path().join("set")).unwrap();
    assert!(dataset.log.frames.is_none() && dataset.truth.track.is_empty());
    assert_eq!(dataset.log.sightings.len(), 400);
}
