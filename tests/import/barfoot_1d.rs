//! The robot on a rail: a small source made here, and the real log where it is at hand.

use std::io::Write;

use asami::import::barfoot_1d::read;
use asami::scorer::line::Yardstick;
use asami_dataset::store;
use asami_math::polynomial::Polynomial;

use crate::{import, real, said, unspaced};

/// A robot that goes to and fro in front of the cylinder, seen perfectly.
fn source() -> String {
    let mut text = String::from("t_s,v_odometry_m_per_s,range_m,x_true_m\n");
    let mut x_m: f64 = 1.0;
    for n in 0..300 {
        let v: f64 = if (n / 60) % 2 == 0 { 0.2 } else { -0.1 };
        let range = if n == 100 { String::new() } else { format!("{}", 4.428479 - x_m) };
        text += &format!("{},{v},{range},{x_m}\n", f64::from(n) * 0.1);
        x_m += v * 0.1;
    }
    text
}

#[test]
fn a_made_log_becomes_a_data_set_in_our_frame() {
    let dir = tempfile::tempdir().unwrap();
    let mut gz = flate2::write::GzEncoder::new(
        std::fs::File::create(dir.path().join("log.csv.gz")).unwrap(),
        Default::default(),
    );
    gz.write_all(source().as_bytes()).unwrap();
    gz.finish().unwrap();
    let out = dir.path().join("set");
    let run = import("barfoot-1d", dir.path(), None, &out);
    assert!(run.status.success(), "{run:?}");
    assert_eq!(String::from_utf8_lossy(&run.stdout).trim(), out.display().to_string());
    let said = String::from_utf8_lossy(&run.stderr).into_owned();
    for sentence in
        ["stands in for the command", "300 rows over 29.9 s", "rows at 10.000 Hz", "1 frames without a range", "0 gaps"]
    {
        assert!(said.contains(sentence), "{said}");
    }

    let dataset = store::read(&out).unwrap();
    assert_eq!(dataset.log.known.robot, "create");
    assert_eq!(dataset.log.known.commands_are, asami_dataset::CommandsAre::Odometry);
    assert_eq!(dataset.log.frames.as_ref().unwrap().len(), 300);
    assert_eq!(dataset.log.sightings.len(), 299);
    let yardstick = Yardstick::of(&dataset.log, &dataset.truth);
    // The range is the distance in the house's frame, and the command the forward speed.
    assert!(yardstick.sensor.iter().all(|[range_m, distance_m]| (range_m - distance_m).abs() < 1e-9));
    let identity = asami_dataset::ActionModel::Polynomial(Polynomial::plain(vec![0.0, 1.0]).into());
    let scores = yardstick.score(&asami_dataset::Models { action: Some(identity), ..Default::default() });
    assert!(scores.action_rmse_m_per_s.unwrap() < 1e-9, "{scores:?}");
    assert!((scores.action_scale.unwrap() - 1.0).abs() < 1e-9);
}

#[test]
fn gaps_are_reported_and_a_late_clock_is_found() {
    let dir = tempfile::tempdir().unwrap();
    let lines: Vec<String> = source().lines().map(str::to_owned).collect();
    // The truth of three rows later: the range lags it by 0.3 s, a lead of -0.3 s.
    let late = |n: usize| {
        let (head, _) = lines[n].rsplit_once(',').unwrap();
        format!("{head},{}\n", lines[n + 3].rsplit_once(',').unwrap().1)
    };
    let text: String = (0..290)
        .filter(|n| !(41..45).contains(n))
        .map(|n| if n == 0 { lines[0].clone() + "\n" } else { late(n) })
        .collect();
    let file = dir.path().join("log.csv");
    std::fs::write(&file, text).unwrap();
    let notes = read(&file).unwrap().notes.join("\n");
    assert!(notes.contains("steps of 0.1000 to 0.5000 s, 1 gaps"), "{notes}");
    let lead = notes.split("motion capture by ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap();
    assert!((lead.parse::<f64>().unwrap() + 0.3).abs() < 0.05, "{notes}");
}

#[test]
fn broken_sources_are_refused_with_their_line() {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("log.csv");
    let sound = source();
    let cases = [
        (sound.replace("x_true_m", "x"), "log.csv:1: the header must have a column x_true_m"),
        (sound.replacen("\n0.1,", "\n0.0,", 1), "log.csv:3: t_s must increase, not 0 after 0"),
        (
            sound.replacen("\n0.1,0.2", "\n0.1,fast", 1),
            "log.csv:3: v_odometry_m_per_s must be a finite number or empty, not fast",
        ),
        (sound.replacen("\n0.1,0.2", "\n0.1,", 1), "v_odometry_m_per_s must be a finite number, not empty"),
        (sound.replacen("\n0.1,0.2,3", "\n0.1,0.2,-3", 1), "range_m must be greater than 0"),
        (sound.lines().take(2).collect::<Vec<_>>().join("\n"), "must have at least 2 rows, not 1"),
        (sound.replacen("\n0.1,", "\n", 1), "found record with 3 fields"),
    ];
    for (text, expected) in cases {
        std::fs::write(&file, text).unwrap();
        let run = import("barfoot-1d", &file, None, &dir.path().join("set"));
        assert_eq!(run.status.code(), Some(2));
        let said = said(&run);
        assert!(said.contains(&unspaced(expected)), "\nwanted: {expected}\nfound:  {said}");
    }
    let absent = import("barfoot-1d", &dir.path().join("nothing"), None, &dir.path().join("set"));
    assert_eq!(absent.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&absent.stderr).contains("Giant Glass of Milk"));
}

#[test]
fn the_real_log_is_read_whole() {
    let Some(source) = real("barfoot_1d") else { return };
    let imported = read(&source).unwrap();
    let log = &imported.dataset.log;
    assert_eq!((log.commands.len(), log.sightings.len()), (6750, 6750));
    let dir = tempfile::tempdir().unwrap();
    store::write(&imported.dataset, dir.path()).unwrap();
    assert_eq!(store::read(dir.path()).unwrap(), imported.dataset);

    // The data set's documentation gives the range's variance about the true distance.
    let yardstick = Yardstick::of(log, &imported.dataset.truth);
    let n = yardstick.sensor.len() as f64;
    let variance = yardstick.sensor.iter().map(|[range_m, distance_m]| (range_m - distance_m).powi(2)).sum::<f64>() / n;
    assert!((0.75..1.25).contains(&(variance / 3.669e-4)), "{variance}");
}
