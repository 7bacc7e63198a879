//! Compile time against the size of an expression: from text to the kernels that the method `affine` asks for, of the gallery's
//! surfaces and of formulas that are made as large as one likes.

mod chart;
mod formulas;

pub use formulas::Source;

use crate::arguments::CompileArguments;
use crate::error::ChartError;
use crate::files::write_csv;
use crate::machine::Machine;
use crate::measure::pool;
use crate::progress::progress;
use crate::quantile::quantile;
use crate::views::rng;
use formulas::{Formula, all};
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::time::Instant;
use zeroset::program::Program;
use zeroset::scene;
use zeroset_eval::{ContractTiles, Question};
use zeroset_syntax::{Options as Reading, read};
use zeroset_trace::{Method, Options};

/// A formula's line of results. Times are in milliseconds, on one thread: the least of all rounds, as the same work is done
/// in each and whatever else the processor does only adds to it, the more the longer it takes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)] // names of columns
pub struct Row {
    pub name: String,
    pub source: Source,
    /// Of the graph as typed.
    pub nodes_typed: usize,
    /// Of the simplified graph, which kernels are made of.
    pub nodes: usize,
    /// From text to graph.
    pub parse_ms: f64,
    /// From that graph to the simplified one.
    pub simplify_ms: f64,
    /// To all kernels that are asked for, poles cleared where there are any.
    pub compile_ms: f64,
    pub kernels: usize,
    /// Of all kernels.
    pub code_bytes: usize,
    /// Whether they hold affine forms: a formula too large for these is drawn by intervals alone.
    pub forms: bool,
    pub repeats: usize,
    pub seed: u64,
    pub version: String,
    pub rustc: String,
    pub flags: String,
    pub processor: String,
}

/// Measures formulas in rounds of random order, and writes `compile.csv`, `compile-time.svg` and `compile-code.svg` after each
/// round; returns what was found, as a table.
///
/// # Errors
/// If a formula has no kernels, or the directory cannot be written.
pub fn growth(arguments: &CompileArguments) -> Result<String, ChartError> {
    let CompileArguments { nodes, repeats, seed, .. } = *arguments;
    let formulas = all(nodes, seed)?;
    let (machine, pool) = (Machine::this(), pool(1));
    let bar = progress((1 + repeats) * formulas.len());
    let mut random = rng(&format!("{seed} growth order"));
    let mut order: Vec<usize> = (0..formulas.len()).collect();
    let mut made: Vec<Vec<Compiled>> = formulas.iter().map(|_| Vec::new()).collect();
    let mut rows = Vec::new();
    // The first round warms up. A disturbance falls on one round of many formulas, and not on one formula.
    for round in 0..=repeats {
        random.shuffle(&mut order);
        for &number in &order {
            let one = pool.install(|| compile(&formulas[number]))?;
            if round > 0 {
                made[number].push(one);
            }
            bar.inc(1);
        }
        if round > 0 {
            let pairs = formulas.iter().zip(&made);
            rows = pairs.map(|(formula, made)| row(formula, made, seed, &machine)).collect();
            save(&rows, &arguments.output)?;
        }
    }
    bar.finish_and_clear();
    Ok(table(&rows))
}

fn save(rows: &[Row], directory: &Path) -> Result<(), ChartError> {
    let mut sorted: Vec<&Row> = rows.iter().collect();
    sorted.sort_by_key(|row| (row.source, row.nodes, row.name.clone()));
    write_csv(&directory.join("compile.csv"), sorted)?;
    chart::times(rows).save(directory)?;
    chart::code(rows).save(directory)
}

/// What came of a formula, and its times in milliseconds.
struct Compiled {
    /// To parse, to simplify, to compile.
    times: [f64; 3],
    nodes: (usize, usize),
    kernels: usize,
    bytes: usize,
    forms: bool,
}

fn compile(formula: &Formula) -> Result<Compiled, ChartError> {
    let refuse = |why: String| ChartError::Surface { surface: formula.name.clone(), why };
    let mut start = Instant::now();
    let mut lap = || {
        let now = Instant::now();
        (now - std::mem::replace(&mut start, now)).as_secs_f64() * 1e3
    };
    let document = read(&formula.text, &Reading::default());
    let document = document.map_err(|errors| refuse(errors.to_string()))?;
    let parse = lap();
    let program = Program::new(&document, scene::bounds(&formula.region));
    let program = program.map_err(|error| refuse(error.to_string()))?;
    let simplify = lap();
    let affine = Method::named("affine").expect("the default");
    for surface in 0..document.surfaces.len() {
        let kernels = program.surface(surface);
        let tracer = affine.prepare(kernels, &formula.region, Options::default());
        tracer.map_err(|error| refuse(error.to_string()))?;
    }
    let compile = lap();
    let made = program.made();
    Ok(Compiled {
        times: [parse, simplify, compile],
        nodes: program.nodes(),
        kernels: made.len(),
        bytes: made.iter().map(|made| made.bytes).sum(),
        forms: made.iter().any(|made| made.question == ContractTiles::NAME),
    })
}

fn row(formula: &Formula, rounds: &[Compiled], seed: u64, machine: &Machine) -> Row {
    let [parse_ms, simplify_ms, compile_ms] = [0, 1, 2].map(|stage| {
        let times: Vec<f64> = rounds.iter().map(|round| round.times[stage]).collect();
        quantile(&times, 0.0).expect("repeats")
    });
    let one = &rounds[0];
    let Machine { version, rustc, flags, processor, .. } = machine.clone();
    Row {
        name: formula.name.clone(),
        source: formula.source,
        nodes_typed: one.nodes.0,
        nodes: one.nodes.1,
        parse_ms,
        simplify_ms,
        compile_ms,
        kernels: one.kernels,
        code_bytes: one.bytes,
        forms: one.forms,
        repeats: rounds.len(),
        seed,
        version,
        rustc,
        flags,
        processor,
    }
}

/// What was found, in few lines: how times and code grow with nodes, and what the largest formula takes.
fn table(rows: &[Row]) -> String {
    let Some(largest) = rows.iter().max_by_key(|row| row.nodes) else { return String::new() };
    let (formulas, nodes) = (rows.len(), largest.nodes);
    let head =
        format!("{formulas} formulas: exponents of growth, and ms or bytes at {nodes} nodes\n");
    let lines = chart::QUANTITIES.iter().map(|(name, value)| {
        let slope =
            chart::slope(rows, *value).map_or("-".to_owned(), |slope| format!("{slope:.2}"));
        format!("{name:10}{slope:>6}{:12.1}\n", value(largest))
    });
    std::iter::once(head).chain(lines).collect()
}
