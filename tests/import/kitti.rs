//! Pictures of a real scanner's firings.

use std::fs::{self, File};
use std::path::Path;

use asami::import::ImportError;
use asami::import::kitti::read;
use asami_gap::answer::diagnosis::Verdict;

use crate::real;

/// A picture of `columns` firings, with `depth` and `rows` as they should be or not.
fn picture(path: &Path, columns: u32, rows: u32, sixteen: bool, value: impl Fn(u32, u32) -> u16) {
    let mut encoder = png::Encoder::new(File::create(path).unwrap(), columns, rows);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(if sixteen { png::BitDepth::Sixteen } else { png::BitDepth::Eight });
    let values = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    let bytes: Vec<u8> = if sixteen {
        values.flat_map(|(row, column)| value(row, column).to_be_bytes()).collect()
    } else {
        values.map(|_| 0).collect()
    };
    encoder.write_header().unwrap().write_image_data(&bytes).unwrap();
}

fn drive(dir: &Path, spoil: impl Fn(u32, u32) -> Option<u16>) {
    fs::create_dir_all(dir.join("range")).unwrap();
    for turn in 0..3 {
        let value = |row: u32, column: u32| match row {
            64 => (column * 300) as u16,
            _ => (row * 100 + column) as u16,
        };
        let path = dir.join(format!("range/{turn:06}.png"));
        picture(&path, 120, 65, true, |row, column| spoil(row, column).unwrap_or_else(|| value(row, column)));
    }
    let row = |turn: i32| {
        let fields = (0..30).map(|k| {
            if k == 8 {
                "2.0".to_owned()
            } else if k == 22 {
                "0.5".to_owned()
            } else {
                turn.to_string()
            }
        });
        fields.collect::<Vec<_>>().join(" ")
    };
    fs::write(dir.join("oxts.txt"), (0..3).map(row).collect::<Vec<_>>().join("\n")).unwrap();
}

#[test]
fn pictures_become_firings_and_speeds_become_a_track() {
    let dir = tempfile::tempdir().unwrap();
    drive(dir.path(), |_, _| None);
    let found = read(dir.path()).unwrap().dataset;
    let firings = found.log.firings.unwrap();
    assert_eq!((firings.len(), firings.lasers(), firings.check()), (360, 64, Ok(())));
    // The sixtieth column looks back: there a turn begins.
    assert_eq!((firings.range_2mm[63][121], firings.range_2mm[0][0], firings.encoder_cdeg[359]), (6361, 60, 17_700));
    assert!((firings.t_s[180] - 1.5 * 0.1036).abs() < 1e-12 && firings.encoder_cdeg[180] == 0);
    let last = found.truth.track[2];
    assert!((last.theta_rad - 0.1036).abs() < 1e-12 && last.x_m < 0.0 && (last.y_m - 0.4144).abs() < 1e-3, "{last:?}");
    assert_eq!(found.log.known.velodyne.as_ref().unwrap().vertical_angles_rad.len(), 64);
}

/// A first column left of ahead and a last one right of it belong to the turn's middle, on either side.
#[test]
fn columns_about_the_front_keep_their_order_in_time() {
    let dir = tempfile::tempdir().unwrap();
    drive(dir.path(), |row, column| (row == 64).then(|| ((column * 300 + 35_900) % 36_000) as u16));
    let firings = read(dir.path()).unwrap().dataset.log.firings.unwrap();
    assert_eq!((firings.check(), firings.encoder_cdeg[0], firings.encoder_cdeg[59]), (Ok(()), 18_200, 35_900));
    let step_s = 0.1036 / 120.0;
    assert!(firings.t_s.windows(2).all(|pair| (pair[1] - pair[0] - step_s).abs() < 1e-9));
}

/// In a left turn a scanner on the right is faster than the navigation unit, and drifts outward ahead of it.
#[test]
fn the_track_is_the_scanners() {
    let dir = tempfile::tempdir().unwrap();
    drive(dir.path(), |_, _| None);
    fs::write(dir.path().join("calib.txt"), "P0: 1 2\nTr_imu_to_velo: 1 0 0 -0.8 0 1 0 0.3 0 0 1 -0.8\n").unwrap();
    let found = read(dir.path()).unwrap();
    let says = |notes: &[String], what: &str| assert!(notes.iter().any(|note| note.contains(what)), "{notes:?}");
    says(&found.notes, "0.80 m ahead of the navigation and -0.30 m");
    let track = &found.dataset.truth.track;
    let (first, last) = (track[0], track[2]);
    assert!((first.x_m - 0.3).abs() < 1e-12 && (first.y_m - 0.8).abs() < 1e-12, "{first:?}");
    assert!((last.v_m_per_s.unwrap() - 2.15).abs() < 1e-12);
    let [v, omega] = asami::scorer::car::moved(track, 0.0, 2.0 * 0.1036).unwrap();
    assert!((v - 2.15).abs() < 1e-3 && (omega - 0.5).abs() < 1e-9, "{v} {omega}");
    fs::write(dir.path().join("calib.txt"), "P0: 1 2\n").unwrap();
    let unknown = read(dir.path()).unwrap();
    says(&unknown.notes, "the navigation is where the unit is");
    assert_eq!(unknown.dataset.truth.track[0].x_m, 0.0);
    for wrong in ["Tr_imu_to_velo: 1 0 0", "Tr_imu_to_velo: 1 0 0 nan 0 1 0 0.3 0 0 1 -0.8"] {
        fs::write(dir.path().join("calib.txt"), wrong).unwrap();
        let said = read(dir.path()).unwrap_err().to_string();
        assert!(said.contains("must be a row of Tr_imu_to_velo"), "{said}");
    }
}

