//! The command-line arguments. Most values are checked where they are used, not here.

use super::array::Arrays;
use super::vector::{Size, point};
use anyhow::{Context, Result, anyhow};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Arg, ArgAction, ArgMatches, Args, FromArgMatches, Parser, Subcommand};
use glam::DVec3;
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::LazyLock;
use zeroset_export::{UNITS, Unit};
use zeroset_jit::vector_widths;
use zeroset_render::names::Named;
use zeroset_render::overlay::Overlay;
use zeroset_render::picture::{Normals, Precision};
use zeroset_scene::camera::CameraChoice;
use zeroset_scene::number;
use zeroset_scene::view::{ClipChoice, ClipShape, Clipping, DomainChoice};
use zeroset_shade::UndecidedStyle;
use zeroset_space::Projection;
use zeroset_style::{
    ANTIALIAS, BITS, CHOICES, Choices, LOOKS, Look, Setting, StandardView, VIEWS, Values,
};
use zeroset_syntax::{Document, Format};
use zeroset_trace::{METHODS, Method, MethodOption, OPTIONS, TraceOptions};

/// Texts shown below the options of each command's help.
mod examples {
    pub const PROGRAM: &str = "\
Examples:
  zeroset                                the window, with the gyroid
  zeroset 'x^2+y^2+z^2 = 1'              the window, with this surface
  zeroset --preview barth-sextic         no window: pictures in the terminal
  zeroset render gyroid -o gyroid.png    a picture
  zeroset eval 'x^2+y' --at points.npy   values at points
  zeroset gallery --list                 names of surfaces
The help of a command has more: zeroset render --help";

    pub const RENDER: &str = "\
Examples:
  zeroset render 'x^2+y^2+z^2 = 1' -o sphere.png
  zeroset render gyroid -o gyroid.png --size 1024 --axes --look paper
  zeroset render 'z = sin(x) cos(y)' -o graph.png --domain 4 --view front
  zeroset render 'x^2+y^2+z^2 = r^2' -D r=2 -o frame-%02d.png --frames 20 --turntable
  zeroset render model.glsl -o model.png --eye 3,-4,2 --target 0,0,1

--help-all also lists arrays of what is proven, and options of methods, light and sequences.";

    pub const RENDER_ALL: &str = "\
Examples:
  zeroset render gyroid -o gyroid.png --depth depth.npy --status status.npy
  zeroset render cayley-cubic -o cayley.png --strict --json
  zeroset render 'z = sin(x+t)' -o wave.gif --frames 60 --time 0..2pi
  zeroset render gyroid -o frame-%04d.png --frames 900 --turntable --resume";

    pub const EXPLAIN: &str = "\
Examples:
  zeroset explain '2x^2 + y^2 = sin z'
  zeroset explain gyroid --code
  zeroset explain barth-sextic --emit glsl";

    pub const MESH: &str = "\
Examples:
  zeroset mesh 'x^2+y^2+z^2 = 1' -o sphere.stl
  zeroset mesh rook -o rook.3mf --tolerance 0.05 --unit millimeter
  zeroset mesh gyroid -o gyroid.glb --estimate";

    pub const MEASURE: &str = "\
Examples:
  zeroset measure 'x^2+y^2+z^2 <= 1'
  zeroset measure rook --volume --relative 1e-2 --json";

    pub const GALLERY: &str = "\
Examples:
  zeroset gallery --list
  zeroset gallery -o pictures --size 256";

    pub const COMPLETIONS: &str = "\
Example:
  zeroset completions bash > ~/.local/share/bash-completion/completions/zeroset";
}

/// Headings of options that are needed less often than the options without a heading.
const CAMERA: &str = "Camera";
const LIGHT: &str = "Light and color";
const SEQUENCES: &str = "Sequences";
const METHOD_OPTIONS: &str = "Methods";

/// The version, the commit if this is a release, the system, and the bits of a kernel's vectors on
/// this processor.
fn version() -> &'static str {
    static VERSION: LazyLock<String> = LazyLock::new(|| {
        let commit = option_env!("ZEROSET_COMMIT").map_or(String::new(), |it| format!("{it}, "));
        let bits = 8 * vector_widths().next().unwrap_or(0);
        let (version, os) = (env!("CARGO_PKG_VERSION"), std::env::consts::OS);
        format!("{version} ({commit}{}-{os}, vectors of {bits} bits)", std::env::consts::ARCH)
    });
    &VERSION
}

