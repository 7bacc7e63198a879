//! Outputs of the command line: files that appear whole or not at all, and standard output.

use anyhow::{Context, Result};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use zeroset_render::atomic_file::AtomicFile;

/// A file being written, which appears under its name at the end.
pub struct OutputFile {
    /// The path as the user gave it, for messages.
    path: PathBuf,
    sink: OutputSink,
}

enum OutputSink {
    File(AtomicFile),
    /// Standard output. Its content is collected here and printed at the end.
    Standard(Vec<u8>),
}

impl OutputFile {
    /// Prepares to write to `path`, following links; `-` is standard output.
    ///
    /// # Errors
    /// If the directory does not exist or cannot be written to, or the path is a directory.
    pub fn create(path: &Path) -> Result<Self> {
        let sink = if path == Path::new("-") {
            OutputSink::Standard(Vec::new())
        } else {
            let file = AtomicFile::create(path);
            OutputSink::File(file.with_context(|| format!("cannot write '{}'", path.display()))?)
        };
        Ok(Self { path: path.to_owned(), sink })
    }

    /// Whether both outputs write to one file, so that one of them would be lost.
    pub fn is_same(&self, other: &Self) -> bool {
        match (&self.sink, &other.sink) {
            (OutputSink::File(one), OutputSink::File(other)) => one.is_same(other),
            _ => false,
        }
    }

    /// Writes the whole content, then makes it appear under its name.
    ///
    /// # Errors
    /// If writing or renaming fails; the target is then unchanged.
    pub fn finish(
        mut self,
        content: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
    ) -> Result<()> {
        content(&mut self).map_err(|error| self.failed(error))?;
        self.end()
    }

    /// Like [`OutputFile::finish`], but writes to standard output immediately. A closed pipe ends
    /// the output without an error.
    ///
    /// # Errors
    /// If writing or renaming fails; a file is then unchanged.
    pub fn stream(self, content: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
        match self.sink {
            OutputSink::Standard(_) => written(content(&mut std::io::stdout().lock())),
            OutputSink::File(_) => self.finish(content),
        }
    }

    /// Adds the file's path to a write error.
    pub fn failed(&self, error: std::io::Error) -> anyhow::Error {
        anyhow::Error::new(error).context(format!("cannot write '{}'", self.path.display()))
    }

    /// Makes the written content appear under its name.
    ///
    /// # Errors
    /// If writing or renaming fails; the target is then unchanged.
    pub fn end(self) -> Result<()> {
        match self.sink {
            OutputSink::File(file) => {
                file.commit().with_context(|| format!("cannot write '{}'", self.path.display()))
            }
            OutputSink::Standard(whole) => print_bytes(&whole),
        }
    }
}

impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        match &mut self.sink {
            OutputSink::File(file) => file.write(bytes),
            OutputSink::Standard(whole) => whole.write(bytes),
        }
    }

    fn flush(&mut self) -> std::io::Result<()> {
        match &mut self.sink {
            OutputSink::File(file) => file.flush(),
            OutputSink::Standard(_) => Ok(()),
        }
    }
}

/// Writes to standard output. A closed pipe is no error.
///
/// # Errors
/// If writing fails, for example on a full disk.
pub fn print(text: &str) -> Result<()> {
    print_bytes(text.as_bytes())
}

fn print_bytes(bytes: &[u8]) -> Result<()> {
    written(std::io::stdout().write_all(bytes))
}

/// Flushes standard output if `result` of the last write is a success. A closed pipe is no error.
///
/// # Errors
/// If the write or the flush failed.
pub fn written(result: std::io::Result<()>) -> Result<()> {
    match result.and_then(|()| std::io::stdout().flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(error).context("cannot write to standard output")
        }
        _ => Ok(()),
    }
}
