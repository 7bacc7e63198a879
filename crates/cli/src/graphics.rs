//! Pictures in terminals that show more than characters: the protocols of kitty and of iTerm2, and
//! sixels.
//!
//! Sixels are made by `icy_sixel`, since they need a palette. The other two take a PNG in base64
//! between a few keys, which is less than what the crates that write them bring along: `viuer` asks
//! the terminal without a limit of time and writes to standard output itself, `ratatui-image` needs
//! `ratatui`.

use super::png_file::{Origin, write_png};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use std::fmt::Write as _;

/// How pixels are sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Protocol {
    /// <https://sw.kovidgoyal.net/kitty/graphics-protocol/>, which others have taken over.
    Kitty,
    /// <https://iterm2.com/documentation-images.html>, likewise.
    Iterm,
    /// <https://vt100.net/docs/vt3xx-gp/chapter14.html>, up to 256 colors.
    Sixel,
}

/// Kitty takes no more of a picture at once.
const CHUNK: usize = 4096;

/// The device attribute of terminals that show sixels.
const SIXEL: &str = "4";

/// What a terminal's environment tells of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Known {
    /// It speaks this.
    Speaks(Protocol),
    /// It has to be asked, with [`Protocol::answered`].
    Unknown,
    /// It answers no questions.
    Mute,
}

impl Known {
    /// What `variable` says of the environment.
    pub fn detect(variable: impl Fn(&str) -> Option<String>) -> Self {
        let is_set = |name: &str| variable(name).is_some_and(|value| !value.is_empty());
        let term = variable("TERM").unwrap_or_default();
        // These show their own screen, whatever the terminal around them can do, and some show
        // sixels on it.
        if is_set("TMUX") || is_set("STY") || term.starts_with("screen") || term.starts_with("tmux")
        {
            return Self::Unknown;
        }
        let program = variable("TERM_PROGRAM").unwrap_or_default();
        if is_set("KITTY_WINDOW_ID") || term == "xterm-kitty" || term == "xterm-ghostty" {
            return Self::Speaks(Protocol::Kitty);
        }
        match program.as_str() {
            "ghostty" => Self::Speaks(Protocol::Kitty),
            "iTerm.app" | "WezTerm" | "mintty" => Self::Speaks(Protocol::Iterm),
            _ if term.is_empty() || term == "dumb" => Self::Mute,
            _ => Self::Unknown,
        }
    }
}

impl Protocol {
    /// What a terminal speaks that answers the question for its primary device attributes so;
    /// `None` if only characters.
    pub fn answered(answer: &str) -> Option<Self> {
        let attributes = answer.strip_prefix("\x1b[?")?.strip_suffix('c')?;
        // The first number is the kind of terminal.
        attributes.split(';').skip(1).any(|one| one == SIXEL).then_some(Self::Sixel)
    }

    /// What shows a picture, three bytes a pixel, over so many columns and rows of characters, from
    /// where the cursor is; sixels take their own size. `None` if it cannot be packed.
    pub fn encode(
        self,
        rgb: &[u8],
        (width, height): (usize, usize),
        (columns, rows): (usize, usize),
    ) -> Option<String> {
        match self {
            Self::Kitty | Self::Iterm => {
                let mut png = Vec::new();
                write_png(&mut png, rgb, [width, height], &Origin::default()).ok()?;
                Some(self.wrap(&png, columns, rows))
            }
            Self::Sixel => sixels(rgb, width, height),
        }
    }

    /// A PNG between the keys of a protocol that takes one.
    fn wrap(self, png: &[u8], columns: usize, rows: usize) -> String {
        let data = STANDARD.encode(png);
        if self == Self::Iterm {
            return format!(
                "\x1b]1337;File=inline=1;size={};width={columns};height={rows}:{data}\x07",
                png.len()
            );
        }
        let mut text = String::new();
        let mut left = data.as_str();
        // Quiet, since nobody reads an answer.
        let mut keys = format!("a=T,f=100,q=2,c={columns},r={rows},");
        loop {
            let (part, rest) = left.split_at(left.len().min(CHUNK));
            let more = u8::from(!rest.is_empty());
            // Writing to a string cannot fail.
            let _ = write!(text, "\x1b_G{keys}m={more};{part}\x1b\\");
            if rest.is_empty() {
                return text;
            }
            left = rest;
            keys.clear();
        }
    }
}

