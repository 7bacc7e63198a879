//! What one picture is written to: files opened before the work, and where they came from.

use super::arguments::OutputArgs;
use super::array::{ARRAYS, ArrayRow, Arrays};
use super::output::{Output, check_png, write_png};
use anyhow::{Result, bail, ensure};
use std::path::{Path, PathBuf};
use zeroset::live::quote;
use zeroset::picture::Picture;

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

    /// # Errors
    /// If a file cannot be written.
    pub fn finish(self, picture: &Picture, origin: &Origin) -> Result<()> {
        if let Some(file) = self.picture {
            let size = [picture.buffer.width, picture.buffer.height];
            file.finish(|out| write_png(out, &picture.rgb, size, origin))?;
        }
        self.arrays
            .into_iter()
            .try_for_each(|(row, file)| file.finish(|out| (row.write)(picture, out)))
    }
}

/// Where a picture came from, as its file tells.
#[derive(Clone, Default, PartialEq, Eq)]
pub struct Origin {
    /// The command that makes it, and the text that it drew.
    pub chunks: Vec<(&'static str, String)>,
}

/// What makes no difference to pictures: which of them are made here, how fast, and whether they are made again.
const INDIFFERENT: [(&str, bool); 3] =
    [("--shard", true), ("--resume", false), ("--threads", true)];

impl Origin {
    /// What was typed, as it could be typed again, and the text that is drawn.
    pub fn typed(text: &str) -> Self {
        let mut words = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned());
        let mut kept = vec!["zeroset".to_owned()];
        while let Some(word) = words.next() {
            let (flag, value) = word.split_once('=').map_or((&*word, None), |(a, b)| (a, Some(b)));
            match INDIFFERENT.iter().find(|(name, _)| *name == flag) {
                Some((_, true)) if value.is_none() => drop(words.next()),
                Some(_) => {}
                None => kept.push(quote(&word)),
            }
        }
        Self { chunks: vec![("Comment", kept.join(" ")), ("Description", text.to_owned())] }
    }

    /// This command alone.
    pub fn command(command: &str) -> Self {
        Self { chunks: vec![("Comment", command.to_owned())] }
    }

    /// The same for one frame of a sequence.
    #[must_use]
    pub fn frame(&self, number: usize) -> Self {
        let mut chunks = self.chunks.clone();
        chunks.push(("Title", format!("frame {number}")));
        Self { chunks }
    }

    /// Whether a PNG file came from here.
    pub fn is_of(&self, file: &Path) -> bool {
        let open = || {
            let file = std::io::BufReader::new(std::fs::File::open(file).ok()?);
            png::Decoder::new(file).read_info().ok()
        };
        let Some(reader) = open() else { return false };
        let texts = &reader.info().utf8_text;
        self.chunks.iter().all(|(key, value)| {
            let same = |chunk: &png::text_metadata::ITXtChunk| {
                chunk.keyword == *key && chunk.get_text().is_ok_and(|text| text == *value)
            };
            texts.iter().any(same)
        })
    }
}
