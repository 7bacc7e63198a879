//! The options of methods, in one table. The command line, the prompt, the status line, JSON and
//! charts are derived from it.

use crate::scalar::Scalar;
use std::fmt;
use std::ops::RangeInclusive;

/// Values of all options. A method reads the options that its row names, and ignores the others.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(clippy::struct_excessive_bools, reason = "each is an option of its own")]
pub struct TraceOptions {
    /// The floats in which kernels compute.
    pub precision: Precision,
    /// Number of times that the region is halved along a ray, from 1 to [`Precision::max_depth`].
    /// Larger numbers are clamped.
    pub depth: u32,
    /// Greatest distance, in pixels, from a zero to the reported hit. Proofs do not depend on it.
    pub tolerance: f64,
    /// Number of samples on a ray's path through the region, or largest number of steps. At least
    /// 2.
    pub steps: u32,
    /// Whether segments are narrowed to where a form may vanish. Otherwise they are only halved.
    pub contract: bool,
    /// Whether rays are traced together, tile by tile. Otherwise each ray is traced alone.
    pub tiles: bool,
    /// Whether intervals are tried on segments that affine forms leave undecided.
    pub intervals: bool,
    /// Length below which a segment may stay undecided, as a share of the longest bracket. At 0,
    /// segments are narrowed to the limit of precision. Larger values suit a preview: segments are
    /// narrowed less before they are painted. Only methods that prove hits read it.
    pub least: f64,
    /// Whether the surface is the boundary of a solid. Then every change of sign is a face, also at
    /// a pole or a jump. Otherwise, if the function is unbounded on a segment that may hold a zero,
    /// the pixel is undecided, and the place is not painted.
    pub is_solid: bool,
}

impl TraceOptions {
    /// Checks that the value of each option is in the option's range.
    ///
    /// # Errors
    /// If a value is out of range. The text has the option's key in JSON and the reason.
    pub fn check(&self) -> Result<(), String> {
        let check = |option: &MethodOption| {
            let typed = (option.set)(&mut self.clone(), &(option.get)(self));
            typed.map_err(|why| format!("{}: {why}", option.key))
        };
        OPTIONS.iter().try_for_each(check)
    }

    /// Greatest length of a hit's bracket, in pixels. The hit is reported in the bracket's middle.
    pub(crate) fn longest(&self) -> f64 {
        2.0 * self.tolerance
    }
}

impl Default for TraceOptions {
    fn default() -> Self {
        Self {
            precision: Precision::Auto,
            depth: 10,
            tolerance: 0.5,
            steps: 256,
            contract: true,
            tiles: true,
            intervals: true,
            least: 0.0,
            is_solid: false,
        }
    }
}

/// The floats in which kernels compute. Enclosures are rigorous in each choice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Precision {
    /// 32 bits first, then 64 bits for rays that stay undecided. Methods that cannot combine both
    /// treat this as [`Precision::F32`].
    #[default]
    Auto,
    /// 32 bits: twice as fast as 64 bits.
    F32,
    /// 64 bits: for thinner slabs, and for surfaces that `f32` cannot tell from their surroundings.
    F64,
}

impl Precision {
    /// Each precision, its name, and one line of help.
    pub const NAMES: &'static [(Self, &'static str, &'static str)] = &[
        (Self::Auto, "auto", "32 bits, rounded outward, and 64 for what these leave undecided"),
        (Self::F32, "f32", "32 bits, rounded outward"),
        (Self::F64, "f64", "64 bits, rounded outward; at most half as fast"),
    ];

    /// The greatest depth at which slabs are thicker than the rounding error of their planes.
    pub fn max_depth(self) -> u32 {
        match self {
            Self::Auto | Self::F32 => f32::MAX_DEPTH,
            Self::F64 => f64::MAX_DEPTH,
        }
    }
}

impl fmt::Display for Precision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let row = Self::NAMES.iter().find(|row| row.0 == *self);
        f.write_str(row.map_or("", |row| row.1))
    }
}

