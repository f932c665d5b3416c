//! The camera in the Aibo's nose: from the field and the camera's poses to pixels.
//!
//! A pinhole with square pixels. The camera's frame is x right, y down, z ahead. Cylinders are drawn
//! as their section through the axis that faces the camera, so that a beacon of height H at distance
//! d from a level camera is `focal_px * H / d` tall: 38388.7/d for 200 mm (Stronger 2008, section
//! 2.5.1). Pixels are covered in part, moving things are blurred over the exposure, and every pixel
//! is noisy. Rows are exposed one after another, as in the ERS-7's CMOS sensor: a nodding head
//! stretches and shrinks what it sees.

use asami_dataset::Rng;
use asami_math::elementary::{cos, ln};
use nalgebra::{Isometry3, Point3};
use rand::{Rng as _, RngExt};

use super::image::Image;
use super::paint::{CARPET, WALL, paint};
use super::raster::{Coverage, FULL, Quad, Window};
use crate::knobs::EyeKnobs;
use crate::scenes::field::{Colour, Cylinder, Field};

asami_dataset::parameters! {
    /// The camera. The default is the ERS-7's: 56.9 by 45.2 degrees on 208 by 160 pixels.
    pub struct CameraConfig {
        /// Width of the image.
        width_px: u32 = 208, "px", 32.0..=1024.0;
        /// Height of the image.
        height_px: u32 = 160, "px", 32.0..=1024.0;
        /// Focal length, in square pixels.
        focal_px: f64 = 191.943, "px", 20.0..=5000.0;
        /// Frames a second.
        frame_rate_hz: f64 = 20.0, "Hz", 1.0..=100.0;
        /// How long the shutter of one row stays open.
        exposure_s: f64 = 0.005, "s", 0.0..=0.05;
        /// From the top row's exposure to the bottom row's; the frame's time is half-way through the middle row's.
        readout_s: f64 = 0.02, "s", 0.0..=0.05;
        /// Standard deviation of a pixel's noise in each plane, in levels of 255.
        pixel_noise_sd: f64 = 4.0, "1", 0.0..=30.0;
        /// From the camera to the wall of the room, all around.
        wall_distance_m: f64 = 7.0, "m", 1.0..=100.0;
        /// Beacons that look smaller are not recognised.
        least_height_px: f64 = 0.0, "px", 0.0..=1024.0;
        /// Beacons that look larger are not recognised.
        greatest_height_px: f64 = 1024.0, "px", 1.0..=1024.0;
    }
}

impl CameraConfig {
    /// From the opening of the top row's shutter to the closing of the bottom row's.
    #[must_use]
    pub fn frame_s(&self) -> f64 {
        self.exposure_s + self.readout_s
    }
}

/// Levels of noise kept ready; rows start at random places in it.
const NOISE_TABLE: usize = 1 << 13;
/// A cylinder's upper band, its lower band, and the white post that it stands on.
const PARTS: usize = 3;
/// Nothing nearer to the camera than this is drawn.
const NEAREST_M: f64 = 0.05;

/// A camera that looks at a field.
#[derive(Clone, Debug)]
pub struct Camera {
    focal_px: f64,
    wall_distance_m: f64,
    /// Share of a frame's time for which one row is exposed; the rest passes between top and bottom row.
    exposed: f64,
    cylinders: Vec<Cylinder>,
    flaws: EyeKnobs,
    rng: Rng,
    noise: Vec<i16>,
    image: Image,
    /// Kept between frames for their memory.
    drawn: Vec<Drawn>,
    coverage: [Coverage; PARTS],
    cover: [Vec<i32>; PARTS],
    wall_foot: Vec<i32>,
}

/// A cylinder as it comes to stand in the image.
#[derive(Clone, Debug)]
struct Drawn {
    depth_m: f64,
    window: Window,
    /// For each part, where it is when the shutter opens and closes.
    parts: [[Quad; 2]; PARTS],
    paints: [[u8; 3]; PARTS],
}

