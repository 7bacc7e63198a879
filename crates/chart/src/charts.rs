//! The charts, and the rows that each shows.

mod errors;
mod options;
mod resolution;

use crate::error::ChartError;
use crate::grid::Configuration;
use crate::groups::{distinct, grouped};
use crate::plot::{Figure, MarkShape, PlotSeries};
use crate::quantile::{Quartiles, geometric_mean};
use crate::row::Row;
use std::path::Path;
use zeroset_trace::{DEPTH, METHODS, Precision, STEPS, TOLERANCE};

/// All charts that have rows: first the charts over all surfaces, then the charts of single
/// surfaces.
pub fn charts(rows: &[Row]) -> [Vec<Figure>; 2] {
    let rows = MeasuredRows::of(rows);
    let Some(size) = rows.common_size() else { return Default::default() };
    let same = rows.filter(|row| row.size == size);
    let mut all = errors::over_all(&same);
    all.extend(options::charts(&same));
    all.extend(resolution::chart(&rows));
    [all, errors::by_surface(&same)]
}

/// Draws all charts that have rows into a directory; returns the number of charts.
///
/// # Errors
/// If a chart cannot be drawn or written.
pub fn draw_all(rows: &[Row], directory: &Path) -> Result<usize, ChartError> {
    let charts = charts(rows).concat();
    for chart in &charts {
        chart.save(directory)?;
    }
    Ok(charts.len())
}

/// Rows whose method this version knows, each with its configuration.
#[derive(Clone, Debug)]
struct MeasuredRows<'a>(Vec<(&'a Row, Configuration)>);

impl<'a> MeasuredRows<'a> {
    fn of(rows: &'a [Row]) -> Self {
        Self(rows.iter().filter_map(|row| Some((row, row.configuration().ok()?))).collect())
    }

    fn filter(&self, keep: impl Fn(&Row) -> bool) -> Self {
        Self(self.0.iter().filter(|(row, _)| keep(row)).copied().collect())
    }

    fn of_configuration(&self, configuration: &Configuration) -> Self {
        Self(self.0.iter().filter(|(_, other)| other == configuration).copied().collect())
    }

    fn surfaces(&self) -> Vec<&'a str> {
        distinct(self.0.iter().map(|(row, _)| row.surface.as_str()))
    }

    /// The picture size of most rows. If several sizes are equally common, the largest of them.
    fn common_size(&self) -> Option<usize> {
        let sizes = distinct(self.0.iter().map(|(row, _)| row.size));
        let number = |size: &usize| self.0.iter().filter(|(row, _)| row.size == *size).count();
        sizes.into_iter().max_by_key(|size| (number(size), *size))
    }

    /// The rows of each method in one precision: `auto` if measured, else the first measured one.
    fn in_one_precision(&self) -> Self {
        let best = |method: &str| {
            let of_method = self.0.iter().filter(|(_, other)| other.method.name == method);
            let measured: Vec<_> = of_method.map(|(_, other)| other.precision).collect();
            let auto = measured.iter().find(|p| **p == Some(Precision::Auto));
            auto.or(measured.first()).copied().flatten()
        };
        let best: Vec<_> = METHODS.iter().map(|method| (method.name, best(method.name))).collect();
        let is_best = |one: &Configuration| best.contains(&(one.method.name, one.precision));
        Self(self.0.iter().filter(|(_, one)| is_best(one)).copied().collect())
    }

    /// For each surface, the geometric mean of a quantity over the surface's rows.
    fn by_surface(&self, value: impl Fn(&Row) -> Option<f64>) -> Vec<f64> {
        let surfaces = self.surfaces().into_iter();
        surfaces.filter_map(|surface| self.mean_on(surface, &value)).collect()
    }

    fn mean_on(&self, surface: &str, value: impl Fn(&Row) -> Option<f64>) -> Option<f64> {
        let rows = self.0.iter().filter(|(row, _)| row.surface == surface);
        mean(&rows.filter_map(|(row, _)| value(row)).collect::<Vec<_>>())
    }
}

/// Stands for an error of 0 in geometric means, in pixels. Pictures cannot show such a small error.
const LEAST: f64 = 1e-6;

/// The geometric mean, with values raised to at least [`LEAST`]; 0 if all values are 0.
fn mean(values: &[f64]) -> Option<f64> {
    if values.iter().all(|value| *value == 0.0) {
        return values.first().copied();
    }
    geometric_mean(&values.iter().map(|value| value.max(LEAST)).collect::<Vec<_>>())
}

/// The lower and upper quartile; `None` if there are fewer than two values.
fn bar(values: &[f64]) -> Option<[f64; 2]> {
    let quartiles = Quartiles::of(values).filter(|_| values.len() > 1)?;
    Some([quartiles.lower, quartiles.upper])
}

/// Color number of a method, the same in every chart.
fn color(method: &str) -> usize {
    METHODS.iter().position(|other| other.name == method).unwrap_or(METHODS.len())
}

fn shape(precision: Option<Precision>) -> MarkShape {
    match precision {
        Some(Precision::F32) => MarkShape::Square,
        Some(Precision::F64) => MarkShape::Triangle,
        Some(Precision::Auto) | None => MarkShape::Disc,
    }
}

/// An empty series for a method in a precision.
fn series(configuration: &Configuration) -> PlotSeries {
    let method = configuration.method.name;
    let precision = configuration.precision.map(|p| format!(", {p}")).unwrap_or_default();
    PlotSeries {
        name: format!("{method}{precision}"),
        color: color(method),
        shape: shape(configuration.precision),
        is_joined: true,
        ..PlotSeries::default()
    }
}

/// Configurations grouped by method and precision. Within a group, only numeric options differ.
fn families(rows: &MeasuredRows<'_>) -> Vec<Vec<Configuration>> {
    let configurations = distinct(rows.0.iter().map(|(_, configuration)| *configuration));
    let families = grouped(configurations, |one| (one.method, one.precision));
    families.into_iter().map(|(_, family)| family).collect()
}

/// Lines of the legend that explain the letters in labels.
fn letters(rows: &MeasuredRows<'_>) -> Vec<&'static str> {
    let letters = [(TOLERANCE, "t: tolerance in pixels"), (DEPTH, "d: depth"), (STEPS, "s: steps")];
    let has = |option| rows.0.iter().any(|(_, one)| one.number(option).is_some());
    letters.into_iter().filter(|(option, _)| has(*option)).map(|(_, letter)| letter).collect()
}

/// Notes of a legend: properties that the pictures share, then the lines of `further`.
fn notes<'a>(rows: &MeasuredRows<'_>, further: impl IntoIterator<Item = &'a str>) -> Vec<String> {
    let Some((row, _)) = rows.0.first() else { return Vec::new() };
    let surfaces = rows.surfaces();
    // Surfaces may have different views, so views are counted surface by surface.
    let views_of = |surface: &&str| {
        let own = rows.0.iter().filter(|(row, _)| row.surface == **surface);
        distinct(own.map(|(row, _)| row.view.as_str())).len()
    };
    let views = surfaces.iter().map(views_of).max().unwrap_or_default();
    let surfaces = match surfaces[..] {
        [surface] => surface.to_owned(),
        _ => format!("{} surfaces", surfaces.len()),
    };
    let number = |n: usize, noun: &str| format!("{n} {noun}{}", if n == 1 { "" } else { "s" });
    let common = [
        format!("{surfaces}, {}", number(views, "view")),
        format!("{0}×{0} pixels, {1}", row.size, number(row.threads, "thread")),
    ];
    common.into_iter().chain(further.into_iter().map(str::to_owned)).collect()
}
