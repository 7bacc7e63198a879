//! The command `zeroset eval`: JSON lines in, JSON lines out; or arrays in, arrays out.
//!
//! Kernels compute in `f32` or `f64`. A number is read as the nearest `f64`. For `f32` kernels,
//! points are rounded to nearest, and boxes are rounded outward. The results of kernels are written
//! exactly.

mod arrays;

use super::arguments::EvalArgs;
use super::point_array::read_points;
use super::source::{self, Source};
use super::{USER_ERROR, interrupt, notes, number};
use anyhow::{Context, Result, anyhow, bail, ensure};
use arrays::Arrays;
use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::ffi::OsStr;
use std::fs::File;
use std::io::{BufRead, BufReader, BufWriter, Read, Write};
use std::path::Path;
use std::process::ExitCode;
use zeroset_eval::{Boxes, Enclose, Kernel, KernelError, KernelFloat, Points, SampleGradient};
use zeroset_interval::{Facts, Interval};
use zeroset_ir::Node;
use zeroset_render::names::Named;
use zeroset_render::picture::Precision;
use zeroset_scene::gallery::example;
use zeroset_scene::kernels::Evaluator;
use zeroset_scene::program::Program;
use zeroset_syntax::{Document, Options, ParameterKind};

/// Longest accepted line, in bytes. The parser's limit for a formula is lower.
const LONGEST_LINE: u64 = 4 << 20;

/// Largest number of compiled formulas in the cache. A full cache is cleared.
const MAX_CACHED: usize = 256;

/// Number of bytes at the beginning of a file by which JSON lines are told from a formula.
const BEGINNING: u64 = 4096;

pub fn run(arguments: &EvalArgs) -> Result<ExitCode> {
    let mut functions = FormulaCache {
        overrides: arguments.overrides()?,
        time: arguments.time()?,
        precision: arguments.precision,
        reference: arguments.reference,
        given: None,
        compiled: HashMap::new(),
    };
    let argument = arguments.source.as_deref();
    if let Some(points) = &arguments.at {
        let Some(argument) = argument else {
            bail!("--at needs a formula: zeroset eval 'x^2+y^2-1' --at {}", points.display());
        };
        let is_twice = argument == "-" && points == Path::new("-");
        ensure!(!is_twice, "formula and points cannot both come from standard input");
        // With --at, a pipe can only have a formula.
        let has_lines = Path::new(argument).is_file() && holds_lines(argument)?;
        ensure!(!has_lines, "'{}' has lines of JSON; --at needs a formula", argument.display());
        let program = functions.read_text(&source::find(argument)?)?;
        let only = surface(None, program.roots().len()).map_err(|_| {
            anyhow!("--at needs exactly one formula, not {}", program.roots().len())
        })?;
        debug_assert_eq!(only, 0, "the arrays are of the first surface");
        return arrays(arguments, &program, points);
    }
    let input: Box<dyn BufRead> = match argument {
        Some(file) if file != "-" && holds_lines(file)? => {
            let cannot = || format!("cannot read '{}'", file.display());
            Box::new(BufReader::new(File::open(file).with_context(cannot)?))
        }
        Some(formula) if formula != "-" => {
            functions.given = Some(functions.read_text(&source::find(formula)?)?);
            Box::new(std::io::stdin().lock())
        }
        _ => Box::new(std::io::stdin().lock()),
    };
    functions.answer_all(input)
}

/// Evaluates the formula at the points of a file.
fn arrays(arguments: &EvalArgs, program: &Program, points: &Path) -> Result<ExitCode> {
    let files = Arrays::create(arguments)?;
    if !files.is_empty() {
        interrupt::listen("nothing is written")?;
    }
    let array = read_points(points)?;
    if !files.is_empty() {
        return match arguments.precision {
            Precision::Auto | Precision::F32 => files.write::<f32>(program, &array),
            Precision::F64 => files.write::<f64>(program, &array),
        };
    }
    let mut out = BufWriter::new(std::io::stdout().lock());
    for point in &array.points {
        let found = answer(program, 0, &PointOrBox::At(*point), arguments.precision);
        match writeln!(out, "{}", found.map_err(|error| anyhow!(error))?) {
            Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => break,
            other => other.context("cannot write the answer")?,
        }
    }
    super::output::written(out.flush())?;
    Ok(ExitCode::SUCCESS)
}

