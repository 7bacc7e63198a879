//! What may be typed after `zeroset`. Values are checked where they are used; only their shape is known here.

use super::vector::{Domain, Numbers, Size};
use clap::builder::{PossibleValue, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::ffi::OsString;
use std::path::PathBuf;
use zeroset::picture;
use zeroset_trace::{METHODS, Method};

/// Type any f(x,y,z) = 0 and see its zero set, with a proof for every pixel.
///
/// Without a command: a window, and a prompt to type in.
#[derive(Debug, Parser)]
#[command(name = "zeroset", version, max_term_width = 100)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Option<Command>,

    #[command(flatten)]
    pub interactive: Interactive,
}

/// What is shown first, where nothing but a subject is given.
#[derive(Debug, Args)]
pub struct Interactive {
    /// A formula, a file that is watched from then on, or a name from `zeroset gallery --list`
    #[arg(value_name = "FORMULA|FILE|NAME", allow_hyphen_values = true)]
    pub source: Option<OsString>,

    /// Give a name of the formula a value; may be repeated
    #[arg(short = 'D', long = "define", value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub define: Vec<String>,

    /// The time t
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    pub time: Option<String>,

    /// Where to look: auto, a number r for the cube from -r to r, or six bounds
    #[arg(long, value_name = "auto|R|X0,X1,Y0,Y1,Z0,Z1", allow_hyphen_values = true)]
    pub domain: Option<Domain>,

    #[command(flatten)]
    pub camera: Camera,

    /// How often a ray's way through the domain is halved
    #[arg(long, value_name = "N", default_value_t = 10)]
    pub max_depth: u32,

    /// The floats that kernels compute in; enclosures are rigorous in either
    #[arg(long, value_enum, default_value_t = Precision::F32)]
    pub precision: Precision,

    /// The window's width and height in pixels
    #[arg(long, value_name = "N|WxH", default_value = "800x640", allow_hyphen_values = true)]
    pub size: Size,

    /// Size of the window's letters: 1, 2 or 3 [default: by the window's height]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=3))]
    pub ui_scale: Option<u8>,

    /// Show pictures in the terminal and open no window
    #[arg(long)]
    pub preview: bool,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a formula, a file, or a surface of the gallery to a picture.
    Render(Box<Render>),
    /// Evaluate formulas at points or over boxes: one JSON object a line in, one out.
    #[command(after_long_help = EVAL_FORMAT)]
    Eval(Eval),
    /// Show how a formula is read, simplified and compiled.
    Explain(Explain),
    /// Render every surface of the gallery, and a contact sheet.
    Gallery(Gallery),
    /// Print a completion script for a shell.
    Completions {
        /// The shell to complete in.
        shell: clap_complete::Shell,
    },
}

/// What is drawn, and the values it is drawn for.
#[derive(Debug, Args)]
pub struct Subject {
    /// A formula such as 'x^2+y^2+z^2=1', a file of them, a name from `zeroset gallery --list`, or - for standard input
    #[arg(value_name = "FORMULA|FILE|NAME|-", allow_hyphen_values = true)]
    pub source: OsString,

    /// Give a name of the formula a value; may be repeated
    #[arg(short = 'D', long = "define", value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub define: Vec<String>,

    /// The time t
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    pub time: Option<String>,

    /// Where to look: auto, a number r for the cube from -r to r, or six bounds
    #[arg(long, value_name = "auto|R|X0,X1,Y0,Y1,Z0,Z1", allow_hyphen_values = true)]
    pub domain: Option<Domain>,
}

#[derive(Debug, Args)]
pub struct Render {
    #[command(flatten)]
    pub subject: Subject,

    #[command(flatten)]
    pub outputs: Outputs,

    #[command(flatten)]
    pub camera: Camera,

    #[command(flatten)]
    pub tracing: Tracing,

    #[command(flatten)]
    pub look: Look,

    /// Exit with code 1 if any pixel is undecided
    #[arg(long)]
    pub strict: bool,
}

/// What is written, and where.
#[derive(Debug, Args)]
pub struct Outputs {
    /// The picture, as PNG; - for standard output
    #[arg(short, long, value_name = "FILE.png")]
    pub output: Option<PathBuf>,

    /// Width and height in pixels, or one number for a square
    #[arg(long, value_name = "N|WxH", default_value = "512", allow_hyphen_values = true)]
    pub size: Size,

    /// Distance from the eye as a float32 array (float64 with --precision f64), inf where there is nothing
    #[arg(long, value_name = "FILE.npy")]
    pub distance: Option<PathBuf>,

    /// What is proven of each pixel as a uint8 array: 0 miss, 1 hit, 2 undecided
    #[arg(long, value_name = "FILE.npy")]
    pub status: Option<PathBuf>,

    /// Unit normals towards f > 0 as a float32 array, 0 where there is nothing
    #[arg(long, value_name = "FILE.npy")]
    pub normal: Option<PathBuf>,

