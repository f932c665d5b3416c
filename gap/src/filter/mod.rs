//! How likely a log is under a response: an extended Kalman filter over the robot's pose.
//!
//! The motion of each frame interval comes from the response's columns, the size and the bearing of each
//! landmark from its sensor's. What it gives for every frame is `log p(o_t | past)` (Stronger 2008,
//! equations 4.13 and 4.14), and the standardised innovations. Of a real robot it is an iterated invariant one.

mod detection;
mod errors;
mod sighting;
mod told;

use std::f64::consts::TAU;
use std::ops::Range;

use asami_math::angle::wrap_rad;
use asami_math::elementary::{exp, ln, logistic, sin_cos};
use nalgebra::{Matrix3, RowVector3, SVector, Vector3};

use crate::columns::Group;
use crate::hears::{Filtered, Hears, Innovation};
use crate::memory::{Memory, Sway, pace};
use crate::shape::{CHANGING, Numbers, Shape, Sight, speed_class};
use crate::state::{Belief, LASTING, STEADY, SWAYING, State};
use crate::view::{Seen, View};
use detection::Seeing;
pub use detection::{Counted, Counts, UNCOUNTED, counted};
use errors::Held;
use told::Part;

/// Variances that a second adds where a robot goes astray: 0.3 m to the right and forwards, a radian.
const ASTRAY: [f64; 3] = [0.1, 0.1, 1.0];
/// How likely it is at a sighting that a robot that walks is not where its response has it, but somewhere near. A filter that
/// cannot jump loses for good what an effect sent elsewhere once, with thousands of nats that speak for whatever would have kept the
/// robot there.
const JUMPS: f64 = 1e-5;
/// How likely it is after a sighting that was of something else: a filter that asks for as much again at each of a row of them takes
/// all for ones of something else.
const AGAIN: f64 = 0.1;
/// A sway is not followed over a gap of so many frames.
const GAP: f64 = 2.5;

/// A response's numbers, ready to be used step by step.
struct Ready<'a> {
    shape: &'a Shape,
    numbers: &'a [f64],
    size: Range<usize>,
    bearing: Range<usize>,
    moved: Vec<[f64; 2]>,
    /// What each of the motion's columns moves the robot by: right, forwards, counter-clockwise.
    motion: Vec<[f64; 3]>,
    heading: usize,
    variances: Vec<f64>,
    size_vars: Vec<f64>,
    bearing_vars: Vec<f64>,
    share_false: f64,
    seen: Vec<f64>,
    /// Of each landmark of the frame at hand, where it is known what was missed: how likely it is to be seen.
    shares: Vec<Option<Seeing>>,
    visits: Vec<f64>,
    size_columns: Vec<f64>,
    bearing_columns: Vec<f64>,
    memory: Memory,
    kalman: Kalman,
    /// Whose errors are held.
    held: Held,
    /// Whether the robot may be anywhere near by now.
    lost: bool,
    /// How likely the last sighting was of something else.
    doubted: f64,
}

/// A log under a response.
#[derive(Clone, Copy)]
pub struct Walk<'a> {
    /// What the response's numbers mean.
    pub shape: &'a Shape,
    /// The response.
    pub numbers: &'a [f64],
    /// How noise hangs together.
    pub memory: Memory,
    /// The log.
    pub view: &'a View,
    /// What is missed counts where this says so.
    pub counted: &'a [Counts],
    /// How the pose is unsure.
    pub kalman: Kalman,
}

/// How a pose is unsure, and where what is seen is taken to be linear in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kalman {
    /// By differences in x, y and heading, about where the robot was believed to be.
    Extended,
    /// By motions of the whole plane, in which it stays normally distributed where a robot goes on with a heading that it is unsure of
    /// (Barrau and Bonnabel 2017, section V), and about where the robot is believed to be once it has seen that (Bourmaud et al.
    /// 2016). A real robot scatters by so much between sightings that the other is lost for a while.
    Invariant,
}

impl Walk<'_> {
    /// Walks through some steps from a belief, and leaves the belief as it stands afterwards.
    #[must_use]
    pub fn filter(&self, steps: Range<usize>, belief: &mut Belief) -> Filtered {
        let mut filtered = Filtered::default();
        filtered.visits = self.tell(&mut filtered, steps, belief);
        filtered
    }

    /// The same, told to somebody. Gives how often each bin of detection was visited.
    pub fn tell(&self, who: &mut impl Hears, steps: Range<usize>, belief: &mut Belief) -> Vec<f64> {
        let mut ready = Ready::new(self);
        if self.memory.sways() {
            ready.walk::<SWAYING, _>(self, steps, belief, who);
        } else if self.memory.lasts() {
            ready.walk::<LASTING, _>(self, steps, belief, who);
        } else {
            ready.walk::<STEADY, _>(self, steps, belief, who);
        }
        ready.visits
    }
}