/// Returns whether the argument is a file with lines of JSON. A pipe counts as one: it cannot be
/// looked into and read again.
fn holds_lines(argument: &OsStr) -> Result<bool> {
    let path = Path::new(argument);
    let Ok(metadata) = path.metadata() else { return Ok(false) };
    if !metadata.is_file() {
        return Ok(!metadata.is_dir());
    }
    let mut beginning = Vec::new();
    let cannot = || format!("cannot read '{}'", path.display());
    let file = File::open(path).with_context(cannot)?;
    file.take(BEGINNING).read_to_end(&mut beginning).with_context(cannot)?;
    let beginning = beginning.trim_ascii_start();
    // No formula begins with these two signs. A file without a line has nothing to be evaluated.
    let is_object = |rest: &[u8]| matches!(rest.trim_ascii_start().first(), Some(b'"' | b'}'));
    Ok(beginning.is_empty() || beginning.strip_prefix(b"{").is_some_and(is_object))
}

/// Compiled formulas by their text.
struct FormulaCache {
    /// Names and their values, from the command line.
    overrides: Vec<(String, String)>,
    /// The time, from the command line.
    time: Option<f64>,
    /// Precision for lines that name no precision.
    precision: Precision,
    reference: bool,
    /// The formula of lines that have none.
    given: Option<Program>,
    compiled: HashMap<String, Program>,
}

/// The point or the box at which a formula is evaluated.
enum PointOrBox {
    At([f64; 3]),
    Over([Interval; 3]),
}

impl FormulaCache {
    /// Answers each line of `input`.
    fn answer_all(&mut self, mut input: Box<dyn BufRead>) -> Result<ExitCode> {
        let mut out = BufWriter::new(std::io::stdout().lock());
        let (mut lines, mut errors) = (0, 0);
        let mut line = Vec::new();
        loop {
            line.clear();
            let mut limited = input.by_ref().take(LONGEST_LINE);
            let read = limited.read_until(b'\n', &mut line).context("cannot read the input")?;
            if read == 0 {
                break;
            }
            let cut = read as u64 == LONGEST_LINE && line.last() != Some(&b'\n');
            let answer = if cut {
                input.skip_until(b'\n').context("cannot read the input")?;
                Err(format!("the line is longer than {LONGEST_LINE} bytes"))
            } else if line.iter().all(u8::is_ascii_whitespace) {
                continue;
            } else {
                self.answer(&line)
            };
            lines += 1;
            errors += usize::from(answer.is_err());
            let answer = answer.unwrap_or_else(|message| json!({ "error": message }));
            // Flush each answer, since a client at the other end of a pipe may be waiting for it.
            let written = writeln!(out, "{answer}").and_then(|()| out.flush());
            match written {
                Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => break,
                other => other.context("cannot write the answer")?,
            }
        }
        if errors > 0 {
            notes::note(&format!("{errors} of {lines} lines are answered by an error"));
            return Ok(ExitCode::from(USER_ERROR));
        }
        Ok(ExitCode::SUCCESS)
    }

