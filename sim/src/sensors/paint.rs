//! What colours look like to the camera. The vision is calibrated to the same paints.

use crate::scenes::field::Colour;

/// Carpet of the field, in Y, Cb and Cr.
pub(super) const CARPET: [u8; 3] = ycbcr([62, 104, 70]);
/// Wall of the room.
pub(super) const WALL: [u8; 3] = ycbcr([190, 186, 178]);

/// A paint's Y, Cb and Cr.
pub(super) fn paint(colour: Colour) -> [u8; 3] {
    ycbcr(match colour {
        Colour::Pink => [230, 90, 150],
        Colour::Yellow => [225, 200, 40],
        Colour::Blue => [60, 140, 220],
        Colour::Green => [70, 200, 80],
        Colour::Orange => [235, 110, 50],
        Colour::White => [235, 235, 235],
        Colour::Grey => [120, 120, 120],
    })
}

/// ITU-R BT.601, full range, in thousandths.
pub(super) const fn ycbcr([r, g, b]: [u8; 3]) -> [u8; 3] {
    let (r, g, b) = (r as i32, g as i32, b as i32);
    let y = 299 * r + 587 * g + 114 * b;
    let cb = 128_000 + (-169 * r - 331 * g + 500 * b);
    let cr = 128_000 + (500 * r - 419 * g - 81 * b);
    [level(y), level(cb), level(cr)]
}

const fn level(thousandths: i32) -> u8 {
    let level = (thousandths + 500) / 1000;
    if level > 255 { 255 } else { level as u8 }
}
