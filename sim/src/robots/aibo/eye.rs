//! The camera in the moving head: when frames are due, what the shutter sees, what the vision reports.

use std::collections::VecDeque;

use asami_dataset::{Frame, Rng, Seed, Sighting, Size};
use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, sin};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};
use rand::RngExt;

use super::blueprint::Blueprint;
use super::config::Head;
use crate::effect::Glance;
use crate::knobs::EyeKnobs;
use crate::scenes::field::Field;
use crate::sensors::camera::{Camera, CameraConfig};
use crate::sensors::image::Image;
use crate::sensors::vision::{Neck, Pattern, Vision};

/// Height of the beacons that are mistaken sightings, and between which distances they seem to be, where the camera's
/// own limits are no narrower.
const LANDMARK_M: f64 = 0.2;
const NEAREST_M: f64 = 0.8;
const FARTHEST_M: f64 = 4.5;

/// Camera, shutter and vision.
pub struct Eye {
    camera: Camera,
    vision: Vision,
    head_from_camera: Isometry3<f64>,
    frame_rate_hz: f64,
    /// From the opening of the middle row's shutter, half-way through, to the last row's closing.
    half_frame_s: f64,
    /// From the first row's exposure to the last one's, in engine steps.
    frame_steps: f64,
    /// Poses of the camera at the latest steps, newest first.
    world_from_camera: VecDeque<Isometry3<f64>>,
    /// The head's pan at the same steps.
    pan_rad: VecDeque<f64>,
    /// The span of [`Head::pan_reading_span_s`] in engine steps.
    reading_steps: f64,
    /// By how much the image is older than its time stamp, in engine steps.
    delay_steps: f64,
    pan_offset_rad: f64,
    landmarks: Vec<u16>,
    view_rad: f64,
    heights_px: [f64; 2],
    rng: Rng,
    frames: u64,
}

impl Eye {
    /// An eye that has taken no frame yet; the vision knows nothing of its flaws.
    #[must_use]
    pub fn new(
        camera: &CameraConfig,
        head: &Head,
        blueprint: &Blueprint,
        field: &Field,
        flaws: &EyeKnobs,
        time_step_s: f64,
        seed: Seed,
    ) -> Self {
        let neck = Neck {
            axis_ahead_m: blueprint.neck_m[0] + blueprint.neck_length_m * sin(head.neck_lean_rad),
            camera_ahead_m: blueprint.head_from_camera.translation.x,
        };
        let mut head_from_camera = blueprint.head_from_camera;
        if flaws.pitch_rad != 0.0 {
            // About the camera's right.
            head_from_camera *= UnitQuaternion::from_axis_angle(&Vector3::x_axis(), flaws.pitch_rad);
        }
        let height_px = |distance_m: f64| camera.focal_px * LANDMARK_M / distance_m;
        Self {
            camera: Camera::flawed(camera, flaws, field, seed.stream("camera")),
            vision: Vision::new(camera, neck, field.beacons.iter().map(Pattern::from).collect()),
            head_from_camera,
            delay_steps: flaws.delay_s / time_step_s,
            pan_offset_rad: flaws.pan_offset_rad,
            landmarks: field.beacons.iter().map(|beacon| beacon.id).collect(),
            view_rad: 2.0 * atan2(0.5 * f64::from(camera.width_px), camera.focal_px),
            heights_px: [
                camera.least_height_px.max(height_px(FARTHEST_M)),
                camera.greatest_height_px.min(height_px(NEAREST_M)),
            ],
            frame_rate_hz: camera.frame_rate_hz,
            half_frame_s: 0.5 * camera.frame_s(),
            frame_steps: camera.frame_s() / time_step_s,
            world_from_camera: VecDeque::new(),
            pan_rad: VecDeque::new(),
            reading_steps: head.pan_reading_span_s / time_step_s,
            rng: seed.stream("pan_reading"),
            frames: 0,
        }
    }

