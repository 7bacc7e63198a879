//! Pictures in terminals that show more than characters: the protocols of kitty and of iTerm2.
//!
//! Whether a terminal speaks one is told by its environment and never asked: an answer would arrive among what is typed.

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
}

/// Kitty takes no more of a picture at once.
const CHUNK: usize = 4096;

impl Protocol {
    /// What the terminal speaks, by what `variable` says of the environment.
    pub fn detect(variable: impl Fn(&str) -> Option<String>) -> Option<Self> {
        let is_set = |name: &str| variable(name).is_some_and(|value| !value.is_empty());
        let term = variable("TERM").unwrap_or_default();
        // These show their own screen, whatever the terminal around them can do.
        if is_set("TMUX") || is_set("STY") || term.starts_with("screen") || term.starts_with("tmux")
        {
            return None;
        }
        let program = variable("TERM_PROGRAM").unwrap_or_default();
        if is_set("KITTY_WINDOW_ID") || term == "xterm-kitty" || term == "xterm-ghostty" {
            return Some(Self::Kitty);
        }
        match program.as_str() {
            "ghostty" => Some(Self::Kitty),
            "iTerm.app" | "WezTerm" | "mintty" => Some(Self::Iterm),
            _ => None,
        }
    }

    /// What shows a PNG over so many columns and rows of characters, from where the cursor is.
    pub fn encode(self, png: &[u8], columns: usize, rows: usize) -> String {
        let data = STANDARD.encode(png);
        match self {
            // Writing to a string cannot fail.
            Self::Kitty => {
                let mut text = String::new();
                let mut left = data.as_str();
                // Quiet, since nobody reads an answer.
                let mut keys = format!("a=T,f=100,q=2,c={columns},r={rows},");
                loop {
                    let (part, rest) = left.split_at(left.len().min(CHUNK));
                    let more = u8::from(!rest.is_empty());
                    let _ = write!(text, "\x1b_G{keys}m={more};{part}\x1b\\");
                    if rest.is_empty() {
                        return text;
                    }
                    left = rest;
                    keys.clear();
                }
            }
            Self::Iterm => format!(
                "\x1b]1337;File=inline=1;size={};width={columns};height={rows}:{data}\x07",
                png.len()
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn detected(variables: &[(&str, &str)]) -> Option<Protocol> {
        Protocol::detect(|name| {
            let found = variables.iter().find(|(known, _)| *known == name);
            found.map(|(_, value)| (*value).to_owned())
        })
    }

    #[test]
    fn terminals_are_known_by_their_environment() {
        assert_eq!(detected(&[("TERM", "xterm-kitty")]), Some(Protocol::Kitty));
        assert_eq!(detected(&[("TERM_PROGRAM", "ghostty")]), Some(Protocol::Kitty));
        assert_eq!(detected(&[("TERM_PROGRAM", "WezTerm")]), Some(Protocol::Iterm));
        assert_eq!(detected(&[("TERM", "xterm-256color")]), None);
        assert_eq!(detected(&[("KITTY_WINDOW_ID", "1"), ("TMUX", "/tmp/t")]), None);
    }

    #[test]
    fn the_picture_arrives_whole() {
        let png: Vec<u8> = (0..10_000_u32).map(|n| ((n * n) >> 3) as u8).collect();
        let text = Protocol::Kitty.encode(&png, 40, 20);
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
        let text = Protocol::Iterm.encode(&png, 40, 20);
        let (keys, data) = text.split_once(':').expect("keys");
        assert!(keys.contains("size=10000;width=40;height=20"), "{keys}");
        assert_eq!(STANDARD.decode(data.trim_end_matches('\x07')).expect("base64"), png);
    }
}