/// An option that a method may read: a row of [`OPTIONS`].
#[derive(Clone, Copy)]
pub struct MethodOption {
    /// The flag's name, without its dashes.
    pub name: &'static str,
    /// Other names of the flag.
    pub aliases: &'static [&'static str],
    /// The prompt's command that sets the option; empty if there is none.
    pub command: &'static str,
    /// The arguments that may follow the command at the prompt.
    pub arguments: &'static str,
    /// Notation of the option's value in help; empty for a switch, which takes no value.
    pub value: &'static str,
    /// All possible values, each with one line of help; empty if they are numbers.
    pub values: fn() -> Vec<(&'static str, &'static str)>,
    /// One line of help on the command line.
    pub help: &'static str,
    /// One line of help at the prompt.
    pub prompt_help: &'static str,
    /// The option's key in JSON reports; empty if reports leave it out.
    pub key: &'static str,
    /// Whether short help lists the option.
    pub is_common: bool,
    /// The axis label of charts that vary the option; empty if charts do not.
    pub axis: &'static str,
    /// Returns the option's value as it is typed; `on` or `off` for a switch.
    pub get: fn(&TraceOptions) -> String,
    /// Sets the option's value from its text.
    ///
    /// # Errors
    /// If the text is not a valid value. The message names neither the flag nor the command.
    pub set: fn(&mut TraceOptions, &str) -> Result<(), String>,
    /// Returns a phrase that describes the option's value.
    pub describe: fn(&TraceOptions) -> String,
    /// Whether summaries show the option's value even if it is the default.
    pub is_always_shown: bool,
    /// The unit that follows the option's value in summaries.
    pub unit: &'static str,
}

/// Valid values of [`TraceOptions::steps`]. The smallest is one sample at each end of a ray's path.
/// At the largest, a picture takes minutes.
const STEPS_RANGE: RangeInclusive<u32> = 2..=1 << 20;

/// A message that states the valid range of [`TraceOptions::tolerance`] and the reason for it.
pub const TOLERANCES: &str = "a tolerance is a number of pixels, above 0, since no arithmetic finds a root exactly, and at \
     most 100; 0.5 is the default";

/// Returns whether `pixels` is a valid tolerance.
pub fn is_tolerance(pixels: f64) -> bool {
    pixels > 0.0 && pixels <= 100.0
}

/// Checks that slabs at `depth` are thick enough for floats of this precision.
///
/// # Errors
/// If the slabs are too thin, or `depth` is 0. The message names neither the flag nor the command.
pub fn check_depth(depth: u32, precision: Precision) -> Result<(), String> {
    let most = precision.max_depth();
    if (1..=most).contains(&depth) {
        return Ok(());
    }
    let hint = match precision {
        Precision::Auto | Precision::F32 => {
            format!(", or {} in precision f64", Precision::F64.max_depth())
        }
        Precision::F64 => String::new(),
    };
    Err(format!("a depth is between 1 and {most}{hint}"))
}

/// The option that sets [`TraceOptions::precision`]. It comes before [`DEPTH`], whose range depends
/// on it.
pub const PRECISION: MethodOption = MethodOption {
    name: "precision",
    command: "precision",
    arguments: "[auto|f32|f64]",
    value: "PRECISION",
    values: || Precision::NAMES.iter().map(|row| (row.1, row.2)).collect(),
    help: "Kernel precision; enclosures are rigorous in all",
    prompt_help: "kernel precision: f64 is slower but resolves more",
    key: "precision",
    is_common: true,
    axis: "precision",
    get: |options| options.precision.to_string(),
    // If the depth is too large for the new precision, it becomes the largest valid depth.
    set: |options, text| {
        let row = Precision::NAMES.iter().find(|row| row.1 == text);
        let row = row.ok_or_else(|| format!("'{text}' is not one of auto, f32, f64"))?;
        options.precision = row.0;
        options.depth = options.depth.min(row.0.max_depth());
        Ok(())
    },
    describe: |options| {
        let row = Precision::NAMES.iter().find(|row| row.0 == options.precision);
        format!("precision {} ({})", options.precision, row.map_or("", |row| row.2))
    },
    is_always_shown: true,
    ..SWITCH
};

