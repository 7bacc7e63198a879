//! The colors of a picture's pixels, as sRGB bytes or as light.

use crate::color::LinearRgb;
use std::ops::Range;
use zeroset_trace::buffer_pool::{BufferPool, PICTURES, serves};

/// Number of pixels that are filled before they are copied.
const RUN: usize = 64;

/// The numbers in which a picture's colors are kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorDepth {
    /// As sRGB bytes.
    #[default]
    Bytes,
    /// As light, in 32-bit floats.
    Floats,
}

impl ColorDepth {
    /// The numbers that a PNG file with this many bits per channel needs.
    pub fn of(bits: usize) -> Self {
        if bits > 8 { Self::Floats } else { Self::Bytes }
    }
}

/// The colors of pixels, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub enum Colors {
    /// Red, green and blue bytes (sRGB) of each pixel.
    Bytes(Vec<u8>),
    /// The light of each pixel.
    Floats(Vec<LinearRgb>),
}

/// The colors of some adjacent pixels, to be changed.
pub enum ColorsMut<'a> {
    /// As [`Colors::Bytes`].
    Bytes(&'a mut [[u8; 3]]),
    /// As [`Colors::Floats`].
    Floats(&'a mut [LinearRgb]),
}

impl Default for Colors {
    fn default() -> Self {
        Self::Bytes(Vec::new())
    }
}

impl Default for ColorsMut<'_> {
    fn default() -> Self {
        Self::Bytes(&mut [])
    }
}

impl Colors {
    /// Memory for the colors of this many pixels. Its contents are unspecified.
    pub fn unset(depth: ColorDepth, pixels: usize) -> Self {
        match depth {
            ColorDepth::Bytes => Self::Bytes(unset_bytes(pixels)),
            ColorDepth::Floats => Self::Floats(vec![LinearRgb([0.0; 3]); pixels]),
        }
    }

    /// The color of a pixel.
    #[inline]
    pub fn get(&self, pixel: usize) -> LinearRgb {
        match self {
            Self::Bytes(bytes) => LinearRgb::from_srgb(bytes.as_chunks().0[pixel]),
            Self::Floats(light) => light[pixel],
        }
    }

    /// Sets the color of a pixel.
    #[inline]
    pub fn set(&mut self, pixel: usize, color: LinearRgb) {
        self.as_mut().set(pixel, color);
    }

    /// All colors, to be changed.
    #[inline]
    pub fn as_mut(&mut self) -> ColorsMut<'_> {
        match self {
            Self::Bytes(bytes) => ColorsMut::Bytes(bytes.as_chunks_mut().0),
            Self::Floats(light) => ColorsMut::Floats(light),
        }
    }

    /// Adds a color at the end.
    pub fn push(&mut self, color: LinearRgb) {
        match self {
            Self::Bytes(bytes) => bytes.extend(color.to_srgb()),
            Self::Floats(light) => light.push(color),
        }
    }

    /// Keeps only these pixels.
    pub fn crop(&mut self, kept: Range<usize>) {
        match self {
            Self::Bytes(bytes) => crop(bytes, 3 * kept.start..3 * kept.end),
            Self::Floats(light) => crop(light, kept),
        }
    }

    /// Keeps the colors for which `is_kept` is true. It is called once for each, in order.
    pub fn retain(&mut self, mut is_kept: impl FnMut() -> bool) {
        match self {
            Self::Bytes(bytes) => {
                let kept = bytes.as_chunks::<3>().0.iter().filter(|_| is_kept());
                *bytes = kept.flatten().copied().collect();
            }
            Self::Floats(light) => light.retain(|_| is_kept()),
        }
    }

    /// Gives memory back that is not used.
    pub fn shrink_to_fit(&mut self) {
        match self {
            Self::Bytes(bytes) => bytes.shrink_to_fit(),
            Self::Floats(light) => light.shrink_to_fit(),
        }
    }

    /// The colors as sRGB bytes: red, green, blue.
    pub fn into_bytes(self) -> Vec<u8> {
        match self {
            Self::Bytes(bytes) => bytes,
            Self::Floats(light) => light.into_iter().flat_map(LinearRgb::to_srgb).collect(),
        }
    }

    /// Leaves the memory of bytes to later pictures, as [`hand_back_colors`]. Floats are freed.
    pub fn hand_back(self) {
        if let Self::Bytes(bytes) = self {
            hand_back_colors(bytes);
        }
    }
}

impl ColorsMut<'_> {
    /// Sets the color of a pixel.
    #[inline]
    pub fn set(&mut self, pixel: usize, color: LinearRgb) {
        match self {
            Self::Bytes(bytes) => bytes[pixel] = color.to_srgb(),
            Self::Floats(light) => light[pixel] = color,
        }
    }

    /// The color of a pixel.
    #[inline]
    pub fn get(&self, pixel: usize) -> LinearRgb {
        match self {
            Self::Bytes(bytes) => LinearRgb::from_srgb(bytes[pixel]),
            Self::Floats(light) => light[pixel],
        }
    }

    /// Number of pixels.
    pub fn len(&self) -> usize {
        match self {
            Self::Bytes(bytes) => bytes.len(),
            Self::Floats(light) => light.len(),
        }
    }

    /// Returns whether there are no pixels.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Parts of this many pixels. The last one may be shorter.
    pub fn split(self, pixels: usize) -> Vec<Self> {
        match self {
            Self::Bytes(bytes) => bytes.chunks_mut(pixels).map(Self::Bytes).collect(),
            Self::Floats(light) => light.chunks_mut(pixels).map(Self::Floats).collect(),
        }
    }

    /// Gives all pixels one color.
    pub(crate) fn fill(&mut self, color: LinearRgb) {
        match self {
            Self::Bytes(bytes) => {
                // Copies of long runs are faster than the same three bytes again and again.
                let mut done = bytes.len().min(RUN);
                bytes[..done].fill(color.to_srgb());
                while done < bytes.len() {
                    let more = done.min(bytes.len() - done);
                    bytes.copy_within(..more, done);
                    done += more;
                }
            }
            Self::Floats(light) => light.fill(color),
        }
    }
}

fn crop<T>(all: &mut Vec<T>, kept: Range<usize>) {
    all.truncate(kept.end);
    all.drain(..kept.start.min(all.len()));
}

/// Memory for the bytes of this many pixels. Its contents are unspecified.
fn unset_bytes(pixels: usize) -> Vec<u8> {
    let mut bytes =
        SPARES.take().filter(|bytes| serves(bytes.capacity(), 3 * pixels)).unwrap_or_default();
    bytes.resize(3 * pixels, 0);
    bytes
}

/// Leaves the memory of a picture's bytes to later pictures. Up to two pictures' memory is kept
/// until the process ends.
pub fn hand_back_colors(bytes: Vec<u8>) {
    SPARES.hand_back(bytes);
}

static SPARES: BufferPool<Vec<u8>> = BufferPool::new(PICTURES);
