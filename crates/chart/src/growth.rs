//! Compile time by expression size, from text to the kernels of the method `affine`. The formulas
//! are the gallery's and generated ones.

mod chart;
mod formulas;

pub use formulas::FormulaSource;

use crate::arguments::CompileArguments;
use crate::error::ChartError;
use crate::files::write_csv;
use crate::machine::Environment;
use crate::measure::pool;
use crate::progress::progress;
use crate::surfaces::ChartSurface;
use crate::views::rng;
use formulas::all;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::time::Instant;
use zeroset_eval::{ContractTiles, Query};
use zeroset_scene::program::Program;
use zeroset_scene::view;
use zeroset_syntax::{Options, read};
use zeroset_trace::{Method, TraceOptions};

/// Results of one formula. A time, in milliseconds on one thread, is the least over all rounds.
/// Every round does the same work, so other load on the processor can only add to a time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)] // names of columns
pub struct GrowthRow {
    pub name: String,
    pub source: FormulaSource,
    /// Nodes of the graph as typed.
    pub nodes_typed: usize,
    /// Nodes of the simplified graph, from which kernels are compiled.
    pub nodes: usize,
    /// Time from text to graph.
    pub parse_ms: f64,
    /// Time from the graph as typed to the simplified graph.
    pub simplify_ms: f64,
    /// Time from the simplified graph to all kernels of the method, rational forms included.
    pub compile_ms: f64,
    pub kernels: usize,
    /// Size of all kernels' code, in bytes.
    pub code_bytes: usize,
    /// Whether some kernels compute affine forms. Formulas too large for these are drawn by
    /// intervals.
    pub forms: bool,
    pub repeats: usize,
    pub seed: u64,
    pub version: String,
    pub rustc: String,
    pub flags: String,
    pub processor: String,
}

/// Measures formulas in rounds of random order. Writes `compile.csv`, `compile-time.svg` and
/// `compile-code.svg` after each round, and returns a table of the results.
///
/// # Errors
/// If a formula has no kernels, or the directory cannot be written.
pub fn growth(arguments: &CompileArguments) -> Result<String, ChartError> {
    let CompileArguments { nodes, repeats, seed, .. } = *arguments;
    let formulas = all(nodes, seed)?;
    let (machine, pool) = (Environment::this(), pool(1));
    let bar = progress((1 + repeats) * formulas.len());
    let mut random = rng(&format!("{seed} growth order"));
    let mut order: Vec<usize> = (0..formulas.len()).collect();
    let mut rounds: Vec<Vec<GrowthRow>> = vec![Vec::new(); formulas.len()];
    let mut rows = Vec::new();
    // The first round warms up. Rounds spread a disturbance over many formulas.
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
            rows = rounds.iter().map(|rounds| combine_rounds(rounds)).collect();
            save(&rows, &arguments.output)?;
        }
    }
    bar.finish_and_clear();
    Ok(table(&rows))
}

fn save(rows: &[GrowthRow], directory: &Path) -> Result<(), ChartError> {
    let mut sorted: Vec<&GrowthRow> = rows.iter().collect();
    sorted.sort_by_key(|row| (row.source, row.nodes, row.name.clone()));
    write_csv(&directory.join("compile.csv"), sorted)?;
    chart::times(rows).save(directory)?;
    chart::code(rows).save(directory)
}

/// Compiles a formula once.
fn compile(
    (source, formula): &(FormulaSource, ChartSurface),
    seed: u64,
    machine: &Environment,
) -> Result<GrowthRow, ChartError> {
    let refuse = ChartError::of_surface(&formula.name);
    let mut start = Instant::now();
    let mut lap = || {
        let now = Instant::now();
        (now - std::mem::replace(&mut start, now)).as_secs_f64() * 1e3
    };
    let document = read(&formula.text, &Options::default());
    let document = document.map_err(ChartError::of_surface(&formula.name))?;
    let parse_ms = lap();
    let program = Program::new(&document, view::bounds(&formula.region));
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
    let Environment { version, rustc, flags, processor, .. } = machine.clone();
    Ok(GrowthRow {
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

/// Combines a formula's rounds: each time is the least over the rounds.
fn combine_rounds(rounds: &[GrowthRow]) -> GrowthRow {
    let least = |time: fn(&GrowthRow) -> f64| rounds.iter().map(time).fold(f64::INFINITY, f64::min);
    GrowthRow {
        parse_ms: least(|row| row.parse_ms),
        simplify_ms: least(|row| row.simplify_ms),
        compile_ms: least(|row| row.compile_ms),
        repeats: rounds.len(),
        ..rounds[0].clone()
    }
}

/// A table of times and code size: their growth with nodes, and values for the largest formula.
fn table(rows: &[GrowthRow]) -> String {
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