/// Type any f(x,y,z) = 0 and see its zero set, with a proof for every pixel.
///
/// Without a command, zeroset opens a window and a prompt.
#[derive(Debug, Parser)]
#[command(name = "zeroset", version = version(), max_term_width = 100)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
#[command(disable_help_flag = true, after_help = examples::PROGRAM)]
pub struct Arguments {
    #[command(subcommand)]
    pub command: Option<Command>,

    #[command(flatten)]
    pub interactive: InteractiveArgs,

    /// Print the most used options
    #[arg(short, long, global = true, action = ArgAction::HelpShort, display_order = 1000)]
    help: Option<bool>,

    /// Print all options
    #[arg(long, global = true, action = ArgAction::HelpLong, display_order = 1001)]
    help_all: Option<bool>,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a formula, a file, or a gallery surface to a picture.
    #[command(after_help = examples::RENDER, after_long_help = examples::RENDER_ALL)]
    Render(Box<RenderArgs>),
    /// Evaluate formulas at points or over boxes: JSON lines or an array in, and out.
    #[command(after_help = EVAL_FORMAT)]
    Eval(EvalArgs),
    /// Show how a formula is read, simplified and compiled.
    #[command(after_help = examples::EXPLAIN)]
    Explain(ExplainArgs),
    /// Write a formula's surface as triangles, with a proof of its shape.
    #[command(after_help = examples::MESH)]
    Mesh(MeshArgs),
    /// Measure a solid's volume, centroid and inertia, and a surface's extent, area and shape.
    #[command(after_help = examples::MEASURE)]
    Measure(MeasureArgs),
    /// Render every gallery surface, and a contact sheet.
    #[command(after_help = examples::GALLERY)]
    Gallery(GalleryArgs),
    /// Print a completion script for a shell.
    #[command(after_help = examples::COMPLETIONS)]
    Completions {
        /// Print the script for this shell
        shell: clap_complete::Shell,
    },
}

/// Size of a window, and of a picture in it, unless another one is chosen.
pub const USUAL_SIZE: Size = Size { width: 800, height: 640 };

fn ui_scale(text: &str) -> Result<f64, String> {
    let scale = text.parse().ok().filter(|scale| (0.5..=6.0).contains(scale));
    scale.ok_or_else(|| "it must be a number from 0.5 to 6".to_owned())
}

/// Arguments of `zeroset` without a subcommand.
#[derive(Debug, Args)]
pub struct InteractiveArgs {
    /// Show a formula, a file (watched for changes), or a name from `zeroset gallery --list`
    #[arg(value_name = "FORMULA|FILE|NAME", allow_hyphen_values = true)]
    pub source: Option<OsString>,

    /// Show the last document that was not saved
    #[arg(long, conflicts_with = "source")]
    pub last: bool,

    #[command(flatten)]
    pub values: ValueArgs,

    #[command(flatten)]
    pub camera: CameraArgs,

    #[command(flatten)]
    pub kernels: KernelArgs,

    /// Set the window's width and height in pixels [default: 800x640, times the display's scale]
    #[arg(long, value_name = "N|WxH", allow_hyphen_values = true)]
    pub size: Option<Size>,

    /// Set the size of the window's letters, from 0.5 to 6 [default: the display's scale]
    #[arg(long, value_name = "SCALE", value_parser = ui_scale)]
    pub ui_scale: Option<f64>,

    /// Show pictures in the terminal and open no window
    #[arg(long)]
    pub preview: bool,
}

/// A document, with the values of its parameters, its time and its domain.
#[derive(Debug, Args)]
pub struct DocumentArgs {
    /// Read a formula such as 'x^2+y^2+z^2=1', a file, a name from `zeroset gallery --list`, or
    /// standard input for -
    #[arg(value_name = "FORMULA|FILE|NAME|-", allow_hyphen_values = true)]
    pub source: OsString,

    #[command(flatten)]
    pub values: ValueArgs,
}

