//! A race car's log.

use asami::import::ImportError;
use asami::import::av21::read;
use asami_dataset::Action;

use crate::{Source, real, refused_when_broken, write};

const HEADER: &str =
    "# time(s),x(m),y(m),vx(m/s),vy(m/s),delta(rad),omega(rad/s),throttle_ped_cmd(%),brake_ped_cmd(kPa)\n";

/// Straight on at 10 m/s, then a turn to the left.
fn source() -> Source {
    let row = |i: u32| {
        let turning = if i < 50 { 0.0 } else { 0.1 };
        format!("{:.3},0,0,10.0,0,{:.3},{turning},25.0,689.475\n", 1_672_875_115.4 + 0.04 * f64::from(i), 0.3 * turning)
    };
    Source::from([("log.csv", HEADER.to_owned() + &(0..101).map(row).collect::<String>())])
}

#[test]
fn rows_become_pedals_odometry_and_a_track() {
    let dir = tempfile::tempdir().unwrap();
    write(&source(), dir.path());
    let found = read(dir.path()).unwrap();
    let (log, truth) = (found.dataset.log, found.dataset.truth);
    assert_eq!((log.commands.len(), log.odometry.len(), truth.track.len()), (101, 101, 101));
    let Action::Pedals { throttle, brake, steering } = log.commands[100].action else { panic!() };
    assert!((throttle - 0.25).abs() < 1e-12 && (brake - 0.25).abs() < 1e-12 && (steering - 0.03 / 0.2793).abs() < 1e-4);
    assert!((log.odometry[100].t_s - 4.0).abs() < 1e-6 && log.odometry[0].t_s == 0.0);
    let last = truth.track[100];
    // Two seconds ahead, then an arc of radius 100 m to the left.
    assert!((last.y_m - (20.0 + 100.0 * 0.2f64.sin())).abs() < 0.1 && last.x_m < -1.5, "{last:?}");
    assert!((last.theta_rad - 0.2).abs() < 0.01, "{last:?}");
    assert!(found.notes.iter().any(|note| note.starts_with("assumed: throttle")), "{:?}", found.notes);
}

#[test]
fn what_is_no_log_of_the_car_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    assert!(matches!(read(dir.path()), Err(ImportError::Absent { .. })));
    let cases = [
        ["log.csv", "vx(m/s)", "vx", "the header must have a column vx(m/s)"],
        ["log.csv", ",10.0,", ",,", "vx(m/s) must be a finite number, not empty"],
        ["log.csv", "1672875115.440", "1672875115.300", "must increase"],
    ];
    refused_when_broken("av21", &source(), None, &cases);
}

#[test]
fn the_real_log_is_read() {
    let Some(source) = real("av21") else { return };
    let found = read(&source).unwrap().dataset;
    assert_eq!(found.log.commands.len(), 16_791);
    let (_, last_s) = found.log.span_s().unwrap();
    assert!((last_s - 671.6).abs() < 0.1, "{last_s}");
    // What is commanded is what pedals and wheels can do.
    let possible = |action: &Action| match action {
        Action::Pedals { throttle, brake, steering } => {
            (0.0..=1.0).contains(throttle) && (0.0..=1.0).contains(brake) && steering.abs() < 0.8
        }
        _ => false,
    };
    assert!(found.log.commands.iter().all(|command| possible(&command.action)));
}
