//! From pixels to sightings: all that the robot learns of the world.
//!
//! The vision is given an image and the head's pan. Beyond these it knows what the robot's makers
//! told it: the camera, the neck, and what beacons look like. It knows nothing of where anything
//! stands.
//!
//! Pixels are told apart by their chroma. A beacon is a patch of its upper colour right above a patch
//! of its lower colour, of the right proportions and clear of the image's border. Its height is
//! counted column by column in whole pixels, mixed pixels at the upper and lower end counting half,
//! and averaged over the columns. Off the image's centre a flat image shows things larger by
//! 1/cos(angle); heights are those that the beacon would have had in the centre.

use asami_math::angle::wrap_rad;
use asami_math::elementary::{atan2, sin_cos};

use super::blobs::{Blob, Hue, Segmenter};
use super::camera::CameraConfig;
use super::image::Image;
use crate::scenes::field::{Colour, Landmark};

/// Where the neck holds the camera, in the robot's frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neck {
    /// The pan axis, ahead of the body's centre.
    pub axis_ahead_m: f64,
    /// The camera, ahead of the pan axis along the head's direction.
    pub camera_ahead_m: f64,
}

/// What a beacon looks like.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    /// Its name in sightings.
    pub landmark: u16,
    /// Colours of the upper and of the lower half.
    pub bands: [Colour; 2],
    /// Height of both bands together.
    pub height_m: f64,
    /// Width.
    pub width_m: f64,
}

impl From<&Landmark> for Pattern {
    fn from(beacon: &Landmark) -> Self {
        let body = &beacon.body;
        Self { landmark: beacon.id, bands: body.bands, height_m: body.height_m, width_m: 2.0 * body.radius_m }
    }
}

/// One beacon found in one image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glimpse {
    /// Which beacon.
    pub landmark: u16,
    /// Height in the image, as if in its centre.
    pub height_px: f64,
    /// From the body's straight ahead, seen from the body's centre, counter-clockwise, in
    /// `[-pi, pi)`. The camera is off that centre; its parallax is taken out with the distance that
    /// the apparent height stands for.
    pub bearing_rad: f64,
}

/// Smallest patch that counts, in pixels.
const LEAST_AREA: u32 = 4;
/// Mixed pixels looked for beyond a band's end: blur spreads an end over no more.
const MIXED_ROWS: usize = 2;

/// The robot's vision.
#[derive(Clone, Debug)]
pub struct Vision {
    focal_px: f64,
    /// Heights that are reported, as if in the image's centre.
    heights_px: [f64; 2],
    neck: Neck,
    patterns: Vec<(Pattern, [usize; 2])>,
    segmenter: Segmenter,
}

impl Vision {
    /// Knows the camera and the neck, and looks for `patterns`. Patterns with a colourless band are
    /// never found.
    #[must_use]
    pub fn new(camera: &CameraConfig, neck: Neck, patterns: Vec<Pattern>) -> Self {
        let mut hues: Vec<Hue> = Vec::new();
        let mut index = |colour: Colour| {
            let hue = Hue::of(colour)?;
            let known = hues.iter().position(|known| known.colour == hue.colour);
            Some(known.unwrap_or_else(|| {
                hues.push(hue);
                hues.len() - 1
            }))
        };
        let patterns = patterns
            .into_iter()
            .filter_map(|pattern| {
                let [upper, lower] = pattern.bands.map(&mut index);
                Some((pattern, [upper?, lower?]))
            })
            .collect();
        let heights_px = [camera.least_height_px, camera.greatest_height_px];
        Self { focal_px: camera.focal_px, heights_px, neck, patterns, segmenter: Segmenter::new(hues) }
    }

    /// What one image shows, at most one glimpse of each beacon; `head_pan_rad` is counter-clockwise.
    pub fn sight(&mut self, image: &Image, head_pan_rad: f64) -> Vec<Glimpse> {
        self.segmenter.segment(image, LEAST_AREA);
        let blobs = &self.segmenter.blobs;
        let mut glimpses = Vec::new();
        for (pattern, hues) in &self.patterns {
            let of = |hue: usize| blobs.iter().filter(move |blob| blob.hue == hue);
            let pairs = of(hues[0]).flat_map(|upper| of(hues[1]).map(move |lower| (upper, lower)));
            let stacks = pairs.filter(|(upper, lower)| is_stack(upper, lower));
            let Some((upper, lower)) = stacks.max_by_key(|(upper, lower)| upper.area + lower.area) else { continue };
            let measured = measure(image, [upper, lower], hues.map(|hue| &self.segmenter.hues[hue]));
            let glimpse = measured
                .filter(|extent| extent.fits(pattern))
                .map(|extent| self.glimpse(pattern, &extent, image, head_pan_rad));
            let [least_px, greatest_px] = self.heights_px;
            glimpses.extend(glimpse.filter(|glimpse| (least_px..=greatest_px).contains(&glimpse.height_px)));
        }
        glimpses
    }

