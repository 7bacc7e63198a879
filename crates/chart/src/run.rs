//! Measures the grid view by view, and keeps the rows that are already stored.

use crate::arguments::RunArguments;
use crate::error::ChartError;
use crate::errors::PixelErrors;
use crate::grid::{Configuration, configurations};
use crate::machine::Environment;
use crate::measure::{measure, pool};
use crate::progress::progress;
use crate::reference::{RootReference, Sampling};
use crate::row::{Conditions, Row};
use crate::store::Store;
use crate::surfaces::{ChartSurface, chosen};
use crate::views::{View, views};
use rayon::ThreadPool;
use std::path::Path;
use zeroset_testkit::certified::BUDGET;
use zeroset_trace::RayGrid;

/// Measures the rows that the directory lacks, and stores them view by view. Returns the number of
/// new rows.
///
/// # Errors
/// If a surface is unknown or cannot be drawn, or the directory has results of another machine or
/// cannot be written.
pub fn run(arguments: &RunArguments) -> Result<usize, ChartError> {
    let surfaces = chosen(&arguments.surfaces)?;
    let configurations = configurations(&arguments.methods.chosen(), &arguments.values());
    let (all, number) = (arguments.conditions(), arguments.views());
    let mut store = Store::open(&arguments.output)?;
    let machine = Environment::this();
    if store.rows.iter().any(|row| row.machine() != machine) {
        let why = "holds results of another machine, compiler or version";
        return Err(ChartError::of_content(&arguments.output)(why));
    }
    let (pool, before) = (pool(arguments.threads), store.rows.len());
    let rounds = 3 + all[0].repeats;
    let bar = progress(surfaces.len() * number * all.len() * rounds);
    for surface in &surfaces {
        for view in views(surface, number, arguments.seed)? {
            for &conditions in &all {
                bar.set_message(format!("{} {} {}", surface.name, view.name, conditions.size));
                let end = bar.position() + rounds as u64;
                let batch = RunBatch { surface, view: &view, conditions, machine: &machine };
                let missing: Vec<Configuration> = configurations
                    .iter()
                    .copied()
                    .filter(|one| !store.rows.iter().any(|row| batch.is(row, one)))
                    .collect();
                if !missing.is_empty() {
                    let rows =
                        batch.rows(&missing, &pool, &store.path("reference"), &|| bar.inc(1))?;
                    store.rows.extend(rows);
                    store.save()?;
                }
                bar.set_position(end);
            }
        }
    }
    bar.finish_and_clear();
    Ok(store.rows.len() - before)
}

/// One view of one surface, and the conditions of its measurement.
pub struct RunBatch<'a> {
    /// The surface.
    pub surface: &'a ChartSurface,
    /// The view.
    pub view: &'a View,
    /// The conditions.
    pub conditions: Conditions,
    /// The machine.
    pub machine: &'a Environment,
}

impl RunBatch<'_> {
    fn is(&self, row: &Row, configuration: &Configuration) -> bool {
        row.surface == self.surface.name
            && row.view == self.view.name
            && row.conditions() == self.conditions
            && row.configuration().is_ok_and(|other| other == *configuration)
    }

    /// Measures configurations, and compares their pictures with the reference. The reference is
    /// stored in the directory `references`.
    ///
    /// # Errors
    /// If the directory cannot be written, or a picture cannot be drawn.
    pub fn rows(
        &self,
        configurations: &[Configuration],
        pool: &ThreadPool,
        references: &Path,
        advance: &(dyn Fn() + Sync),
    ) -> Result<Vec<Row>, ChartError> {
        let Self { surface, view, conditions, machine } = *self;
        let Conditions { size, repeats, samples, seed, .. } = conditions;
        let sampling = Sampling { size, samples, seed, budget: BUDGET };
        let reference = RootReference::kept(references, surface, view, sampling)?;
        advance();
        let measured = pool.install(|| {
            measure(surface, &view.camera, size, configurations, repeats, seed, &advance)
        })?;
        let rays = RayGrid::new(&view.camera, size, size);
        let rows = configurations.iter().zip(measured).map(|(configuration, measured)| {
            let errors = PixelErrors::new(&reference, &rays, &measured.picture.buffer);
            let row =
                Row::new(surface, view, conditions, configuration, &measured, &errors, machine);
            measured.picture.hand_back();
            row
        });
        Ok(rows.collect())
    }
}
