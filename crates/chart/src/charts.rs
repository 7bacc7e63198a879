//! Which charts there are, and what of the rows each shows.

mod errors;
mod options;
mod resolution;

use crate::grid::{Configuration, distinct};
use crate::plot::{Figure, Series, Shape};
use crate::quantile::{Quartiles, geometric_mean};
use crate::row::Row;
use zeroset_trace::{METHODS, Precision};

/// A figure, and what its file is called, without extension.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Within the directory of charts.
    pub name: String,
    /// What it shows.
    pub figure: Figure,
    /// Whether it is of one surface only.
    pub is_of_one: bool,
}

/// All charts that rows can fill.
pub fn charts(rows: &[Row]) -> Vec<Chart> {
    let rows = Rows::of(rows);
    let Some(size) = rows.common_size() else { return Vec::new() };
    let same = rows.filter(|row| row.size == size);
    let mut charts = errors::over_all(&same);
    charts.extend(options::charts(&same));
    charts.extend(resolution::chart(&rows));
    charts.extend(errors::by_surface(&same));
    charts
}

/// Rows whose method is known.
#[derive(Clone, Debug)]
struct Rows<'a>(Vec<(&'a Row, Configuration)>);

impl<'a> Rows<'a> {
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

    fn configurations(&self) -> Vec<Configuration> {
        distinct(self.0.iter().map(|(_, configuration)| *configuration))
    }

    /// The one that most rows have, the greatest of such.
    fn common_size(&self) -> Option<usize> {
        let sizes = distinct(self.0.iter().map(|(row, _)| row.size));
        let number = |size: &usize| self.0.iter().filter(|(row, _)| row.size == *size).count();
        sizes.into_iter().max_by_key(|size| (number(size), *size))
    }

    /// Those of each method in one precision: `auto` where it was measured.
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

    /// A quantity's geometric mean on each surface, over views.
    fn by_surface(&self, value: impl Fn(&Row) -> Option<f64>) -> Vec<f64> {
        let surfaces = self.surfaces().into_iter();
        surfaces.filter_map(|surface| self.mean_on(surface, &value)).collect()
    }

    fn mean_on(&self, surface: &str, value: impl Fn(&Row) -> Option<f64>) -> Option<f64> {
        let rows = self.0.iter().filter(|(row, _)| row.surface == surface);
        mean(&rows.filter_map(|(row, _)| value(row)).collect::<Vec<_>>())
    }
}

/// Below this, an error in pixels counts as this where means are taken: no picture shows it.
const LEAST: f64 = 1e-6;

/// The geometric mean of values, of which some may be 0; 0 if all are.
fn mean(values: &[f64]) -> Option<f64> {
    if values.iter().all(|value| *value == 0.0) {
        return values.first().copied();
    }
    geometric_mean(&values.iter().map(|value| value.max(LEAST)).collect::<Vec<_>>())
}

/// From its lower to its upper quartile, if there is more than one.
fn bar(values: &[f64]) -> Option<[f64; 2]> {
    let quartiles = Quartiles::of(values).filter(|_| values.len() > 1)?;
    Some([quartiles.lower, quartiles.upper])
}

/// Of a method, everywhere the same.
fn colour(method: &str) -> usize {
    METHODS.iter().position(|other| other.name == method).unwrap_or(METHODS.len())
}

fn shape(precision: Option<Precision>) -> Shape {
    match precision {
        Some(Precision::F32) => Shape::Square,
        Some(Precision::F64) => Shape::Triangle,
        Some(Precision::Auto) | None => Shape::Disc,
    }
}

/// A method in a precision: an empty series.
fn series(configuration: &Configuration) -> Series {
    let method = configuration.method.name;
    let precision = configuration.precision.map(|p| format!(", {p}")).unwrap_or_default();
    Series {
        name: format!("{method}{precision}"),
        colour: colour(method),
        shape: shape(configuration.precision),
        is_joined: true,
        ..Series::default()
    }
}

/// Configurations that differ in numbers only, method by method.
fn families(rows: &Rows<'_>) -> Vec<Vec<Configuration>> {
    let mut families: Vec<Vec<Configuration>> = Vec::new();
    for one in rows.configurations() {
        let same =
            |other: &Configuration| (other.method, other.precision) == (one.method, one.precision);
        match families.iter_mut().find(|family| family.iter().all(same)) {
            Some(family) => family.push(one),
            None => families.push(vec![one]),
        }
    }
    families
}

/// What the letters of labels stand for.
fn letters(rows: &Rows<'_>) -> Vec<&'static str> {
    let any = |has: fn(&Configuration) -> bool| rows.0.iter().any(|(_, one)| has(one));
    let letters = [
        any(|one| one.tolerance.is_some()).then_some("t: tolerance in pixels"),
        any(|one| one.depth.is_some()).then_some("d: depth"),
        any(|one| one.steps.is_some()).then_some("s: steps"),
    ];
    letters.into_iter().flatten().collect()
}

/// What pictures have in common, for a legend.
fn circumstances(rows: &Rows<'_>) -> Vec<String> {
    let Some((row, _)) = rows.0.first() else { return Vec::new() };
    let surfaces = rows.surfaces();
    // What the views are may differ from one surface to the next.
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
    vec![
        format!("{surfaces}, {}", number(views, "view")),
        format!("{0}×{0} pixels, {1}", row.size, number(row.threads, "thread")),
    ]
}
