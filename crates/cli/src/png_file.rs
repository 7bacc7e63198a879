//! The origin of a picture: the command and the text it was made from, stored in its PNG file.

use std::path::Path;
use zeroset_live::quote;

/// The origin of a picture, as stored in its file.
#[derive(Clone, Default, PartialEq, Eq)]
pub struct PictureOrigin {
    /// Keyword and text of each PNG chunk: one chunk for the command that renders the picture, one
    /// for the document.
    pub chunks: Vec<(&'static str, String)>,
}

/// Each flag that does not affect pictures, and whether a value follows the flag.
const IRRELEVANT_FLAGS: [(&str, bool); 3] =
    [("--shard", true), ("--resume", false), ("--threads", true)];

impl PictureOrigin {
    /// Returns the origin of a picture of `text`: the command line of this process, quoted for a
    /// shell, and the text.
    pub fn typed(text: &str) -> Self {
        let mut words = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned());
        let mut kept = vec!["zeroset".to_owned()];
        while let Some(word) = words.next() {
            let (flag, value) = word.split_once('=').map_or((&*word, None), |(a, b)| (a, Some(b)));
            match IRRELEVANT_FLAGS.iter().find(|(name, _)| *name == flag) {
                Some((_, true)) if value.is_none() => drop(words.next()),
                Some(_) => {}
                None => kept.push(quote(&word)),
            }
        }
        Self { chunks: vec![("Comment", kept.join(" ")), ("Description", text.to_owned())] }
    }

    /// Returns an origin that holds this command and no document.
    pub fn command(command: &str) -> Self {
        Self { chunks: vec![("Comment", command.to_owned())] }
    }

    /// Returns the origin of one frame of a sequence.
    #[must_use]
    pub fn frame(&self, number: usize) -> Self {
        let mut chunks = self.chunks.clone();
        chunks.push(("Title", format!("frame {number}")));
        Self { chunks }
    }

    /// Whether a PNG file has this origin.
    pub fn is_origin_of(&self, file: &Path) -> bool {
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
