//! Command-line arguments.

use crate::grid::Values;
use crate::groups::distinct;
use crate::row::Conditions;
use clap::builder::{PossibleValuesParser, RangedI64ValueParser};
use clap::{Args, Parser, Subcommand};
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::time::Duration;
use zeroset_render::names::Named;
use zeroset_trace::{METHODS, Method, Precision, is_tolerance};

/// Measure and chart the methods of zeroset: speed against accuracy.
///
/// Exit codes: 0 for success; 1 if `check` finds different counts or hashes; 2 for errors that the
/// user can fix.
#[derive(Debug, Parser)]
#[command(name = "zeroset-chart", version, about)]
pub struct ChartArguments {
    /// Subcommand to run.
    #[command(subcommand)]
    pub command: ChartCommand,
}

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum ChartCommand {
    /// Measure times and errors of each method with each value of the options that it reads
    Run(RunArguments),
    /// Draw formulas on which methods are known to fail, and classify each picture
    Stability(StabilityArguments),
    /// Trace given or random rays with each method and with the certified tracer
    ///
    /// Writes .npy files of float64, so that other programs can be compared on the same rays. A row
    /// of `rays` is an origin and a direction of any length. `domain` has the ends of x, y and z.
    /// Each method has a file of its name. Its rows are the status (0 for a proven miss, 1 for a
    /// proven hit, 2 for undecided), the two ends of the hit's bracket and the drawn distance. A
    /// row of `certified` is 0 for no root, 1 for a root or 2 for open, then the two bounds of the
    /// first root. Distances are from the origin in world units; a missing distance is NaN.
    Rays(RaysArguments),
    /// Draw time against the number of parts, from the rows that `benches/rivals` has measured
    ///
    /// Writes `parts.svg`.
    Parts(PartsArguments),
    /// Draw the charts of a directory's rows again, as `run` does at its end
    Draw {
        /// Directory that `run` has written
        directory: PathBuf,
    },
    /// Measure a directory's rows again, and report counts and hashes that differ
    Check {
        /// Directory that `run` has written
        directory: PathBuf,
    },
}

/// The option that selects methods.
#[derive(Args, Debug)]
pub struct Methods {
    /// Methods, separated by commas; all methods if none is given
    #[arg(long, value_delimiter = ',', value_parser = PossibleValuesParser::new(METHODS.iter().map(|m| m.name)))]
    methods: Vec<String>,
}

impl Methods {
    /// The selected methods, in the order of the table; all methods if none is named.
    pub fn chosen(&self) -> Vec<&'static Method> {
        let names = &self.methods;
        let is_chosen =
            |method: &&Method| names.is_empty() || names.iter().any(|n| n == method.name);
        METHODS.iter().filter(is_chosen).collect()
    }
}

/// Arguments of `run`.
#[derive(Args, Debug)]
pub struct RunArguments {
    /// Names of surfaces: those of `zeroset gallery --list`, or of the ten measured by default
    pub surfaces: Vec<String>,
    /// Methods to measure.
    #[command(flatten)]
    pub methods: Methods,
    /// Depths, for methods that have this option
    #[arg(long, value_delimiter = ',', default_value = "6,8,10,12", value_name = "DEPTHS",
        value_parser = clap::value_parser!(u32).range(1..=i64::from(Precision::F64.max_depth())))]
    max_depth: Vec<u32>,
    /// Tolerances in pixels, for methods that have this option
    #[arg(long, value_delimiter = ',', default_value = "2,0.5,0.1,0.01", value_name = "PIXELS",
        value_parser = tolerance)]
    tolerances: Vec<f64>,
    /// Numbers of steps along a ray, for methods that have this option
    #[arg(long, value_delimiter = ',', default_value = "64,256,1024", value_name = "NUMBERS",
        value_parser = clap::value_parser!(u32).range(2..))]
    steps: Vec<u32>,
    /// Precisions, for methods that have this option
    #[arg(long, value_delimiter = ',', default_value = "f32,f64,auto", value_name = "NAMES",
        value_parser = precision_name)]
    precision: Vec<String>,
    /// Side of the square pictures in pixels; several sizes, separated by commas, give a chart of
    /// time against resolution
    #[arg(long, visible_alias = "size", value_delimiter = ',', default_value = "256", value_name = "PIXELS",
        value_parser = number(8..=8192))]
    sizes: Vec<usize>,
    /// Number of views of each surface; their kinds are standard, around, close, grazing, inside
    #[arg(long, default_value_t = 8, value_parser = number(1..=1000))]
    views: usize,
    /// Seed of views, sampled pixels and the order of measurements
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Number of times that each picture is measured
    #[arg(long, default_value_t = 15, value_parser = number(1..=100_000))]
    repeats: usize,
    /// Number of threads that draw a picture
    #[arg(long, default_value_t = 1, value_parser = number(1..=1024))]
    pub threads: usize,
    /// Approximate number of pixels per picture that the certified tracer checks; 0 for all
    #[arg(long, default_value_t = 1024, value_parser = number(0..=u32::MAX.into()))]
    samples: usize,
    /// Directory for the results; rows that it already has are kept
    #[arg(short, long, value_name = "DIRECTORY")]
    pub output: PathBuf,
    /// Small trial run: at most two views, three repeats and 64×64 pixels
    #[arg(long)]
    quick: bool,
}

