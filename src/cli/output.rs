//! Files that appear whole or not at all.
//!
//! Content goes to a temporary file beside the target, which is renamed over it. Whether such a file can be made is tried
//! before any work is done, so that a target that cannot be written is an error at once and not after the rendering; the
//! file itself is made when there is something to write, so that an interrupted run leaves nothing behind.

use anyhow::{Context, Result};
use std::fs::File;
use std::io::{BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// A file about to be written.
pub struct Output {
    path: PathBuf,
    sink: Sink,
}

enum Sink {
    /// An ordinary file, or none yet, in this directory.
    Renamed(PathBuf),
    /// A device or a pipe, which a rename would replace.
    Direct(File),
    /// The path `-`.
    Standard,
}

impl Output {
    /// Prepares to write `path`; `-` is standard output.
    ///
    /// # Errors
    /// If the directory does not exist or cannot be written to, or the path is a directory.
    pub fn create(path: &Path) -> Result<Self> {
        let cannot = || format!("cannot write '{}'", path.display());
        let sink = if path == Path::new("-") {
            Sink::Standard
        } else {
            match std::fs::metadata(path) {
                Ok(found) if found.is_dir() => {
                    anyhow::bail!("{}: it is a directory", cannot());
                }
                Ok(found) if !found.is_file() => {
                    let file = File::options().write(true).open(path);
                    Sink::Direct(file.with_context(cannot)?)
                }
                _ => {
                    if path.file_name().is_none() {
                        anyhow::bail!("{}: it names no file", cannot());
                    }
                    let directory = path.parent().filter(|parent| !parent.as_os_str().is_empty());
                    let directory = directory.unwrap_or(Path::new("."));
                    if !directory.is_dir() {
                        let directory = directory.display();
                        anyhow::bail!("{}: there is no directory '{directory}'", cannot());
                    }
                    temporary(directory).with_context(cannot)?;
                    Sink::Renamed(directory.to_owned())
                }
            }
        };
        Ok(Self { path: path.to_owned(), sink })
    }

    /// Writes the whole content, then makes it appear under its name.
    ///
    /// # Errors
    /// If writing or renaming fails; the target is then as it was.
    pub fn finish(self, content: impl FnOnce(&mut dyn Write) -> std::io::Result<()>) -> Result<()> {
        let path = self.path;
        let cannot = || format!("cannot write '{}'", path.display());
        match self.sink {
            Sink::Renamed(directory) => {
                let file = temporary(&directory).with_context(cannot)?;
                let mut writer = BufWriter::new(file);
                content(&mut writer).and_then(|()| writer.flush()).with_context(cannot)?;
                let file = writer.into_inner().map_err(|e| e.into_error()).with_context(cannot)?;
                file.persist(&path).map_err(|e| e.error).with_context(cannot)?;
            }
            Sink::Direct(file) => {
                let mut writer = BufWriter::new(file);
                content(&mut writer).and_then(|()| writer.flush()).with_context(cannot)?;
            }
            Sink::Standard => {
                let mut whole = Vec::new();
                content(&mut whole).with_context(cannot)?;
                print_bytes(&whole)?;
            }
        }
        Ok(())
    }
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
    let mut out = std::io::stdout().lock();
    match out.write_all(bytes).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(error).context("cannot write to standard output")
        }
        _ => Ok(()),
    }
}

/// Refuses a path that asks for another format than PNG. A path without an extension asks for none.
///
/// # Errors
/// If it does.
pub fn check_png(path: &Path) -> Result<()> {
    match path.extension() {
        Some(extension) if !extension.eq_ignore_ascii_case("png") => {
            let other = path.with_extension("png");
            anyhow::bail!(
                "pictures are written as PNG only: '{}' would not be one; say '{}'",
                path.display(),
                other.display()
            )
        }
        Some(_) | None => Ok(()),
    }
}

/// Writes rows of red, green and blue bytes as PNG.
///
/// # Errors
/// If the sink fails.
pub fn write_png(
    out: &mut dyn Write,
    rgb: &[u8],
    width: usize,
    height: usize,
) -> std::io::Result<()> {
    use image::ImageEncoder;
    let (width, height) = (width as u32, height as u32);
    image::codecs::png::PngEncoder::new(out)
        .write_image(rgb, width, height, image::ExtendedColorType::Rgb8)
        .map_err(std::io::Error::other)
}