    /// Height and bearing as reported, out of rows and columns.
    fn glimpse(&self, pattern: &Pattern, extent: &Extent, image: &Image, head_pan_rad: f64) -> Glimpse {
        let left = (0.5 * image.width_px() as f64 - extent.centre_px) / self.focal_px;
        let height_px = extent.height_px() / (1.0 + left * left).sqrt();
        // In the head's frame, from the pan axis: ahead along the camera's axis, and left.
        let depth_m = self.focal_px * pattern.height_m / extent.height_px();
        let (ahead_m, left_m) = (self.neck.camera_ahead_m + depth_m, depth_m * left);
        let (sin_pan, cos_pan) = sin_cos(head_pan_rad);
        let body_ahead_m = self.neck.axis_ahead_m + ahead_m * cos_pan - left_m * sin_pan;
        let body_left_m = ahead_m * sin_pan + left_m * cos_pan;
        Glimpse { landmark: pattern.landmark, height_px, bearing_rad: wrap_rad(atan2(body_left_m, body_ahead_m)) }
    }
}

/// Whether one patch stands right on top of the other.
fn is_stack(upper: &Blob, lower: &Blob) -> bool {
    let (left, right) = (upper.x0.max(lower.x0), upper.x1.min(lower.x1));
    let narrower = (upper.x1 - upper.x0).min(lower.x1 - lower.x0) + 1;
    let overlaps = right + 1 > left && 2 * (right + 1 - left) > narrower;
    // Mixed pixels part the bands by a row or two; roll lets their rows overlap.
    let slack = 2 + narrower / 4;
    overlaps && lower.y0 <= upper.y1 + 1 + slack && upper.y1 <= lower.y0 + slack && upper.y0 < lower.y0
}

/// Size and place of a stack of two bands, in pixels of the image.
#[derive(Clone, Copy, Debug)]
struct Extent {
    /// Heights of the upper and lower band.
    bands_px: [f64; 2],
    width_px: f64,
    /// Middle column, from the image's left border.
    centre_px: f64,
}

impl Extent {
    fn height_px(&self) -> f64 {
        self.bands_px[0] + self.bands_px[1]
    }

    /// Whether a beacon could look like this with nothing before it: bands of one height, and as wide
    /// as it is tall. Ends are good to half a pixel or so, and a panning head smears the sides.
    fn fits(&self, pattern: &Pattern) -> bool {
        let height_px = self.height_px();
        let width_px = height_px * pattern.width_m / pattern.height_m;
        let uneven_px = (self.bands_px[0] - self.bands_px[1]).abs();
        uneven_px <= 1.25 + 0.04 * height_px
            && self.width_px >= 0.7 * width_px - 1.5
            && self.width_px <= 1.4 * width_px + 1.5
    }
}

/// Measures a stack; `None` where the image's border cuts it.
fn measure(image: &Image, [upper, lower]: [&Blob; 2], hues: [&Hue; 2]) -> Option<Extent> {
    let (width, height) = (image.width_px(), image.height_px());
    let [_, cb, cr] = image.planes();
    let is = |hue: &Hue, x: usize, y: usize| hue.is(cb[y * width + x], cr[y * width + x]);
    let is_partly = |hue: &Hue, x: usize, y: usize| hue.is_partly(cb[y * width + x], cr[y * width + x]);
    if upper.x0.min(lower.x0) == 0 || upper.x1.max(lower.x1) + 1 >= width || upper.y0 == 0 || lower.y1 + 1 >= height {
        return None;
    }
    let (mut left, mut right) = (upper.x0.max(lower.x0), upper.x1.min(lower.x1));
    // The outermost columns are mixed pixels from top to bottom.
    if right >= left + 3 {
        (left, right) = (left + 1, right - 1);
    }
    let (mut columns, mut bands_px) = (0.0, [0.0; 2]);
    for x in left..=right {
        let mut of_upper = (upper.y0..=upper.y1).filter(|y| is(hues[0], x, *y));
        let mut of_lower = (lower.y0..=lower.y1).filter(|y| is(hues[1], x, *y));
        let (Some(top), Some(below)) = (of_upper.next(), of_lower.next()) else { continue };
        let (above, bottom) = (of_upper.next_back().unwrap_or(top), of_lower.next_back().unwrap_or(below));
        let mixed_above = (0..top).rev().take(MIXED_ROWS).take_while(|y| is_partly(hues[0], x, *y)).count();
        let mixed_below = (bottom + 1..height).take(MIXED_ROWS).take_while(|y| is_partly(hues[1], x, *y)).count();
        if mixed_above >= top || bottom + mixed_below + 1 >= height {
            return None;
        }
        let split = 0.5 * (above + 1 + below) as f64;
        columns += 1.0;
        bands_px[0] += split - (top as f64 - 0.5 * mixed_above as f64);
        bands_px[1] += (bottom + 1) as f64 + 0.5 * mixed_below as f64 - split;
    }
    let area = f64::from(upper.area + lower.area);
    let bands_px = (columns > 0.0).then(|| bands_px.map(|sum| sum / columns))?;
    Some(Extent {
        bands_px,
        width_px: area / (bands_px[0] + bands_px[1]),
        centre_px: (upper.sum_x + lower.sum_x) as f64 / area + 0.5,
    })
}
