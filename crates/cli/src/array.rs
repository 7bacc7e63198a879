//! Pixel data as files: a table of each file's flag, help and writer. All but the claims are arrays
//! in numpy's `.npy` format.

use super::claims;
use clap::{Arg, ArgMatches, Args, Command, FromArgMatches, value_parser};
use npyz::{AutoSerialize, NpyWriter, WriterBuilder};
use std::io::{self, Write};
use std::path::PathBuf;
use zeroset_render::picture::{Picture, Precision};
use zeroset_space::Region;
use zeroset_syntax::Document;
use zeroset_trace::{GBuffer, RayGrid};

/// All that is known of a picture before its rows are.
#[derive(Clone, Copy)]
pub struct Beginning<'a> {
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// The precision in which it is computed.
    pub precision: Precision,
    /// The text.
    pub text: &'a str,
    /// The text's meaning.
    pub document: &'a Document,
    /// The domain.
    pub region: &'a Region,
}

/// A kind of data that `render` can write to a file.
#[derive(Debug)]
pub struct ArrayRow {
    /// Name of the flag, without the dashes.
    pub flag: &'static str,
    help: &'static str,
    /// Name of the file in the help.
    file: &'static str,
    /// Whether the array needs normals.
    pub needs_normals: bool,
    /// Whether the array needs the brackets of hits.
    pub needs_brackets: bool,
    /// Begins a file.
    pub begin: fn(Box<dyn Write>, &Beginning<'_>) -> NewRowWriter,
}

/// A writer for an array's rows, or the error if its file could not be begun.
pub type NewRowWriter = io::Result<Box<dyn RowWriter>>;

/// A file that is written row by row.
pub trait RowWriter {
    /// Writes the next rows of a picture, which have these rays.
    ///
    /// # Errors
    /// If the sink fails.
    fn add(&mut self, picture: &Picture, rays: &RayGrid) -> io::Result<()>;

