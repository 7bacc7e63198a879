//! Pictures in a terminal, by the protocols of kitty and iTerm2, or as sixels.
//!
//! The crate `icy_sixel` encodes sixels, since these need a palette. kitty and iTerm2 take a base64
//! PNG with a few parameters, which needs little code. Crates for these protocols do too much:
//! `viuer` queries the terminal without a time limit and writes to standard output itself, and
//! `ratatui-image` depends on `ratatui`.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use std::fmt::Write as _;
use zeroset_render::png_file::{PngFormat, write_png};

/// A protocol that sends pixels to a terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Protocol {
    /// The kitty graphics protocol: <https://sw.kovidgoyal.net/kitty/graphics-protocol/>.
    Kitty,
    /// Inline images of iTerm2: <https://iterm2.com/documentation-images.html>.
    Iterm,
    /// Sixels, with up to 256 colors: <https://vt100.net/docs/vt3xx-gp/chapter14.html>.
    Sixel,
}

/// Largest chunk of base64 data that kitty accepts in one escape sequence, in bytes.
const CHUNK: usize = 4096;

/// Device attribute that a terminal reports if it supports sixels.
const SIXEL: &str = "4";

/// Support for graphics, as far as the environment variables reveal it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GraphicsSupport {
    /// The terminal supports this protocol.
    Supports(Protocol),
    /// The terminal has to be queried; [`Protocol::from_answer`] reads the answer.
    Unknown,
    /// The terminal does not answer queries.
    Mute,
}

impl GraphicsSupport {
    /// Detects the terminal from environment variables, which `variable` looks up.
    pub fn detect(variable: impl Fn(&str) -> Option<String>) -> Self {
        let is_set = |name: &str| variable(name).is_some_and(|value| !value.is_empty());
        let term = variable("TERM").unwrap_or_default();
        // A multiplexer draws a screen of its own, so the outer terminal's protocol does not
        // matter. Some multiplexers support sixels.
        if is_set("TMUX") || is_set("STY") || term.starts_with("screen") || term.starts_with("tmux")
        {
            return Self::Unknown;
        }
        let program = variable("TERM_PROGRAM").unwrap_or_default();
        if is_set("KITTY_WINDOW_ID") || term == "xterm-kitty" || term == "xterm-ghostty" {
            return Self::Supports(Protocol::Kitty);
        }
        match program.as_str() {
            "ghostty" => Self::Supports(Protocol::Kitty),
            "iTerm.app" | "WezTerm" | "mintty" => Self::Supports(Protocol::Iterm),
            _ if term.is_empty() || term == "dumb" => Self::Mute,
            _ => Self::Unknown,
        }
    }
}

impl Protocol {
    /// Returns the protocol of a terminal, from its answer to the query for primary device
    /// attributes. `None` if the terminal shows only characters.
    pub fn from_answer(answer: &str) -> Option<Self> {
        let attributes = answer.strip_prefix("\x1b[?")?.strip_suffix('c')?;
        // Skip the first number, which identifies the kind of terminal.
        attributes.split(';').skip(1).any(|one| one == SIXEL).then_some(Self::Sixel)
    }

    /// Returns the text that shows a picture (three bytes per pixel) at the cursor, or `None` if
    /// encoding fails. The picture is scaled to this many columns and rows of characters, unless it
    /// is sent as sixels.
    pub fn encode(
        self,
        rgb: &[u8],
        (width, height): (usize, usize),
        (columns, rows): (usize, usize),
    ) -> Option<String> {
        match self {
            Self::Kitty | Self::Iterm => {
                let mut png = Vec::new();
                write_png(&mut png, rgb, PngFormat::RGB, [width, height], &[]).ok()?;
                Some(self.wrap(&png, columns, rows))
            }
            Self::Sixel => sixels(rgb, width, height),
        }
    }

    /// Encloses a PNG in the escape sequences of kitty or iTerm2.
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
        // The key `q=2` suppresses the terminal's answers, which nothing would read.
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
    // 256 colors shade one or two surfaces smoothly. Dithering would only add grain and size.
    let options = icy_sixel::EncodeOptions { diffusion: 0.0, ..Default::default() };
    icy_sixel::sixel_encode(&opaque, width, height, &options).ok()
}

/// Never called, since a build without this feature does not detect sixels.
#[cfg(not(feature = "sixel"))]
fn sixels(_: &[u8], _: usize, _: usize) -> Option<String> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn detected(variables: &[(&str, &str)]) -> GraphicsSupport {
        GraphicsSupport::detect(|name| {
            let found = variables.iter().find(|(known, _)| *known == name);
            found.map(|(_, value)| (*value).to_owned())
        })
    }

    #[test]
    fn terminals_are_known_by_their_environment_or_asked() {
        let (kitty, iterm) = (
            GraphicsSupport::Supports(Protocol::Kitty),
            GraphicsSupport::Supports(Protocol::Iterm),
        );
        assert_eq!(detected(&[("TERM", "xterm-kitty")]), kitty);
        assert_eq!(detected(&[("TERM", "xterm"), ("TERM_PROGRAM", "ghostty")]), kitty);
        assert_eq!(detected(&[("TERM", "xterm"), ("TERM_PROGRAM", "WezTerm")]), iterm);
        assert_eq!(detected(&[("TERM", "xterm-256color")]), GraphicsSupport::Unknown);
        assert_eq!(
            detected(&[("TERM", "tmux"), ("KITTY_WINDOW_ID", "1"), ("TMUX", "/tmp/t")]),
            GraphicsSupport::Unknown
        );
        assert_eq!(detected(&[("TERM", "dumb")]), GraphicsSupport::Mute);
        assert_eq!(detected(&[]), GraphicsSupport::Mute);
    }

    #[test]
    fn the_attribute_for_sixels_is_told_from_others() {
        for answer in ["\x1b[?62;4c", "\x1b[?64;1;2;4;6;9c", "\x1b[?4;6;4c"] {
            assert_eq!(Protocol::from_answer(answer), Some(Protocol::Sixel), "{answer:?}");
        }
        for answer in ["", "\x1b[?6c", "\x1b[?4c", "\x1b[?4;6c", "\x1b[?64;14;40;22c", "62;4c"] {
            assert_eq!(Protocol::from_answer(answer), None, "{answer:?}");
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