    fn answer(&mut self, line: &[u8]) -> Result<Value, String> {
        let request: Map<String, Value> =
            serde_json::from_slice(line).map_err(|error| format!("not a JSON object: {error}"))?;
        let formula = match request.get("f") {
            Some(Value::String(formula)) => Some(formula),
            Some(other) => return Err(format!("\"f\" must be a string, not {other}")),
            None if self.given.is_some() => None,
            None => return Err("the formula \"f\" is missing".to_owned()),
        };
        let known = ["f", "at", "box", "precision", "surface"];
        if let Some(other) = request.keys().find(|key| !known.contains(&key.as_str())) {
            return Err(format!(
                "\"{other}\" is not a key; keys are \"f\", \"at\", \"box\", \"precision\" and \
                 \"surface\""
            ));
        }
        let place = match (request.get("at"), request.get("box")) {
            (Some(at), None) => PointOrBox::At(three(at, number::read)?),
            (None, Some(over)) => PointOrBox::Over(three(over, interval)?),
            _ => return Err("either \"at\" or \"box\" is required".to_owned()),
        };
        let precision = match request.get("precision") {
            None => self.precision,
            Some(name) => name
                .as_str()
                .and_then(Precision::named)
                .filter(|precision| *precision != Precision::Auto)
                .ok_or_else(|| format!("\"precision\" is \"f32\" or \"f64\", not {name}"))?,
        };
        let program = match (formula, &self.given) {
            (None, Some(given)) => given,
            (formula, _) => self.program(formula.map_or("", |formula| formula))?,
        };
        let surface = surface(request.get("surface"), program.roots().len())?;
        answer(program, surface, &place, precision).map_err(|error| error.to_string())
    }

    fn program(&mut self, formula: &str) -> Result<&Program, String> {
        if !self.compiled.contains_key(formula) {
            let text = example(formula).map_or(formula, |example| example.text);
            let document =
                zeroset_syntax::read(text, &self.options()).map_err(
                    |errors| match source::misspelt(formula) {
                        Some(slug) => format!("{errors}; did you mean '{slug}' of the gallery?"),
                        None => errors.to_string(),
                    },
                )?;
            let program = self.compile(&document)?;
            if self.compiled.len() >= MAX_CACHED {
                self.compiled.clear();
            }
            self.compiled.insert(formula.to_owned(), program);
        }
        Ok(&self.compiled[formula])
    }

    /// Reads the formula that the command line gives.
    fn read_text(&self, source: &Source) -> Result<Program> {
        let Source { from, text } = source;
        let from = from.to_string();
        let document = zeroset_syntax::read(text, &self.options()).map_err(|errors| {
            notes::FormattedError(errors.render(Some(&from), text, notes::colored()))
        })?;
        for note in &document.notes {
            notes::say(&note.render(Some(&from), text, notes::colored()));
        }
        self.compile(&document).map_err(|error| anyhow!(error))
    }

    fn options(&self) -> Options<'_> {
        Options { overrides: &self.overrides, time: self.time, ..Options::default() }
    }

    fn compile(&self, document: &Document) -> Result<Program, String> {
        if document.surfaces.is_empty() {
            return Err("there is no formula to evaluate".to_owned());
        }
        if self.lacks_time(document) {
            return Err(
                "the formula depends on the time `t`, which has no value: add a line such \
                        as t = 0.5, or --time 0.5"
                    .to_owned(),
            );
        }
        let program = Program::unchecked(document, [Interval::ENTIRE; 3])
            .map_err(|error| error.to_string())?;
        let evaluator = if self.reference { Evaluator::Reference } else { Evaluator::Native };
        Ok(program.on(evaluator))
    }

    /// Whether the function depends on the time, and neither the text nor the command line sets it.
    /// A picture may begin at 0, but values for a time that nobody named would mislead.
    fn lacks_time(&self, document: &Document) -> bool {
        let is_given = self.time.is_some() || self.overrides.iter().any(|(name, _)| name == "t");
        let is_unset = |one: &&zeroset_syntax::Parameter| {
            one.kind == ParameterKind::Time && one.span.is_none()
        };
        let roots: Vec<_> = document.surfaces.iter().map(|surface| surface.root).collect();
        let needed = document.graph.reachable(&roots);
        let is_used = |time: &zeroset_syntax::Parameter| {
            let node = Node::Parameter(time.number);
            document.graph.iter().any(|(id, other)| needed[id.index()] && *other == node)
        };
        !is_given && document.parameters.iter().find(is_unset).is_some_and(is_used)
    }
}

