//! The output files of one picture, opened before it is rendered.

use super::arguments::OutputArgs;
use super::array::{ARRAYS, ArrayRow, Arrays, Beginning, NewRowWriter, RowWriter};
use super::output::OutputFile;
use super::png_file::PictureOrigin;
use anyhow::{Context, Error, Result, bail, ensure};
use png::StreamWriter;
use std::cell::RefCell;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use zeroset_render::picture::Picture;
use zeroset_render::png_file::{PngFormat, check_png, png_encoder};
use zeroset_trace::RayGrid;

impl OutputArgs {
    fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        self.output.iter().chain(self.arrays.0.iter().map(|(_, path)| path))
    }

    /// Checks that at least one output is requested.
    ///
    /// # Errors
    /// If none is requested.
    pub fn check(&self) -> Result<()> {
        if self.paths().next().is_none() && !self.json {
            let flags: Vec<String> = ARRAYS.iter().map(|row| format!("--{}", row.flag)).collect();
            bail!("nothing to write: add -o picture.png, or --json, {}", flags.join(", "));
        }
        Ok(())
    }
}

/// The requested files, opened before rendering. The file of an array has the array's row of
/// `ARRAYS`. The file of the picture itself has `None`.
pub struct Files(Vec<(Option<&'static ArrayRow>, OutputFile)>);

impl Files {
    /// Opens all requested files.
    ///
    /// # Errors
    /// If nothing is requested, two outputs share a file, or a file cannot be written.
    pub fn create(wanted: &OutputArgs) -> Result<Self> {
        wanted.check()?;
        let OutputArgs { output: picture, arrays: Arrays(arrays), json, size: _ } = wanted;
        let paths = || wanted.paths();
        let standard = paths().filter(|path| path.as_path() == Path::new("-")).count();
        ensure!(
            standard + usize::from(*json) <= 1,
            "only one thing can be written to standard output"
        );
        if let Some(path) = picture {
            if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("gif")) {
                bail!(
                    "a GIF holds an animation, so '{}' needs --frames N, and --turntable, \
                     --time A..B or --sweep NAME=A..B; for one picture use '{}'",
                    path.display(),
                    path.with_extension("png").display()
                );
            }
            check_png(path).map_err(Error::msg)?;
        }
        let outputs = paths().map(|path| OutputFile::create(path)).collect::<Result<Vec<_>>>()?;
        for (index, (one, path)) in outputs.iter().zip(paths()).enumerate() {
            let twice = outputs[..index].iter().any(|other| one.is_same(other));
            ensure!(!twice, "'{}' is given for two outputs", path.display());
        }
        let rows = picture.iter().map(|_| None).chain(arrays.iter().map(|(row, _)| Some(*row)));
        Ok(Self(rows.zip(outputs).collect()))
    }

    /// Writes a whole picture of these rays.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn finish(
        self,
        picture: &Picture,
        rays: &RayGrid,
        beginning: &Beginning<'_>,
        origin: &PictureOrigin,
    ) -> Result<()> {
        let mut files = self.begin(beginning, picture.png_format(), origin)?;
        files.add(picture, rays)?;
        files.finish()
    }

    /// Starts the files of a picture with this pixel format. Its rows are added later.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn begin(
        self,
        beginning: &Beginning<'_>,
        format: PngFormat,
        origin: &PictureOrigin,
    ) -> Result<OpenFiles> {
        let begin = |row: Option<&ArrayRow>, out: Box<dyn Write>| -> NewRowWriter {
            if let Some(row) = row {
                return (row.begin)(out, beginning);
            }
            let writer =
                png_encoder(out, beginning.size, format, &origin.chunks)?.write_header()?;
            Ok(Box::new(Png(writer.into_stream_writer()?)))
        };
        let open = |(row, file)| {
            let file = SharedOutput(Rc::new(RefCell::new(file)));
            let rows = begin(row, Box::new(file.clone())).map_err(|error| file.failed(error))?;
            Ok((file, rows))
        };
        Ok(OpenFiles(self.0.into_iter().map(open).collect::<Result<_>>()?))
    }
}

/// Open files, each with its row writer. They appear under their names in [`OpenFiles::finish`].
pub struct OpenFiles(Vec<(SharedOutput, Box<dyn RowWriter>)>);

impl OpenFiles {
    /// Writes the next rows of a picture, which have these rays.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn add(&mut self, picture: &Picture, rays: &RayGrid) -> Result<()> {
        for (file, rows) in &mut self.0 {
            rows.add(picture, rays).map_err(|error| file.failed(error))?;
        }
        Ok(())
    }

    /// Makes the files appear under their names, the picture last. If the picture exists, so do all
    /// arrays.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn finish(self) -> Result<()> {
        self.0.into_iter().rev().try_for_each(|(file, rows)| {
            rows.end().map_err(|error| file.failed(error))?;
            // `end` dropped the row writer, which was the only other owner of the file.
            let file = Rc::into_inner(file.0).context("a file is still being written")?;
            file.into_inner().end()
        })
    }
}

/// An output file, shared with its row writer.
#[derive(Clone)]
struct SharedOutput(Rc<RefCell<OutputFile>>);

impl SharedOutput {
    fn failed(&self, error: io::Error) -> anyhow::Error {
        self.0.borrow().failed(error)
    }
}

impl Write for SharedOutput {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.borrow_mut().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.borrow_mut().flush()
    }
}

struct Png(StreamWriter<'static, Box<dyn Write>>);

impl RowWriter for Png {
    fn add(&mut self, picture: &Picture, _: &RayGrid) -> io::Result<()> {
        self.0.write_all(&picture.samples())
    }

    fn end(self: Box<Self>) -> io::Result<()> {
        Ok(self.0.finish()?)
    }
}