/// The option that sets [`TraceOptions::depth`].
pub const DEPTH: MethodOption = MethodOption {
    name: "max-depth",
    aliases: &["depth", "dstop"],
    command: "depth",
    arguments: "[N]",
    value: "N",
    help: "How many times a ray's path through the domain is halved: at most 20, or 40 in f64; beyond \
           14, rays that stay undecided are given up after 32768 steps",
    prompt_help: "how often a ray's path through the domain is halved",
    key: "max_depth",
    axis: "depth: how often the domain is halved",
    get: |options| options.depth.to_string(),
    set: |options, text| {
        let depth = whole(text)?;
        check_depth(depth, options.precision)?;
        options.depth = depth;
        Ok(())
    },
    describe: |options| {
        format!("depth {} of at most {}", options.depth, options.precision.max_depth())
    },
    is_always_shown: true,
    ..SWITCH
};

/// The option that sets [`TraceOptions::steps`].
pub const STEPS: MethodOption = MethodOption {
    name: "steps",
    command: "steps",
    arguments: "[N]",
    value: "N",
    help: "Samples on a ray's path through the domain, or the most steps along it: 2 to 1048576",
    prompt_help: "samples on a ray's path through the domain, or the most steps along it",
    key: "steps",
    axis: "steps: samples on a ray's way, or steps along it at most",
    get: |options| options.steps.to_string(),
    set: |options, text| {
        let steps = whole(text)?;
        if !STEPS_RANGE.contains(&steps) {
            let (least, most) = (STEPS_RANGE.start(), STEPS_RANGE.end());
            return Err(format!("steps are between {least} and {most}"));
        }
        options.steps = steps;
        Ok(())
    },
    describe: |options| format!("{} steps on a ray's path through the domain", options.steps),
    is_always_shown: true,
    ..SWITCH
};

/// The option that sets [`TraceOptions::tolerance`].
pub const TOLERANCE: MethodOption = MethodOption {
    name: "tolerance",
    command: "tolerance",
    arguments: "[PIXELS]",
    value: "PIXELS",
    help: "How far, in pixels, a hit may be from where it is reported: above 0, at most 100",
    prompt_help: "how far a hit may be from where it is drawn, in pixels",
    key: "tolerance",
    is_common: true,
    axis: "tolerance, in pixels",
    get: |options| options.tolerance.to_string(),
    set: |options, text| {
        let pixels = text.parse().map_err(|_| format!("'{text}' is not a number"))?;
        if !is_tolerance(pixels) {
            return Err(TOLERANCES.to_owned());
        }
        options.tolerance = pixels;
        Ok(())
    },
    describe: |options| {
        format!("hits are within {} pixels of where they are drawn", options.tolerance)
    },
    unit: " px",
    ..SWITCH
};

/// Turns [`TraceOptions::contract`] off.
pub const NO_CONTRACT: MethodOption = MethodOption {
    name: "no-contract",
    help: "Halve segments, rather than narrow them to where an affine form may vanish",
    get: |options| switch(!options.contract),
    set: |options, text| is_on(text).map(|is_left_out| options.contract = !is_left_out),
    describe: |_| "segments are halved, not narrowed".to_owned(),
    ..SWITCH
};

/// Turns [`TraceOptions::tiles`] off.
pub const NO_TILES: MethodOption = MethodOption {
    name: "no-tiles",
    help: "Follow each ray alone, rather than tiles of rays",
    get: |options| switch(!options.tiles),
    set: |options, text| is_on(text).map(|is_left_out| options.tiles = !is_left_out),
    describe: |_| "each ray is followed alone".to_owned(),
    ..SWITCH
};

/// Turns [`TraceOptions::intervals`] off.
pub const NO_INTERVALS: MethodOption = MethodOption {
    name: "no-interval",
    help: "Ask no intervals where affine forms leave a segment open",
    get: |options| switch(!options.intervals),
    set: |options, text| is_on(text).map(|is_left_out| options.intervals = !is_left_out),
    describe: |_| "no intervals where forms leave a segment open".to_owned(),
    ..SWITCH
};

/// All options, in the order in which they are set and shown.
pub static OPTIONS: [MethodOption; 7] =
    [PRECISION, DEPTH, STEPS, TOLERANCE, NO_CONTRACT, NO_TILES, NO_INTERVALS];

