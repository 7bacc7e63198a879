//! Compile time against the size of an expression: from text to the kernels that the method
//! `affine` asks for, of the gallery's surfaces and of formulas that are made as large as one
//! likes.

mod chart;
mod formulas;

pub use formulas::Source;

use crate::arguments::CompileArguments;
use crate::error::ChartError;
use crate::files::write_csv;
use crate::machine::Machine;
use crate::measure::pool;
use crate::progress::progress;
use crate::surfaces::Surface;
use crate::views::rng;
use formulas::all;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::time::Instant;
use zeroset::program::Program;
use zeroset::scene;
use zeroset_eval::{ContractTiles, Query};
use zeroset_syntax::{Options, read};
use zeroset_trace::{Method, TraceOptions};

/// A formula's line of results. Times are in milliseconds, on one thread: the least of all rounds,
/// as the same work is done in each and whatever else the processor does only adds to it, the more
/// the longer it takes.
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

/// Measures formulas in rounds of random order, and writes `compile.csv`, `compile-time.svg` and
/// `compile-code.svg` after each round; returns what was found, as a table.
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
    let mut rounds: Vec<Vec<Row>> = vec![Vec::new(); formulas.len()];
    let mut rows = Vec::new();
    // The first round warms up. A disturbance falls on one round of many formulas, and not on one
    // formula.
    for round in 0..=repeats {
        random.shuffle(&mut order);
        for &number in &order {
            let row = pool.install(|| compile(&formulas[number], seed, &machine))?;
            if round > 0 {
                rounds[number].push(row);
            }
            bar.inc(1);
        }
        if round > 0 {
            rows = rounds.iter().map(|rounds| together(rounds)).collect();
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

/// A formula compiled once.
fn compile(
    (source, formula): &(Source, Surface),
    seed: u64,
    machine: &Machine,
) -> Result<Row, ChartError> {
    let refuse = ChartError::of_surface(&formula.name);
    let mut start = Instant::now();
    let mut lap = || {
        let now = Instant::now();
        (now - std::mem::replace(&mut start, now)).as_secs_f64() * 1e3
    };
    let document = read(&formula.text, &Options::default());
    let document = document.map_err(ChartError::of_surface(&formula.name))?;
    let parse_ms = lap();
    let program = Program::new(&document, scene::bounds(&formula.region));
    let program = program.map_err(ChartError::of_surface(&formula.name))?;
    let simplify_ms = lap();
    let affine = Method::named("affine").expect("the default");
    for surface in 0..document.surfaces.len() {
        let kernels = program.surface(surface);
        affine.prepare(kernels, &formula.region, TraceOptions::default()).map_err(&refuse)?;
    }
    let compile_ms = lap();
    let made = program.made();
    let (nodes_typed, nodes) = program.nodes();
    let Machine { version, rustc, flags, processor, .. } = machine.clone();
    Ok(Row {
        name: formula.name.clone(),
        source: *source,
        nodes_typed,
        nodes,
        parse_ms,
        simplify_ms,
        compile_ms,
        kernels: made.len(),
        code_bytes: made.iter().map(|made| made.bytes).sum(),
        forms: made.iter().any(|made| made.question == ContractTiles::NAME),
        repeats: 1,
        seed,
        version,
        rustc,
        flags,
        processor,
    })
}

/// What all rounds of a formula tell: times are the least of each.
fn together(rounds: &[Row]) -> Row {
    let least = |time: fn(&Row) -> f64| rounds.iter().map(time).fold(f64::INFINITY, f64::min);
    Row {
        parse_ms: least(|row| row.parse_ms),
        simplify_ms: least(|row| row.simplify_ms),
        compile_ms: least(|row| row.compile_ms),
        repeats: rounds.len(),
        ..rounds[0].clone()
    }
}

/// What was found, in few lines: how times and code grow with nodes, and what the largest formula
/// takes.
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