impl Camera {
    /// A camera that sees the beacons and the clutter of `field`; `rng` is its stream of noise.
    #[must_use]
    pub fn new(config: &CameraConfig, field: &Field, mut rng: Rng) -> Self {
        let (width_px, height_px) = (config.width_px as usize, config.height_px as usize);
        let noise = gaussian_levels(config.pixel_noise_sd, NOISE_TABLE + width_px, &mut rng);
        let beacons = field.beacons.iter().map(|beacon| &beacon.body);
        Self {
            focal_px: config.focal_px,
            wall_distance_m: config.wall_distance_m,
            // A frame that takes no time has nothing moving in it.
            exposed: config.exposure_s / config.frame_s().max(f64::MIN_POSITIVE),
            cylinders: beacons.chain(&field.clutter).cloned().collect(),
            flaws: EyeKnobs::default(),
            rng,
            noise,
            image: Image::new(width_px, height_px),
            drawn: Vec::new(),
            coverage: Default::default(),
            cover: Default::default(),
            wall_foot: vec![0; width_px],
        }
    }

    /// A camera with another focal length than it is said to have, a lens that bends, more noise and rims that
    /// bloom. The room's horizon stays straight; no vision looks at it.
    #[must_use]
    pub fn flawed(config: &CameraConfig, flaws: &EyeKnobs, field: &Field, rng: Rng) -> Self {
        let config = CameraConfig {
            focal_px: config.focal_px * flaws.focal_ratio,
            pixel_noise_sd: config.pixel_noise_sd * flaws.noise_ratio,
            ..config.clone()
        };
        Self { flaws: flaws.clone(), ..Self::new(&config, field, rng) }
    }

    /// The picture taken while the camera moves from where the top row's shutter opens to where the
    /// bottom row's closes, [`CameraConfig::frame_s`] later.
    pub fn look(&mut self, world_from_open: &Isometry3<f64>, world_from_close: &Isometry3<f64>) -> &Image {
        self.paint_room(world_from_close);
        self.drawn.clear();
        for cylinder in &self.cylinders {
            self.drawn.extend(self.project(cylinder, world_from_open, world_from_close));
        }
        self.drawn.sort_by(|a, b| b.depth_m.total_cmp(&a.depth_m));
        for drawn in &self.drawn {
            compose(&mut self.image, drawn, &mut self.coverage, &mut self.cover);
        }
        self.add_noise();
        &self.image
    }

    /// The latest picture; black before the first.
    #[must_use]
    pub fn image(&self) -> &Image {
        &self.image
    }

    /// Carpet below, wall above. The wall's foot follows the horizon of each column.
    fn paint_room(&mut self, world_from_camera: &Isometry3<f64>) {
        let (width_px, height_px) = (self.image.width_px(), self.image.height_px());
        let down = world_from_camera.inverse_transform_vector(&-nalgebra::Vector3::z());
        let foot_slope = world_from_camera.translation.z / self.wall_distance_m;
        let rows = 256.0 * height_px as f64;
        for (column, foot) in self.wall_foot.iter_mut().enumerate() {
            let x = (column as f64 + 0.5 - 0.5 * width_px as f64) / self.focal_px;
            // The ray (x, y, 1) is level where down . ray = 0, and meets the foot foot_slope below.
            // Looking straight up or down, the column lies on one side.
            let ahead = down.x * x + down.z;
            let y = if down.y > 0.05 {
                (foot_slope * (1.0 + x * x).sqrt() - ahead) / down.y
            } else {
                -ahead.signum() * 1e3
            };
            *foot = (256.0 * (0.5 * height_px as f64 + self.focal_px * y)).clamp(-512.0, rows + 512.0) as i32;
        }
        let (highest, lowest) =
            self.wall_foot.iter().fold((i32::MAX, i32::MIN), |(low, high), foot| (low.min(*foot), high.max(*foot)));
        for (plane, (wall, carpet)) in self.image.planes.iter_mut().zip(WALL.into_iter().zip(CARPET)) {
            for (row, pixels) in plane.chunks_exact_mut(width_px).enumerate() {
                let top = 256 * row as i32;
                if top + 256 <= highest {
                    pixels.fill(wall);
                } else if top >= lowest {
                    pixels.fill(carpet);
                } else {
                    for (pixel, foot) in pixels.iter_mut().zip(&self.wall_foot) {
                        let of_wall = foot.wrapping_sub(top).clamp(0, 256);
                        let more = (i32::from(wall) - i32::from(carpet)).wrapping_mul(of_wall);
                        *pixel = (i32::from(carpet).wrapping_add(more.wrapping_add(128) >> 8)) as u8;
                    }
                }
            }
        }
    }

