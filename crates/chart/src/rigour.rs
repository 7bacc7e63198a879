//! The cost of sound rounding, by comparison of three arithmetics. The unsound one rounds to
//! nearest. The widened one rounds to nearest, and then moves each bound outward by further
//! operations; it suits machines whose rounding mode cannot be set. The third rounds up, as zeroset
//! itself does.
//!
//! Kernels are timed on the inputs that a picture gives them. Whole pictures are timed in each
//! arithmetic, too.

mod chart;
mod inputs;
mod kernels;
mod row;

pub use row::{RigourRow, Workload, name};

use crate::arguments::RigourArguments;
use crate::error::ChartError;
use crate::files::write_csv;
use crate::machine::Environment;
use crate::measure::pool;
use crate::progress::progress;
use crate::quantile::{Quartiles, geometric_mean};
use crate::surfaces::{self, ChartSurface};
use crate::views::{View, rng, views};
use inputs::{ByArithmetic, boxes, chosen, errors, lengths, widths};
use kernels::{HasKernel, KernelPrecision, KernelSet, PrecisionKernels};
use std::hint::black_box;
use std::path::Path;
use std::time::{Duration, Instant};
use zeroset_eval::{ContractSegments, ContractTiles, Enclose, Input, Kernel, KernelError, Query};
use zeroset_jit::comparison::Arithmetic;
use zeroset_scene::program::Program;
use zeroset_scene::view;
use zeroset_trace::{Driver, GBuffer, Method, Precision, RayGrid, TraceOptions};

/// Least time that a kernel runs between two readings of the clock.
const MIN_RUN: Duration = Duration::from_micros(300);

/// Measures surfaces, and writes `rigour.csv` and `rigour.svg` after each. Returns a table of the
/// results.
///
/// # Errors
/// If a surface is unknown, has parameters or poles, or has no kernels, or the directory cannot be
/// written. Parameters and poles need kernels that are not compared here.
pub fn rigour(arguments: &RigourArguments) -> Result<String, ChartError> {
    let surfaces = surfaces::chosen(&arguments.surfaces)?;
    let (machine, pool) = (Environment::this(), pool(1));
    let mut rows = Vec::new();
    let bar = progress(2 * surfaces.len());
    for surface in &surfaces {
        bar.set_message(surface.name.clone());
        let refuse = ChartError::of_surface(&surface.name);
        let program = Program::new(&surface.document, view::bounds(&surface.region));
        let program = program.map_err(&refuse)?;
        let view = &views(surface, 1, arguments.seed)?[0];
        let plan = Plan { surface, view, program: &program, arguments, machine: &machine };
        rows.extend(pool.install(|| plan.rows::<f32>())?);
        bar.inc(1);
        rows.extend(pool.install(|| plan.rows::<f64>())?);
        bar.inc(1);
        save(&rows, &arguments.output)?;
    }
    bar.finish_and_clear();
    Ok(table(&rows))
}

fn save(rows: &[RigourRow], directory: &Path) -> Result<(), ChartError> {
    write_csv(&directory.join("rigour.csv"), rows)?;
    chart::figure(rows).save(directory)
}

/// A table of times relative to the unsound kernels, and widths relative to the rounded-up ones.
fn table(rows: &[RigourRow]) -> String {
    let mean = |rows: &[&RigourRow], value: fn(&RigourRow) -> Option<f64>| {
        let values: Vec<f64> = rows.iter().filter_map(|row| value(row)).collect();
        geometric_mean(&values).map_or("-".to_owned(), |mean| format!("{mean:.3}"))
    };
    let line = |name: &str, cells: [String; 4]| {
        let [widened, upward, width, points] = cells;
        format!("{name:16}{widened:>10}{upward:>10}{width:>10}{points:>10}\n")
    };
    let names = ["widened", "round-up", "width", "at points"].map(str::to_owned);
    let head = "geometric means over surfaces: times over those of the unsound, widths of the widened over round-up\n";
    let lines = chart::places(rows).into_iter().map(|(asked, precision)| {
        let of = |arithmetic| chart::of(rows, asked, precision, arithmetic);
        let (widened, upward) = (of(Arithmetic::Widened), of(Arithmetic::Upward));
        let cells = [
            mean(&widened, |row| Some(row.times_unsound)),
            mean(&upward, |row| Some(row.times_unsound)),
            mean(&widened, |row| row.width),
            mean(&widened, |row| row.width_at_points),
        ];
        line(&format!("{asked} {precision}"), cells)
    });
    [head.to_owned(), line("", names)].into_iter().chain(lines).collect()
}