/// Parameters, time and domain, as given on the command line.
#[derive(Debug, Args)]
pub struct ValueArgs {
    /// Set a parameter of the formula (may be repeated)
    #[arg(
        display_order = 6,
        short = 'D',
        long = "define",
        value_name = "NAME=VALUE",
        allow_hyphen_values = true
    )]
    define: Vec<String>,

    /// Set the time t, or with --frames its start and end
    #[arg(display_order = 8, long, value_name = "T|A..B", allow_hyphen_values = true)]
    pub time: Option<String>,

    /// Set the domain: auto, a number R for the cube from -R to R, or six bounds
    #[arg(
        display_order = 7,
        long,
        value_name = "auto|R|X0,X1,Y0,Y1,Z0,Z1",
        allow_hyphen_values = true
    )]
    domain: Option<DomainChoice>,
}

impl ValueArgs {
    /// Returns the name and the value of each `-D`.
    ///
    /// # Errors
    /// If one is not of the form `name=value`.
    pub fn overrides(&self) -> Result<Vec<(String, String)>> {
        overrides(&self.define)
    }

    /// Returns the value of `--time`, if it was given.
    ///
    /// # Errors
    /// If it is not a finite number.
    pub fn time(&self) -> Result<Option<f64>> {
        time(self.time.as_deref())
    }

    pub fn domain(&self) -> DomainChoice {
        self.domain.unwrap_or_default()
    }
}

/// Returns the name and the value of each `-D`.
fn overrides(defined: &[String]) -> Result<Vec<(String, String)>> {
    let split = |define: &String| {
        let (name, value) = define
            .split_once('=')
            .with_context(|| format!("-D '{define}' is not of the form name=value"))?;
        Ok((name.trim().to_owned(), value.trim().to_owned()))
    };
    defined.iter().map(split).collect()
}

/// Returns the value of `--time`, if it was given.
fn time(text: Option<&str>) -> Result<Option<f64>> {
    let number = |text| {
        number::number(text).with_context(|| format!("--time '{text}' is not a finite number"))
    };
    text.map(number).transpose()
}

#[derive(Debug, Args)]
pub struct RenderArgs {
    #[command(flatten)]
    pub document: DocumentArgs,

    #[command(flatten)]
    pub outputs: OutputArgs,

    #[command(flatten)]
    pub camera: CameraArgs,

    /// Choose the shape that the domain is clipped to
    #[arg(help_heading = CAMERA, long, value_name = "auto|ball|box", value_parser = one_of::<ClipShape>(), default_value = "auto", hide_short_help = true)]
    pub clip_to: ClipShape,

    #[command(flatten)]
    pub shading: ShadingArgs,

    /// Stop searching for surfaces after this time; unreached pixels are undecided and not drawn
    ///
    /// Time counts from the start of the command, or of each frame. Choosing the domain and
    /// choosing the camera take at most a quarter of the remaining time each. Colors that are not
    /// computed by then are missing. Kernels that only some rays need are waited for; so are the
    /// kernels and the domain of a sequence.
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    pub budget: Option<f64>,

    /// Exit with code 1 if any pixel is undecided
    #[arg(long)]
    pub strict: bool,

    #[command(flatten)]
    pub sequence: SequenceArgs,

    #[command(flatten)]
    pub tracing: TracingArgs,
}

impl RenderArgs {
    /// Returns the clip plane and the shape that the domain is clipped to.
    pub fn cut(&self) -> Clipping {
        Clipping { plane: self.camera.clip(), to: self.clip_to }
    }

    /// Returns the overlay of pictures of this document.
    pub fn overlay(&self, document: &Document) -> Overlay {
        let around = Overlay::asked(self.tracing.choices.0, document);
        around.titled(self.shading.title.as_deref())
    }
}

/// Outputs, and the size of the picture.
#[derive(Debug, Args)]
pub struct OutputArgs {
    /// Write the picture as PNG to this file, or to standard output for -
    #[arg(short, long, value_name = "FILE.png", display_order = 1)]
    pub output: Option<PathBuf>,

