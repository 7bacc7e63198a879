//! The command line's arguments.

use crate::grid::{Values, precision};
use crate::groups::distinct;
use crate::row::Conditions;
use clap::builder::{PossibleValuesParser, RangedI64ValueParser};
use clap::{Args, Parser, Subcommand};
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::time::Duration;
use zeroset::picture::is_tolerance;
use zeroset_trace::{METHODS, Method, Precision};

/// Measure and chart the methods of zeroset: speed against accuracy.
///
/// Exit codes: 0; 1 if `check` finds that what was counted differs; 2 for what the user can mend.
#[derive(Debug, Parser)]
#[command(name = "zeroset-chart", version, about)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Measure times and errors of each method with each value of the options that it reads
    Run(RunArguments),
    /// Draw formulas on which methods are known to fail, and name what becomes of each
    Stability(StabilityArguments),
    /// Follow given rays, or random ones, by each method and by the certified tracer
    ///
    /// So that other programs can be held against the same rays. Writes, as .npy files of float64:
    /// `rays`, of which a row is an origin and a direction of any length; `domain`, the ends of x,
    /// y and z; for each method a file of its name, of which a row is 0 for a proven miss, 1 for a
    /// proven hit or 2 for undecided, the two distances between which the hit is proven, and the
    /// distance at which the ray is painted; and `certified`, of which a row is 0 for no root, 1
    /// for one or 2 for open, and the distances between which the first root lies. Distances are
    /// from the origin in units of the world; they are NaN where there are none.
    Rays(RaysArguments),
    /// Time kernels and pictures without rigour, widened operation by operation, and rounded up as
    /// they are
    ///
    /// In the directory: `rigour.csv`, of which a row is a surface's kernel or picture in one
    /// arithmetic, and `rigour.svg`.
    Rigour(RigourArguments),
    /// Time text to kernels against the size of formulas: those of the gallery, and sums and
    /// products that are made
    ///
    /// In the directory: `compile.csv`, of which a row is a formula, `compile-time.svg` and
    /// `compile-code.svg`.
    Compile(CompileArguments),
    /// Draw the charts of a directory's rows once more, as `run` does at its end
    Draw {
        /// What `run` has written
        directory: PathBuf,
    },
    /// Measure a directory's rows once more: counts and hashes must be the same
    Check {
        /// What `run` has written
        directory: PathBuf,
    },
}

/// Which methods.
#[derive(Args, Debug)]
pub struct Methods {
    /// Methods, with commas between; all if not given
    #[arg(long, value_delimiter = ',', value_parser = PossibleValuesParser::new(METHODS.iter().map(|m| m.name)))]
    methods: Vec<String>,
}

impl Methods {
    /// The methods of these names, in the order of the table; all if there are none.
    pub fn chosen(&self) -> Vec<&'static Method> {
        let names = &self.methods;
        let is_chosen =
            |method: &&Method| names.is_empty() || names.iter().any(|n| n == method.name);
        METHODS.iter().filter(is_chosen).collect()
    }
}

/// What to measure.
#[derive(Args, Debug)]
pub struct RunArguments {
    /// Surfaces: names of `zeroset gallery --list`, or of the ten that are measured by default
    pub surfaces: Vec<String>,
    /// Which methods.
    #[command(flatten)]
    pub methods: Methods,
    /// Depths, for methods that read one
    #[arg(long, value_delimiter = ',', default_value = "6,8,10,12", value_name = "DEPTHS",
        value_parser = clap::value_parser!(u32).range(1..=i64::from(Precision::F64.max_depth())))]
    max_depth: Vec<u32>,
    /// Tolerances in pixels, for methods that read one
    #[arg(long, value_delimiter = ',', default_value = "2,0.5,0.1,0.01", value_name = "PIXELS",
        value_parser = tolerance)]
    tolerances: Vec<f64>,
    /// Steps along a ray, for methods that read them
    #[arg(long, value_delimiter = ',', default_value = "64,256,1024", value_name = "NUMBERS",
        value_parser = clap::value_parser!(u32).range(2..))]
    steps: Vec<u32>,
    /// Precisions, for methods that read one
    #[arg(long, value_delimiter = ',', default_value = "f32,f64,auto", value_name = "NAMES",
        value_parser = precision_name)]
    precision: Vec<String>,
    /// Rows of a picture, and pixels in a row; several, with commas between, chart time against
    /// resolution
    #[arg(long, visible_alias = "size", value_delimiter = ',', default_value = "256", value_name = "PIXELS",
        value_parser = number(8..=8192))]
    sizes: Vec<usize>,
    /// Views of each surface: a standard one, then around it, close, grazing and inside
    #[arg(long, default_value_t = 8, value_parser = number(1..=1000))]
    views: usize,
    /// Draws views, pixels and the order of measurements
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// How often each picture is measured
    #[arg(long, default_value_t = 15, value_parser = number(1..=100_000))]
    repeats: usize,
    /// Threads that pictures are drawn on
    #[arg(long, default_value_t = 1, value_parser = number(1..=1024))]
    pub threads: usize,
    /// About how many pixels of a picture are held against the certified tracer; 0 for all
    #[arg(long, default_value_t = 1024, value_parser = number(0..=u32::MAX.into()))]
    samples: usize,
    /// Where results go; those that are there are kept
    #[arg(short, long, value_name = "DIRECTORY")]
    pub output: PathBuf,
    /// Little of everything, to try it: two views, three repeats, 64 pixels in a row
    #[arg(long)]
    quick: bool,
}

