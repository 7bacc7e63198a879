//! The command `zeroset eval`: JSON lines in, JSON lines out.
//!
//! Kernels compute in `f32` or `f64`. A number is read as the nearest `f64`. For `f32` kernels,
//! points are rounded to nearest, and boxes are rounded outward. The results of kernels are written
//! exactly.

use super::arguments::EvalArgs;
use super::number;
use anyhow::{Context, Result};
use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::fs::File;
use std::io::{BufRead, BufReader, BufWriter, Read, Write};
use std::path::Path;
use std::process::ExitCode;
use zeroset_eval::{Boxes, Enclose, Kernel, KernelError, KernelFloat, Points, SampleGradient};
use zeroset_interval::{Facts, Interval};
use zeroset_render::names::Named;
use zeroset_render::picture::Precision;
use zeroset_scene::kernels::Evaluator;
use zeroset_scene::program::Program;
use zeroset_syntax::Options;

/// Longest accepted line, in bytes. The parser's limit for a formula is lower.
const LONGEST_LINE: u64 = 4 << 20;

/// Largest number of compiled formulas in the cache. A full cache is cleared.
const MAX_CACHED: usize = 256;

pub fn run(arguments: &EvalArgs) -> Result<ExitCode> {
    let source = &arguments.source;
    let mut input: Box<dyn BufRead> = if source == Path::new("-") {
        Box::new(std::io::stdin().lock())
    } else {
        let cannot = || format!("cannot read '{}'", source.display());
        anyhow::ensure!(!source.is_dir(), "'{}' is a directory", source.display());
        Box::new(BufReader::new(File::open(source).with_context(cannot)?))
    };
    let mut out = BufWriter::new(std::io::stdout().lock());
    let mut functions = FormulaCache {
        precision: arguments.precision,
        reference: arguments.reference,
        compiled: HashMap::new(),
    };
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
            functions.answer(&line)
        };
        let answer = answer.unwrap_or_else(|message| json!({ "error": message }));
        // Flush each answer, since a client at the other end of a pipe may be waiting for it.
        let written = writeln!(out, "{answer}").and_then(|()| out.flush());
        match written {
            Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => break,
            other => other.context("cannot write the answer")?,
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Compiled formulas by their text.
struct FormulaCache {
    /// Precision for lines that name no precision.
    precision: Precision,
    reference: bool,
    compiled: HashMap<String, Program>,
}

/// The point or the box at which a formula is evaluated.
enum PointOrBox {
    At([f64; 3]),
    Over([Interval; 3]),
}

impl FormulaCache {
    fn answer(&mut self, line: &[u8]) -> Result<Value, String> {
        let request: Map<String, Value> =
            serde_json::from_slice(line).map_err(|error| format!("not a JSON object: {error}"))?;
        let formula = match request.get("f") {
            Some(Value::String(formula)) => formula,
            Some(other) => return Err(format!("\"f\" must be a string, not {other}")),
            None => return Err("the formula \"f\" is missing".to_owned()),
        };
        let known = ["f", "at", "box", "precision"];
        if let Some(other) = request.keys().find(|key| !known.contains(&key.as_str())) {
            return Err(format!(
                "\"{other}\" is not a key; keys are \"f\", \"at\", \"box\" and \"precision\""
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
        let program = self.program(formula)?;
        let mut answer = match precision {
            Precision::Auto | Precision::F32 => answer::<f32>(program, &place),
            Precision::F64 => answer::<f64>(program, &place),
        }
        .map_err(|error| error.to_string())?;
        answer["precision"] = precision.to_string().into();
        Ok(answer)
    }

    fn program(&mut self, formula: &str) -> Result<&Program, String> {
        if !self.compiled.contains_key(formula) {
            let program = self.read(formula)?;
            if self.compiled.len() >= MAX_CACHED {
                self.compiled.clear();
            }
            self.compiled.insert(formula.to_owned(), program);
        }
        Ok(&self.compiled[formula])
    }

    fn read(&self, formula: &str) -> Result<Program, String> {
        let document = zeroset_syntax::read(formula, &Options::default())
            .map_err(|errors| errors.to_string())?;
        if document.surfaces.len() != 1 {
            return Err(format!(
                "exactly one formula is required, not {}",
                document.surfaces.len()
            ));
        }
        let program = Program::unchecked(&document, [Interval::ENTIRE; 3])
            .map_err(|error| error.to_string())?;
        let evaluator = if self.reference { Evaluator::Reference } else { Evaluator::Native };
        Ok(program.on(evaluator))
    }
}

fn answer<T: KernelFloat>(program: &Program, place: &PointOrBox) -> Result<Value, KernelError> {
    let kernels = program.kernels::<T>(0);
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