    /// Set the picture's width and height in pixels, or one number for a square
    #[arg(
        display_order = 5,
        long,
        value_name = "N|WxH",
        default_value = "512",
        allow_hyphen_values = true
    )]
    pub size: Size,

    #[command(flatten)]
    pub arrays: Arrays,

    /// Print times, counts, camera and domain as a JSON object
    #[arg(long)]
    pub json: bool,
}

#[derive(Debug, Args)]
pub struct CameraArgs {
    /// Look from this side
    #[arg(display_order = 4, long, value_parser = side(), conflicts_with_all = ["eye", "up"])]
    view: Option<&'static StandardView>,

    /// Set the position of the eye, which may be inside the domain
    #[arg(help_heading = CAMERA, long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    eye: Option<DVec3>,

    /// Set the point to look at [default: the center of the domain]
    #[arg(help_heading = CAMERA, long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    target: Option<DVec3>,

    /// Set the direction that points up in the picture
    #[arg(help_heading = CAMERA, long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true, hide_short_help = true)]
    up: Option<DVec3>,

    /// Set the vertical field of view, in degrees [default: 40]
    #[arg(help_heading = CAMERA, long, value_name = "DEGREES", allow_hyphen_values = true)]
    fov: Option<f64>,

    /// Use parallel projection, with a picture this high in world units
    #[arg(
        help_heading = CAMERA,
        long,
        value_name = "HEIGHT",
        conflicts_with = "fov",
        allow_hyphen_values = true,
        hide_short_help = true
    )]
    ortho: Option<f64>,

    /// Keep only a*x + b*y + c*z <= d; `off` removes a clip plane that the file sets
    #[arg(help_heading = CAMERA, long, value_name = "A,B,C,D", allow_hyphen_values = true)]
    clip: Option<ClipChoice>,
}

impl CameraArgs {
    pub fn choice(&self) -> CameraChoice {
        let parallel = self.ortho.map(|height| Projection::Orthographic { height });
        CameraChoice {
            view: self.view,
            eye: self.eye,
            target: self.target,
            up: self.up,
            projection: parallel.or(self.fov.map(|fov| Projection::Perspective { fov })),
            ..CameraChoice::default()
        }
    }

    pub fn clip(&self) -> ClipChoice {
        self.clip.unwrap_or_default()
    }
}

/// The tracing method, and its options as they were typed.
#[derive(Clone, Debug)]
pub struct KernelArgs {
    pub method: &'static Method,
    given: Vec<(&'static MethodOption, String)>,
}

impl KernelArgs {
    /// Returns the method's options, with defaults for those that were not typed.
    ///
    /// # Errors
    /// If a value is invalid.
    pub fn options(&self) -> Result<TraceOptions> {
        let mut options = TraceOptions::default();
        for (option, text) in &self.given {
            (option.set)(&mut options, text)
                .map_err(|why| anyhow!("--{} {text}: {why}", option.name))?;
        }
        Ok(options)
    }
}

/// The flags are `--method`, and one for each row of [`OPTIONS`].
impl Args for KernelArgs {
    fn augment_args(command: clap::Command) -> clap::Command {
        let method = Arg::new("method").long("method").value_name("METHOD").value_parser(methods());
        let method = method.default_value(METHODS[0].name).help("How rays are traced");
        let method = method.help_heading(METHOD_OPTIONS);
        OPTIONS.iter().fold(command.arg(method), |command, option| command.arg(flag(option)))
    }