/// Which rays to follow.
#[derive(Args, Debug)]
pub struct RaysArguments {
    /// A surface: a name of `zeroset gallery --list`, or one of the ten that are measured by
    /// default
    pub surface: String,
    /// Rays from an .npy file: float64, a row of six numbers each, an origin and a direction
    #[arg(long, value_name = "FILE", conflicts_with = "random")]
    pub rays: Option<PathBuf>,
    /// So many random rays, from around the domain to points in it
    #[arg(long, default_value_t = 1000, value_parser = number(1..=10_000_000))]
    pub random: usize,
    /// Draws the random rays
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Which methods.
    #[command(flatten)]
    pub methods: Methods,
    /// How near a hit is to be, as a share of the domain's diagonal
    #[arg(long, default_value_t = 1e-6, value_name = "SHARE", value_parser = tolerance)]
    pub within: f64,
    /// Where the files go
    #[arg(short, long, value_name = "DIRECTORY")]
    pub output: PathBuf,
}

/// What rigour is to be priced on.
#[derive(Args, Debug)]
pub struct RigourArguments {
    /// Surfaces without parameters and poles, as for `run`; the ten if not given
    pub surfaces: Vec<String>,
    /// Rows of a picture, and pixels in a row
    #[arg(long, default_value_t = 256, value_name = "PIXELS", value_parser = number(8..=8192))]
    pub size: usize,
    /// How often each kernel and each picture is measured
    #[arg(long, default_value_t = 15, value_parser = number(1..=100_000))]
    pub repeats: usize,
    /// Draws boxes and the order of measurements
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Where rows and chart go
    #[arg(short, long, value_name = "DIRECTORY")]
    pub output: PathBuf,
}

/// What is to be compiled.
#[derive(Args, Debug)]
pub struct CompileArguments {
    /// About how many nodes the largest sum and product have
    #[arg(long, default_value_t = 3000, value_parser = number(12..=100_000))]
    pub nodes: usize,
    /// How often each formula is compiled
    #[arg(long, default_value_t = 15, value_parser = number(1..=100_000))]
    pub repeats: usize,
    /// Draws the numbers in sums and products, and the order of measurements
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Where rows and charts go
    #[arg(short, long, value_name = "DIRECTORY")]
    pub output: PathBuf,
}

/// Which difficult formulas to draw.
#[derive(Args, Debug)]
pub struct StabilityArguments {
    /// Cases by name; all of tests/data/stability if not given
    pub cases: Vec<String>,
    /// Which methods.
    #[command(flatten)]
    pub methods: Methods,
    /// How long each picture may take, in seconds
    #[arg(long, default_value = "10", value_name = "SECONDS", value_parser = seconds)]
    pub budget: Duration,
    /// Where table, rows and contact sheet go
    #[arg(short, long, value_name = "DIRECTORY")]
    pub output: PathBuf,
}

/// A whole number in this range.
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
    let refuse = || zeroset::picture::TOLERANCES.to_owned();
    is_tolerance(pixels).then_some(pixels).ok_or_else(refuse)
}

fn precision_name(text: &str) -> Result<String, String> {
    precision(text).map(|_| text.to_owned()).ok_or_else(|| "not one of f32, f64, auto".to_owned())
}

impl RunArguments {
    /// The options' values.
    pub fn values(&self) -> Values {
        Values {
            depths: distinct(self.max_depth.iter().copied()),
            tolerances: distinct(self.tolerances.iter().copied()),
            steps: distinct(self.steps.iter().copied()),
            precisions: distinct(self.precision.iter().cloned()),
        }
    }

    /// This many, or no more than `few` if little is asked for.
    fn limited(&self, number: usize, few: usize) -> usize {
        if self.quick { number.min(few) } else { number }
    }

    /// How many views each surface has.
    pub fn views(&self) -> usize {
        self.limited(self.views, 2)
    }

    /// How pictures are measured, size by size.
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
