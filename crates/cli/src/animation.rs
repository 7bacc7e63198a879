//! Animations: all frames of a sequence in one file, as animated PNG, GIF, or raw bytes.

use super::png_file::PictureOrigin;
use anyhow::{Result, bail, ensure};
use std::io::{self, Write};
use std::path::Path;
use zeroset_render::picture::Picture;
use zeroset_render::png_file::{PngFormat, png_encoder};

/// File format of an animation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnimationFormat {
    /// Animated PNG: sRGB, lossless.
    Png,
    /// GIF: 256 colors per frame.
    Gif,
    /// Raw bytes: red, green and blue of each pixel. Rows run from the top, frame after frame.
    Raw,
}

/// Largest width or height of a GIF, in pixels.
const GIF_SIDE: usize = u16::MAX as usize;

/// Highest frame rate that every GIF viewer shows. Delays are in hundredths of a second, and
/// viewers replace a delay of 1 by 10.
const GIF_FPS: u16 = 50;

/// How carefully the palette of a GIF frame is chosen, from 1 (best) to 30 (fastest).
const GIF_SPEED: i32 = 10;

impl AnimationFormat {
    /// Returns the animation's format: by the extension of `path`, or raw if `path` is `-`.
    ///
    /// # Errors
    /// If the extension is unknown, or a GIF cannot have this size or frame rate.
    pub fn of(path: &Path, size: [usize; 2], fps: u16) -> Result<Self> {
        let extension = path.extension().and_then(|extension| extension.to_str());
        let extension = extension.map(str::to_ascii_lowercase);
        match extension.as_deref() {
            Some("png") => Ok(Self::Png),
            Some("gif") => {
                let fits = size.iter().all(|side| *side <= GIF_SIDE);
                ensure!(fits, "a GIF has at most {GIF_SIDE} columns and rows; use a PNG");
                ensure!(fps <= GIF_FPS, "a GIF shows at most {GIF_FPS} frames a second; use a PNG");
                Ok(Self::Gif)
            }
            None if path == Path::new("-") => Ok(Self::Raw),
            Some(_) | None => bail!(
                "'{}': a sequence is written to a file for each frame, such as frame-%04d.png, to an \
                 animated .png or .gif, or to - for other programs",
                path.display()
            ),
        }
    }
}

/// An animation that is being written.
pub struct Animation<W: Write> {
    sink: FrameSink<W>,
    size: [usize; 2],
    fps: u32,
    frame: u32,
}

enum FrameSink<W: Write> {
    Png(png::Writer<W>),
    Gif(gif::Encoder<W>),
    Raw(W),
}

impl<W: Write> Animation<W> {
    /// Begins an animation that repeats forever. The frames of an animated PNG have these pixels.
    ///
    /// # Errors
    /// If writing to `out` fails.
    pub fn begin(
        format: AnimationFormat,
        out: W,
        size: [usize; 2],
        pixels: PngFormat,
        (frames, fps): (usize, u16),
        origin: &PictureOrigin,
    ) -> io::Result<Self> {
        let sink = match format {
            AnimationFormat::Png => {
                let mut encoder = png_encoder(out, size, pixels, &origin.chunks)?;
                encoder.set_animated(frames as u32, 0)?;
                encoder.set_frame_delay(1, fps)?;
                FrameSink::Png(encoder.write_header()?)
            }
            AnimationFormat::Gif => {
                let [width, height] = size.map(|side| side as u16);
                let mut encoder =
                    gif::Encoder::new(out, width, height, &[]).map_err(io::Error::other)?;
                encoder.set_repeat(gif::Repeat::Infinite).map_err(io::Error::other)?;
                FrameSink::Gif(encoder)
            }
            AnimationFormat::Raw => FrameSink::Raw(out),
        };
        Ok(Self { sink, size, fps: fps.into(), frame: 0 })
    }

    /// Adds a frame. GIF and raw bytes have no opacities.
    ///
    /// # Errors
    /// If writing fails.
    pub fn add(&mut self, picture: &Picture) -> io::Result<()> {
        let rgb = picture.opaque_rgb();
        match &mut self.sink {
            FrameSink::Png(writer) => {
                writer.write_image_data(&picture.samples())?;
            }
            FrameSink::Gif(encoder) => {
                let [width, height] = self.size.map(|side| side as u16);
                let mut frame = gif::Frame::from_rgb_speed(width, height, &rgb, GIF_SPEED);
                // Round frames' end times, not their delays, so that rounding errors do not add up.
                let hundredths = |frame: u32| (100 * u64::from(frame)).div_ceil(self.fps.into());
                frame.delay = (hundredths(self.frame + 1) - hundredths(self.frame)) as u16;
                encoder.write_frame(&frame).map_err(io::Error::other)?;
            }
            FrameSink::Raw(out) => out.write_all(&rgb).and_then(|()| out.flush())?,
        }
        self.frame += 1;
        Ok(())
    }

    /// Finishes the file.
    ///
    /// # Errors
    /// If writing fails.
    pub fn end(self) -> io::Result<()> {
        match self.sink {
            FrameSink::Png(writer) => Ok(writer.finish()?),
            FrameSink::Gif(encoder) => encoder.into_inner().map_err(io::Error::other).map(drop),
            FrameSink::Raw(mut out) => out.flush(),
        }
    }
}