    fn augment_args_for_update(command: clap::Command) -> clap::Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for KernelArgs {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let text = |option: &'static MethodOption| {
            let text = if option.is_switch() {
                matches.get_flag(option.name).then(|| "on".to_owned())
            } else {
                matches.get_one::<String>(option.name).cloned()
            };
            text.map(|text| (option, text))
        };
        let method = matches.get_one::<&Method>("method").copied().unwrap_or_default();
        Ok(Self { method, given: OPTIONS.iter().filter_map(text).collect() })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// Returns the flag that sets a method option.
fn flag(option: &'static MethodOption) -> Arg {
    let arg = Arg::new(option.name).long(option.name).help(option.help);
    let arg = arg.help_heading(METHOD_OPTIONS);
    if option.is_switch() {
        return arg.action(ArgAction::SetTrue).hide_short_help(true);
    }
    let default = (option.get)(&TraceOptions::default());
    let arg = arg.value_name(option.value).visible_aliases(option.aliases.iter().copied());
    let values = (option.values)();
    let arg = if values.is_empty() {
        arg
    } else {
        let values = values.into_iter().map(|(name, help)| PossibleValue::new(name).help(help));
        arg.value_parser(PossibleValuesParser::new(values))
    };
    arg.allow_negative_numbers(true)
        .help(format!("{} [default: {default}]", option.help))
        .hide_short_help(!option.is_common)
}

/// The choices for a whole picture. The flags are those of [`CHOICES`].
#[derive(Clone, Copy, Debug)]
pub struct ChoiceArgs(pub Choices);

impl Args for ChoiceArgs {
    fn augment_args(command: clap::Command) -> clap::Command {
        let flag = |row: &'static Setting| {
            let arg = Arg::new(row.word).long(row.flag).help(row.flag_help()).help_heading(LIGHT);
            if row.values == Values::Switch {
                return arg.action(ArgAction::SetTrue);
            }
            let arg = arg.value_name(row.values.notation()).allow_hyphen_values(true);
            arg.value_parser(|text: &str| row.values.read(text, number::number))
        };
        let command = command.args(CHOICES.iter().map(flag));
        let command = command.mut_arg("axes", |arg| arg.help_heading(None).display_order(3));
        command.mut_arg("ambient", |arg| arg.hide_short_help(true))
    }

