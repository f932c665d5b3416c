//! Five robots among landmarks.

use std::f64::consts::FRAC_PI_2;
use std::io::Write;

use asami::import::mrclam::read;
use asami::real::clock::heard;
use asami::real::odometry::{Clocks, Readied};
use asami_dataset::{Action, Command, Dataset, Size, TruePose, store};
use asami_math::angle::wrap_rad;

use crate::{Source, import, real, refused, refused_when_broken, said, unspaced, write};

/// A robot that drives along +x at 0.1 m/s and sees a landmark ahead, another robot, and a barcode that nobody has.
fn source() -> Source {
    let (mut odometry, mut measurement, mut groundtruth) = (String::new(), String::new(), String::new());
    for n in 0..100 {
        let t_s = 1_248_444_175.0 + f64::from(n) * 0.1;
        let x_m = f64::from(n) * 0.01;
        odometry += &format!("{t_s:.3} \t 0.100 \t -0.000\n");
        groundtruth += &format!("{t_s:.3} \t {x_m:.6} \t 0.0 \t 0.0\n");
        if n >= 10 && n % 10 == 0 {
            measurement +=
                &format!("{t_s:.3} \t 14 \t {:.6} \t {:.6}\n", (4.0 - x_m).hypot(1.0), 1.0f64.atan2(4.0 - x_m));
            measurement += &format!("{t_s:.3} \t 41 \t 2.0 \t 0.1\n{t_s:.3} \t 99 \t 2.0 \t 0.1\n");
        }
    }
    Source::from([
        ("Barcodes.dat", "# Subject #    Barcode #\n  1 \t 5\n  3 \t 41\n  6 \t 14\n".to_owned()),
        ("Landmark_Groundtruth.dat", "# Subject\n  6 \t 4.0 \t 1.0 \t 0.00004570 \t 0.00027395\n".to_owned()),
        ("Robot1_Odometry.dat", "# Time [s]\n".to_owned() + &odometry),
        ("Robot1_Measurement.dat", "# Time [s]\n".to_owned() + &measurement),
        ("Robot1_Groundtruth.dat", "# Time [s]\n".to_owned() + &groundtruth),
    ])
}

#[test]
fn a_made_log_becomes_a_data_set_in_our_frame() {
    let (plain, zipped) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    write(&source(), plain.path());
    for (name, text) in source() {
        let file = std::fs::File::create(zipped.path().join(format!("{name}.gz"))).unwrap();
        let mut gz = flate2::write::GzEncoder::new(file, Default::default());
        gz.write_all(text.as_bytes()).unwrap();
        gz.finish().unwrap();
    }
    let out = plain.path().join("set");
    let run = import("mrclam", plain.path(), Some(1), &out);
    assert!(run.status.success(), "{run:?}");
    for sentence in [
        "are velocity commands",
        "heading 0 faces +x in the source",
        "time 0 is 1248444175.000 s",
        "commands at 10.000 Hz",
        "9 sightings of other robots, ignored",
        "9 sightings of barcodes that nobody carries, ignored",
    ] {
        assert!(said(&run).contains(&unspaced(sentence)), "{sentence}: {run:?}");
    }
    let dataset = store::read(&out).unwrap();
    assert_eq!(dataset, read(zipped.path(), 1).unwrap().dataset, "gzipped or not");
    let Dataset { log, truth, .. } = dataset;
    assert_eq!((log.commands.len(), log.sightings.len(), truth.track.len()), (100, 9, 100));
    assert!(log.frames.is_none(), "misses are unknown");
    assert_eq!(log.commands[1].t_s, 0.1);
    assert_eq!(log.commands[1].action, Action::Wheels { id: None, v_m_per_s: 0.1, omega_rad_per_s: 0.0 });
    // Along +x is a heading of -pi/2 here, and what lies at +y of it is to its left.
    assert!(truth.track.iter().all(|pose| (pose.theta_rad + FRAC_PI_2).abs() < 1e-12));
    let seen = log.sightings[0];
    assert!(matches!(seen.size, Size::RangeM(range_m) if (range_m - 3.9f64.hypot(1.0)).abs() < 1e-6));
    assert!((seen.bearing_rad - 1.0f64.atan2(3.9)).abs() < 1e-6);
}