/// A surface, and the conditions under which it is measured.
struct Plan<'a> {
    surface: &'a ChartSurface,
    view: &'a View,
    program: &'a Program,
    arguments: &'a RigourArguments,
    machine: &'a Environment,
}

/// The three kernels for a query, one per arithmetic in the order of [`Arithmetic::ALL`].
fn three<T: KernelPrecision, Q: Query>(
    sets: &[KernelSet; 3],
) -> Result<ByArithmetic<'_, Q, T>, KernelError>
where
    PrecisionKernels<T>: HasKernel<Q, T>,
{
    let [unsound, widened, upward] = sets;
    Ok([unsound.kernel()?, widened.kernel()?, upward.kernel()?])
}

/// A timed task. `run` repeats the task, and each repetition evaluates `lanes` lanes or pixels.
struct TimedTask<'a> {
    run: Box<dyn Fn(usize) + 'a>,
    lanes: usize,
}

impl Plan<'_> {
    fn rows<T: KernelPrecision>(&self) -> Result<Vec<RigourRow>, ChartError> {
        let surface = &self.surface;
        let refuse = ChartError::of_surface(&surface.name);
        let set = |arithmetic, records| {
            KernelSet::new(self.program, arithmetic, records).map_err(&refuse)
        };
        // Tracing a picture in the arithmetic that rounds up records the inputs of its kernels.
        let asked = set(Arithmetic::Upward, true)?;
        self.picture(&asked, T::PRECISION)?;
        let [unsound, widened, upward] = Arithmetic::ALL.map(|arithmetic| set(arithmetic, false));
        let sets = [unsound?, widened?, upward?];
        let mut random = rng(&format!("{} {} boxes", self.arguments.seed, surface.name));
        let [places, points] = [1.0 / 16.0, 0.0].map(|s| boxes(&surface.region, s, &mut random));
        let refuse = ChartError::of_surface(&surface.name);

        let kernels = three::<T, Enclose>(&sets).map_err(&refuse)?;
        let widths = [widths(&kernels, &places), widths(&kernels, &points)];
        let mut rows = self.kernel_rows(Workload::Boxes, &kernels, &places, widths);
        let kernels = three::<T, ContractSegments>(&sets).map_err(&refuse)?;
        let segments = asked.recorded::<T, ContractSegments>().map_err(&refuse)?;
        let widths = [lengths(&kernels, &segments), [None; 3]];
        rows.extend(self.kernel_rows(Workload::Segments, &kernels, &segments, widths));
        let kernels = three::<T, ContractTiles>(&sets).map_err(&refuse)?;
        let tiles = asked.recorded::<T, ContractTiles>().map_err(&refuse)?;
        let widths = [errors(&kernels, &tiles), [None; 3]];
        rows.extend(self.kernel_rows(Workload::Tiles, &kernels, &tiles, widths));
        rows.extend(self.picture_rows(&sets, T::PRECISION)?);
        Ok(rows)
    }

    /// Rows with the kernels' times on some of `inputs`. The rows get the given `widths`.
    fn kernel_rows<T: KernelPrecision, Q: Query>(
        &self,
        asked: Workload,
        kernels: &ByArithmetic<Q, T>,
        inputs: &[Q::Input<T>],
        widths: [[Option<f64>; 3]; 2],
    ) -> Vec<RigourRow> {
        let inputs = &chosen(inputs);
        if inputs.is_empty() {
            return Vec::new();
        }
        let lanes = inputs.iter().map(Input::count).sum();
        let tasks = kernels.map(|kernel| {
            // Tracers call kernels through a trait object, so this call does, too.
            let kernel: &dyn Kernel<Q, T> = kernel;
            let run = move |times: usize| {
                let mut output = Q::Output::<T>::default();
                for input in (0..times).flat_map(|_| inputs) {
                    kernel.eval(black_box(input), black_box(&mut output));
                }
            };
            TimedTask { run: Box::new(run), lanes }
        });
        let mut rows = self.timed(asked, T::PRECISION, &tasks);
        for (number, row) in rows.iter_mut().enumerate() {
            row.code_bytes = Some(kernels[number].code_bytes());
            [row.width, row.width_at_points] = widths.map(|widths| widths[number]);
        }
        rows
    }

    fn picture_rows(
        &self,
        sets: &[KernelSet; 3],
        precision: Precision,
    ) -> Result<Vec<RigourRow>, ChartError> {
        // These untimed pictures compile the kernels.
        let mut undecided = Vec::new();
        for set in sets {
            undecided.push(self.picture(set, precision)?);
        }
        let tasks = sets.each_ref().map(|set| {
            let run = move |times: usize| {
                for _ in 0..times {
                    // The same picture succeeded above, so it cannot fail here.
                    let _ = black_box(self.picture(set, precision));
                }
            };
            TimedTask { run: Box::new(run), lanes: self.arguments.size * self.arguments.size }
        });
        let mut rows = self.timed(Workload::Picture, precision, &tasks);
        for (row, undecided) in rows.iter_mut().zip(undecided) {
            row.undecided = Some(undecided);
        }
        Ok(rows)
    }

    /// Traces the surface by the method `affine`; returns the number of undecided pixels.
    fn picture(&self, set: &KernelSet, precision: Precision) -> Result<usize, ChartError> {
        let size = self.arguments.size;
        let affine = Method::named("affine").expect("the default");
        let options = TraceOptions { precision, ..TraceOptions::default() };
        let tracer = affine
            .prepare(set, &self.surface.region, options)
            .map_err(ChartError::of_surface(&self.surface.name))?;
        let rays = RayGrid::new(&self.view.camera, size, size);
        let mut buffer = GBuffer::new(size, size, 0);
        Driver { rays: &rays, tracer: &*tracer, advance: &|_| true }.picture(&mut buffer);
        let undecided = buffer.counts().undecided;
        buffer.hand_back();
        Ok(undecided)
    }

    /// Times the three tasks in rounds of random order. Rows are in the order of
    /// [`Arithmetic::ALL`].
    fn timed(
        &self,
        asked: Workload,
        precision: Precision,
        tasks: &[TimedTask<'_>; 3],
    ) -> Vec<RigourRow> {
        // Interruptions only lengthen a time, so the least of three times counts.
        let time = |task: &TimedTask<'_>, times: usize| {
            let once = || {
                let start = Instant::now();
                (task.run)(times);
                start.elapsed().as_secs_f64()
            };
            once().min(once()).min(once())
        };
        // The first round warms up, and determines the number of repetitions.
        let times = tasks.each_ref().map(|task| {
            let once = time(task, 1);
            (MIN_RUN.as_secs_f64() / once.max(1e-9)).ceil() as usize
        });
        let RigourArguments { size, repeats, seed, .. } = *self.arguments;
        let mut order = [0, 1, 2];
        let mut random = rng(&format!("{seed} {} {asked} order", self.surface.name));
        let mut nanoseconds = vec![[0.0; 3]; repeats];
        for round in &mut nanoseconds {
            random.shuffle(&mut order);
            for number in order {
                let task = &tasks[number];
                let lanes = (times[number] * task.lanes) as f64;
                round[number] = time(task, times[number]) * 1e9 / lanes;
            }
        }
        let quartiles = |value: &dyn Fn(&[f64; 3]) -> f64| {
            let values: Vec<f64> = nanoseconds.iter().map(value).collect();
            Quartiles::of(&values).expect("repeats")
        };
        let rows = Arithmetic::ALL.iter().enumerate().map(|(number, arithmetic)| {
            let own = quartiles(&|round| round[number]);
            let ratio = quartiles(&|round| round[number] / round[0]);
            let Environment { version, rustc, flags, processor, .. } = self.machine.clone();
            RigourRow {
                surface: self.surface.name.clone(),
                asked,
                precision: precision.to_string(),
                arithmetic: name(*arithmetic),
                ns: own.median,
                ns_lower: own.lower,
                ns_upper: own.upper,
                times_unsound: ratio.median,
                times_unsound_lower: ratio.lower,
                times_unsound_upper: ratio.upper,
                code_bytes: None,
                width: None,
                width_at_points: None,
                undecided: None,
                size,
                repeats,
                seed,
                version,
                rustc,
                flags,
                processor,
            }
        });
        rows.collect()
    }
}
