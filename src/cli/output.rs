//! Files that appear whole or not at all.
//!
//! Content goes to a file without a name, which at the end is copied beside the target and renamed over it. Whether that can
//! be done is tried before any work is, so that a target that cannot be written is an error at once and not after the
//! rendering; an interrupted run leaves nothing behind.

use anyhow::{Context, Result, bail, ensure};
use std::cell::RefCell;
use std::fs::File;
use std::io::{BufWriter, ErrorKind, Seek, Write};
use std::path::{Path, PathBuf};
use std::rc::Rc;
use tempfile::NamedTempFile;

/// As many symbolic links as Linux follows.
const MOST_LINKS: usize = 40;

/// A file about to be written.
pub struct Output {
    /// The path as given, for messages.
    path: PathBuf,
    sink: Sink,
}

enum Sink {
    /// An ordinary file, or none yet, at this place.
    Renamed(PathBuf),
    /// A device or a pipe, which a rename would replace.
    Direct(File),
    /// The path `-`.
    Standard,
}

impl Output {
    /// Prepares to write `path`; `-` is standard output, and links are followed.
    ///
    /// # Errors
    /// If the directory does not exist or cannot be written to, or the path is a directory.
    pub fn create(path: &Path) -> Result<Self> {
        let sink = if path == Path::new("-") {
            Sink::Standard
        } else {
            sink(path).with_context(|| format!("cannot write '{}'", path.display()))?
        };
        Ok(Self { path: path.to_owned(), sink })
    }

    /// Whether both are the same file, so that one would replace the other.
    pub fn is_same(&self, other: &Self) -> bool {
        match (&self.sink, &other.sink) {
            (Sink::Renamed(one), Sink::Renamed(other)) => one == other,
            _ => false,
        }
    }

    /// Writes the whole content, then makes it appear under its name.
    ///
    /// # Errors
    /// If writing or renaming fails; the target is then as it was.
    pub fn finish(self, content: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
        let mut open = self.begin()?;
        content(&mut open).map_err(|error| open.failed(error))?;
        open.finish()
    }

    /// As [`Output::finish`], but standard output is written as content comes. That nobody reads on
    /// ends it, and is no error.
    ///
    /// # Errors
    /// If writing or renaming fails; a file is then as it was.
    pub fn stream(self, content: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
        match self.sink {
            Sink::Standard => written(content(&mut std::io::stdout().lock())),
            Sink::Renamed(_) | Sink::Direct(_) => self.finish(content),
        }
    }

    /// Makes ready for content that comes in parts.
    ///
    /// # Errors
    /// If there can be no file.
    pub fn begin(self) -> Result<Open> {
        let Self { path, sink } = self;
        let open = match sink {
            Sink::Renamed(target) => {
                let unnamed = tempfile::tempfile_in(directory(&target));
                unnamed.map(|file| Opened::Renamed(BufWriter::new(file), target))
            }
            Sink::Direct(file) => Ok(Opened::Direct(BufWriter::new(file))),
            Sink::Standard => Ok(Opened::Standard(Vec::new())),
        };
        let opened = open.with_context(|| format!("cannot write '{}'", path.display()))?;
        Ok(Open { path, opened: Rc::new(RefCell::new(opened)) })
    }
}

/// A file that is being written, and appears at the end. What writes to it may own a clone.
#[derive(Clone)]
pub struct Open {
    path: PathBuf,
    opened: Rc<RefCell<Opened>>,
}

enum Opened {
    /// Without a name, so that an interrupted run leaves nothing; to be put in this place.
    Renamed(BufWriter<File>, PathBuf),
    Direct(BufWriter<File>),
    /// Printed at the end.
    Standard(Vec<u8>),
}

impl Open {
    /// What is said of a failure to write it.
    pub fn failed(&self, error: std::io::Error) -> anyhow::Error {
        anyhow::Error::new(error).context(format!("cannot write '{}'", self.path.display()))
    }

