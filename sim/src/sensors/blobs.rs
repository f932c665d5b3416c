//! Patches of one colour, found row by row from runs (Bruce, Balch and Veloso 2000, "Fast and
//! inexpensive color image segmentation for interactive robots").

use super::image::Image;
use super::paint::paint;
use crate::scenes::field::Colour;

/// One colour of the vision's calibration: a direction in the (Cb, Cr) plane and how far out.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hue {
    pub colour: Colour,
    /// The paint's chroma direction, times 64.
    axis: [i32; 2],
    /// Chroma along the axis from which on a pixel is this colour, times 64.
    strict: i32,
    /// Chroma along the axis from which on a pixel is partly this colour, times 64.
    loose: i32,
}

/// Greatest chroma off the axis of a mixed pixel, times 64.
const LOOSE_OFF_AXIS: i32 = 28 * 64;

impl Hue {
    /// The hue of a paint; a colourless one is found nowhere.
    pub fn of(colour: Colour) -> Option<Self> {
        let [_, cb, cr] = paint(colour).map(|level| f64::from(level) - 128.0);
        let chroma = (cb * cb + cr * cr).sqrt();
        (chroma > 30.0).then(|| Self {
            colour,
            axis: [(64.0 * cb / chroma).round() as i32, (64.0 * cr / chroma).round() as i32],
            strict: (64.0 * chroma * 2.0 / 3.0) as i32,
            loose: (64.0 * chroma / 3.0) as i32,
        })
    }

    fn along_and_off(&self, cb: u8, cr: u8) -> (i32, i32) {
        let (cb, cr) = (i32::from(cb) - 128, i32::from(cr) - 128);
        (cb * self.axis[0] + cr * self.axis[1], (cb * self.axis[1] - cr * self.axis[0]).abs())
    }

    /// Two thirds of the paint's chroma at least, and within 20 degrees of its direction.
    pub fn is(&self, cb: u8, cr: u8) -> bool {
        let (along, off) = self.along_and_off(cb, cr);
        along >= self.strict && off * 11 <= along * 4
    }

    /// One third of the paint's chroma at least: a pixel that is half this colour, more or less.
    pub fn is_partly(&self, cb: u8, cr: u8) -> bool {
        let (along, off) = self.along_and_off(cb, cr);
        along >= self.loose && off <= LOOSE_OFF_AXIS
    }

    /// Every pixel that [`is`](Self::is) this colour has |Cb - 128| or |Cr - 128| above this.
    fn least_side(&self) -> u8 {
        // The wedge's corners at its near end: nearest to colourless of all its pixels in one of them.
        let [x, y] = self.axis.map(|axis| f64::from(axis) / 64.0);
        let near = f64::from(self.strict) / 64.0;
        let sides = (-8..=8).map(|step| {
            let off = f64::from(step) / 8.0 * 4.0 / 11.0;
            let (cb, cr) = (near * (x - off * y), near * (y + off * x));
            cb.abs().max(cr.abs())
        });
        (sides.fold(f64::INFINITY, f64::min) - 3.0).max(0.0) as u8
    }
}

/// A patch of one colour, 4-connected.
#[derive(Clone, Copy, Debug)]
pub(super) struct Blob {
    /// Index of its hue.
    pub hue: usize,
    pub area: u32,
    /// Sum of its pixels' columns.
    pub sum_x: u64,
    /// First and last column and row, inclusive.
    pub x0: usize,
    pub x1: usize,
    pub y0: usize,
    pub y1: usize,
}

impl Blob {
    fn join(&mut self, other: &Blob) {
        self.area += other.area;
        self.sum_x += other.sum_x;
        self.x0 = self.x0.min(other.x0);
        self.x1 = self.x1.max(other.x1);
        self.y0 = self.y0.min(other.y0);
        self.y1 = self.y1.max(other.y1);
    }
}

/// Pixels of one hue side by side in a row.
#[derive(Clone, Copy, Debug)]
struct Run {
    hue: usize,
    start: usize,
    end: usize,
    blob: usize,
}