#[test]
fn of_two_commands_of_one_time_the_later_holds() {
    let dir = tempfile::tempdir().unwrap();
    let mut files = source();
    let twice =
        files["Robot1_Odometry.dat"].replacen("75.100 \t 0.100", "75.100 \t 0.3 \t 0.1\n1248444175.100 \t 0.2", 1);
    files.insert("Robot1_Odometry.dat", twice);
    write(&files, dir.path());
    let imported = read(dir.path(), 1).unwrap();
    assert!(imported.notes.join("\n").contains("100 commands, and 1 replaced"), "{:?}", imported.notes);
    assert_eq!(imported.dataset.log.commands[1].action.forward_m_per_s(), Some(0.2));
}

/// Cameras of one model have one rate, which three of the logs tell by bearings and commands; what is dated by it is told no clock
/// any more.
#[test]
fn the_real_cameras_take_ten_pictures_a_second() {
    let Some(source) = real("mrclam6") else { return };
    let told = |robot: u16| {
        let log = read(&source, robot).unwrap().dataset.log;
        let found = heard(&log, 10.0).unwrap();
        found.is_told().then(|| {
            let again = heard(&found.clock.taken_back(&log), 10.0).unwrap();
            assert!(!again.is_told(), "{robot}: {again:?}");
            1.0 / found.clock.period_s
        })
    };
    let rates_hz: Vec<Option<f64>> = (1..=5).map(told).collect();
    assert!([1, 2, 4].iter().all(|i| rates_hz[*i].is_some()), "{rates_hz:?}");
    // Rates are looked at by an eighth of a period over the log, 0.0001 Hz.
    assert!(rates_hz.iter().flatten().all(|hz| (hz - 9.9958).abs() < 5e-4), "{rates_hz:?}");
}

/// For how long the robot turned, by motion capture, each time that it was told to turn fast for a second at most, and not for a second
/// before and after, in seconds.
fn turns_s(Dataset { log, truth, .. }: &Dataset) -> Vec<f64> {
    let rate = |it: &Command| match it.action {
        Action::Wheels { omega_rad_per_s, .. } if omega_rad_per_s.abs() > 0.02 => omega_rad_per_s,
        _ => 0.0,
    };
    // From the first command of each turn to the one after its last.
    let mut told: Vec<(f64, f64, f64)> = Vec::new();
    for pair in log.commands.windows(2).filter(|pair| rate(&pair[0]) != 0.0) {
        match told.last_mut().filter(|(_, until_s, _)| pair[0].t_s - *until_s < 0.3) {
            Some((_, until_s, least)) => (*until_s, *least) = (pair[1].t_s, least.min(rate(&pair[0]).abs())),
            None => told.push((pair[0].t_s, pair[1].t_s, rate(&pair[0]).abs())),
        }
    }
    let heading = |from_s: f64| {
        let of = |it: &&TruePose| (from_s..from_s + 0.2).contains(&it.t_s);
        let all: Vec<f64> = truth.track.iter().filter(of).map(|it| it.theta_rad).collect();
        let first = *all.first()?;
        Some(first + all.iter().map(|it| wrap_rad(it - first)).sum::<f64>() / all.len() as f64)
    };
    let alone = told.windows(3).filter(|it| {
        let [before, (from_s, until_s, least), after] = it else { return false };
        until_s - from_s < 1.0 && *least > 0.39 && from_s - before.1 > 1.0 && after.0 - until_s > 1.0
    });
    let length_s = |it: &[(f64, f64, f64)]| {
        let (from_s, until_s, _) = it[1];
        // Told 0.398 rad/s to one side and 0.408 to the other.
        Some(wrap_rad(heading(until_s + 0.7)? - heading(from_s - 0.2)?).abs() / 0.403)
    };
    alone.filter_map(length_s).collect()
}

