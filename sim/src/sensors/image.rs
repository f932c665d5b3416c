//! A picture in three planes.

/// Luma and the two colour differences, 8 bits each, in rows from the top left, as the ERS-7's camera
/// gives them (ITU-R BT.601, full range).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Image {
    width_px: usize,
    height_px: usize,
    /// Y, Cb and Cr.
    pub(super) planes: [Vec<u8>; 3],
}

impl Image {
    /// A black picture.
    #[must_use]
    pub fn new(width_px: usize, height_px: usize) -> Self {
        let plane = |level: u8| vec![level; width_px * height_px];
        Self { width_px, height_px, planes: [plane(0), plane(128), plane(128)] }
    }

    /// Pixels in a row.
    #[must_use]
    pub fn width_px(&self) -> usize {
        self.width_px
    }

    /// Rows.
    #[must_use]
    pub fn height_px(&self) -> usize {
        self.height_px
    }

    /// Y, Cb and Cr, row after row.
    #[must_use]
    pub fn planes(&self) -> [&[u8]; 3] {
        [&self.planes[0], &self.planes[1], &self.planes[2]]
    }

    /// Red, green and blue of every pixel, row after row, to look at or to write to a file.
    #[must_use]
    pub fn to_rgb(&self) -> Vec<u8> {
        let [y, cb, cr] = self.planes();
        let mut rgb = Vec::with_capacity(3 * y.len());
        for ((y, cb), cr) in y.iter().zip(cb).zip(cr) {
            let (y, cb, cr) = (f64::from(*y), f64::from(*cb) - 128.0, f64::from(*cr) - 128.0);
            // ITU-R BT.601-7, section 2.5.
            let primaries = [y + 1.402 * cr, y - 0.344_136 * cb - 0.714_136 * cr, y + 1.772 * cb];
            rgb.extend(primaries.map(|level| (level + 0.5).clamp(0.0, 255.0) as u8));
        }
        rgb
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensors::paint::ycbcr;

    #[test]
    fn colours_survive_the_way_to_ycbcr_and_back() {
        for rgb in [[230, 90, 150], [225, 200, 40], [60, 100, 70], [0, 0, 0], [255, 255, 255]] {
            let mut image = Image::new(1, 1);
            for (plane, level) in image.planes.iter_mut().zip(ycbcr(rgb)) {
                plane[0] = level;
            }
            for (back, level) in image.to_rgb().iter().zip(rgb) {
                // Half a level of each plane, times the matrix's greatest row sum, and the last rounding.
                assert!(back.abs_diff(level) <= 2, "{back} for {level}");
            }
        }
    }
}
