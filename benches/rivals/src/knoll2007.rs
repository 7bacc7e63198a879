//! The rival in C++: the algorithm of Knoll et al. 2007. Only the call into C++ is unsafe code.

use crate::side::{EnclosureCalls, Side};
use crate::surfaces::EYE;
use anyhow::{Result, ensure};
use rayon::prelude::*;
use std::ffi::{CString, c_char, c_int, c_long, c_uchar};

/// Parameters: `(name, size, top, bottom, depth, eye, repeats, rgb, distance, drawn, boxes)`. The
/// end of `cpp/knoll2007.cpp` documents them.
type Draw = unsafe extern "C" fn(
    *const c_char,
    c_int,
    c_int,
    c_int,
    c_int,
    *const f32,
    c_int,
    *mut c_uchar,
    *mut f32,
    *mut c_long,
    *mut c_long,
) -> bool;

#[allow(unsafe_code)] // functions of the library that build.rs compiles
mod library {
    use super::{c_char, c_int, c_long, c_uchar};

    macro_rules! declare {
        ($name:ident) => {
            unsafe extern "C" {
                pub fn $name(
                    name: *const c_char,
                    size: c_int,
                    top: c_int,
                    bottom: c_int,
                    depth: c_int,
                    eye: *const f32,
                    repeats: c_int,
                    rgb: *mut c_uchar,
                    distance: *mut f32,
                    drawn: *mut c_long,
                    boxes: *mut c_long,
                ) -> bool;
            }
        };
    }

    declare!(knoll2007_w4);
    #[cfg(sixteen_lanes)]
    declare!(knoll2007_w16);
}

/// The packet sizes for which the C++ is compiled.
pub const PACKET_WIDTHS: &[PacketWidth] = &[
    PacketWidth { lanes: 4, draw: library::knoll2007_w4 },
    #[cfg(sixteen_lanes)]
    PacketWidth { lanes: 16, draw: library::knoll2007_w16 },
];

/// The code for packets of one size.
pub struct PacketWidth {
    /// Number of rays in a packet.
    pub lanes: usize,
    draw: Draw,
}

/// Number of rows that a thread takes at a time: a multiple of every packet's height.
const BAND: usize = 16;
/// Greatest depth that the arrays of the C++ can hold.
const DEEPEST: u32 = 32;

/// A surface of the C++, with the buffers of its picture.
pub struct Knoll2007 {
    width: &'static PacketWidth,
    name: CString,
    size: usize,
    depth: u32,
    rgb: Vec<u8>,
    distance: Vec<f32>,
    boxes: u64,
}

impl Knoll2007 {
    /// Returns the C++ surface called `name`, if there is one.
    ///
    /// # Errors
    /// If the picture is too large, or the depth is not from 1 to 32.
    pub fn new(
        width: &'static PacketWidth,
        name: &str,
        size: usize,
        depth: u32,
    ) -> Result<Option<Self>> {
        ensure!((1..=DEEPEST).contains(&depth), "the C++ takes depths from 1 to {DEEPEST}");
        // The C++ indexes three bytes per pixel by an `int`.
        ensure!(size <= 1 << 14, "the C++ draws no more than {} rows", 1 << 14);
        let name = CString::new(name)?;
        let (rgb, distance) = (vec![0; 3 * size * size], vec![0.0; size * size]);
        let this = Self { width, name, size, depth, rgb, distance, boxes: 0 };
        let known = this.band(0, &mut [], &mut []).is_some();
        Ok(known.then_some(this))
    }

    /// Draws the rows from `top` on that the buffers have room for. Returns the number of evaluated
    /// boxes, or `None` if the C++ does not know the surface.
    #[allow(unsafe_code)] // the only call
    fn band(&self, top: usize, rgb: &mut [u8], distance: &mut [f32]) -> Option<u64> {
        let rows = distance.len() / self.size;
        assert!(rgb.len() == 3 * self.size * rows && distance.len() == self.size * rows);
        let [size, first, last] = [self.size, top, top + rows].map(|n| n as c_int);
        let (mut drawn, mut boxes) = (0, 0);
        let depth = self.depth as c_int;
        let eye = EYE.as_vec3().to_array();
        // SAFETY: the name ends with 0, the eye has three numbers, and each count is one integer.
        // The function writes the pixels of `size` columns and of rows from `first` to before
        // `last`. The assertion ensures that the slices hold these pixels. `new` keeps the depth
        // within the C++'s arrays and indices within `int`. The function keeps no pointer, has
        // thread-local state only, and restores the register of rounding modes.
        let known = unsafe {
            (self.width.draw)(
                self.name.as_ptr(),
                size,
                first,
                last,
                depth,
                eye.as_ptr(),
                1,
                rgb.as_mut_ptr(),
                distance.as_mut_ptr(),
                &raw mut drawn,
                &raw mut boxes,
            )
        };
        known.then_some(boxes as u64)
    }
}

impl Side for Knoll2007 {
    fn name(&self) -> String {
        format!("C++ {} lanes", self.width.lanes)
    }

    fn size(&self) -> usize {
        self.size
    }

    fn draw(&mut self) -> Result<()> {
        let pixels = self.size * BAND;
        let (mut rgb, mut distance) =
            (std::mem::take(&mut self.rgb), std::mem::take(&mut self.distance));
        let bands = rgb.par_chunks_mut(3 * pixels).zip(distance.par_chunks_mut(pixels));
        let boxes = bands.enumerate().map(|(band, (rgb, distance))| {
            self.band(band * BAND, rgb, distance).expect("known since `new`")
        });
        let boxes = boxes.sum();
        (self.rgb, self.distance, self.boxes) = (rgb, distance, boxes);
        Ok(())
    }

    fn distances(&self) -> Vec<f64> {
        let far = |&d: &f32| if d < 0.0 { f64::INFINITY } else { d.into() };
        self.distance.iter().map(far).collect()
    }

    fn enclosure_calls(&self) -> Option<EnclosureCalls> {
        Some(EnclosureCalls { calls: self.boxes, lanes: self.width.lanes as f64 })
    }
}
