use nalgebra::Translation3;

use super::*;

/// Goes where it is told, as far as it was aimed with every step; counts its steps.
#[derive(Clone, Default)]
struct Walker {
    aim: f64,
    at: f64,
    down: bool,
    steps: Arc<Mutex<usize>>,
}

impl Engine for Walker {
    fn load(&mut self, knobs: &BodyKnobs) {
        self.at -= knobs.payload_kg;
    }
    fn incline(&mut self, [x, _]: [f64; 2]) {
        self.at += x;
    }
    fn set_torque(&mut self, [first, ..]: [f64; 4]) {
        self.down = first < 1.0;
    }
    fn set_friction(&mut self, _: [f64; 4], shell: f64) {
        self.aim *= shell;
    }
    fn aim(&mut self, set_points_rad: &[f64]) {
        self.aim = set_points_rad[0];
    }
    fn step(&mut self) {
        self.at += self.aim;
        *self.steps.lock().unwrap() += 1;
    }
    fn angle_rad(&self, i: usize) -> f64 {
        self.aim + i as f64
    }
    fn feet_down(&self) -> [bool; 4] {
        [self.down; 4]
    }
    fn world_from_torso(&self) -> Isometry3<f64> {
        Translation3::new(self.at, 0.0, 0.0).into()
    }
    fn world_from_head(&self) -> Isometry3<f64> {
        Translation3::new(self.at, 0.0, 1.0).into()
    }
    fn world_from_link(&self, _: &str) -> Option<Isometry3<f64>> {
        Some(self.world_from_torso())
    }
    fn mass_kg(&self) -> f64 {
        1.0
    }
}

fn told(aims: &[f64]) -> Vec<Told> {
    let mut told = vec![Told::Load(BodyKnobs { payload_kg: 0.5, ..BodyKnobs::default() }), Told::Incline([0.2, 0.0])];
    for aim in aims {
        told.extend([Told::Friction([1.0; 4], 0.8), Told::Torque([*aim; 4]), Told::Aim(vec![*aim; 2]), Told::Step]);
    }
    told
}

fn noted(aims: &[f64]) -> Arc<Take> {
    let notes = Notes::default();
    let mut noting = Rehearsed::noting(Box::<Walker>::default(), &notes);
    told(aims).iter().for_each(|told| told.tell(&mut noting));
    let take = std::mem::take(&mut *notes.lock().unwrap());
    Arc::new(take)
}

/// What one engine says of itself after everything that it is told.
fn heard(engine: &mut dyn Engine, aims: &[f64]) -> Vec<Stood> {
    let mut stood = vec![Stood::of(engine)];
    for it in told(aims) {
        it.tell(engine);
        if it == Told::Step {
            stood.push(Stood::of(engine));
        }
    }
    stood
}

#[test]
fn what_is_told_again_moves_no_engine_and_what_is_not_does_from_the_beginning() {
    let take = noted(&[0.5, 0.25, 2.0]);
    for (aims, steps) in [
        (&[0.5, 0.25, 2.0][..], 0),
        (&[0.5, 0.25], 0),
        (&[0.5, 0.25, 3.0], 3),
        (&[0.1, 0.25, 2.0], 3),
        (&[0.5, 0.25, 2.0, 1.0, 4.0], 5),
    ] {
        let walker = Walker::default();
        let counted = walker.steps.clone();
        let mut following = Rehearsed::following(Box::new(walker), &take);
        assert_eq!(heard(&mut following, aims), heard(&mut Walker::default(), aims), "{aims:?}");
        assert_eq!(*counted.lock().unwrap(), steps, "{aims:?}");
    }
}

#[test]
fn a_body_that_begins_elsewhere_follows_nothing() {
    let (take, aims) = (noted(&[0.5, 0.25]), [0.5, 0.25]);
    let elsewhere = Walker { at: 3.0, ..Walker::default() };
    let mut following = Rehearsed::following(Box::new(elsewhere.clone()), &take);
    assert_eq!(heard(&mut following, &aims), heard(&mut elsewhere.clone(), &aims));
}

/// Links other than torso and head are only where the engine is.
#[test]
fn what_no_take_holds_is_not_told() {
    let take = noted(&[0.5]);
    let mut following = Rehearsed::following(Box::<Walker>::default(), &take);
    heard(&mut following, &[0.5]);
    assert_eq!(following.world_from_link("torso"), Some(following.world_from_torso()));
    assert_eq!(following.world_from_link("head"), Some(following.world_from_head()));
    assert_eq!(following.world_from_link("neck"), None);
    following.step();
    assert!(following.world_from_link("neck").is_some());
}