    /// Makes what was written appear.
    ///
    /// # Errors
    /// If there still is a clone, or writing or renaming fails; the target is then as it was.
    pub fn finish(self) -> Result<()> {
        let opened = Rc::into_inner(self.opened).context("a file is still being written")?;
        let written = match opened.into_inner() {
            Opened::Renamed(writer, target) => writer
                .into_inner()
                .map_err(|error| error.into_error())
                .and_then(|file| put(file, &target)),
            Opened::Direct(mut writer) => writer.flush(),
            Opened::Standard(whole) => return print_bytes(&whole),
        };
        written.with_context(|| format!("cannot write '{}'", self.path.display()))
    }
}

impl Write for Open {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        match &mut *self.opened.borrow_mut() {
            Opened::Renamed(writer, _) | Opened::Direct(writer) => writer.write(bytes),
            Opened::Standard(whole) => whole.write(bytes),
        }
    }

    fn flush(&mut self) -> std::io::Result<()> {
        match &mut *self.opened.borrow_mut() {
            Opened::Renamed(writer, _) | Opened::Direct(writer) => writer.flush(),
            Opened::Standard(_) => Ok(()),
        }
    }
}

fn sink(path: &Path) -> Result<Sink> {
    let path = followed(path.to_owned())?;
    match std::fs::metadata(&path) {
        Ok(found) if found.is_dir() => bail!("it is a directory"),
        Ok(found) if !found.is_file() => {
            return Ok(Sink::Direct(File::options().write(true).open(&path)?));
        }
        // It is replaced, which its directory allows; a file that is read-only is left alone all the same.
        Ok(_) => drop(File::options().write(true).open(&path)?),
        Err(_) => {}
    }
    let name = path.file_name().context("it names no file")?;
    let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    let directory = directory.unwrap_or(Path::new("."));
    ensure!(directory.is_dir(), "there is no directory '{}'", directory.display());
    temporary(directory)?;
    // In full, so that a file is known by whatever path it is given.
    Ok(Sink::Renamed(directory.canonicalize()?.join(name)))
}

/// Copies what was written to a file beside `target`, which is renamed.
fn put(mut written: File, target: &Path) -> std::io::Result<()> {
    let mut file = temporary(directory(target))?;
    written.rewind()?;
    std::io::copy(&mut written, file.as_file_mut())?;
    if let Ok(replaced) = std::fs::metadata(target) {
        #[cfg(unix)]
        {
            use std::os::unix::fs::{MetadataExt, fchown};
            // Only a superuser can give files away.
            let _ = fchown(file.as_file(), Some(replaced.uid()), Some(replaced.gid()));
        }
        // What was private stays so.
        file.as_file().set_permissions(replaced.permissions())?;
    }
    file.persist(target).map_err(|error| error.error)?;
    Ok(())
}

/// That in which a file lies.
fn directory(file: &Path) -> &Path {
    file.parent().unwrap_or(Path::new("."))
}

/// Where a path leads through symbolic links, which a rename would replace; the last of them may
/// lead to a file that does not exist yet.
fn followed(mut path: PathBuf) -> std::io::Result<PathBuf> {
    for _ in 0..MOST_LINKS {
        if !path.is_symlink() {
            return Ok(path);
        }
        let link = std::fs::read_link(&path)?;
        // What a link holds counts from where it lies.
        path = path.parent().unwrap_or(Path::new("")).join(link);
    }
    Err(std::io::Error::other("its symbolic links form a loop"))
}

/// A new file in `directory`, readable by all as any other new file would be.
fn temporary(directory: &Path) -> std::io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".zeroset-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The process's umask still applies.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    // The error as it comes would name the temporary file.
    builder.tempfile_in(directory).map_err(|error| error.kind().into())
}

/// Writes to standard output. That nobody reads on is no error.
///
/// # Errors
/// If it cannot be written to, a full disk for example.
pub fn print(text: &str) -> Result<()> {
    print_bytes(text.as_bytes())
}

fn print_bytes(bytes: &[u8]) -> Result<()> {
    written(std::io::stdout().write_all(bytes))
}

/// Whether standard output could be written to, after an attempt with this result; that nobody
/// reads on is no error.
///
/// # Errors
/// If it could not, or if what is still to be written cannot be.
pub fn written(result: std::io::Result<()>) -> Result<()> {
    match result.and_then(|()| std::io::stdout().flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(error).context("cannot write to standard output")
        }
        _ => Ok(()),
    }
}