/// Arguments of `rays`.
#[derive(Args, Debug)]
pub struct RaysArguments {
    /// A surface: a name of `zeroset gallery --list`, or one of the ten measured by default
    pub surface: String,
    /// Rays from an .npy file of float64: an origin and a direction per row, six numbers
    #[arg(long, value_name = "FILE", conflicts_with = "random")]
    pub rays: Option<PathBuf>,
    /// Number of random rays, which start around the domain and aim at points in it
    #[arg(long, default_value_t = 1000, value_parser = number(1..=10_000_000))]
    pub random: usize,
    /// Seed of the random rays
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Methods that trace the rays.
    #[command(flatten)]
    pub methods: Methods,
    /// Tolerance of a hit, as a share of the domain's diagonal
    #[arg(long, default_value_t = 1e-6, value_name = "SHARE", value_parser = tolerance)]
    pub within: f64,
    /// Directory for the files
    #[arg(short, long, value_name = "DIRECTORY")]
    pub output: PathBuf,
}

/// Arguments of `parts`.
#[derive(Args, Debug)]
pub struct PartsArguments {
    /// CSV file that `parts -o FILE` of `benches/rivals` has written
    pub rows: PathBuf,
    /// Directory for the chart
    #[arg(short, long, value_name = "DIRECTORY")]
    pub output: PathBuf,
}

/// Arguments of `stability`.
#[derive(Args, Debug)]
pub struct StabilityArguments {
    /// Names of cases; all cases of tests/data/stability if none is given
    pub cases: Vec<String>,
    /// Methods that draw the cases.
    #[command(flatten)]
    pub methods: Methods,
    /// Time limit of each picture, in seconds
    #[arg(long, default_value = "10", value_name = "SECONDS", value_parser = seconds)]
    pub budget: Duration,
    /// Directory for the table, the rows and the contact sheet
    #[arg(short, long, value_name = "DIRECTORY")]
    pub output: PathBuf,
}

/// A parser of whole numbers in this range.
fn number(range: RangeInclusive<i64>) -> RangedI64ValueParser<usize> {
    RangedI64ValueParser::new().range(range)
}

fn seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    let some = seconds.filter(|time| !time.is_zero());
    some.ok_or_else(|| "not a number of seconds above 0".to_owned())
}

fn tolerance(text: &str) -> Result<f64, String> {
    let pixels: f64 = text.parse().map_err(|_| "not a number".to_owned())?;
    let refuse = || zeroset_trace::TOLERANCES.to_owned();
    is_tolerance(pixels).then_some(pixels).ok_or_else(refuse)
}

fn precision_name(text: &str) -> Result<String, String> {
    Precision::named(text)
        .map(|_| text.to_owned())
        .ok_or_else(|| "not one of f32, f64, auto".to_owned())
}

impl RunArguments {
    /// The values to measure for each option.
    pub fn values(&self) -> Values {
        Values {
            depths: distinct(self.max_depth.iter().copied()),
            tolerances: distinct(self.tolerances.iter().copied()),
            steps: distinct(self.steps.iter().copied()),
            precisions: distinct(self.precision.iter().cloned()),
        }
    }

    /// Returns `number`, but at most `few` with `--quick`.
    fn limited(&self, number: usize, few: usize) -> usize {
        if self.quick { number.min(few) } else { number }
    }

    /// Number of views of each surface.
    pub fn views(&self) -> usize {
        self.limited(self.views, 2)
    }

    /// The conditions of measurement, one per picture size.
    pub fn conditions(&self) -> Vec<Conditions> {
        let sizes = distinct(self.sizes.iter().map(|size| self.limited(*size, 64)));
        let conditions = |size| Conditions {
            size,
            threads: self.threads,
            seed: self.seed,
            repeats: self.limited(self.repeats, 3),
            samples: self.limited(self.samples, 256),
        };
        sizes.into_iter().map(conditions).collect()
    }
}