/// The defaults of a row's columns. A switch turns off a part of a method.
const SWITCH: MethodOption = MethodOption {
    name: "",
    aliases: &[],
    command: "",
    arguments: "",
    value: "",
    values: Vec::new,
    help: "",
    prompt_help: "",
    key: "",
    is_common: false,
    axis: "",
    get: |_| String::new(),
    set: |_, _| Ok(()),
    describe: |_| String::new(),
    is_always_shown: false,
    unit: "",
};

impl MethodOption {
    /// Returns whether the option is a switch, which takes no value.
    pub fn is_switch(&self) -> bool {
        self.value.is_empty()
    }

    /// Returns whether the option has its default value in `options`.
    pub fn is_default(&self, options: &TraceOptions) -> bool {
        (self.get)(options) == (self.get)(&TraceOptions::default())
    }

    /// The option as a flag with its value, as typed. `None` if the value is the default.
    pub fn flag(&self, options: &TraceOptions) -> Option<String> {
        let value =
            if self.is_switch() { String::new() } else { format!(" {}", (self.get)(options)) };
        (!self.is_default(options)).then(|| format!("--{}{value}", self.name))
    }

    /// The text that a summary shows for the option: its value, or its name if it is a switch.
    /// `None` if the value is the default and summaries then omit it.
    pub fn short(&self, options: &TraceOptions) -> Option<String> {
        let is_shown = self.is_always_shown || !self.is_default(options);
        is_shown.then(|| {
            if self.is_switch() {
                self.name.to_owned()
            } else {
                format!("{}{}", (self.get)(options), self.unit)
            }
        })
    }
}

impl PartialEq for MethodOption {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl fmt::Debug for MethodOption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name)
    }
}

/// Reads a whole number. A number out of the range of `u32` becomes 0 or the largest `u32`, neither
/// of which is a valid value.
fn whole(text: &str) -> Result<u32, String> {
    let number: i128 = text.parse().map_err(|_| format!("'{text}' is not a whole number"))?;
    Ok(number.clamp(0, u32::MAX.into()) as u32)
}

fn switch(is_on: bool) -> String {
    (if is_on { "on" } else { "off" }).to_owned()
}

fn is_on(text: &str) -> Result<bool, String> {
    match text {
        "on" => Ok(true),
        "off" => Ok(false),
        _ => Err(format!("'{text}' is neither on nor off")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::METHODS;

    #[test]
    fn a_value_that_is_shown_can_be_typed() {
        let mut options = TraceOptions {
            precision: Precision::F64,
            depth: 33,
            tolerance: 0.125,
            steps: 77,
            contract: false,
            tiles: false,
            intervals: false,
            ..TraceOptions::default()
        };
        let expected = options;
        let shown = OPTIONS.map(|option| (option.get)(&options));
        options = TraceOptions::default();
        for (option, shown) in OPTIONS.iter().zip(&shown) {
            assert!(option.is_default(&options), "{option:?}");
            (option.set)(&mut options, shown).expect(option.name);
            assert_eq!(&(option.get)(&options), shown);
            assert!(option.flag(&options).is_some_and(|flag| flag.starts_with("--")));
            assert!((option.set)(&mut options, "?").is_err(), "{option:?}");
        }
        assert_eq!(options, expected);
    }

    #[test]
    fn every_option_is_read_by_some_method_and_named_once() {
        for option in &OPTIONS {
            assert!(METHODS.iter().any(|method| method.reads.contains(option)), "{option:?}");
            assert_eq!(OPTIONS.iter().filter(|other| *other == option).count(), 1);
        }
    }

    #[test]
    fn values_out_of_range_are_refused_and_change_nothing() {
        let mut options = TraceOptions::default();
        for (option, text) in
            [(DEPTH, "0"), (DEPTH, "21"), (STEPS, "1"), (TOLERANCE, "nan"), (TOLERANCE, "101")]
        {
            assert!((option.set)(&mut options, text).is_err(), "{option:?} {text}");
            assert_eq!(options, TraceOptions::default());
        }
        (PRECISION.set)(&mut options, "f64").expect("a name");
        (DEPTH.set)(&mut options, "40").expect("thick enough");
        (PRECISION.set)(&mut options, "f32").expect("a name");
        assert_eq!(options.depth, 20);
    }
}