    fn augment_args_for_update(command: clap::Command) -> clap::Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for ChoiceArgs {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut choices = Choices::default();
        for row in CHOICES {
            let value = match row.values {
                Values::Switch => matches.get_flag(row.word).then_some(1.0),
                _ => matches.get_one(row.word).copied(),
            };
            if let Some(value) = value {
                (row.set)(&mut choices, value);
            }
        }
        Ok(Self(choices))
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

#[derive(Debug, Args)]
pub struct TracingArgs {
    #[command(flatten)]
    pub kernels: KernelArgs,

    #[command(flatten)]
    pub choices: ChoiceArgs,

    /// Halve a shadow ray's path this many times [default: one less than --max-depth]
    #[arg(help_heading = LIGHT, long, value_name = "N", requires = "shadows", hide_short_help = true)]
    pub shadow_depth: Option<u32>,

    /// Choose how normals are computed
    #[arg(help_heading = LIGHT, long, value_parser = one_of::<Normals>(), default_value = "gradient", hide_short_help = true)]
    pub normals: Normals,

    /// Use this many threads [default: one per processor]
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
}

/// Arguments of a sequence of pictures.
#[derive(Debug, Args)]
pub struct SequenceArgs {
    /// Render N frames: -o frame-%04d.png writes a file for each, any other PNG or GIF file holds
    /// all, and - writes them to standard output, three bytes per pixel
    #[arg(help_heading = SEQUENCES, long, value_name = "N")]
    pub frames: Option<usize>,

    /// Move a parameter from A to B (may be repeated)
    #[arg(help_heading = SEQUENCES, long, value_name = "NAME=A..B", allow_hyphen_values = true)]
    pub sweep: Vec<String>,

    /// Turn the eye around its target by this many degrees
    #[arg(help_heading = SEQUENCES, long, value_name = "DEGREES", num_args = 0..=1, default_missing_value = "360")]
    #[arg(require_equals = true)]
    pub turntable: Option<f64>,

    /// Stop one step before the end, which shows the same as the start, so that an animation
    /// repeats smoothly (implied by a full turn without other motion)
    #[arg(help_heading = SEQUENCES, long = "loop", hide_short_help = true)]
    pub is_loop: bool,

    /// Show this many frames per second of an animation
    #[arg(help_heading = SEQUENCES, long, value_name = "N", default_value_t = 30, hide_short_help = true)]
    pub fps: u16,

    /// Split the work into N equal parts and render only part I: 1/8 to 8/8
    #[arg(help_heading = SEQUENCES, long, value_name = "I/N", hide_short_help = true)]
    pub shard: Option<String>,

    /// Keep frames that this command has already rendered from the same text
    #[arg(help_heading = SEQUENCES, long, hide_short_help = true)]
    pub resume: bool,
}

#[derive(Debug, Args)]
pub struct ShadingArgs {
    /// Choose how undecided pixels are drawn
    #[arg(help_heading = LIGHT, long, value_parser = one_of::<UndecidedStyle>(), default_value = "shade", hide_short_help = true)]
    pub undecided: UndecidedStyle,

    /// Choose lighting and background [default: the document's, else studio]
    #[arg(display_order = 2, long, value_parser = looks())]
    pub look: Option<&'static Look>,

    /// Write a title at the top of the picture; an empty one for none [default: the document's]
    #[arg(help_heading = LIGHT, long, value_name = "TEXT")]
    pub title: Option<String>,

    #[arg(help = ANTIALIAS.flag_help(), help_heading = LIGHT, long, value_name = "N", value_parser = count(&ANTIALIAS))]
    pub aa: Option<usize>,

    #[arg(help = BITS.flag_help(), help_heading = LIGHT, long, value_name = "N", value_parser = count(&BITS), hide_short_help = true)]
    pub bits: Option<usize>,

    /// Set the position of the light [default: far above and to the left of the camera]
    #[arg(help_heading = LIGHT, long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true, hide_short_help = true)]
    pub light: Option<DVec3>,

    /// Set the background to a CSS color such as white, to hexadecimal digits, or to transparent
    /// [default: the document's, else the look's]
    #[arg(help_heading = LIGHT, long, value_name = "RRGGBB|NAME")]
    pub background: Option<String>,
}

/// Returns a parser that accepts the names of `T`.
fn one_of<T: Named>() -> impl TypedValueParser<Value = T> {
    let names = T::NAMES.iter().map(|(_, name, help)| PossibleValue::new(*name).help(*help));
    PossibleValuesParser::new(names).try_map(|name| T::named(&name).ok_or("no such value"))
}

/// Returns a parser that accepts the precisions a kernel can have: all but `auto`.
fn floats() -> impl TypedValueParser<Value = Precision> {
    let one = Precision::NAMES.iter().filter(|(precision, ..)| *precision != Precision::Auto);
    let names = one.map(|(_, name, help)| PossibleValue::new(*name).help(*help));
    PossibleValuesParser::new(names).try_map(|name| Precision::named(&name).ok_or("no such value"))
}

/// Returns a parser that accepts the names of formats in which formulas are written.
fn format() -> impl TypedValueParser<Value = Format> {
    let names = PossibleValuesParser::new(Format::ALL.map(Format::name));
    names.try_map(|name| {
        Format::ALL.into_iter().find(|format| format.name() == name).ok_or("no such format")
    })
}

/// Returns a parser that accepts the names of standard views.
fn side() -> impl TypedValueParser<Value = &'static StandardView> {
    let names = PossibleValuesParser::new(VIEWS.map(|view| view.name));
    names.try_map(|name| StandardView::named(&name).ok_or("no such view"))
}

/// Description of the JSON lines, shown below the options by `eval --help`.
const EVAL_FORMAT: &str = r#"Without --at: one line in, one line out; both are JSON objects.

At a point:
  {"f": "sin(x)*y", "at": [1, 2, 0]}
  {"defined": true, "empty": false, "grad": [1.08, 0.84, 0.0], "precision": "f32", "value": 1.68}

Over a box, a lower and an upper end for each of x, y and z:
  {"f": "sin(x)*y", "box": [[0, 1], [1, "0x1p1"], [0, "inf"]], "precision": "f64"}
  {"lo": 0.0, "hi": 1.68, "defined": true, "continuous": true, "empty": false, "precision": "f64"}

All values lie between lo and hi. "empty" is true where f is proven to have no value,
"defined" where it is proven to have one at the point or everywhere in the box, "continuous"
where it is proven to be continuous too. At a point where f is proven to have no value,
"value" and "grad" are "nan"; where nothing is proven they are what the arithmetic of floats
yields. Numbers may be texts: hexadecimal floats, "inf" and "-inf". "f" may hold several
lines, as a file does, or be a name from `zeroset gallery --list`. If the argument is a formula,
lines on standard input may leave "f" out. "surface": 2 chooses the second of several formulas.
A line that cannot be answered gives {"error": "..."}; then the exit code is 2.

With --at, points come from an array of NumPy of shape (N, 3), in float32 or float64:
  zeroset eval 'x^2+y^2-z' --at points.npy -o values.npy --precision f64
Values have the type of --precision: float32, or float64 for f64. They are NaN where f is proven
to have no value, and where a coordinate is not finite. Without -o and --gradient, one JSON
object per point is printed."#;

#[derive(Debug, Args)]
pub struct EvalArgs {
    /// Read a formula, or a file or name as `render` does; or JSON lines from a file, or from
    /// standard input for - or nothing
    #[arg(value_name = "FORMULA|FILE|NAME|-", allow_hyphen_values = true)]
    pub source: Option<OsString>,