impl<'a> Ready<'a> {
    fn new(&Walk { shape, numbers, memory, kalman, .. }: &Walk<'a>) -> Self {
        let part = |group| &numbers[shape.range(group)];
        let squares = |group| part(group).iter().map(|it| exp(2.0 * it)).collect::<Vec<_>>();
        let (motion, width) = (part(Numbers::Motion), shape.columns.len());
        Self {
            shape,
            numbers,
            size: shape.range(Numbers::Size),
            bearing: shape.range(Numbers::Bearing),
            moved: (0..shape.landmarks).map(|landmark| shape.moved(numbers, landmark)).collect(),
            motion: (0..width).map(|column| std::array::from_fn(|axis| motion[axis * width + column])).collect(),
            heading: shape.columns.range(Group::Heading).start,
            variances: part(Numbers::MotionNoise).iter().map(|it| exp(*it)).collect(),
            size_vars: squares(Numbers::SizeNoise),
            bearing_vars: squares(Numbers::BearingNoise),
            share_false: logistic(part(Numbers::False)[0]),
            seen: part(Numbers::Detection).iter().map(|it| logistic(*it)).collect(),
            shares: Vec::new(),
            visits: vec![0.0; shape.width(Numbers::Detection)],
            size_columns: vec![0.0; shape.width(Numbers::Size)],
            bearing_columns: vec![0.0; shape.width(Numbers::Bearing)],
            memory,
            kalman,
            held: Held::default(),
            lost: false,
            doubted: 0.0,
        }
    }

    /// The displacement of one interval, in the robot's frame.
    fn displacement(&self, view: &View, i: usize, (sin, cos): (f64, f64)) -> [f64; 3] {
        let mut moved = [0.0; 3];
        for &(column, value) in view.row(i) {
            // The row holds how much, and how fast, the robot moves where the cosines' columns are; the sines' are empty.
            let of = if column == self.heading || column == self.heading + 2 {
                let [along, across] = [self.motion[column], self.motion[column + 1]];
                std::array::from_fn(|axis| along[axis] * cos + across[axis] * sin)
            } else {
                self.motion[column]
            };
            moved.iter_mut().zip(of).for_each(|(moved, of)| *moved += value * of);
        }
        moved.map(|it| view.steps[i].dt_s * it)
    }

    fn walk<const N: usize, H: Hears>(
        &mut self,
        Walk { view, counted, .. }: &Walk,
        steps: Range<usize>,
        belief: &mut Belief,
        who: &mut H,
    ) {
        let mut state = State::<N>::new(belief);
        state.forget_sways(&self.sways(view, steps.start));
        for i in steps {
            if view.steps[i].dt_s > 0.0 {
                self.predict(view, i, &mut state);
            }
            let (mut log_likelihood, mut expected) = self.detection::<H>(view, i, &state.belief(), counted);
            for seen in view.steps[i].seen.clone() {
                let (likely, innovation) = self.update(view, i, seen, &mut state);
                log_likelihood += likely;
                if H::EXPECTS {
                    // The entropy: of a Gaussian a half for each of its squares, and its scales.
                    let [size, bearing] = innovation.scale;
                    let landmark = view.seen[seen].landmark;
                    let [itself, _] = self.of_itself_or_mistaken(landmark);
                    expected -= if self.is_counted(landmark) { 0.0 } else { ln(itself) };
                    expected += match view.aims {
                        true => self.memory.tails.entropy() + ln(TAU * size * bearing),
                        false => 0.5 + ln(TAU.sqrt() * size),
                    };
                }
                who.sighting(innovation);
            }
            if !who.step(log_likelihood, expected) {
                break;
            }
        }
        *belief = state.belief();
    }