/// Robots of one software have one cycle, which four of the logs tell by bearings and commands; and by motion capture robots turn for whole
/// multiples of it, for whatever time they are told to.
#[test]
fn the_real_robots_take_commands_up_once_in_a_cycle() {
    let Some(source) = real("mrclam6") else { return };
    let (mut cycles_s, mut lengths_s) = (Vec::new(), Vec::new());
    for robot in 1..=5 {
        let dataset = read(&source, robot).unwrap().dataset;
        let readied = Readied { camera_hz: Some(10.0), command_cycle_s: Some(0.2), ..Readied::default() };
        let (taken, Clocks { command_cycle_s, .. }) = readied.of(&dataset.log);
        assert_eq!(command_cycle_s.is_none(), taken.commands == dataset.log.commands, "{robot}");
        cycles_s.push(command_cycle_s);
        lengths_s.extend(turns_s(&dataset));
    }
    assert!(cycles_s[1..].iter().all(Option::is_some), "{cycles_s:?}");
    assert!(cycles_s.iter().flatten().all(|it| (it / 0.2162 - 1.0).abs() < 0.01), "{cycles_s:?}");
    let whole = |it: &&f64| (*it / 0.2162 - (*it / 0.2162).round().max(1.0)).abs() < 0.16;
    let share = lengths_s.iter().filter(whole).count() as f64 / lengths_s.len() as f64;
    // Of lengths of any kind it would be a third.
    assert!(lengths_s.len() > 60 && share > 0.75, "{share} of {lengths_s:.2?}");
}

/// How fast the robot went, by motion capture, in half seconds in which and before which it was told for long to go straight on at a speed;
/// the one that all are told most of all is left out.
fn straight_m_per_s(Dataset { log, truth, .. }: &Dataset) -> Vec<f64> {
    let told = |it: &Command| match it.action {
        Action::Wheels { v_m_per_s, omega_rad_per_s, .. } if omega_rad_per_s.abs() < 0.01 => Some(v_m_per_s),
        _ => None,
    };
    let position = |t_s: f64| {
        let pose = truth.track.get(truth.track.partition_point(|it| it.t_s < t_s))?;
        (pose.t_s - t_s < 0.03).then_some([pose.t_s, pose.x_m, pose.y_m])
    };
    let speed = |from_s: f64| {
        let at = |t_s: f64| log.commands.partition_point(|it| it.t_s <= t_s).saturating_sub(1);
        let speeds: Option<Vec<f64>> = log.commands[at(from_s - 0.9)..=at(from_s + 0.5)].iter().map(told).collect();
        let speeds = speeds?;
        let (least, most) =
            speeds.iter().fold((f64::INFINITY, 0.0_f64), |(least, most), v| (least.min(*v), most.max(*v)));
        if most - least > 0.003 || least < 0.02 || (most - 0.067).abs() < 0.0015 {
            return None;
        }
        let ([a_s, ax, ay], [b_s, bx, by]) = (position(from_s)?, position(from_s + 0.5)?);
        Some((bx - ax).hypot(by - ay) / (b_s - a_s))
    };
    let (first_s, last_s) = (log.commands[0].t_s + 1.0, log.commands[log.commands.len() - 1].t_s - 1.0);
    (0..(2.0 * (last_s - first_s)) as usize).filter_map(|i| speed(first_s + 0.5 * i as f64)).collect()
}