    /// Evaluate the formula at the points of this array, or of standard input for -
    #[arg(long, value_name = "FILE.npy")]
    pub at: Option<PathBuf>,

    /// Write the values at the points of --at to this file
    #[arg(short, long, value_name = "FILE.npy", requires = "at")]
    pub output: Option<PathBuf>,

    /// Write the gradients at the points of --at to this file
    #[arg(long, value_name = "FILE.npy", requires = "at")]
    pub gradient: Option<PathBuf>,

    /// Set a parameter of the formula (may be repeated)
    #[arg(short = 'D', long = "define", value_name = "NAME=VALUE", allow_hyphen_values = true)]
    define: Vec<String>,

    /// Set the time t
    #[arg(long, value_name = "T", allow_hyphen_values = true)]
    time: Option<String>,

    /// Set the precision of values, and of lines that do not name one
    #[arg(long, value_parser = floats(), default_value = "f32")]
    pub precision: Precision,

    /// Use the reference evaluator instead of compiled code
    #[arg(long)]
    pub reference: bool,
}

impl EvalArgs {
    /// As [`ValueArgs::overrides`].
    ///
    /// # Errors
    /// If one is not of the form `name=value`.
    pub fn overrides(&self) -> Result<Vec<(String, String)>> {
        overrides(&self.define)
    }

    /// As [`ValueArgs::time`].
    ///
    /// # Errors
    /// If it is not a finite number.
    pub fn time(&self) -> Result<Option<f64>> {
        time(self.time.as_deref())
    }
}

#[derive(Debug, Args)]
pub struct ExplainArgs {
    #[command(flatten)]
    pub document: DocumentArgs,

    /// Show kernels of this precision
    #[arg(long, value_parser = floats(), default_value = "f32")]
    pub precision: Precision,

    /// Also show the intermediate code of the kernels that find zeros
    #[arg(long)]
    pub code: bool,

    /// Write the formula in this format instead: `vm` is the format of fidget
    #[arg(long, value_name = "vm|glsl|tex|zset", value_parser = format(), conflicts_with = "code")]
    pub emit: Option<Format>,
}

#[derive(Debug, Args)]
pub struct MeshArgs {
    #[command(flatten)]
    pub document: DocumentArgs,

    /// Write the triangles to this file, in the format that its extension names
    #[arg(short, long, value_name = "FILE.stl|obj|ply|3mf|glb")]
    pub output: Option<PathBuf>,

    /// Set the largest distance between triangles and surface [default: a thousandth of the
    /// domain's diagonal]
    #[arg(long, value_name = "DISTANCE", allow_hyphen_values = true)]
    pub tolerance: Option<f64>,

    /// Estimate bounds from samples: often several times as fast, and nothing is proven
    #[arg(long)]
    pub estimate: bool,

    /// Keep as few triangles as the tolerance allows, or all of the first mesh
    #[arg(long, value_parser = ["least", "full"], default_value = "least")]
    pub detail: String,

    /// Set the unit of coordinates, in 3MF and GLB [default: millimeter in 3MF, meter in GLB]
    #[arg(long, value_parser = units())]
    pub unit: Option<&'static Unit>,

    /// Write center and size of cells in which the shape is not proven, as a float64 array of six
    /// values per cell
    #[arg(long, value_name = "FILE.npy")]
    pub cells_unproven: Option<PathBuf>,

    /// Write all that the mesh claims to prove, for programs that check it, as a JSON object. -o
    /// must name a PLY file
    #[arg(long, value_name = "FILE.json", requires = "output")]
    pub claims: Option<PathBuf>,