    fn predict<const N: usize>(&self, view: &View, i: usize, state: &mut State<N>) {
        let theta_rad = state.mean[2];
        let (sin, cos) = sin_cos(theta_rad);
        let [right, forward, turn] = self.displacement(view, i, (sin, cos));
        let rotation = Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0);
        state.carry([-sin * right - cos * forward, cos * right - sin * forward]);
        let moved = rotation * Vector3::new(right, forward, turn);
        for (axis, moved) in moved.iter().enumerate() {
            state.mean[axis] += moved;
        }
        state.mean[2] = wrap_rad(state.mean[2]);
        let step = &view.steps[i];
        let [class, changing] = [speed_class(step.attempt), CHANGING].map(|it| &self.variances[3 * it..3 * it + 3]);
        let anywhere = if step.astray || self.lost { ASTRAY } else { [0.0; 3] };
        let q = Vector3::from_fn(|axis, _| step.dt_s * (class[axis] + step.changing * changing[axis] + anywhere[axis]));
        let q = rotation * Matrix3::from_diagonal(&q) * rotation.transpose();
        let sways = self.sways(view, i);
        let gap = view.steps[i].dt_s > GAP * self.memory.frame_s;
        if gap {
            state.forget_sways(&sways);
        }
        for (at, sway) in State::<N>::sways().zip(&sways).filter(|_| !gap) {
            state.sway_on(at, sway.on);
        }
        let kept = self.memory.lasting.kept(step.dt_s);
        State::<N>::errors().for_each(|at| state.fade(at, kept));
        let mut of_pose = state.covariance.fixed_view_mut::<3, 3>(0, 0);
        of_pose += q;
        for (at, sway) in State::<N>::sways().zip(&sways).filter(|_| !gap) {
            state.covariance[(at, at)] += sway.fresh_var();
        }
        State::<N>::errors().for_each(|at| state.covariance[(at, at)] += 1.0 - kept * kept);
    }

    /// The sways at the pace of a step.
    fn sways(&self, view: &View, i: usize) -> [Sway; 2] {
        self.memory.sways[view.steps.get(i).map_or(0, |step| pace(step.attempt))]
    }

    fn sight(&self, view: &View, i: usize, landmark: usize, belief: &Belief) -> Sight {
        view.sight(i, landmark, belief.mean.into(), self.moved(landmark))
    }

    /// By how much a landmark stands elsewhere: by nothing where there are more than nominally.
    fn moved(&self, landmark: usize) -> [f64; 2] {
        self.moved.get(landmark).copied().unwrap_or_default()
    }

    /// From the sensor to a landmark: world x and y.
    fn towards(&self, view: &View, landmark: usize, belief: &Belief) -> [f64; 2] {
        let ([x_m, y_m], [moved_x_m, moved_y_m]) = (view.landmarks[landmark], self.moved(landmark));
        let ([out_x_m, out_y_m], _) = view.out(belief.mean.z);
        [x_m + moved_x_m - belief.mean.x - out_x_m, y_m + moved_y_m - belief.mean.y - out_y_m]
    }

    /// Takes one sighting in, and gives its log-likelihood and what it said.
    fn update<const N: usize>(
        &mut self,
        view: &View,
        i: usize,
        seen: usize,
        state: &mut State<N>,
    ) -> (f64, Innovation) {
        let Seen { landmark, size, bearing_rad } = view.seen[seen];
        let odd = self.odd(view, i, seen, state);
        let Some(told) = odd.told(&state.covariance) else {
            let lost = [f64::NAN; 2];
            let innovation = Innovation { step: i, seen, plain: lost, white: lost, scale: [1.0; 2], genuine: 0.0 };
            return (f64::NEG_INFINITY, innovation);
        };
        let off_rad = view.off_rad(view.steps[i].pan_rad, bearing_rad);
        let elsewhere = self.shape.elsewhere(size, off_rad);
        let elsewhere = if view.aims { elsewhere } else { elsewhere * TAU.sqrt() * told.scale[1] };
        let [itself, mistaken] = self.of_itself_or_mistaken(landmark);
        let of_it = told.likely(itself);
        let mut part = told.part(of_it);
        if let Some(jumped) = self.jumped(&odd, &told, state) {
            part = part.or(jumped.part(jumped.likely(JUMPS.max(AGAIN * self.doubted) * itself)));
        }
        // A sighting of something else leaves the state as it is, and nobody knows for sure which it was (probabilistic
        // data association, Bar-Shalom and Tse 1975).
        let moved = part.likely;
        let as_it_was = Part { likely: mistaken * elsewhere, step: SVector::zeros(), covariance: state.covariance };
        let part = part.or(as_it_was);
        self.doubted = 1.0 - moved / part.likely;
        state.covariance = part.covariance;
        self.step(state, &part.step);
        let (white, scale, genuine) = (told.white, told.scale, of_it / part.likely);
        let innovation = Innovation { step: i, seen, plain: odd.plain.into(), white, scale, genuine };
        let innovation = if view.aims { innovation } else { innovation.of_size_alone() };
        (ln(part.likely), innovation)
    }
}

/// Derivatives with respect to the pose of a landmark's distance from the sensor and of its bearing: by the unit vector
/// towards it, the distance, and how the sensor's place changes with the heading.
fn by_pose([ux, uy]: [f64; 2], distance_m: f64, [swung_x, swung_y]: [f64; 2]) -> [RowVector3<f64>; 2] {
    let (across_x, across_y) = (uy / distance_m, -ux / distance_m);
    let far = RowVector3::new(-ux, -uy, -(ux * swung_x + uy * swung_y));
    [far, RowVector3::new(across_x, across_y, across_x * swung_x + across_y * swung_y - 1.0)]
}
