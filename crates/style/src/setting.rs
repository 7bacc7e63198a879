//! The type of a picture's settings: names, values, and the messages about them.

use crate::settings::Choices;
use std::fmt;
use std::ops::RangeInclusive;

/// The name of a part of a whole.
pub const SHARE: &str = "share";

/// The values that a setting takes.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// `on` or `off`, as 1 or 0.
    Switch,
    /// A number. With `on`, the words `on` and `off` are read, too: as this number, and as 0.
    Number {
        /// The numbers that are accepted.
        range: RangeInclusive<f64>,
        /// The name of such a number in messages, without its article. A [`SHARE`] may be a
        /// percentage.
        noun: &'static str,
        /// The notation of a value, as in help.
        notation: &'static str,
        /// The number that `on` stands for.
        on: Option<f64>,
    },
    /// One of some whole numbers.
    OneOf {
        /// The numbers, in increasing order.
        all: &'static [usize],
        /// The number without this setting.
        usual: usize,
    },
}

impl Values {
    /// Returns the value, if the setting takes it.
    ///
    /// # Errors
    /// If it does not. The message has no subject.
    pub fn check(&self, value: f64) -> Result<f64, String> {
        let is_valid = match self {
            Self::Switch => value == 0.0 || value == 1.0,
            Self::Number { range, .. } => range.contains(&value),
            Self::OneOf { all, .. } => all.iter().any(|one| *one as f64 == value),
        };
        if is_valid { Ok(value) } else { Err(format!("must be {self}")) }
    }

    /// Reads a value as it is typed. `number` reads a number.
    ///
    /// # Errors
    /// If the setting does not take it. The message has no subject.
    pub fn read(&self, text: &str, number: fn(&str) -> Option<f64>) -> Result<f64, String> {
        let value = match (text, text.strip_suffix('%'), self) {
            ("on", _, Self::Switch) => Some(1.0),
            ("on", _, Self::Number { on: Some(on), .. }) => Some(*on),
            ("off", _, Self::Switch | Self::Number { on: Some(_), .. }) => Some(0.0),
            (_, _, Self::Switch) => None,
            (_, Some(percent), Self::Number { noun: SHARE, .. }) => {
                number(percent).map(|percent| percent / 100.0)
            }
            _ => number(text),
        };
        self.check(value.unwrap_or(f64::NAN))
    }

    /// The notation of a value, as in help.
    pub fn notation(&self) -> &'static str {
        match self {
            Self::Switch => "on|off",
            Self::Number { notation, .. } => notation,
            Self::OneOf { .. } => "N",
        }
    }
}

impl fmt::Display for Values {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Switch => f.write_str("on or off"),
            Self::Number { range, noun, on, .. } => {
                let words = if on.is_some() { "on, off, or " } else { "" };
                write!(f, "{words}a {noun} from {} to {}", range.start(), range.end())
            }
            Self::OneOf { all, .. } => {
                let (last, others) = all.split_last().expect("a setting has values");
                let others: Vec<String> = others.iter().map(usize::to_string).collect();
                write!(f, "{} or {last}", others.join(", "))
            }
        }
    }
}

/// A setting of a picture: a row of the table [`settings`](crate::settings()).
#[derive(Clone, Debug)]
pub struct Setting {
    /// The word that begins the setting's line in a document, and its name in the library.
    pub word: &'static str,
    /// The values that it takes.
    pub values: Values,
    /// A value as it may be typed.
    pub example: &'static str,
    /// One line of help, in the imperative.
    pub help: &'static str,
    /// The value without this setting, in words; empty if help does not name it.
    pub default: &'static str,
    /// The flag's name on the command line, without its dashes; empty without a flag.
    pub flag: &'static str,
    /// True if documents may have a line that begins with the word.
    pub is_line: bool,
    /// Returns the value; `None` if it is not chosen, or kept elsewhere.
    pub get: fn(&Choices) -> Option<f64>,
    /// Sets the value, which the setting takes. Does nothing if values are kept elsewhere.
    pub set: fn(&mut Choices, f64),
}

impl Setting {
    /// Returns the value, if the setting takes it.
    ///
    /// # Errors
    /// If it does not. The message begins with the word.
    pub fn check(&self, value: f64) -> Result<f64, String> {
        self.values.check(value).map_err(|why| format!("{} {why}", self.word))
    }

    /// How to write the setting's line, for error messages.
    pub fn hint(&self) -> String {
        format!("write {}, such as `{} {}`", self.values, self.word, self.example)
    }

    /// The help of the flag, with its values and its default.
    pub fn flag_help(&self) -> String {
        let (first, rest) = self.help.split_at(1);
        let values = match self.values {
            Values::Switch => String::new(),
            _ => format!(": {}", self.values),
        };
        let default = match (&self.values, self.default) {
            (Values::OneOf { usual, .. }, _) => format!(" [default: {usual}]"),
            (_, "") => String::new(),
            (_, default) => format!(" [default: {default}]"),
        };
        format!("{}{rest}{values}{default}", first.to_uppercase())
    }

    /// The flag and its value, as typed. `None` if there is nothing to type: no flag turns a switch
    /// off.
    pub fn typed_flag(&self, choices: &Choices) -> Option<String> {
        let value = (self.get)(choices).filter(|_| !self.flag.is_empty())?;
        match self.values {
            Values::Switch => (value == 1.0).then(|| format!("--{}", self.flag)),
            _ => Some(format!("--{} {value}", self.flag)),
        }
    }
}

impl PartialEq for Setting {
    fn eq(&self, other: &Self) -> bool {
        self.word == other.word
    }
}

impl Eq for Setting {}