/// Speeds straight on gather at multiples of a step, and of no other (Rayleigh's test: by chance 200 are so
/// concentrated once in 300 000 times).
#[test]
fn the_real_wheels_know_few_speeds() {
    let Some(source) = real("mrclam6") else { return };
    let speeds: Vec<f64> = (1..=5).flat_map(|robot| straight_m_per_s(&read(&source, robot).unwrap().dataset)).collect();
    let gathered = |step: f64| {
        let sum = speeds.iter().fold([0.0, 0.0], |[re, im], v| {
            let (sin, cos) = (std::f64::consts::TAU * v / step).sin_cos();
            [re + cos, im + sin]
        });
        sum.map(|it| it / speeds.len() as f64)
    };
    let [re, im] = gathered(0.008_45);
    assert!(speeds.len() > 200 && re > 0.25 && im.abs() < 0.1, "{re} {im} of {}", speeds.len());
    let others = (0..200).map(|i| 0.006 + 5e-5 * f64::from(i)).filter(|step| (step / 0.008_45 - 1.0).abs() > 0.06);
    let most = others.map(|step| gathered(step)[0]).fold(0.0, f64::max);
    assert!(most < 0.5 * re, "{most} {re}");
}

#[test]
fn broken_sources_are_refused_with_their_line() {
    let cases = [
        [
            "Barcodes.dat",
            "6 \t 14",
            "7 \t 14",
            "Barcodes.dat:4: subject must be a robot or a landmark of Landmark_Groundtruth.dat, not 7",
        ],
        ["Barcodes.dat", "6 \t 14", "6 \t 41", "Barcodes.dat:4: barcode must belong to one subject, not 41"],
        ["Landmark_Groundtruth.dat", "  6", "  4", "Landmark_Groundtruth.dat:2: subject must be greater than"],
        ["Landmark_Groundtruth.dat", "4.0 \t", "", "must have 5 fields (subject x y x std-dev y std-dev), not 4"],
        ["Robot1_Odometry.dat", "175.100", "174.100", "Robot1_Odometry.dat:3: time must not decrease"],
        [
            "Robot1_Odometry.dat",
            "0.100",
            "fast",
            "Robot1_Odometry.dat:2: forward velocity must be a finite number, not fast",
        ],
        ["Robot1_Measurement.dat", "14 \t ", "14 \t -", "Robot1_Measurement.dat:2: range must be greater than 0"],
        [
            "Robot1_Measurement.dat",
            "2.0 \t 0.1",
            "2.0 \t 45",
            "bearing must be an angle of at most a turn, 2 pi rad (is the column in degrees?), not 45",
        ],
        ["Robot1_Groundtruth.dat", "175.100", "175.000", "Robot1_Groundtruth.dat:3: time must increase"],
        ["Robot1_Groundtruth.dat", "0.0\n", "NaN\n", "orientation must be a finite number, not NaN"],
    ];
    refused_when_broken("mrclam", &source(), Some(1), &cases);
    let dir = tempfile::tempdir().unwrap();
    write(&source(), dir.path());
    refused("mrclam", dir.path(), None, "not none");
    refused("mrclam", dir.path(), Some(6), "one of 1, 2, 3, 4, 5 for mrclam, not 6");
    refused("mrclam", dir.path(), Some(2), "no such file");
}

#[test]
fn the_real_logs_are_read_whole() {
    let Some(source) = real("mrclam6") else { return };
    let rows =
        [(61785, 1534, 49241), (65004, 3239, 59705), (61150, 4348, 56977), (52906, 2023, 61714), (60563, 4239, 57467)];
    for (robot, (commands, sightings, poses)) in (1..).zip(rows) {
        let imported = read(&source, robot).unwrap();
        let Dataset { log, truth, .. } = &imported.dataset;
        assert_eq!(
            (log.commands.len(), log.sightings.len(), truth.track.len()),
            (commands, sightings, poses),
            "{robot}"
        );
        assert_eq!(log.known.landmarks.len(), 15);
        let notes = imported.notes.join("\n");
        assert!(notes.contains("they look like depths along the sensor's axis"), "{notes}");
        // Bearings are right to a degree or so only if frames and signs are.
        assert!(truth.survey.as_ref().unwrap().sigma2_rad.unwrap() < 0.02);
    }
}
