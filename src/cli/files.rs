//! What one picture is written to: files opened before the work.

use super::arguments::OutputArgs;
use super::array::{ARRAYS, ArrayRow, Arrays, Begun, Rows};
use super::output::Output;
use super::png_file::{Origin, check_png, png_encoder};
use anyhow::{Context, Result, bail, ensure};
use png::StreamWriter;
use std::cell::RefCell;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use zeroset::picture::{Picture, Precision};

/// What is to be written of a picture, and where.
#[derive(Clone)]
pub struct Wanted {
    pub picture: Option<PathBuf>,
    pub arrays: Vec<(&'static ArrayRow, PathBuf)>,
    /// Whether standard output is taken.
    pub json: bool,
}

impl OutputArgs {
    /// What was asked for.
    pub fn wanted(&self) -> Wanted {
        let Self { output, arrays: Arrays(arrays), json, size: _ } = self;
        Wanted { picture: output.clone(), arrays: arrays.clone(), json: *json }
    }
}

impl Wanted {
    pub fn paths(&self) -> impl Iterator<Item = &PathBuf> {
        self.picture.iter().chain(self.arrays.iter().map(|(_, path)| path))
    }

    /// # Errors
    /// If nothing is wanted.
    pub fn check(&self) -> Result<()> {
        if self.paths().next().is_none() && !self.json {
            let flags: Vec<String> = ARRAYS.iter().map(|row| format!("--{}", row.flag)).collect();
            bail!("nothing to write: add -o picture.png, or --json, {}", flags.join(", "));
        }
        Ok(())
    }
}

/// The files asked for, opened before the work.
pub struct Files {
    picture: Option<Output>,
    arrays: Vec<(&'static ArrayRow, Output)>,
}

impl Files {
    /// # Errors
    /// If nothing is asked for, something twice, or a file cannot be written.
    pub fn create(wanted: &Wanted) -> Result<Self> {
        wanted.check()?;
        let Wanted { picture, arrays, json } = wanted;
        let paths = || wanted.paths();
        let standard = paths().filter(|path| path.as_path() == Path::new("-")).count();
        ensure!(
            standard + usize::from(*json) <= 1,
            "only one thing can be written to standard output"
        );
        if let Some(path) = picture {
            check_png(path)?;
        }
        let outputs = paths().map(|path| Output::create(path)).collect::<Result<Vec<_>>>()?;
        for (index, (one, path)) in outputs.iter().zip(paths()).enumerate() {
            let twice = outputs[..index].iter().any(|other| one.is_same(other));
            ensure!(!twice, "'{}' is given for two outputs", path.display());
        }
        let mut outputs = outputs.into_iter();
        let picture = picture.as_ref().and_then(|_| outputs.next());
        Ok(Self { picture, arrays: arrays.iter().map(|(row, _)| *row).zip(outputs).collect() })
    }

    /// Writes a whole picture.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn finish(self, picture: &Picture, origin: &Origin) -> Result<()> {
        let size = [picture.buffer.width, picture.buffer.height];
        let mut files = self.begin(size, picture.precision, origin)?;
        files.add(picture)?;
        files.finish()
    }

    /// Makes ready for rows of a picture of this size that is computed in these floats.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn begin(
        self,
        size: [usize; 2],
        precision: Precision,
        origin: &Origin,
    ) -> Result<OpenFiles> {
        let [width, height] = size;
        let png = |out: Box<dyn Write>| -> Begun {
            let writer = png_encoder(out, size, origin)?.write_header()?;
            Ok(Box::new(Png(writer.into_stream_writer()?)))
        };
        let picture = self.picture.map(|file| begun(file, png));
        let arrays = self
            .arrays
            .into_iter()
            .map(|(row, file)| begun(file, |out| (row.begin)(out, [height, width], precision)));
        Ok(OpenFiles(picture.into_iter().chain(arrays).collect::<Result<_>>()?))
    }
}

/// A file together with what writes rows to it.
type OpenFile = (Shared, Box<dyn Rows>);

fn begun(file: Output, rows: impl FnOnce(Box<dyn Write>) -> Begun) -> Result<OpenFile> {
    let file = Shared(Rc::new(RefCell::new(file)));
    let rows = rows(Box::new(file.clone())).map_err(|error| file.failed(error))?;
    Ok((file, rows))
}

/// Files to which the rows of a picture are written, and which appear at the end.
pub struct OpenFiles(Vec<OpenFile>);

impl OpenFiles {
    /// Writes the next rows.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn add(&mut self, picture: &Picture) -> Result<()> {
        let add =
            |(file, rows): &mut OpenFile| rows.add(picture).map_err(|error| file.failed(error));
        self.0.iter_mut().try_for_each(add)
    }

    /// Makes the files appear, the picture last: where it is, the others are.
    ///
    /// # Errors
    /// If one cannot be written.
    pub fn finish(self) -> Result<()> {
        self.0.into_iter().rev().try_for_each(|(file, rows)| {
            rows.end().map_err(|error| file.failed(error))?;
            // Whoever wrote rows is gone.
            let file = Rc::into_inner(file.0).context("a file is still being written")?;
            file.into_inner().end()
        })
    }
}

/// A file that what writes rows to it owns as well.
#[derive(Clone)]
struct Shared(Rc<RefCell<Output>>);

impl Shared {
    fn failed(&self, error: io::Error) -> anyhow::Error {
        self.0.borrow().failed(error)
    }
}

impl Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.borrow_mut().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.borrow_mut().flush()
    }
}

struct Png(StreamWriter<'static, Box<dyn Write>>);

impl Rows for Png {
    fn add(&mut self, picture: &Picture) -> io::Result<()> {
        self.0.write_all(&picture.rgb)
    }

    fn end(self: Box<Self>) -> io::Result<()> {
        Ok(self.0.finish()?)
    }
}
