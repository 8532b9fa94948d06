//! TGA in all the kinds that programs write: grey, colours of 15, 16, 24 and 32 bits, and palettes of these,
//! packed or not, from any of the four corners. (The crate that reads BMP mirrors some of them, shifts
//! palettes that do not begin at 0 and refuses 15 and 16 bits.)

/// Bytes of a header.
const HEADER: usize = 18;

/// Why it cannot be read.
type Broken = &'static str;

const SHORT: Broken = "it is not whole";

/// A TGA whose header was read.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tga<'a> {
    /// Width and height, pixels.
    pub(super) size: (u16, u16),
    /// Channels of a pixel as it comes out: grey, grey and alpha, three colours, three colours and alpha.
    pub(super) channels: usize,
    /// The file says that a channel of alpha is none.
    pub(super) alpha_is_unused: bool,
    kind: Kind<'a>,
    /// Bytes of a pixel in the file.
    bytes: usize,
    /// Pixels come in packets, many of them one pixel that is repeated.
    packed: bool,
    from_right: bool,
    from_top: bool,
    /// All after the header, the name and the palette.
    pixels: &'a [u8],
}

/// What the number of a pixel is.
#[derive(Debug, Clone, Copy)]
enum Kind<'a> {
    Grey,
    Colour,
    /// A number into a palette.
    Palette {
        colours: &'a [u8],
        /// Bytes of a colour.
        bytes: usize,
        /// Number of the first that is there.
        first: usize,
    },
}

impl<'a> Tga<'a> {
    /// Reads the header of a file.
    ///
    /// # Errors
    /// A sentence.
    pub(super) fn of(file: &'a [u8]) -> Result<Self, Broken> {
        let (&header, rest) = file.split_first_chunk::<HEADER>().ok_or(SHORT)?;
        let word = |at: usize| u16::from_le_bytes([header[at], header[at + 1]]);
        let [name, has_palette, kind, ..] = header;
        let [depth, descriptor] = [header[16], header[17]];
        let rest = rest.get(usize::from(name)..).ok_or(SHORT)?;
        let entry = header[7];
        let length = match has_palette {
            1 => usize::from(word(5)) * bytes_of(entry),
            _ => 0,
        };
        let (colours, pixels) = rest.split_at_checked(length).ok_or(SHORT)?;
        let alpha_bits = descriptor & 15;
        let (kind, channels) = match kind & !8 {
            1 if has_palette == 1 && matches!(depth, 8 | 16) => {
                let kind = Kind::Palette {
                    colours,
                    bytes: bytes_of(entry),
                    first: usize::from(word(3)),
                };
                (kind, channels(entry, alpha_bits).ok_or(KIND)?)
            }
            2 => (Kind::Colour, channels(depth, alpha_bits).ok_or(KIND)?),
            3 if matches!(depth, 8 | 16) => (Kind::Grey, bytes_of(depth)),
            _ => return Err(KIND),
        };
        Ok(Self {
            size: (word(12), word(14)),
            channels,
            alpha_is_unused: alpha_bits == 0,
            kind,
            bytes: bytes_of(depth),
            packed: header[2] & 8 != 0,
            from_right: descriptor & 0x10 != 0,
            from_top: descriptor & 0x20 != 0,
            pixels,
        })
    }

    /// Writes all pixels, row by row from the upper left, to `out`, which is as long as they are.
    ///
    /// # Errors
    /// A sentence.
    pub(super) fn read(&self, out: &mut [u8]) -> Result<(), Broken> {
        let (width, height) = (usize::from(self.size.0), usize::from(self.size.1));
        let mut rest = self.pixels;
        let (mut left, mut repeats, mut colour) = (0, false, [0; 4]);
        for row in 0..height {
            let row = match self.from_top {
                true => row,
                false => height - 1 - row,
            };
            for column in 0..width {
                let begins = left == 0;
                if begins && self.packed {
                    let (&packet, tail) = rest.split_first().ok_or(SHORT)?;
                    rest = tail;
                    (left, repeats) = (usize::from(packet & 127) + 1, packet & 128 != 0);
                }
                if begins || !repeats {
                    let (pixel, tail) = rest.split_at_checked(self.bytes).ok_or(SHORT)?;
                    rest = tail;
                    colour = self.colour(pixel)?;
                }
                left = left.saturating_sub(1);
                let column = match self.from_right {
                    true => width - 1 - column,
                    false => column,
                };
                let at = (row * width + column) * self.channels;
                if let Some(slot) = out.get_mut(at..at + self.channels) {
                    slot.copy_from_slice(&colour[..self.channels]);
                }
            }
        }
        Ok(())
    }

