//! Finds the text to draw: on standard input, in a file, in the gallery, or on the command line.

use anyhow::{Context, Result, bail};
use std::ffi::OsStr;
use std::fs::File;
use std::io::Read;
use std::path::Path;
use zeroset_live::{DocumentSource, quote};
use zeroset_scene::gallery::{Example, all, example};

/// Longest text that is read, in bytes. The parser's own limit is lower.
const LONGEST: u64 = 80 << 20;

/// A text and where it came from.
pub struct Source {
    pub from: DocumentSource,
    pub text: String,
}

impl From<Example> for Source {
    fn from(example: Example) -> Self {
        Self { from: DocumentSource::Gallery(example), text: example.text.to_owned() }
    }
}

/// Finds the text that `argument` stands for: standard input (`-`), an existing file, a gallery
/// surface, or else a formula.
///
/// # Errors
/// If a file cannot be read, the text is not UTF-8, or the argument seems to name a missing file.
pub fn find(argument: &OsStr) -> Result<Source> {
    if argument == "-" {
        let from = DocumentSource::Stream("standard input".to_owned());
        return read(from, std::io::stdin().lock());
    }
    let path = Path::new(argument);
    let shown = argument.to_string_lossy();
    // Unlike `exists`, this also finds a link that leads nowhere. It fails for an empty argument or
    // one with a NUL byte, neither of which is a path.
    if path.symlink_metadata().is_ok() {
        if !path.is_dir() {
            return open(path);
        }
        // A directory cannot be drawn. But if it has a gallery surface's name, for example because
        // pictures of the surface are in it, the surface is meant.
        let Some(example) = argument.to_str().and_then(example) else {
            bail!("'{shown}' is a directory, not a function file");
        };
        return Ok(example.into());
    }
    let Some(text) = argument.to_str() else {
        bail!("the formula is not valid UTF-8, and no file has this name: '{shown}'");
    };
    if let Some(example) = example(text) {
        return Ok(example.into());
    }
    if path.extension().is_some_and(|extension| extension == "zset") {
        let slug = text.strip_suffix(".zset").and_then(example);
        match slug {
            Some(example) => {
                bail!("there is no file '{shown}'; the gallery has '{}'", example.slug)
            }
            None => bail!("there is no file '{shown}'; 'zeroset gallery --list' lists the gallery"),
        }
    }
    if is_like_a_path(path) && !is_formula(text) {
        bail!("there is no file '{shown}', and it is no formula");
    }
    if let Some(slug) = misspelt(text) {
        bail!(
            "'{shown}' is not a file, a surface of the gallery or a formula; did you mean '{slug}' of the gallery?"
        );
    }
    Ok(Source { from: DocumentSource::Typed, text: text.to_owned() })
}

/// The word of a shell for which [`find`] finds this text: the file or the name of the gallery that
/// it came from, if that still holds it, or else the text itself.
pub fn shell_word(from: &DocumentSource, text: &str) -> String {
    let name = match from {
        DocumentSource::File(path) => {
            let holds_text = || open(path).is_ok_and(|file| file.text == text);
            path.to_str().filter(|_| holds_text())
        }
        DocumentSource::Gallery(example) => Some(example.slug).filter(|_| example.text == text),
        DocumentSource::Typed | DocumentSource::Stream(_) => None,
    };
    quote(name.unwrap_or(text))
}

/// Returns the gallery name that a word probably means: one that begins with the word, or else the
/// most similar one. `None` if the word is a formula.
pub fn misspelt(text: &str) -> Option<&'static str> {
    const SHORTEST: usize = 4;
    let text = text.trim();
    let is_word = text.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
    if text.len() < SHORTEST || text.len() > 40 || !is_word {
        return None;
    }
    let slugs = || all().into_iter().map(|example| example.slug);
    let distance = |slug: &str| strsim::damerau_levenshtein(slug, text);
    let begun = slugs().find(|slug| slug.starts_with(text));
    let near = || slugs().filter(|slug| distance(slug) <= 2 && distance(slug) * 3 <= text.len());
    let slug = begun.or_else(|| near().min_by_key(|slug| distance(slug)))?;
    (!is_formula(text)).then_some(slug)
}

fn is_formula(text: &str) -> bool {
    zeroset_syntax::read(text, &zeroset_syntax::Options::default()).is_ok()
}

/// Whether a path looks like a file name with an alphabetic extension, perhaps in a directory.
fn is_like_a_path(path: &Path) -> bool {
    let is_word = |text: &str| text.chars().all(|c| c.is_alphanumeric() || "-_./\\".contains(c));
    let extension = path.extension().and_then(OsStr::to_str).unwrap_or_default();
    extension.len() > 1
        && extension.chars().all(|c| c.is_ascii_alphabetic())
        && path.to_str().is_some_and(is_word)
}

/// Reads the text of a file.
///
/// # Errors
/// If it cannot be read, or is not UTF-8.
pub fn open(path: &Path) -> Result<Source> {
    let shown = path.display();
    let file = File::open(path).with_context(|| format!("cannot read '{shown}'"))?;
    // A pipe cannot be watched or saved to.
    let is_file = file.metadata().is_ok_and(|found| found.is_file());
    let from = if is_file {
        DocumentSource::File(path.to_owned())
    } else {
        DocumentSource::Stream(shown.to_string())
    };
    read(from, file)
}

fn read(from: DocumentSource, stream: impl Read) -> Result<Source> {
    let mut bytes = Vec::new();
    stream
        .take(LONGEST + 1)
        .read_to_end(&mut bytes)
        .with_context(|| format!("cannot read '{from}'"))?;
    if bytes.len() as u64 > LONGEST {
        bail!("'{from}' is longer than {} MB: too large for a formula", LONGEST >> 20);
    }
    match String::from_utf8(bytes) {
        // Some editors begin UTF-8 text with a byte order mark, which is not part of it.
        Ok(text) => {
            let text = text.strip_prefix('\u{feff}').unwrap_or(&text).to_owned();
            Ok(Source { from, text })
        }
        Err(error) => {
            let at = error.utf8_error().valid_up_to();
            let line = 1 + String::from_utf8_lossy(&error.as_bytes()[..at]).matches('\n').count();
            bail!("'{from}' is not valid UTF-8 text: line {line}, byte {at}")
        }
    }
}