    /// Where a cylinder comes to stand in the image; `None` if it does not.
    fn project(&self, cylinder: &Cylinder, open: &Isometry3<f64>, close: &Isometry3<f64>) -> Option<Drawn> {
        let (before, _) = self.parts(cylinder, open)?;
        let (after, depth_m) = self.parts(cylinder, close)?;
        let mut opened = [Quad::default(); PARTS];
        let mut closed = opened;
        for part in 0..PARTS {
            for corner in 0..4 {
                let (before, after) = (before[part][corner], after[part][corner]);
                opened[part][corner] = self.exposed_at(before, after, 0.0);
                closed[part][corner] = self.exposed_at(before, after, self.exposed);
            }
        }
        let corners = opened.iter().chain(&closed).flatten().copied();
        let window = Window::around(corners, self.image.width_px(), self.image.height_px())?;
        let [upper, lower] = cylinder.bands.map(paint);
        let parts = std::array::from_fn(|i| [opened[i], closed[i]]);
        Some(Drawn { depth_m, window, parts, paints: [upper, lower, paint(Colour::White)] })
    }

    /// Where a point that moves evenly through the image during the frame is, `after` its row's shutter opened;
    /// times in shares of the frame's time.
    fn exposed_at(&self, start: [f64; 2], end: [f64; 2], after: f64) -> [f64; 2] {
        let per_row = (1.0 - self.exposed) / self.image.height_px() as f64;
        let [across, down] = [end[0] - start[0], end[1] - start[1]];
        // v = start + down * s meets its row's time s = per_row * v + after. A point as fast as the readout is never
        // caught, or always; at half that speed the picture is beyond use.
        let outrun = (1.0 - per_row * down).max(0.5);
        let s = (per_row * start[1] + after) / outrun;
        [start[0] + across * s, start[1] + down * s]
    }

    /// The parts of a cylinder in pixels, seen from one pose, and the depth of its middle.
    fn parts(&self, cylinder: &Cylinder, world_from_camera: &Isometry3<f64>) -> Option<([Quad; PARTS], f64)> {
        let place = world_from_camera.translation;
        let (x_m, y_m) = (cylinder.x_m - place.x, cylinder.y_m - place.y);
        let range_m = (x_m * x_m + y_m * y_m).sqrt();
        if range_m < cylinder.radius_m + NEAREST_M {
            return None;
        }
        // To the right, seen from the camera.
        let (side_x_m, side_y_m) = (y_m / range_m * cylinder.radius_m, -x_m / range_m * cylinder.radius_m);
        let half_m = 0.5 * cylinder.height_m;
        let heights_m = [cylinder.base_m + cylinder.height_m, cylinder.base_m + half_m, cylinder.base_m, 0.0];
        let mut rims = [[[0.0; 2]; 2]; PARTS + 1];
        let mut depth_m = 0.0;
        for (rim, z_m) in rims.iter_mut().zip(heights_m) {
            for (corner, side) in rim.iter_mut().zip([-1.0, 1.0]) {
                let world = Point3::new(cylinder.x_m + side * side_x_m, cylinder.y_m + side * side_y_m, z_m);
                let seen = world_from_camera.inverse_transform_point(&world);
                if seen.z < NEAREST_M {
                    return None;
                }
                depth_m += seen.z / 8.0;
                let focal_px = if self.flaws.distortion == 0.0 {
                    self.focal_px
                } else {
                    let r2 = (seen.x * seen.x + seen.y * seen.y) / (seen.z * seen.z);
                    self.focal_px * self.flaws.bend(r2)
                };
                *corner = [
                    0.5 * self.image.width_px() as f64 + focal_px * seen.x / seen.z,
                    0.5 * self.image.height_px() as f64 + focal_px * seen.y / seen.z,
                ];
            }
        }
        self.bloom(&mut rims);
        let quads = std::array::from_fn(|i| [rims[i][0], rims[i][1], rims[i + 1][1], rims[i + 1][0]]);
        Some((quads, depth_m))
    }

