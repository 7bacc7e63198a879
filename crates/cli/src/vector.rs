//! Lists of numbers on the command line: points and sizes.

use anyhow::{Result, ensure};
use glam::DVec3;
use std::str::FromStr;
use zeroset_render::picture::MOST_PIXELS_HELD;
use zeroset_scene::number::numbers;

/// Parses three numbers that are separated by commas.
///
/// # Errors
/// If there are not three numbers, or one of them is malformed.
pub fn point(text: &str) -> Result<DVec3, String> {
    match numbers(text)?[..] {
        [x, y, z] => Ok(DVec3::new(x, y, z)),
        ref other => Err(format!("expected 3 numbers with commas between, found {}", other.len())),
    }
}

/// A picture's size in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    pub width: usize,
    pub height: usize,
}

/// Largest number of pixels of a picture. Pictures are rendered in strips, so memory is no limit,
/// but few programs can show larger ones.
const MOST_PIXELS: usize = 1 << 28;

impl Size {
    /// Checks that a picture of this size may be held whole in memory.
    ///
    /// # Errors
    /// If it has too many pixels.
    pub fn held_whole(self) -> Result<()> {
        ensure!(
            self.width * self.height <= MOST_PIXELS_HELD,
            "--size {}x{}: such pictures are held whole and may have at most {MOST_PIXELS_HELD} \
             pixels; only a single one that goes to a file may be larger",
            self.width,
            self.height
        );
        Ok(())
    }
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (width, height) = text.split_once(['x', 'X', '×']).unwrap_or((text, text));
        let side = |text: &str| {
            text.trim().parse::<usize>().map_err(|_| {
                "expected a number of pixels such as 512, or width and height such as 640x480"
                    .to_owned()
            })
        };
        let (width, height) = (side(width)?, side(height)?);
        match width.checked_mul(height) {
            Some(0) => Err("a picture needs at least one pixel".to_owned()),
            Some(pixels) if pixels <= MOST_PIXELS => Ok(Self { width, height }),
            _ => Err(format!("a picture may have at most {MOST_PIXELS} pixels")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_and_bounded() {
        assert_eq!("512".parse(), Ok(Size { width: 512, height: 512 }));
        assert_eq!("640x480".parse(), Ok(Size { width: 640, height: 480 }));
        let wrong = ["", "0", "0x0", "1x0", "-1", "1x2x3", "99999999", "9999999999x9999999999"];
        for text in wrong {
            assert!(text.parse::<Size>().is_err(), "{text}");
        }
    }

    #[test]
    fn points_have_their_number_of_coordinates() {
        assert_eq!(point("1,-2,3"), Ok(DVec3::new(1.0, -2.0, 3.0)));
        assert!(point("1,2").is_err());
    }
}
