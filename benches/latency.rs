//! Times compilation after a warm-up: from a text to the first interval kernel, and from a text to
//! all kernels of the default picture.
//!
//! `cargo bench --bench latency` measures kernels of `f32`, then of `f64`. It prints the gallery's
//! median and worst surface beside the targets of 2 ms and 8 ms. Then it prints the slowest
//! surfaces with the time of each stage. `-- gyroid` at the end of the command selects the surfaces
//! whose names contain `gyroid`. A surface's time is the median over rounds. Each round covers all
//! surfaces, so a disturbance slows many surfaces once instead of one surface always.

use rayon::prelude::*;
use std::hint::black_box;
use std::time::{Duration, Instant};
use zeroset_eval::{Enclose, KernelFloat, SampleGradient};
use zeroset_jit::Compiled;
use zeroset_scene::gallery::{Example, examples};
use zeroset_scene::program::{KernelSource, Program};
use zeroset_scene::view::{self, DomainChoice};
use zeroset_syntax::{Document, Options, read};

const WARM_UP: usize = 2;
const ROUNDS: usize = 31;
const SLOWEST: usize = 10;

/// Measured quantities, in the order of the columns.
const NAMES: [&str; 9] =
    ["first", "all", "parse", "simplify", "tape", "code", "poles", "d tape", "d code"];
const FIRST: usize = 0;
const ALL: usize = 1;

fn document(example: &Example) -> Document {
    read(example.text, &Options::default()).expect(example.slug)
}

fn program(document: &Document) -> Program {
    let (region, _) = view::region(document, DomainChoice::Document, None).expect("a domain");
    Program::new(document, view::bounds(&region)).expect("a surface")
}

/// Reads the example's text and compiles the first interval kernel.
fn first<T: KernelFloat>(example: &Example) -> Program {
    let program = program(&document(example));
    program.kernels::<T>(0).bounds().expect(example.slug);
    program
}

/// Compiles all kernels of a picture with normals, in parallel as in drawing. Returns their number.
fn all<T: KernelFloat>(example: &Example) -> usize {
    let document = document(example);
    let program = program(&document);
    (0..document.surfaces.len()).into_par_iter().for_each(|surface| {
        let kernels = program.kernels::<T>(surface);
        rayon::join(
            || _ = kernels.zeros().expect(example.slug),
            || _ = kernels.gradients().expect(example.slug),
        );
    });
    program.made().len()
}

/// Returns the result of `run` and the duration of the call. Dropping the result is not timed.
fn time<T>(run: impl FnOnce() -> T) -> (T, Duration) {
    let start = Instant::now();
    let result = black_box(run());
    (result, start.elapsed())
}

/// Measures one surface once. The stages run one after another on one thread.
fn round<T: KernelFloat>(example: &Example) -> [Duration; NAMES.len()] {
    let (_, first) = time(|| first::<T>(example));
    let (_, all) = time(|| all::<T>(example));
    let (document, parse) = time(|| document(example));
    let (program, simplify) = time(|| program(&document));
    let tape = |form| program.tape::<T>(0, form).expect(example.slug).expect("every surface's");
    let (function, function_tape) = time(|| tape(KernelSource::Function));
    let (kernel, code) = time(|| Compiled::<Enclose, T>::new(function));
    kernel.expect(example.slug);
    // `zeros` clears poles and compiles the function again. This known time to compile is left out.
    let zeros = time(|| _ = program.kernels::<T>(0).zeros().expect(example.slug)).1;
    let poles = zeros.saturating_sub(function_tape + code);
    let (derivatives, gradient_tape) = time(|| tape(KernelSource::Gradient));
    let (kernel, gradient_code) = time(|| Compiled::<SampleGradient, T>::new(derivatives));
    kernel.expect(example.slug);
    let tape = function_tape;
    [first, all, parse, simplify, tape, code, poles, gradient_tape, gradient_code]
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn main() {
    // Skips the flag `--bench`, which Cargo adds.
    let filter = std::env::args().skip(1).find(|argument| !argument.starts_with('-'));
    let mut examples = examples();
    examples.retain(|example| filter.as_ref().is_none_or(|part| example.slug.contains(part)));
    assert!(!examples.is_empty(), "no surface has a name like {filter:?}");
    println!("kernels of f32");
    report::<f32>(&examples);
    println!("\nkernels of f64");
    report::<f64>(&examples);
}

fn report<T: KernelFloat>(examples: &[Example]) {
    for _ in 0..WARM_UP {
        for example in examples {
            round::<T>(example);
        }
    }
    let mut rounds: Vec<Vec<[Duration; NAMES.len()]>> = vec![Vec::new(); examples.len()];
    for _ in 0..ROUNDS {
        for (example, rounds) in examples.iter().zip(&mut rounds) {
            rounds.push(round::<T>(example));
        }
    }
    // Each surface's median times in milliseconds, by column.
    let table: Vec<(Example, [f64; NAMES.len()])> = examples
        .iter()
        .copied()
        .zip(rounds)
        .map(|(example, rounds)| {
            let column = |column: usize| {
                median(rounds.iter().map(|round| round[column].as_secs_f64() * 1e3).collect())
            };
            (example, std::array::from_fn(column))
        })
        .collect();
    println!("{:16}{:>10}{:>10}{:>10}   worst surface", "", "median", "worst", "target");
    for (name, column, target) in [("first", FIRST, 2.0), ("all", ALL, 8.0)] {
        let worst = slowest(&table, column)[0];
        println!(
            "{:16}{:7.2} ms{:7.2} ms{target:7.0} ms   {}",
            format!("latency/{name}"),
            median(table.iter().map(|(_, times)| times[column]).collect()),
            worst.1[column],
            worst.0.slug,
        );
    }
    for column in [FIRST, ALL] {
        println!("\nslowest by '{}', in ms; stages one after the other", NAMES[column]);
        print!("{:34}", "");
        for name in NAMES {
            print!("{name:>9}");
        }
        println!();
        for (example, times) in slowest(&table, column).iter().take(SLOWEST) {
            print!("{:34}", example.slug);
            for time in times {
                print!("{time:9.2}");
            }
            println!();
        }
    }
}

/// Returns the table's rows in descending order of a column.
fn slowest<const N: usize>(
    table: &[(Example, [f64; N])],
    column: usize,
) -> Vec<(Example, [f64; N])> {
    let mut sorted = table.to_vec();
    sorted.sort_by(|a, b| b.1[column].total_cmp(&a.1[column]));
    sorted
}