    /// Print counts, tolerance, domain and times as a JSON object
    #[arg(long)]
    pub json: bool,

    /// Give up after this time, and write nothing
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    pub budget: Option<f64>,

    /// Exit with code 1 if the shape or the distance is not proven
    #[arg(long)]
    pub strict: bool,

    /// Use this many threads [default: one per processor]
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
}

#[derive(Debug, Args)]
#[allow(clippy::struct_excessive_bools, reason = "each is a flag of its own")]
pub struct MeasureArgs {
    #[command(flatten)]
    pub document: DocumentArgs,

    /// Measure the volume of solids
    #[arg(long, help_heading = "Measures (without any, all)")]
    pub volume: bool,

    /// Measure the mass of solids, by --density
    #[arg(long, requires = "density", help_heading = "Measures (without any, all)")]
    pub mass: bool,

    /// Measure the centroid of solids
    #[arg(long, help_heading = "Measures (without any, all)")]
    pub centroid: bool,

    /// Measure the moments of inertia of solids
    #[arg(long, help_heading = "Measures (without any, all)")]
    pub inertia: bool,

    /// Bound the least and the greatest coordinates
    #[arg(long, help_heading = "Measures (without any, all)")]
    pub ends: bool,

    /// Estimate the area, and prove bounds of it, which takes longer
    #[arg(long, help_heading = "Measures (without any, all)")]
    pub area: bool,

    /// Count pieces, hollows and handles
    #[arg(long, visible_alias = "pieces", help_heading = "Measures (without any, all)")]
    pub shape: bool,

    /// Set the density of solids: a formula, in which names mean what they mean in the text. It
    /// weights mass, centroid and inertia
    #[arg(long, value_name = "FORMULA", allow_hyphen_values = true)]
    pub density: Option<String>,

    /// Make the bounds of a volume this narrow, as a share of the volume [default: 1e-3]
    #[arg(long, value_name = "SHARE", allow_hyphen_values = true)]
    pub relative: Option<f64>,

    /// Print the measures as a JSON object
    #[arg(long)]
    pub json: bool,

    /// Give up after this time, and print nothing
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    pub budget: Option<f64>,

    /// Use this many threads [default: one per processor]
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
}

#[derive(Debug, Args)]
pub struct GalleryArgs {
    /// Write the pictures and contact-sheet.png to this directory, created if missing
    #[arg(short, long, value_name = "DIR", required_unless_present = "list")]
    pub output: Option<PathBuf>,

    /// List the surfaces, then the models, without rendering them
    #[arg(long)]
    pub list: bool,

    /// Set each picture's width and height in pixels, or one number for a square
    #[arg(long, value_name = "N|WxH", default_value = "512", allow_hyphen_values = true)]
    pub size: Size,

    #[command(flatten)]
    pub tracing: TracingArgs,
}

/// Returns a parser that accepts the numbers of a setting.
fn count(row: &'static Setting) -> impl TypedValueParser<Value = usize> {
    move |text: &str| row.values.read(text, number::number).map(|number| number as usize)
}

/// Returns a parser that accepts the names in [`LOOKS`].
fn looks() -> impl TypedValueParser<Value = &'static Look> {
    let values = LOOKS.iter().map(|look| PossibleValue::new(look.name).help(look.help));
    PossibleValuesParser::new(values).try_map(|name| Look::named(&name).ok_or("no such look"))
}

/// Returns a parser that accepts the names in [`UNITS`].
fn units() -> impl TypedValueParser<Value = &'static Unit> {
    let names = PossibleValuesParser::new(UNITS.iter().map(|unit| unit.name));
    names.try_map(|name| Unit::named(&name).ok_or("no such unit"))
}

/// Returns a parser that accepts the names in [`METHODS`].
fn methods() -> impl TypedValueParser<Value = &'static Method> {
    let values = METHODS.iter().map(|row| {
        let options: Vec<String> =
            row.reads.iter().map(|option| format!("--{}", option.name)).collect();
        PossibleValue::new(row.name).help(format!("{}; reads {}", row.help, options.join(", ")))
    });
    PossibleValuesParser::new(values).try_map(|name| Method::named(&name).ok_or("no such method"))
}