#[cfg(feature = "sixel")]
fn sixels(rgb: &[u8], width: usize, height: usize) -> Option<String> {
    let opaque: Vec<u8> = rgb.chunks_exact(3).flat_map(|c| [c[0], c[1], c[2], 255]).collect();
    // 256 colors shade a surface or two smoothly; dithering would only add grain and half the
    // bytes again.
    let options = icy_sixel::EncodeOptions { diffusion: 0.0, ..Default::default() };
    icy_sixel::sixel_encode(&opaque, width, height, &options).ok()
}

/// Without the feature no terminal is asked whether it shows sixels.
#[cfg(not(feature = "sixel"))]
fn sixels(_: &[u8], _: usize, _: usize) -> Option<String> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn detected(variables: &[(&str, &str)]) -> Known {
        Known::detect(|name| {
            let found = variables.iter().find(|(known, _)| *known == name);
            found.map(|(_, value)| (*value).to_owned())
        })
    }

    #[test]
    fn terminals_are_known_by_their_environment_or_asked() {
        let (kitty, iterm) = (Known::Speaks(Protocol::Kitty), Known::Speaks(Protocol::Iterm));
        assert_eq!(detected(&[("TERM", "xterm-kitty")]), kitty);
        assert_eq!(detected(&[("TERM", "xterm"), ("TERM_PROGRAM", "ghostty")]), kitty);
        assert_eq!(detected(&[("TERM", "xterm"), ("TERM_PROGRAM", "WezTerm")]), iterm);
        assert_eq!(detected(&[("TERM", "xterm-256color")]), Known::Unknown);
        assert_eq!(
            detected(&[("TERM", "tmux"), ("KITTY_WINDOW_ID", "1"), ("TMUX", "/tmp/t")]),
            Known::Unknown
        );
        assert_eq!(detected(&[("TERM", "dumb")]), Known::Mute);
        assert_eq!(detected(&[]), Known::Mute);
    }

    #[test]
    fn the_attribute_for_sixels_is_told_from_others() {
        for answer in ["\x1b[?62;4c", "\x1b[?64;1;2;4;6;9c", "\x1b[?4;6;4c"] {
            assert_eq!(Protocol::answered(answer), Some(Protocol::Sixel), "{answer:?}");
        }
        for answer in ["", "\x1b[?6c", "\x1b[?4c", "\x1b[?4;6c", "\x1b[?64;14;40;22c", "62;4c"] {
            assert_eq!(Protocol::answered(answer), None, "{answer:?}");
        }
    }

    #[test]
    fn the_picture_arrives_whole() {
        let png: Vec<u8> = (0..10_000_u32).map(|n| ((n * n) >> 3) as u8).collect();
        let text = Protocol::Kitty.wrap(&png, 40, 20);
        let mut data = String::new();
        let parts: Vec<&str> = text.split_terminator("\x1b\\").collect();
        for (number, part) in parts.iter().enumerate() {
            let (keys, part) = part.split_once(';').expect("keys");
            let more = usize::from(number + 1 < parts.len());
            assert!(keys.starts_with("\x1b_G") && keys.ends_with(&format!("m={more}")), "{keys}");
            assert!(part.len() <= CHUNK && (more == 0 || part.len() % 4 == 0));
            data += part;
        }
        assert!(parts[0].contains("c=40,r=20,"));
        assert_eq!(STANDARD.decode(data).expect("base64"), png);
        let text = Protocol::Iterm.wrap(&png, 40, 20);
        let (keys, data) = text.split_once(':').expect("keys");
        assert!(keys.contains("size=10000;width=40;height=20"), "{keys}");
        assert_eq!(STANDARD.decode(data.trim_end_matches('\x07')).expect("base64"), png);
    }
}
