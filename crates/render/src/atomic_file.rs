//! Files that appear whole or not at all.
//!
//! Content is written to an unnamed file. At the end the file is copied next to the target, and the
//! copy is renamed over the target. [`AtomicFile::create`] checks beforehand that this is possible,
//! so an unwritable target is reported before rendering. A process that is killed leaves no files
//! behind, unless it dies while it copies: then there is a `.zeroset-….part`.

use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Longest chain of symbolic links that is followed, as in Linux.
const MOST_LINKS: usize = 40;

/// A file being written. It appears under its name when it is [committed](Self::commit).
pub struct AtomicFile(Sink);

enum Sink {
    /// An unnamed file, and the path at which its content will appear.
    Renamed(BufWriter<File>, PathBuf),
    /// A device or a pipe. It is written directly, since a rename would replace it.
    Direct(BufWriter<File>),
}

impl AtomicFile {
    /// Prepares to write `path`. Symbolic links are followed.
    ///
    /// # Errors
    /// If the directory does not exist or is not writable, or if the path is a directory.
    pub fn create(path: &Path) -> io::Result<Self> {
        let path = resolve_links(path.to_owned())?;
        match std::fs::metadata(&path) {
            Ok(found) if found.is_dir() => return Err(io::Error::other("it is a directory")),
            Ok(found) if !found.is_file() => {
                let device = File::options().write(true).open(&path)?;
                return Ok(Self(Sink::Direct(BufWriter::new(device))));
            }
            // A rename would replace even a read-only file, so check that it can be written to.
            Ok(_) => drop(File::options().write(true).open(&path)?),
            Err(_) => {}
        }
        let name = path.file_name().ok_or_else(|| io::Error::other("it names no file"))?;
        let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty());
        let directory = directory.unwrap_or(Path::new("."));
        if !directory.is_dir() {
            let missing = format!("there is no directory '{}'", directory.display());
            return Err(io::Error::other(missing));
        }
        // The full error would mention a temporary file's path.
        let unnamed = tempfile::tempfile_in(directory).map_err(|error| error.kind())?;
        let unnamed = BufWriter::new(unnamed);
        // A canonical path identifies the file, however it was spelled.
        Ok(Self(Sink::Renamed(unnamed, directory.canonicalize()?.join(name))))
    }

    /// Returns whether both files have the same target, so that one would replace the other.
    pub fn is_same(&self, other: &Self) -> bool {
        match (&self.0, &other.0) {
            (Sink::Renamed(_, one), Sink::Renamed(_, other)) => one == other,
            _ => false,
        }
    }

    /// Makes the written content appear under its name.
    ///
    /// # Errors
    /// If writing or renaming fails; the target is then unchanged.
    pub fn commit(self) -> io::Result<()> {
        match self.0 {
            Sink::Renamed(writer, target) => {
                copy_and_rename(writer.into_inner().map_err(|error| error.into_error())?, &target)
            }
            Sink::Direct(mut writer) => writer.flush(),
        }
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.0 {
            Sink::Renamed(writer, _) | Sink::Direct(writer) => writer.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.0 {
            Sink::Renamed(writer, _) | Sink::Direct(writer) => writer.flush(),
        }
    }
}

/// Copies the content to a new file beside `target`, and renames the copy over `target`.
fn copy_and_rename(mut written: File, target: &Path) -> io::Result<()> {
    let mut file = temporary(target.parent().unwrap_or(Path::new(".")))?;
    written.rewind()?;
    io::copy(&mut written, file.as_file_mut())?;
    if let Ok(replaced) = std::fs::metadata(target) {
        #[cfg(unix)]
        {
            use std::os::unix::fs::{MetadataExt, fchown};
            // Only a superuser can change the owner. For other users the call fails, which does no
            // harm.
            let _ = fchown(file.as_file(), Some(replaced.uid()), Some(replaced.gid()));
        }
        // A private file stays private.
        file.as_file().set_permissions(replaced.permissions())?;
    }
    file.persist(target).map_err(|error| error.error)?;
    Ok(())
}

/// Follows symbolic links, since a rename would replace a link. The target need not exist.
fn resolve_links(mut path: PathBuf) -> io::Result<PathBuf> {
    for _ in 0..MOST_LINKS {
        if !path.is_symlink() {
            return Ok(path);
        }
        let link = std::fs::read_link(&path)?;
        // A relative link starts at the directory that contains it.
        path = path.parent().unwrap_or(Path::new("")).join(link);
    }
    Err(io::Error::other("its symbolic links form a loop"))
}

/// Creates a temporary file in `directory`, with the permissions of any new file.
fn temporary(directory: &Path) -> io::Result<NamedTempFile> {
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