#[test]
fn what_is_no_picture_of_firings_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    assert!(matches!(read(dir.path()), Err(ImportError::Absent { .. })));
    drive(dir.path(), |row, column| (row == 64 && column == 7).then_some(36_000));
    let said = read(dir.path()).unwrap_err().to_string();
    assert!(
        said.ends_with("000000.png:8: encoder must be an angle in 0..36000 hundredths of a degree, not 36000"),
        "{said}"
    );
    for (columns, rows, sixteen) in [(120, 64, true), (9000, 65, true), (120, 65, false)] {
        picture(&dir.path().join("range/000000.png"), columns, rows, sixteen, |_, _| 0);
        assert!(matches!(read(dir.path()), Err(ImportError::Unreadable { .. })), "{columns} {rows} {sixteen}");
    }
    let good = fs::read(dir.path().join("range/000001.png")).unwrap();
    for length in [0, 20, good.len() / 2] {
        fs::write(dir.path().join("range/000000.png"), &good[..length]).unwrap();
        assert!(matches!(read(dir.path()), Err(ImportError::Unreadable { .. })), "{length}");
    }
}

/// The real revolutions, of which nobody has a map: in each half the same is wrong with the lasers' table. Where they stand is in the
/// maker's own table, 26 mm to either side and the banks 87 mm apart, which the diagnosis does not see. With the table that is found
/// in one half, surfaces are thinner in the other.
#[test]
fn what_the_real_scanners_table_lacks_is_found_in_either_half() {
    let Some(source) = real("kitti_drive0005") else { return };
    let dataset = read(&source).unwrap().dataset;
    let (first_s, last_s) = dataset.log.span_s().unwrap();
    let middle_s = 0.5 * (first_s + last_s);
    let halves = [dataset.log.window(f64::NEG_INFINITY..middle_s), dataset.log.window(middle_s..f64::INFINITY)];
    let variants = asami_gap::Variant::all("car", 0, &[]);
    for (log, other) in [(&halves[0], &halves[1]), (&halves[1], &halves[0])] {
        let found = asami_gap::real::scanner::diagnose(&variants, log).unwrap();
        assert_eq!(found.diagnosis.verdict, Verdict::Named);
        let leads = &found.diagnosis.which[0];
        assert_eq!(leads.effects, ["range_bias", "laser_origin_offsets"]);
        assert!((leads.parameters["laser_origin_offsets.aside_m"].value / 0.026).ln().abs() < 0.3, "{leads:?}");
        assert_eq!(leads.parameters["laser_origin_offsets.apart_m"].value, 0.09);
        let checked = asami::real::scanner::checked(other, &found.lasers, &dataset.truth.track).unwrap();
        let (before, after) = (checked.before, checked.after);
        assert!(after.flat_m < 0.8 * before.flat_m && after.upright_m < 0.9 * before.upright_m, "{checked:?}");
        assert!(after.off_planes_m < before.off_planes_m, "{checked:?}");
        assert!(after.speed_m_per_s < 1.05 * before.speed_m_per_s, "{checked:?}");
    }
}

/// The real revolutions: the best method finds the lasers' angles to the bar, sides of the lasers and all.
#[test]
fn the_real_scanner_is_learned() {
    let Some(source) = real("kitti_drive0005") else { return };
    let found = read(&source).unwrap().dataset;
    assert_eq!(found.log.firings.as_ref().unwrap().check(), Ok(()));
    let learner = asami_learners::Learners::default().configured("car_sides", &Default::default()).unwrap();
    let learned =
        learner.learn(&found.log, &Default::default(), &mut asami_dataset::Seed(1000).stream("learner")).unwrap();
    let Some(asami_dataset::SensorModel::Angles { horizontal_angles_rad, .. }) = learned.models.sensor else {
        panic!()
    };
    let truth = found.truth.survey.unwrap().horizontal_angles_rad;
    let off: Vec<f64> = horizontal_angles_rad.iter().zip(&truth).map(|(a, b)| (a - b).to_degrees()).collect();
    let mean = off.iter().sum::<f64>() / 64.0;
    let rms = (off.iter().map(|e| (e - mean) * (e - mean)).sum::<f64>() / 64.0).sqrt();
    let worst = off.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
    assert!(rms <= 0.10 && worst <= 0.5, "{rms} and {worst} degrees");
}
