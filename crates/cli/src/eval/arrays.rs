//! Values and gradients at the points of an array, as arrays.

use crate::arguments::EvalArgs;
use crate::interrupt;
use crate::output::OutputFile;
use crate::point_array::PointArray;
use anyhow::{Result, ensure};
use npyz::{AutoSerialize, WriterBuilder};
use rayon::prelude::*;
use std::path::Path;
use std::process::ExitCode;
use zeroset_eval::{Boxes, KernelFloat, LANES, Points};
use zeroset_interval::Interval;
use zeroset_scene::program::Program;

/// Least number of batches that a thread takes: some microseconds of work.
const BATCHES: usize = 32;

/// The requested files, opened before anything is computed.
pub struct Arrays {
    values: Option<OutputFile>,
    gradients: Option<OutputFile>,
}

impl Arrays {
    /// Opens the requested files.
    ///
    /// # Errors
    /// If both are the same file, or one cannot be written.
    pub fn create(arguments: &EvalArgs) -> Result<Self> {
        let paths = [&arguments.output, &arguments.gradient];
        let is_standard = |path: &&Option<_>| path.as_deref() == Some(Path::new("-"));
        let standard = paths.iter().copied().filter(is_standard).count();
        ensure!(standard <= 1, "only one thing can be written to standard output");
        let open = |path: &Option<_>| path.as_deref().map(OutputFile::create).transpose();
        let (values, gradients) = (open(paths[0])?, open(paths[1])?);
        if let (Some(values), Some(gradients)) = (&values, &gradients) {
            ensure!(!values.is_same(gradients), "one file is given for two outputs");
        }
        Ok(Self { values, gradients })
    }

    pub fn is_empty(&self) -> bool {
        self.values.is_none() && self.gradients.is_none()
    }

    /// Evaluates the function at the points, and writes the files. Numbers are NaN where the
    /// function is proven undefined, and where a coordinate is not finite.
    ///
    /// # Errors
    /// If the function is too large to compile, or a file cannot be written.
    pub fn write<T>(self, program: &Program, array: &PointArray) -> Result<ExitCode>
    where
        T: KernelFloat + AutoSerialize,
    {
        let PointArray { shape, points } = array;
        let kernels = program.kernels::<T>(0);
        let (kernel, bounds) = (kernels.gradients()?, kernels.bounds()?);
        let nan = T::nearest(f64::NAN);
        let answer = |points: &[[f64; 3]]| {
            let out = kernel.eval_all(&Points::near(points)).swap_remove(0);
            let is_finite = |point: &[f64; 3]| point.iter().all(|part| part.is_finite());
            // Rounding can give a number where the function has no value, for example atan(1/x) at
            // 0. An enclosure around the exact point can prove that it has none.
            let place = |point: &[f64; 3]| if is_finite(point) { *point } else { [0.0; 3] };
            let place = |point| place(point).map(|part| Interval { lo: part, hi: part });
            let boxes: Vec<_> = points.iter().map(place).collect();
            let nowhere = bounds.eval_all(&Boxes::around(&boxes))[0].nowhere;
            let sample = |(lane, point): (usize, &[f64; 3])| {
                if is_finite(point) && nowhere >> lane & 1 == 0 {
                    (out.value[lane], out.gradient.each_ref().map(|lanes| lanes[lane]))
                } else {
                    (nan, [nan; 3])
                }
            };
            points.iter().enumerate().map(sample).collect::<Vec<_>>()
        };
        let batches = points.par_chunks(LANES).with_min_len(BATCHES);
        let (values, gradients): (Vec<T>, Vec<[T; 3]>) = batches.flat_map_iter(answer).unzip();
        let _held = interrupt::hold();
        if let Some(file) = self.gradients {
            let shape = [&shape[..], &[3]].concat();
            write(file, &shape, gradients.into_iter().flatten())?;
        }
        if let Some(file) = self.values {
            write(file, shape, values)?;
        }
        Ok(ExitCode::SUCCESS)
    }
}

fn write<T: AutoSerialize>(
    file: OutputFile,
    shape: &[u64],
    numbers: impl IntoIterator<Item = T>,
) -> Result<()> {
    let options = npyz::WriteOptions::<T>::new().default_dtype().shape(shape);
    file.finish(|out| {
        let mut writer = options.writer(out).begin_nd()?;
        writer.extend(numbers)?;
        writer.finish()
    })
}
