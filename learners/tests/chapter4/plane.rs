//! The view of a log that chapter 4's learners share.

use std::sync::Arc;

use asami_dataset::log::Frame;
use asami_dataset::{Action, Beacon, Command, Known, Log, Sighting, Size};
use asami_learners::plane::Plane;
use asami_learners::{CannotLearn, Lack};

fn legs(t_s: f64, id: Option<u16>, ay_m_per_s: f64) -> Command {
    Command { t_s, action: Action::Legs { id, ax_m_per_s: 0.0, ay_m_per_s, atheta_rad_per_s: 0.0 } }
}

fn seen(t_s: f64, landmark: u16) -> Sighting {
    Sighting { t_s, landmark, size: Size::HeightPx(20.0 + t_s), bearing_rad: 0.1 }
}

fn log(commands: Vec<Command>, frames: Option<Vec<f64>>, sightings: Vec<Sighting>) -> Log {
    let beacon = |id: u16| Beacon { id, x_m: f64::from(id), y_m: 2.0, height_m: Some(0.2) };
    Log {
        known: Arc::new(Known { landmarks: vec![beacon(0), beacon(3)], ..Known::default() }),
        commands: commands.into(),
        frames: frames
            .map(|times| times.into_iter().map(|t_s| Frame { t_s, head_pan_rad: 0.0 }).collect::<Vec<_>>().into()),
        sightings: sightings.into(),
        ..Log::default()
    }
}

#[test]
fn frames_carry_the_action_that_was_executed_longest_and_what_was_seen() {
    let commands = vec![legs(0.0, Some(7), 0.1), legs(0.19, Some(2), 0.3), legs(0.4, None, 0.0)];
    let frames = (0..6).map(|i| 0.1 * f64::from(i)).collect();
    let log = log(commands, Some(frames), vec![seen(0.1, 3), seen(0.1, 0), seen(0.4, 3)]);
    let plane = Plane::try_from(&log).unwrap();
    let ids: Vec<Option<u16>> = plane.frames.iter().map(|frame| plane.actions[frame.action].id).collect();
    // The step from 0.1 s to 0.2 s was action 7 for 90 ms.
    assert_eq!(ids, [Some(7), Some(7), Some(2), Some(2), None, None]);
    let looks: Vec<usize> = (0..6).map(|t| plane.seen(t).len()).collect();
    assert_eq!(looks, [0, 2, 0, 0, 1, 0]);
    let since: Vec<u32> = plane.frames.iter().map(|frame| frame.since_seen).collect();
    assert_eq!(since, [1, 1, 1, 2, 3, 1]);
    assert_eq!(plane.seen(4)[0].landmark_m, [3.0, 2.0]);
    assert!((plane.actions[0].held_s - 0.2).abs() < 1e-12 && (plane.actions[0].attempted[1] - 0.3).abs() < 1e-12);
    assert!((plane.step_s - 0.1).abs() < 1e-12);
}

#[test]
fn without_frames_every_command_and_sighting_is_one() {
    let log = log(vec![legs(0.5, Some(0), 0.1), legs(1.0, Some(1), 0.1)], None, vec![seen(0.2, 0), seen(0.7, 0)]);
    let plane = Plane::try_from(&log).unwrap();
    let times: Vec<f64> = plane.frames.iter().map(|frame| frame.t_s).collect();
    assert_eq!(times, [0.5, 0.7, 1.0]);
    assert_eq!(plane.sightings.len(), 1);
}

#[test]
fn what_is_missing_is_said() {
    let frames: Vec<f64> = (0..100).map(|i| 0.1 * f64::from(i)).collect();
    let looks: Vec<Sighting> = frames.iter().map(|t_s| seen(*t_s, 3)).collect();
    let commands = vec![legs(0.0, Some(0), 0.1), legs(9.5, Some(4), 0.1)];
    let lacks = Plane::try_from(&log(commands.clone(), Some(frames.clone()), looks.clone())).unwrap().lacks(false);
    assert!(lacks.contains(&Lack::RareActions { actions: vec![4], least_s: 1.0 }));
    assert!(lacks.contains(&Lack::OneLandmark { landmark: 3 }));
    let refused = |log: &Log| Plane::try_from(log).unwrap_err();
    assert_eq!(refused(&log(commands.clone(), None, vec![seen(0.1, 1)])), CannotLearn::UnknownLandmark { landmark: 1 });
    assert_eq!(refused(&log(vec![legs(0.0, None, 0.1)], None, looks)), CannotLearn::NoActions);
    assert_eq!(refused(&log(commands.clone(), None, vec![])), CannotLearn::NoSightings);
    let two = log(commands, None, vec![seen(0.1, 0), seen(0.1, 3)]);
    assert_eq!(Plane::along_a_line(&two).unwrap_err(), CannotLearn::SeveralLandmarks { found: 2 });
}
