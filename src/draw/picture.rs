//! Pixels: what a camera sees, as PNG (Portable Network Graphics, 3rd edition, W3C 2025) inside SVG.

use std::io::Write as _;

use flate2::{Compression, Crc, write::ZlibEncoder};

use super::svg;

/// An image of 8-bit RGB pixels with a title and a caption.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Short name, unique in a report.
    pub name: String,
    /// What is seen, in a few words.
    pub title: String,
    /// What it shows, what is good, what to do about it if it is not.
    pub caption: String,
    width_px: u32,
    height_px: u32,
    rgb: Vec<u8>,
    magnified: u32,
}

impl Picture {
    /// An image of `width_px` x `height_px` pixels, rows from the top, three bytes a pixel; missing
    /// bytes are black, surplus bytes are left out.
    #[must_use]
    pub fn new(name: &str, title: &str, width_px: u32, height_px: u32, rgb: impl Into<Vec<u8>>) -> Self {
        let mut rgb = rgb.into();
        rgb.resize(width_px as usize * height_px as usize * 3, 0);
        let (name, title) = (name.to_owned(), title.to_owned());
        Self { name, title, caption: String::new(), width_px, height_px, rgb, magnified: 2 }
    }

    /// Says what the picture shows.
    #[must_use]
    pub fn caption(mut self, caption: impl Into<String>) -> Self {
        self.caption = caption.into();
        self
    }

    /// The pixels, as given to [`Picture::new`].
    #[must_use]
    pub fn rgb(&self) -> &[u8] {
        &self.rgb
    }

    /// Shows each pixel as a square of this many CSS pixels.
    #[must_use]
    pub fn magnified(mut self, times: u32) -> Self {
        self.magnified = times.clamp(1, 64);
        self
    }

    /// Width as shown, in CSS pixels.
    #[must_use]
    pub fn shown_width_px(&self) -> u32 {
        self.width_px * self.magnified
    }

    /// The file that other programs open.
    #[must_use]
    pub fn png(&self) -> Vec<u8> {
        png(self.width_px, self.height_px, &self.rgb)
    }

    /// The picture as an element of an HTML page.
    #[must_use]
    pub fn inline_svg(&self) -> String {
        let (width, height) = (self.shown_width_px(), self.height_px * self.magnified);
        let mut out = svg::open(width, height + 26, &format!("{}: {}", self.name, self.title));
        let title = svg::escape(&self.title);
        out.push_str(&format!(
            "<text class=\"ink\" x=\"0\" y=\"17\" font-weight=\"600\" fill=\"{}\">{title}</text>",
            super::INK
        ));
        let data = base64(&self.png());
        out.push_str(&format!(
            "<image x=\"0\" y=\"26\" width=\"{width}\" height=\"{height}\" style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{data}\"/></svg>"
        ));
        out
    }

    /// The picture as an SVG file of its own.
    #[must_use]
    pub fn svg(&self) -> String {
        svg::standalone(&self.inline_svg())
    }
}

/// A PNG of RGB pixels: signature, header, one data chunk, end.
fn png(width_px: u32, height_px: u32, rgb: &[u8]) -> Vec<u8> {
    let mut out = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut header = Vec::with_capacity(13);
    header.extend(width_px.to_be_bytes());
    header.extend(height_px.to_be_bytes());
    // 8 bits, RGB, and the only compression, filtering and no interlacing.
    header.extend([8, 2, 0, 0, 0]);
    chunk(*b"IHDR", &header, &mut out);
    let mut lines = Vec::with_capacity(rgb.len() + height_px as usize);
    for line in rgb.chunks(width_px.max(1) as usize * 3) {
        lines.push(0);
        lines.extend_from_slice(line);
    }
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::default());
    // Writing to memory does not fail.
    let packed = encoder.write_all(&lines).and_then(|()| encoder.finish()).unwrap_or_default();
    chunk(*b"IDAT", &packed, &mut out);
    chunk(*b"IEND", &[], &mut out);
    out
}

fn chunk(kind: [u8; 4], content: &[u8], out: &mut Vec<u8>) {
    let mut crc = Crc::new();
    crc.update(&kind);
    crc.update(content);
    out.extend((content.len() as u32).to_be_bytes());
    out.extend(kind);
    out.extend(content);
    out.extend(crc.sum().to_be_bytes());
}

/// RFC 4648, section 4.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut out = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let word = three.iter().enumerate().fold(0u32, |word, (i, byte)| word | u32::from(*byte) << (16 - 8 * i));
        for i in 0..4 {
            let letter = LETTERS[(word >> (18 - 6 * i)) as usize & 63];
            out.push(if i <= three.len() { char::from(letter) } else { '=' });
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use std::io::Read as _;

    use flate2::read::ZlibDecoder;

    use super::*;

    #[test]
    fn base64_gives_the_test_vectors_of_rfc_4648() {
        let vectors = [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")];
        for (plain, coded) in vectors {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }

    #[test]
    fn png_holds_the_pixels_under_valid_checksums() {
        let rgb: Vec<u8> = (0..4 * 3 * 3).map(|i| (i * 7) as u8).collect();
        let file = Picture::new("p", "", 4, 3, rgb.clone()).png();
        let mut rest = &file[8..];
        let (mut kinds, mut lines) = (Vec::new(), Vec::new());
        while !rest.is_empty() {
            let length = u32::from_be_bytes(rest[..4].try_into().unwrap()) as usize;
            let mut crc = Crc::new();
            crc.update(&rest[4..8 + length]);
            assert_eq!(crc.sum().to_be_bytes(), rest[8 + length..12 + length]);
            kinds.push(rest[4..8].to_vec());
            if kinds.last().unwrap() == b"IDAT" {
                ZlibDecoder::new(&rest[8..8 + length]).read_to_end(&mut lines).unwrap();
            }
            rest = &rest[12 + length..];
        }
        assert_eq!(kinds, [b"IHDR", b"IDAT", b"IEND"]);
        assert_eq!(file[16..24], [0, 0, 0, 4, 0, 0, 0, 3]);
        let pixels: Vec<u8> = lines.chunks(13).flat_map(|line| line[1..].to_vec()).collect();
        assert_eq!(pixels, rgb);
    }

    #[test]
    fn wrong_sizes_still_make_a_picture() {
        for picture in
            [Picture::new("p", "", 0, 0, []), Picture::new("p", "", 2, 2, [1, 2]), Picture::new("p", "", 1, 1, [9; 50])]
        {
            assert!(picture.svg().contains("data:image/png;base64,iVBORw0KGgo"));
        }
    }
}
