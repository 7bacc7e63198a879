//! Measures results again. Counts must not change, and times must be about as long as before.

use crate::error::ChartError;
use crate::groups::grouped;
use crate::machine::Environment;
use crate::measure::pool;
use crate::progress::progress;
use crate::row::Row;
use crate::run::RunBatch;
use crate::store::Store;
use crate::surfaces::ChartSurface;
use crate::views::View;
use std::path::Path;

/// Greatest accepted relative change of a time. Runs on an otherwise idle machine differ by less.
pub const TIME_TOLERANCE: f64 = 0.15;

/// Differences between stored results and a second measurement.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Differences {
    /// Number of rows compared.
    pub rows: usize,
    /// Counts or hashes that differ, one line each.
    pub counts: Vec<String>,
    /// Rows whose time changed by more than [`TIME_TOLERANCE`], one line each. A change that all
    /// rows of a view share is divided out.
    pub times: Vec<String>,
}

/// Measures every row of `directory` again, without writing any.
///
/// # Errors
/// If there are no rows, or this version cannot repeat them.
pub fn check(directory: &Path) -> Result<Differences, ChartError> {
    let store = Store::existing(directory)?;
    let machine = Environment::this();
    let mut differences = Differences::default();
    // Rows with the same surface, view and conditions are measured together, as they were before.
    let batches = grouped(&store.rows, |row| (&row.surface, &row.view, row.conditions()));
    let bar = progress(batches.len());
    for ((surface, view, conditions), old) in batches {
        let surface = ChartSurface::named(surface)?;
        let view = View { name: view.clone(), camera: old[0].camera()? };
        bar.set_message(format!("{} {}", surface.name, view.name));
        let configurations =
            old.iter().map(|row| row.configuration()).collect::<Result<Vec<_>, _>>()?;
        let batch = RunBatch { surface: &surface, view: &view, conditions, machine: &machine };
        let new = batch.rows(
            &configurations,
            &pool(conditions.threads),
            &store.path("reference"),
            &|| {},
        )?;
        differences.add(&old, &new);
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(differences)
}

impl Differences {
    /// Compares the rows of one view. Records counts and hashes that differ, and times that changed
    /// more than the other times of the view.
    fn add(&mut self, old: &[&Row], new: &[Row]) {
        // A change that all times of a view share comes from the machine, so it is divided out.
        let ratios: Vec<f64> = old.iter().zip(new).map(|(a, b)| b.total_ms / a.total_ms).collect();
        let common = crate::quantile::quantile(&ratios, 0.5).unwrap_or(1.0);
        for ((old, new), ratio) in old.iter().zip(new).zip(ratios) {
            self.rows += 1;
            let what = old.configuration().map(|one| one.to_string()).unwrap_or_default();
            let key = format!("{} {} {}, {what}", old.surface, old.view, old.size);
            for ((what, before), (_, now)) in old.work().into_iter().zip(new.work()) {
                if before != now {
                    self.counts.push(format!("{key}: {what} {before}, now {now}"));
                }
            }
            if old.status_hash != new.status_hash {
                let (before, now) = (&old.status_hash, &new.status_hash);
                self.counts.push(format!("{key}: hash {before}, now {now}"));
            }
            let ratio = ratio / common;
            if !(1.0 - TIME_TOLERANCE..=1.0 + TIME_TOLERANCE).contains(&ratio) {
                let (before, now) = (old.total_ms, new.total_ms);
                self.times.push(format!(
                    "{key}: {before:.2} ms, now {now:.2} ms: {ratio:.2} times as long as before, beside its view's others"
                ));
            }
        }
    }
}
