//! The camera in the moving head: when frames are due, what the shutter sees, what the vision reports.

use std::collections::VecDeque;

use asami_dataset::{Frame, Rng, Seed, Sighting, Size};
use nalgebra::{Isometry3, UnitQuaternion};
use rand::RngExt;

use super::blueprint::Blueprint;
use super::config::Head;
use crate::scenes::field::Field;
use crate::sensors::camera::{Camera, CameraConfig};
use crate::sensors::image::Image;
use crate::sensors::vision::{Neck, Pattern, Vision};

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
    rng: Rng,
    frames: u64,
}

impl Eye {
    /// An eye that has taken no frame yet.
    #[must_use]
    pub fn new(
        camera: &CameraConfig,
        head: &Head,
        blueprint: &Blueprint,
        field: &Field,
        time_step_s: f64,
        seed: Seed,
    ) -> Self {
        let neck = Neck {
            axis_ahead_m: blueprint.neck_m[0]
                + blueprint.neck_length_m * asami_math::elementary::sin(head.neck_lean_rad),
            camera_ahead_m: blueprint.head_from_camera.translation.x,
        };
        Self {
            camera: Camera::new(camera, field, seed.stream("camera")),
            vision: Vision::new(camera, neck, field.beacons.iter().map(Pattern::from).collect()),
            head_from_camera: blueprint.head_from_camera,
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
        let kept = self.frame_steps.ceil().max(0.5 * (self.frame_steps + self.reading_steps).ceil()) as usize + 1;
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
        let Some(close) = self.world_from_camera.front() else { return (frame, Vec::new()) };
        let image = self.camera.look(&self.opened(close), close);
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
        self.pan_rad.get(back).or(self.pan_rad.back()).copied().unwrap_or_default()
    }

    /// The latest frame; black before the first.
    #[must_use]
    pub fn image(&self) -> &Image {
        self.camera.image()
    }

    /// Where the camera was when the first row's shutter opened, between the two steps around that time.
    fn opened(&self, close: &Isometry3<f64>) -> Isometry3<f64> {
        let later = self.frame_steps.floor();
        let part = self.frame_steps - later;
        let pose = |back: usize| self.world_from_camera.get(back).or(self.world_from_camera.back()).unwrap_or(close);
        let (later, earlier) = (pose(later as usize), pose(later as usize + 1));
        between(later, earlier, part)
    }
}

/// The pose `part` of the way; for rotations small enough that chords are arcs.
fn between(from: &Isometry3<f64>, to: &Isometry3<f64>, part: f64) -> Isometry3<f64> {
    let translation = from.translation.vector.lerp(&to.translation.vector, part);
    let rotation = UnitQuaternion::new_normalize(from.rotation.lerp(&to.rotation, part));
    Isometry3::from_parts(translation.into(), rotation)
}