    /// Channels of a pixel.
    fn colour(&self, pixel: &[u8]) -> Result<[u8; 4], Broken> {
        match self.kind {
            Kind::Grey => Ok([pixel[0], pixel.last().copied().unwrap_or(0), 0, 0]),
            Kind::Colour => Ok(rgba(pixel)),
            Kind::Palette {
                colours,
                bytes,
                first,
            } => {
                let number = pixel
                    .iter()
                    .rev()
                    .fold(0, |number, &byte| number << 8 | usize::from(byte));
                let at = number.checked_sub(first).map(|number| number * bytes);
                let colour = at.and_then(|at| colours.get(at..at + bytes));
                colour
                    .map(rgba)
                    .ok_or("it has pixels of colours that are not in its palette")
            }
        }
    }
}

const KIND: Broken = "its pixels are of a kind that TGA does not have";

fn bytes_of(bits: u8) -> usize {
    usize::from(bits.div_ceil(8))
}

/// Channels of a colour of so many bits.
fn channels(bits: u8, alpha_bits: u8) -> Option<usize> {
    match bits {
        16 if alpha_bits > 0 => Some(4),
        15 | 16 | 24 => Some(3),
        32 => Some(4),
        _ => None,
    }
}

/// Of blue, green and red, with 5 bits each or 8, and alpha.
fn rgba(bytes: &[u8]) -> [u8; 4] {
    match *bytes {
        [low, high] => {
            let word = u16::from_le_bytes([low, high]);
            let [b, g, r] = [0, 5, 10].map(|shift| {
                let five = (word >> shift & 31) as u8;
                five << 3 | five >> 2
            });
            [r, g, b, if high & 128 != 0 { 255 } else { 0 }]
        }
        [b, g, r] => [r, g, b, 255],
        [b, g, r, a] => [r, g, b, a],
        _ => [0; 4],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two by two pixels, a row from the lower left, then one above: a kind, a palette (number of its
    /// first colour, bits of one, bytes), bits of a pixel, a descriptor and pixels.
    fn file(
        kind: u8,
        (first, entry, palette): (u16, u8, &[u8]),
        depth: u8,
        descriptor: u8,
        pixels: &[u8],
    ) -> Vec<u8> {
        let length = palette.len() / bytes_of(entry).max(1);
        let [first, length] = [first, length as u16].map(u16::to_le_bytes);
        // A name of three letters.
        let mut out = vec![3, u8::from(entry > 0), kind];
        out.extend(first.into_iter().chain(length));
        out.extend([entry, 0, 0, 0, 0, 2, 0, 2, 0, depth, descriptor]);
        out.extend(b"abc");
        out.extend(palette);
        out.extend(pixels);
        out
    }

    const NONE: (u16, u8, &[u8]) = (0, 0, &[]);

    fn read(file: &[u8]) -> Result<Vec<u8>, Broken> {
        let tga = Tga::of(file)?;
        let mut out = vec![0; 4 * tga.channels];
        tga.read(&mut out)?;
        Ok(out)
    }

    #[test]
    fn rows_begin_at_any_corner() {
        let of = |descriptor| read(&file(3, NONE, 8, descriptor, &[1, 2, 3, 4]));
        assert_eq!(of(0), Ok(vec![3, 4, 1, 2]));
        assert_eq!(of(0x10), Ok(vec![4, 3, 2, 1]));
        assert_eq!(of(0x20), Ok(vec![1, 2, 3, 4]));
        assert_eq!(of(0x30), Ok(vec![2, 1, 4, 3]));
    }

    #[test]
    fn colours_of_every_depth() {
        // Blue, green, red, white; the last with the bit of alpha.
        let words = [0x1f, 0, 0xe0, 3, 0, 0x7c, 0xff, 0xff];
        let three = vec![0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255];
        for depth in [15, 16] {
            assert_eq!(read(&file(2, NONE, depth, 0x20, &words)), Ok(three.clone()));
        }
        let four = [0, 0, 255, 0, 0, 255, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255];
        assert_eq!(read(&file(2, NONE, 16, 0x21, &words)), Ok(four.to_vec()));
        // 5 bits are spread over 8.
        let grey = [0x21, 4, 0x42, 8, 0, 0, 0xef, 0x3d];
        let made = read(&file(2, NONE, 16, 0x20, &grey)).unwrap();
        assert_eq!([made[0], made[3], made[6], made[9]], [8, 16, 0, 123]);
        let true_colours = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12];
        assert_eq!(
            read(&file(2, NONE, 24, 0x20, &true_colours)),
            Ok(vec![3, 2, 1, 6, 5, 4, 9, 8, 7, 12, 11, 10])
        );
        let with_alpha = [1, 2, 3, 4].repeat(4);
        let made = read(&file(2, NONE, 32, 0x28, &with_alpha));
        assert_eq!(made, Ok([3, 2, 1, 4].repeat(4)));
        // A palette that nothing uses is passed over.
        let made = read(&file(2, (0, 24, &[9; 6]), 32, 0x28, &with_alpha));
        assert_eq!(made, Ok([3, 2, 1, 4].repeat(4)));
        let grey = read(&file(3, NONE, 16, 0x28, &[1, 2, 3, 4, 5, 6, 7, 8]));
        assert_eq!(grey, Ok(vec![1, 2, 3, 4, 5, 6, 7, 8]));
    }

    #[test]
    fn palettes_of_every_depth() {
        let three = Ok(vec![3, 2, 1, 6, 5, 4, 6, 5, 4, 3, 2, 1]);
        let colours = [1, 2, 3, 4, 5, 6];
        for first in [0, 7] {
            let pixels = [0, 1, 1, 0].map(|number| number + first as u8);
            let made = read(&file(1, (first, 24, &colours), 8, 0x20, &pixels));
            assert_eq!(made, three);
        }
        // Numbers of two bytes, the low one first.
        let pixels = [0, 2, 1, 2, 1, 2, 0, 2];
        let made = read(&file(1, (512, 24, &colours), 16, 0x20, &pixels));
        assert_eq!(made, three);
        let pixels = [0, 1, 1, 0];
        let words = [0x1f, 0, 0, 0xfc];
        for entry in [15, 16] {
            let made = read(&file(1, (0, entry, &words), 8, 0x20, &pixels));
            assert_eq!(made, Ok(vec![0, 0, 255, 255, 0, 0, 255, 0, 0, 0, 0, 255]));
        }
        let four = [1, 2, 3, 4, 5, 6, 7, 8];
        let made = read(&file(1, (0, 32, &four), 8, 0x28, &pixels));
        assert_eq!(
            made,
            Ok(vec![3, 2, 1, 4, 7, 6, 5, 8, 7, 6, 5, 8, 3, 2, 1, 4])
        );
        assert!(read(&file(1, (1, 24, &colours), 8, 0x20, &pixels)).is_err());
        assert!(read(&file(1, (0, 24, &colours), 8, 0x20, &[0, 1, 2, 0])).is_err());
    }

    #[test]
    fn packets_go_on_over_rows() {
        // Three times 7 7, then a pixel alone; the last packet holds more than is left.
        for last in [0, 5] {
            let packed = [0x82, 7, 7, last, 1, 2];
            let made = read(&file(10, NONE, 15, 0x20, &packed)).unwrap();
            assert_eq!(made[..3], made[6..9]);
            assert_ne!(made[..3], made[9..]);
        }
        let packed = [0x83, 1];
        let made = read(&file(9, (0, 24, &[1, 2, 3, 4, 5, 6]), 8, 0x20, &packed));
        assert_eq!(made, Ok([6, 5, 4].repeat(4)));
        assert_eq!(
            read(&file(11, NONE, 8, 0, &[3, 1, 2, 3, 4])),
            Ok(vec![3, 4, 1, 2])
        );
    }

    #[test]
    fn what_is_cut_or_of_no_kind_is_refused() {
        let words = [0x1f, 0, 0xe0, 3, 0, 0x7c, 0xff, 0x7f];
        let files = [
            file(2, NONE, 16, 0x10, &words),
            file(1, (3, 16, &words), 8, 0, &[3, 4, 5, 6]),
            file(9, (3, 32, &words), 8, 0, &[1, 3, 4, 0x81, 3]),
            file(10, NONE, 24, 0, &[0x83, 1, 2, 3]),
            file(11, NONE, 16, 0, &[0, 1, 2, 0x82, 1, 2]),
        ];
        for file in files {
            assert!(read(&file).is_ok(), "{file:?}");
            for end in 0..file.len() {
                assert!(read(&file[..end]).is_err(), "{end} of {file:?}");
            }
        }
        for (kind, depth) in [(0, 8), (4, 8), (2, 8), (2, 40), (3, 24), (1, 8), (32, 8)] {
            assert!(read(&file(kind, NONE, depth, 0, &[0; 64])).is_err());
        }
    }
}
