//! The table of a picture's settings. The command line, the prompt, documents, the library and
//! Python read it. Nothing here knows how a setting changes a picture.

use crate::setting::{SHARE, Setting, Values};

/// Passes the settings that are choices for a whole picture to the macro `$define`: for each, the
/// documentation of its field and of the library's setter, its word, its type, and other columns of
/// its row.
#[macro_export]
macro_rules! choices {
    ($define:ident) => {
        $define! {
            /// The ambient share of the light, from 0 to 1. Default: the look's share.
            ambient: f64 = Setting {
                example: "0.4",
                default: "the look's",
                is_line: false,
                ..share("SHARE", None, "set the ambient light")
            };
            /// Draws a ground below the surfaces: a plane on which they cast shadows. Default: the
            /// text's `ground` line, or else off.
            ground: bool = switch("draw a ground below the surfaces, on which they cast soft shadows");
            /// The share of the background's color in points far away, from 0 to 1. Default: the
            /// text's `haze` line, or else 0.
            haze: f64 = share("on|off|SHARE", Some(0.6), "mix the background into points far away");
            /// Draws lines where surfaces end, bend sharply, meet, or hide each other. Default: the
            /// text's `outlines` line, or else off.
            outlines: bool = switch("draw lines where surfaces end, bend sharply, meet or hide each other");
            /// Casts soft shadows: a ray goes from every visible point to an area light. Default:
            /// the text's `shadows` line, or else off.
            shadows: bool =
                switch("cast soft shadows, by a ray from every visible point to an area light");
            /// Draws the domain's box with axes and ticks. The view makes room for it. Default: the
            /// text's `axes` line, or else off.
            axes: bool = switch("draw the domain's box with axes and ticks, and fit it into the picture");
            /// Draws a legend for colored values. Default: the text's `legend` line, or else on if
            /// there are axes.
            legend: bool = Setting { default: "with --axes", ..switch("draw the color scale of each color map") };
        }
    };
}

macro_rules! define {
    ($($(#[$doc:meta])+ $word:ident: $type:ty = $row:expr;)*) => {
        /// Choices for a whole picture. A choice that is `None` is left to others, such as the
        /// document or the look.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        pub struct Choices {
            $($(#[$doc])+ pub $word: Option<$type>,)*
        }

        impl Choices {
            /// Takes a choice that is missing here from `other`.
            #[must_use]
            pub fn or(self, other: Self) -> Self {
                Self { $($word: self.$word.or(other.$word),)* }
            }
        }

        /// The settings that are choices for a whole picture.
        pub static CHOICES: &[Setting] = &[$(Setting {
            word: stringify!($word),
            flag: stringify!($word),
            get: |choices| choices.$word.map(Into::into),
            set: |choices, value| choices.$word = Some(Choice::of(value)),
            ..$row
        }),*];
    };
}

choices!(define);

const fn switch(help: &'static str) -> Setting {
    Setting {
        word: "",
        values: Values::Switch,
        example: "on",
        help,
        default: "",
        flag: "",
        is_line: true,
        get: |_| None,
        set: |_, _| {},
    }
}

const fn share(notation: &'static str, on: Option<f64>, help: &'static str) -> Setting {
    let values = Values::Number { range: 0.0..=1.0, noun: SHARE, notation, on };
    Setting { values, example: "0.5", ..switch(help) }
}

/// The opacity of a surface.
pub static OPACITY: Setting = Setting {
    word: "opacity",
    example: "50%",
    ..share("SHARE", None, "set how opaque the drawings below are")
};

/// The width of a curve.
pub static WIDTH: Setting = Setting {
    word: "width",
    values: Values::Number {
        range: 0.1..=100.0,
        noun: "number of pixels",
        notation: "PIXELS",
        on: None,
    },
    example: "3px",
    ..switch("set how wide curves and points are")
};

/// The numbers of rays that a pixel on an edge may have.
pub const RAY_COUNTS: [usize; 4] = [1, 4, 16, 64];

/// The number of rays in a pixel on an edge, unless another one is chosen.
pub const RAYS: usize = 16;

/// The number of rays in a pixel on an edge.
pub static ANTIALIAS: Setting = Setting {
    word: "antialias",
    values: Values::OneOf { all: &RAY_COUNTS, usual: RAYS },
    flag: "aa",
    is_line: false,
    ..switch("trace this many rays in a pixel on an edge (output arrays: center ray only)")
};

/// The number of bits per channel of a PNG file.
pub static BITS: Setting = Setting {
    word: "bits",
    values: Values::OneOf { all: &[8, 16], usual: 8 },
    flag: "bits",
    is_line: false,
    ..switch("write PNG files with this many bits per channel")
};

/// All settings: [`CHOICES`], and the settings whose values are kept elsewhere.
pub fn settings() -> impl Iterator<Item = &'static Setting> {
    CHOICES.iter().chain([&OPACITY, &WIDTH, &ANTIALIAS, &BITS])
}

impl Choices {
    /// Checks that all values are in range.
    ///
    /// # Errors
    /// If one is not. The message begins with the setting's word.
    pub fn check(&self) -> Result<(), String> {
        let check =
            |row: &Setting| (row.get)(self).map_or(Ok(()), |value| row.check(value).map(drop));
        CHOICES.iter().try_for_each(check)
    }
}

/// The type of a choice. A row holds its values as numbers.
trait Choice: Into<f64> {
    fn of(value: f64) -> Self;
}

impl Choice for f64 {
    fn of(value: f64) -> Self {
        value
    }
}

impl Choice for bool {
    fn of(value: f64) -> Self {
        value != 0.0
    }
}