/// Finds blobs; keeps its memory between frames.
#[derive(Clone, Debug)]
pub(super) struct Segmenter {
    pub hues: Vec<Hue>,
    least_side: u8,
    above: Vec<Run>,
    here: Vec<Run>,
    /// Blobs so far, and for each the blob it was joined to (itself if none).
    found: Vec<(Blob, usize)>,
    pub blobs: Vec<Blob>,
}

/// Pixels skipped together where none is colourful.
const STRIDE: usize = 16;

impl Segmenter {
    pub fn new(hues: Vec<Hue>) -> Self {
        let least_side = hues.iter().map(Hue::least_side).min().unwrap_or(u8::MAX);
        Self { hues, least_side, above: Vec::new(), here: Vec::new(), found: Vec::new(), blobs: Vec::new() }
    }

    /// Fills `blobs` with those of at least `least_area` pixels.
    pub fn segment(&mut self, image: &Image, least_area: u32) {
        self.above.clear();
        self.found.clear();
        let [_, cb, cr] = image.planes();
        let width = image.width_px();
        for (y, (cb, cr)) in cb.chunks_exact(width).zip(cr.chunks_exact(width)).enumerate() {
            self.runs(cb, cr);
            self.connect(y);
            std::mem::swap(&mut self.above, &mut self.here);
        }
        for i in 0..self.found.len() {
            let root = root(&self.found, i);
            if root != i {
                let blob = self.found[i].0;
                self.found[root].0.join(&blob);
            }
        }
        self.blobs.clear();
        let whole = self.found.iter().enumerate().filter(|(i, (blob, to))| to == i && blob.area >= least_area);
        self.blobs.extend(whole.map(|(_, (blob, _))| *blob));
    }

    /// Fills `here` with the runs of one row.
    fn runs(&mut self, cb: &[u8], cr: &[u8]) {
        self.here.clear();
        let least = self.least_side;
        for (stride, (cb, cr)) in cb.chunks(STRIDE).zip(cr.chunks(STRIDE)).enumerate() {
            let colourful = cb
                .iter()
                .zip(cr)
                .fold(0, |greatest: u8, (cb, cr)| greatest.max(cb.abs_diff(128).max(cr.abs_diff(128))));
            if colourful <= least {
                continue;
            }
            for (i, (cb, cr)) in cb.iter().zip(cr).enumerate() {
                if let Some(hue) = self.hues.iter().position(|hue| hue.is(*cb, *cr)) {
                    let x = stride * STRIDE + i;
                    match self.here.last_mut() {
                        Some(run) if run.hue == hue && run.end == x => run.end += 1,
                        _ => self.here.push(Run { hue, start: x, end: x + 1, blob: usize::MAX }),
                    }
                }
            }
        }
    }

    /// Gives each run of the row to a blob, joining blobs that meet in it.
    fn connect(&mut self, y: usize) {
        let mut first = 0;
        for run in &mut self.here {
            while self.above.get(first).is_some_and(|above| above.end <= run.start) {
                first += 1;
            }
            for above in self.above[first..].iter().take_while(|above| above.start < run.end) {
                if above.hue != run.hue {
                    continue;
                }
                let theirs = root(&self.found, above.blob);
                if run.blob == usize::MAX {
                    run.blob = theirs;
                } else {
                    let ours = root(&self.found, run.blob);
                    self.found[ours.max(theirs)].1 = ours.min(theirs);
                }
            }
            let length = run.end - run.start;
            let part = Blob {
                hue: run.hue,
                area: length as u32,
                sum_x: ((run.start + run.end - 1) * length / 2) as u64,
                x0: run.start,
                x1: run.end - 1,
                y0: y,
                y1: y,
            };
            match self.found.get_mut(run.blob) {
                Some((blob, _)) => blob.join(&part),
                None => {
                    run.blob = self.found.len();
                    self.found.push((part, run.blob));
                }
            }
        }
    }
}

fn root(found: &[(Blob, usize)], mut i: usize) -> usize {
    while found[i].1 != i {
        i = found[i].1;
    }
    i
}