    /// Print times, counts, camera and domain as one JSON object
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub struct Camera {
    /// Look from this side
    #[arg(long, value_parser = ["iso", "front", "back", "left", "right", "top", "bottom"], conflicts_with_all = ["eye", "up"])]
    pub view: Option<String>,

    /// The eye's place; it may lie inside the domain
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub eye: Option<Numbers<3>>,

    /// The point to look at; the middle of the domain if not given
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub target: Option<Numbers<3>>,

    /// The direction shown upright
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub up: Option<Numbers<3>>,

    /// The vertical field of view, in degrees [default: 40]
    #[arg(long, value_name = "DEGREES", allow_hyphen_values = true)]
    pub fov: Option<f64>,

    /// Parallel rays, in a picture this high in world units
    #[arg(long, value_name = "HEIGHT", conflicts_with = "fov", allow_hyphen_values = true)]
    pub ortho: Option<f64>,

    /// Cut away what lies beyond a plane: keep a*x + b*y + c*z <= d
    #[arg(long, value_name = "A,B,C,D", allow_hyphen_values = true)]
    pub clip: Option<Numbers<4>>,
}

#[derive(Debug, Args)]
pub struct Tracing {
    /// How rays are traced
    #[arg(long, value_parser = methods(), default_value = METHODS[0].name)]
    pub method: &'static Method,

    /// The floats to compute in
    #[arg(long, value_enum, default_value_t = Precision::F32)]
    pub precision: Precision,

    /// How often a ray's way through the domain is halved: at most 20, or 40 in f64; beyond 14, rays
    /// that stay undecided are given up after 16384 steps
    #[arg(long, visible_aliases = ["depth", "dstop"], value_name = "N", default_value_t = 10)]
    pub max_depth: u32,

    /// Trace a ray to the light from every point seen
    #[arg(long)]
    pub shadows: bool,

    /// How often a shadow ray's way is halved [default: one less than --max-depth]
    #[arg(long, value_name = "N", requires = "shadows")]
    pub shadow_depth: Option<u32>,

    /// Where normals come from
    #[arg(long, value_enum, default_value_t = Normals::Gradient)]
    pub normals: Normals,

    /// Threads to use [default: one per processor]
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
}

#[derive(Debug, Args)]
pub struct Look {
    /// How undecided pixels are drawn; knoll proves no hit, and shades them by default
    #[arg(long, value_enum)]
    pub undecided: Option<Undecided>,

    /// The light's place [default: far above and left of the camera]
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub light: Option<Numbers<3>>,

    /// Share of the light that comes from everywhere, from 0 to 1
    #[arg(long, value_name = "SHARE", default_value_t = 0.3, allow_hyphen_values = true)]
    pub ambient: f32,

    /// Colour where nothing is seen, as six hexadecimal digits or by a CSS name [default: f4f4f6]
    #[arg(long, value_name = "RRGGBB|NAME")]
    pub background: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Normals {
    /// From the exact derivative
    Gradient,
    /// From differences of values, as in the paper
    Central,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Precision {
    /// 32 bits, outward
    F32,
    /// 64 bits, outward: at most half as fast
    F64,
}

impl From<Precision> for picture::Precision {
    fn from(precision: Precision) -> Self {
        match precision {
            Precision::F32 => Self::F32,
            Precision::F64 => Self::F64,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Undecided {
    /// As hits
    Shade,
    /// As hits with stripes
    Hatch,
    /// As hits with a colour mixed in
    Tint,
    /// Not at all
    Miss,
}

/// Shown below the options of `eval --help`.
const EVAL_FORMAT: &str = r#"One line in, one line out; both are JSON objects.

At a point:
  {"f": "sin(x)*y", "at": [1, 2, 0]}
  {"grad": [1.08, 0.84, 0.0], "precision": "f32", "value": 1.68}

Over a box, a lower and an upper end for each of x, y and z:
  {"f": "sin(x)*y", "box": [[0, 1], [1, "0x1p1"], [0, "inf"]], "precision": "f64"}
  {"lo": 0.0, "hi": 1.68, "defined": true, "continuous": true, "empty": false, "precision": "f64"}

All values lie between lo and hi; "empty" says that there are none, "defined" that there is one everywhere in the
box, "continuous" that f is continuous too. Numbers may be texts: hexadecimal floats, "inf" and "-inf". "f" may hold
several lines, as a file does. A line that cannot be answered gives {"error": "..."}."#;

#[derive(Debug, Args)]
pub struct Eval {
    /// A file of JSON lines, or - for standard input
    #[arg(value_name = "FILE|-", default_value = "-")]
    pub source: PathBuf,

    /// The floats to compute in, where a line does not say
    #[arg(long, value_enum, default_value_t = Precision::F32)]
    pub precision: Precision,

    /// Use the reference evaluator in place of compiled code
    #[arg(long)]
    pub reference: bool,
}

#[derive(Debug, Args)]
pub struct Explain {
    #[command(flatten)]
    pub subject: Subject,

    /// The floats of the code that is shown
    #[arg(long, value_enum, default_value_t = Precision::F32)]
    pub precision: Precision,

    /// Show the intermediate code of the interval kernels too
    #[arg(long)]
    pub code: bool,
}

#[derive(Debug, Args)]
pub struct Gallery {
    /// The directory to write pictures and contact-sheet.png to; made if missing
    #[arg(short, long, value_name = "DIR", required_unless_present = "list")]
    pub output: Option<PathBuf>,

    /// List the names and what they are, and render nothing
    #[arg(long)]
    pub list: bool,

    /// Width and height of each picture in pixels, or one number for a square
    #[arg(long, value_name = "N|WxH", default_value = "512", allow_hyphen_values = true)]
    pub size: Size,

    #[command(flatten)]
    pub tracing: Tracing,
}

/// The rows of the table of methods, as values of an argument.
fn methods() -> impl clap::builder::TypedValueParser<Value = &'static Method> {
    let values = METHODS.iter().map(|row| PossibleValue::new(row.name).help(row.help));
    clap::builder::PossibleValuesParser::new(values)
        .map(|name| Method::named(&name).expect("one of the possible values"))
}