    /// Takes note of where the head is and how far it is panned; to be called once an engine step.
    pub fn follow(&mut self, world_from_head: &Isometry3<f64>, pan_rad: f64) {
        let kept = (self.frame_steps + self.delay_steps)
            .ceil()
            .max(0.5 * (self.frame_steps + self.reading_steps).ceil()) as usize
            + 1;
        self.world_from_camera.push_front(world_from_head * self.head_from_camera);
        self.world_from_camera.truncate(kept);
        self.pan_rad.push_front(pan_rad);
        self.pan_rad.truncate(kept);
    }

    /// Whether a frame is complete at `now_s`: at the first step when its last row has been exposed.
    #[must_use]
    pub fn is_due(&self, now_s: f64) -> bool {
        // Both times are rounded multiples.
        now_s - self.half_frame_s >= self.frames as f64 / self.frame_rate_hz - 1e-9
    }

    /// Takes the frame that is complete: its time, which is when the middle row was exposed, with the head's pan as the
    /// robot pairs it with the frame; and what was seen.
    pub fn look(&mut self, now_s: f64) -> (Frame, Vec<Sighting>) {
        self.frames += 1;
        let t_s = (now_s - self.half_frame_s).max(0.0);
        let head_pan_rad = self.read_pan_rad();
        let frame = Frame { t_s, head_pan_rad };
        if self.world_from_camera.is_empty() {
            return (frame, Vec::new());
        }
        // Where the camera was when the first row's shutter opened and the last row's closed.
        let image = self.camera.look(&self.pose(self.frame_steps + self.delay_steps), &self.pose(self.delay_steps));
        let glimpses = self.vision.sight(image, head_pan_rad);
        let sighting = |glimpse: crate::sensors::vision::Glimpse| Sighting {
            t_s,
            landmark: glimpse.landmark,
            size: Size::HeightPx(glimpse.height_px),
            bearing_rad: glimpse.bearing_rad,
        };
        (frame, glimpses.into_iter().map(sighting).collect())
    }

    /// The head's pan when the image's middle rows were exposed, or read about then.
    fn read_pan_rad(&mut self) -> f64 {
        let mut back = 0.5 * self.frame_steps;
        if self.reading_steps > 0.0 {
            back += self.reading_steps * (self.rng.random::<f64>() - 0.5);
        }
        let back = back.round() as usize;
        let true_rad = self.pan_rad.get(back).or(self.pan_rad.back()).copied().unwrap_or_default();
        if self.pan_offset_rad == 0.0 { true_rad } else { wrap_rad(true_rad + self.pan_offset_rad) }
    }

    /// A frame as stages on its sightings are told of it.
    #[must_use]
    pub fn glance(&self, frame: Frame) -> Glance<'_> {
        Glance {
            frame,
            landmarks: &self.landmarks,
            view_rad: self.view_rad,
            sizes: self.heights_px.map(Size::HeightPx),
        }
    }

    /// The latest frame; black before the first.
    #[must_use]
    pub fn image(&self) -> &Image {
        self.camera.image()
    }

    /// Where the camera was so many engine steps ago, between the two steps around that time.
    fn pose(&self, steps: f64) -> Isometry3<f64> {
        let pose = |back: usize| {
            let oldest = self.world_from_camera.back();
            self.world_from_camera.get(back).or(oldest).copied().unwrap_or_else(Isometry3::identity)
        };
        if steps == 0.0 {
            return pose(0);
        }
        let later = steps.floor();
        let (later_pose, earlier_pose) = (pose(later as usize), pose(later as usize + 1));
        between(&later_pose, &earlier_pose, steps - later)
    }
}

/// The pose `part` of the way; for rotations small enough that chords are arcs.
fn between(from: &Isometry3<f64>, to: &Isometry3<f64>, part: f64) -> Isometry3<f64> {
    let translation = from.translation.vector.lerp(&to.translation.vector, part);
    let rotation = UnitQuaternion::new_normalize(from.rotation.lerp(&to.rotation, part));
    Isometry3::from_parts(translation.into(), rotation)
}