    /// Bands grow over their rims, by half of what their height grows.
    fn bloom(&self, rims: &mut [[[f64; 2]; 2]; PARTS + 1]) {
        // What shrinks is never turned inside out.
        let narrowest_px = rims[0][1][0] - rims[0][0][0];
        let by_px = (0.5 * self.flaws.bloom_px).max(-0.45 * narrowest_px.max(0.0));
        for [left, right] in &mut rims[..PARTS] {
            left[0] -= by_px;
            right[0] += by_px;
        }
        let [top, _, foot, _] = rims;
        for (top, foot) in top.iter_mut().zip(foot) {
            top[1] -= by_px;
            foot[1] += by_px;
        }
    }

    fn add_noise(&mut self) {
        let width_px = self.image.width_px();
        for row in 0..self.image.height_px() {
            let draw = self.rng.next_u64();
            for (i, plane) in self.image.planes.iter_mut().enumerate() {
                let start = (draw >> (16 * i)) as usize % NOISE_TABLE;
                let levels = &self.noise[start..start + width_px];
                // Wrapping, for overflow checks would keep the loop from being vectorised; nothing wraps.
                for (pixel, level) in plane[row * width_px..(row + 1) * width_px].iter_mut().zip(levels) {
                    *pixel = i16::from(*pixel).wrapping_add(*level).clamp(0, 255) as u8;
                }
            }
        }
    }
}

/// Lays one cylinder over the picture.
fn compose(image: &mut Image, drawn: &Drawn, coverage: &mut [Coverage; PARTS], cover: &mut [Vec<i32>; PARTS]) {
    let window = &drawn.window;
    let width_px = image.width_px();
    for ((coverage, cover), [open, close]) in coverage.iter_mut().zip(cover.iter_mut()).zip(&drawn.parts) {
        coverage.draw(window, open, close);
        cover.clear();
        cover.resize(window.width(), 0);
    }
    for row in 0..window.height() {
        for (cover, coverage) in cover.iter_mut().zip(coverage.iter()) {
            for (cover, step) in cover.iter_mut().zip(coverage.step(row)) {
                *cover += step;
            }
        }
        let start = (window.y0 + row) * width_px + window.x0;
        for (i, plane) in image.planes.iter_mut().enumerate() {
            let [upper, lower, post] = drawn.paints.map(|paint| i32::from(paint[i]));
            let covers = cover[0].iter().zip(&cover[1]).zip(&cover[2]);
            for (pixel, ((of_upper, of_lower), of_post)) in plane[start..start + window.width()].iter_mut().zip(covers)
            {
                // Wrapping, as in add_noise.
                let behind = FULL.wrapping_sub(*of_upper).wrapping_sub(*of_lower).wrapping_sub(*of_post);
                let sum = behind
                    .wrapping_mul(i32::from(*pixel))
                    .wrapping_add(upper.wrapping_mul(*of_upper))
                    .wrapping_add(lower.wrapping_mul(*of_lower))
                    .wrapping_add(post.wrapping_mul(*of_post));
                *pixel = (sum.wrapping_add(FULL / 2) >> FULL.ilog2()) as u8;
            }
        }
    }
}

/// Normal draws of mean 0, rounded to whole levels (Box and Muller 1958).
fn gaussian_levels(sd: f64, count: usize, rng: &mut Rng) -> Vec<i16> {
    let mut normal = || {
        let (radius, angle) = (1.0 - rng.random::<f64>(), std::f64::consts::TAU * rng.random::<f64>());
        (-2.0 * ln(radius)).sqrt() * cos(angle)
    };
    (0..count).map(|_| (sd * normal()).round() as i16).collect()
}
