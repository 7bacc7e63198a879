//! Output files that appear whole or not at all.
//!
//! Content is written to an unnamed file. At the end it is copied next to the target and renamed
//! over it. [`Output::create`] checks beforehand that this is possible, so an unwritable target is
//! reported before rendering. An interrupted run leaves no files behind.

use anyhow::{Context, Result, bail, ensure};
use std::fs::File;
use std::io::{BufWriter, ErrorKind, Seek, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Longest chain of symbolic links that is followed, as in Linux.
const MOST_LINKS: usize = 40;

/// A file being written, which appears under its name at the end.
pub struct Output {
    /// The path as given, for messages.
    path: PathBuf,
    sink: Sink,
}

enum Sink {
    /// An unnamed file and its final path. An interrupted run leaves nothing behind.
    Renamed(BufWriter<File>, PathBuf),
    /// A device or a pipe. It is written directly, since a rename would replace it.
    Direct(BufWriter<File>),
    /// Standard output. Its content is collected here and printed at the end.
    Standard(Vec<u8>),
}

impl Output {
    /// Prepares to write to `path`, following links; `-` is standard output.
    ///
    /// # Errors
    /// If the directory does not exist or cannot be written to, or the path is a directory.
    pub fn create(path: &Path) -> Result<Self> {
        let sink = if path == Path::new("-") {
            Sink::Standard(Vec::new())
        } else {
            sink(path).with_context(|| format!("cannot write '{}'", path.display()))?
        };
        Ok(Self { path: path.to_owned(), sink })
    }

    /// Whether both outputs write to one file, so that one would replace the other.
    pub fn is_same(&self, other: &Self) -> bool {
        match (&self.sink, &other.sink) {
            (Sink::Renamed(_, one), Sink::Renamed(_, other)) => one == other,
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

    /// Like [`Output::finish`], but writes to standard output immediately. A closed pipe ends the
    /// output without an error.
    ///
    /// # Errors
    /// If writing or renaming fails; a file is then unchanged.
    pub fn stream(self, content: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
        match self.sink {
            Sink::Standard(_) => written(content(&mut std::io::stdout().lock())),
            Sink::Renamed(..) | Sink::Direct(_) => self.finish(content),
        }
    }

    /// Returns a write error that names the path.
    pub fn failed(&self, error: std::io::Error) -> anyhow::Error {
        anyhow::Error::new(error).context(format!("cannot write '{}'", self.path.display()))
    }

    /// Makes the written content appear under its name.
    ///
    /// # Errors
    /// If writing or renaming fails; the target is then unchanged.
    pub fn end(self) -> Result<()> {
        let written = match self.sink {
            Sink::Renamed(writer, target) => writer
                .into_inner()
                .map_err(|error| error.into_error())
                .and_then(|file| copy_and_rename(file, &target)),
            Sink::Direct(mut writer) => writer.flush(),
            Sink::Standard(whole) => return print_bytes(&whole),
        };
        written.with_context(|| format!("cannot write '{}'", self.path.display()))
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        match &mut self.sink {
            Sink::Renamed(writer, _) | Sink::Direct(writer) => writer.write(bytes),
            Sink::Standard(whole) => whole.write(bytes),
        }
    }

    fn flush(&mut self) -> std::io::Result<()> {
        match &mut self.sink {
            Sink::Renamed(writer, _) | Sink::Direct(writer) => writer.flush(),
            Sink::Standard(_) => Ok(()),
        }
    }
}

fn sink(path: &Path) -> Result<Sink> {
    let path = resolve_links(path.to_owned())?;
    match std::fs::metadata(&path) {
        Ok(found) if found.is_dir() => bail!("it is a directory"),
        Ok(found) if !found.is_file() => {
            return Ok(Sink::Direct(BufWriter::new(File::options().write(true).open(&path)?)));
        }
        // A rename would replace even a read-only file, so check that it can be written to.
        Ok(_) => drop(File::options().write(true).open(&path)?),
        Err(_) => {}
    }
    let name = path.file_name().context("it names no file")?;
    let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    let directory = directory.unwrap_or(Path::new("."));
    ensure!(directory.is_dir(), "there is no directory '{}'", directory.display());
    temporary(directory)?;
    let unnamed = BufWriter::new(tempfile::tempfile_in(directory)?);
    // A canonical path identifies the file, however it was spelled.
    Ok(Sink::Renamed(unnamed, directory.canonicalize()?.join(name)))
}

/// Copies the content to a new file beside `target`, and renames that over it.
fn copy_and_rename(mut written: File, target: &Path) -> std::io::Result<()> {
    let mut file = temporary(target.parent().unwrap_or(Path::new(".")))?;
    written.rewind()?;
    std::io::copy(&mut written, file.as_file_mut())?;
    if let Ok(replaced) = std::fs::metadata(target) {
        #[cfg(unix)]
        {
            use std::os::unix::fs::{MetadataExt, fchown};
            // Only a superuser can change the owner. For others this fails, which does no harm.
            let _ = fchown(file.as_file(), Some(replaced.uid()), Some(replaced.gid()));
        }
        // A private file stays private.
        file.as_file().set_permissions(replaced.permissions())?;
    }
    file.persist(target).map_err(|error| error.error)?;
    Ok(())
}

/// Follows symbolic links, since a rename would replace a link. The target need not exist.
fn resolve_links(mut path: PathBuf) -> std::io::Result<PathBuf> {
    for _ in 0..MOST_LINKS {
        if !path.is_symlink() {
            return Ok(path);
        }
        let link = std::fs::read_link(&path)?;
        // A relative link starts at the directory that contains it.
        path = path.parent().unwrap_or(Path::new("")).join(link);
    }
    Err(std::io::Error::other("its symbolic links form a loop"))
}

/// Creates a temporary file in `directory`, with the permissions of any new file.
fn temporary(directory: &Path) -> std::io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".zeroset-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The process's umask still applies.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    // The full error would mention the temporary file's path.
    builder.tempfile_in(directory).map_err(|error| error.kind().into())
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

/// Flushes standard output after a write with this result. A closed pipe is no error.
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