/// The index of the surface that a line names by its number, of `count` surfaces.
fn surface(number: Option<&Value>, count: usize) -> Result<usize, String> {
    let Some(number) = number else {
        return match count {
            1 => Ok(0),
            _ => Err(format!(
                "there are {count} formulas: add the key \"surface\", from 1 to {count}"
            )),
        };
    };
    let index = number.as_u64().and_then(|number| usize::try_from(number).ok()?.checked_sub(1));
    index
        .filter(|index| *index < count)
        .ok_or_else(|| format!("\"surface\" is a number from 1 to {count}, not {number}"))
}

/// Answers a request in this precision.
fn answer(
    program: &Program,
    surface: usize,
    place: &PointOrBox,
    precision: Precision,
) -> Result<Value, KernelError> {
    let mut answer = match precision {
        Precision::Auto | Precision::F32 => answer_in::<f32>(program, surface, place),
        Precision::F64 => answer_in::<f64>(program, surface, place),
    }?;
    answer["precision"] = precision.to_string().into();
    Ok(answer)
}

fn answer_in<T: KernelFloat>(
    program: &Program,
    surface: usize,
    place: &PointOrBox,
) -> Result<Value, KernelError> {
    let kernels = program.kernels::<T>(surface);
    let bounds = kernels.bounds()?;
    Ok(match place {
        PointOrBox::At(point) => sample(kernels.gradients()?, bounds, *point),
        PointOrBox::Over(over) => enclose(bounds, *over),
    })
}

fn three<T>(value: &Value, read: impl Fn(&Value) -> Result<T, String>) -> Result<[T; 3], String> {
    match value.as_array().map(Vec::as_slice) {
        Some([x, y, z]) => Ok([read(x)?, read(y)?, read(z)?]),
        _ => Err("\"at\" and \"box\" must be arrays of three".to_owned()),
    }
}

fn interval(value: &Value) -> Result<Interval, String> {
    let Some([low, high]) = value.as_array().map(Vec::as_slice) else {
        return Err("each range of \"box\" must be an array of two".to_owned());
    };
    let (low, high) = (number::read(low)?, number::read(high)?);
    Interval::new(low, high).ok_or_else(|| format!("{low} to {high} is not a range"))
}

fn sample<T: KernelFloat>(
    gradient: &dyn Kernel<SampleGradient, T>,
    bounds: &dyn Kernel<Enclose, T>,
    point: [f64; 3],
) -> Value {
    let out = gradient.eval_all(&Points::near(&[point]));
    // Rounding can give a number where the function has no value, for example atan(1/x) at 0. An
    // enclosure around the exact point, not rounded to `T`, can prove that there is no value.
    let facts = if point.iter().all(|c| c.is_finite()) {
        bounds_and_facts(bounds, point.map(|c| Interval { lo: c, hi: c })).1
    } else {
        Facts::NONE
    };
    let undefined = facts.has(Facts::NOWHERE);
    let shown = |number: T| number::write(if undefined { f64::NAN } else { number.into() });
    json!({
        "value": shown(out[0].value[0]),
        "grad": out[0].gradient.map(|lanes| shown(lanes[0])),
        "empty": undefined,
        "defined": facts.has(Facts::DEFINED),
    })
}

fn enclose<T: KernelFloat>(kernel: &dyn Kernel<Enclose, T>, bounds: [Interval; 3]) -> Value {
    let (bounds, facts) = bounds_and_facts(kernel, bounds);
    json!({
        "lo": number::write(bounds.lo),
        "hi": number::write(bounds.hi),
        "empty": facts.has(Facts::NOWHERE),
        "defined": facts.has(Facts::DEFINED),
        "continuous": facts.has(Facts::CONTINUOUS),
    })
}

fn bounds_and_facts<T: KernelFloat>(
    kernel: &dyn Kernel<Enclose, T>,
    bounds: [Interval; 3],
) -> (Interval, Facts) {
    let out = kernel.eval_all(&Boxes::around(&[bounds]));
    // Adding 0 turns a bound of -0 into 0.
    let bounds = Interval { lo: 0.0 - out[0].neg_lo[0].into(), hi: 0.0 + out[0].hi[0].into() };
    (bounds, out[0].facts(0))
}