    /// Finishes the file after the last row.
    ///
    /// # Errors
    /// If the sink fails.
    fn end(self: Box<Self>) -> io::Result<()>;
}

fn distances(buffer: &GBuffer) -> impl Iterator<Item = f64> {
    (0..buffer.status.len()).map(|pixel| buffer.distance(pixel))
}

fn normals(buffer: &GBuffer) -> impl Iterator<Item = f32> {
    // Buffers are reused: a background pixel may still hold the normal of an earlier picture.
    let normal =
        |pixel: usize| if buffer.is_drawn(pixel) { buffer.normal[pixel] } else { [0.0; 3] };
    (0..buffer.normal.len()).flat_map(normal)
}

/// Every array, in the order of the help.
pub const ARRAYS: &[ArrayRow] = &[
    ArrayRow {
        flag: "distance",
        help: "Distance from the eye as a float64 array (float32 with --precision f32), inf for a miss",
        file: "FILE.npy",
        needs_normals: false,
        needs_brackets: false,
        begin: |out, beginning| match beginning.precision {
            // Kernels of this precision compute in `f32`, which is also enough for distances.
            Precision::F32 => array(out, beginning, &[], |picture, _, array| {
                array.extend(distances(&picture.buffer).map(|distance| distance as f32))
            }),
            Precision::Auto | Precision::F64 => array(out, beginning, &[], |picture, _, array| {
                array.extend(distances(&picture.buffer))
            }),
        },
    },
    ArrayRow {
        flag: "points",
        help: "The points that are drawn as a float64 array of x, y and z, NaN where nothing is drawn",
        file: "FILE.npy",
        needs_normals: false,
        needs_brackets: false,
        begin: |out, beginning| {
            array(out, beginning, &[3], |picture, rays, array| {
                array.extend(rays.drawn_points(&picture.buffer.drawn).flatten())
            })
        },
    },
    ArrayRow {
        flag: "bracket",
        help: "For hits, the distances between which the first zero is proven to lie, as a float64 array of two values per pixel, NaN elsewhere",
        file: "FILE.npy",
        needs_normals: false,
        needs_brackets: true,
        begin: |out, beginning| {
            array(out, beginning, &[2], |picture, _, array| {
                array.extend(picture.buffer.bracket.iter().flatten().copied())
            })
        },
    },
    ArrayRow {
        flag: "status",
        help: "What is proven about each pixel as a uint8 array: 0 miss, 1 hit, 2 undecided",
        file: "FILE.npy",
        needs_normals: false,
        needs_brackets: false,
        begin: |out, beginning| {
            array(out, beginning, &[], |picture, _, array| {
                array.extend(picture.buffer.status.iter().map(|&status| status as u8))
            })
        },
    },
    ArrayRow {
        flag: "normal",
        help: "Unit normals towards f > 0 as a float32 array, 0 where nothing is drawn",
        file: "FILE.npy",
        needs_normals: true,
        needs_brackets: false,
        begin: |out, beginning| {
            array(out, beginning, &[3], |picture, _, array| array.extend(normals(&picture.buffer)))
        },
    },
    ArrayRow {
        flag: "surface-id",
        help: "Which surface is drawn as an int16 array: 0 for the first in the text, and so on; -1 for none",
        file: "FILE.npy",
        needs_normals: false,
        needs_brackets: false,
        begin: |out, beginning| {
            array(out, beginning, &[], |picture, _, array| {
                let buffer = &picture.buffer;
                let drawn = |pixel: usize| buffer.is_drawn(pixel).then_some(buffer.surface[pixel]);
                // A surface's number fits an `i16`, since a text has at most 10,000 surfaces.
                let number = |pixel| drawn(pixel).map_or(-1, |surface| surface as i16);
                array.extend((0..buffer.status.len()).map(number))
            })
        },
    },
    ArrayRow {
        flag: "claims",
        help: "All that the picture claims to prove, for programs that check it: the formula, and each pixel's ray, status and bracket, as lines of JSON",
        file: "FILE.jsonl",
        needs_normals: false,
        needs_brackets: true,
        begin: claims::begin,
    },
];

/// The requested arrays, with the paths of their files.
#[derive(Debug)]
pub struct Arrays(pub Vec<(&'static ArrayRow, PathBuf)>);

impl FromArgMatches for Arrays {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let asked = |row: &'static ArrayRow| {
            matches.get_one::<PathBuf>(row.flag).map(|path| (row, path.clone()))
        };
        Ok(Self(ARRAYS.iter().filter_map(asked).collect()))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl Args for Arrays {
    fn augment_args(command: Command) -> Command {
        ARRAYS.iter().fold(command, |command, row| {
            let flag = Arg::new(row.flag).long(row.flag).help(row.help).value_name(row.file);
            let flag = flag.help_heading("Files of what is proven");
            command.arg(flag.value_parser(value_parser!(PathBuf)).hide_short_help(true))
        })
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

type Writer<T> = NpyWriter<T, Box<dyn Write>>;

/// Begins an array of rows, columns and `more`, in C order. For each strip, `add` appends the
/// strip's values.
fn array<T, F>(
    out: Box<dyn Write>,
    beginning: &Beginning<'_>,
    more: &[usize],
    add: F,
) -> NewRowWriter
where
    T: AutoSerialize + Copy + 'static,
    F: FnMut(&Picture, &RayGrid, &mut Writer<T>) -> io::Result<()> + 'static,
{
    let [width, height] = beginning.size;
    let shape: Vec<u64> = [height, width].iter().chain(more).map(|&side| side as u64).collect();
    let options = npyz::WriteOptions::<T>::new().default_dtype().shape(&shape);
    Ok(Box::new(Array { writer: options.writer(out).begin_nd()?, add }))
}

struct Array<T: AutoSerialize, F> {
    writer: Writer<T>,
    add: F,
}

impl<T, F> RowWriter for Array<T, F>
where
    T: AutoSerialize,
    F: FnMut(&Picture, &RayGrid, &mut Writer<T>) -> io::Result<()>,
{
    fn add(&mut self, picture: &Picture, rays: &RayGrid) -> io::Result<()> {
        (self.add)(picture, rays, &mut self.writer)
    }

    fn end(self: Box<Self>) -> io::Result<()> {
        self.writer.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_trace::{RayResult, Status};

    #[test]
    fn what_memory_holds_of_an_earlier_picture_is_not_written() {
        let mut buffer = GBuffer::new(2, 1, 0);
        buffer.normal.fill([0.0, 0.6, 0.8]);
        buffer.set(0, &RayResult { status: Status::Undecided, distance: 3.0, ..RayResult::MISS });
        buffer.set(0, &RayResult::MISS);
        buffer.set(
            1,
            &RayResult { status: Status::Hit, distance: 2.0, drawn: 2.0, ..RayResult::MISS },
        );
        assert_eq!(normals(&buffer).collect::<Vec<_>>(), [0.0, 0.0, 0.0, 0.0, 0.6, 0.8]);
        assert_eq!(distances(&buffer).collect::<Vec<_>>(), [f64::INFINITY, 2.0]);
    }

    #[test]
    fn arrays_are_read_back() {
        let mut file = tempfile::NamedTempFile::new().expect("a file");
        let values = [1.5_f32, f32::INFINITY, 0.0, -0.0, 3.0, 4.0];
        let out = Box::new(file.reopen().expect("the same file"));
        let options = npyz::WriteOptions::<f32>::new().default_dtype().shape(&[2, 3]);
        let mut writer: Writer<f32> =
            options.writer(out as Box<dyn Write>).begin_nd().expect("written");
        writer.extend(values).expect("written");
        writer.finish().expect("written");
        let array = npyz::NpyFile::new(file.as_file_mut()).expect("valid");
        assert_eq!(array.shape(), [2, 3]);
        assert_eq!(array.dtype().descr(), "'<f4'");
        assert_eq!(array.into_vec::<f32>().expect("f32"), values);
    }
}
