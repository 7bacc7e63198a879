//! Time against error, over all surfaces and surface by surface.

use super::{MeasuredRows, bar, families, letters, mean, notes, series};
use crate::grid::Configuration;
use crate::groups::distinct;
use crate::pareto::front;
use crate::plot::{Figure, MarkShape, PlotMark, PlotSeries};
use crate::row::Row;

/// A kind of error that has charts of its own.
#[derive(Clone, Copy)]
struct ErrorMeasure {
    name: &'static str,
    title: &'static str,
    axis: &'static str,
    of: fn(&Row) -> Option<f64>,
    mean: fn(&[f64]) -> Option<f64>,
    mean_name: &'static str,
}

const DISTANCE: ErrorMeasure = ErrorMeasure {
    name: "time-distance",
    title: "Time against distance error",
    axis: "distance from the root, 99.9 % of painted pixels, in pixels' footprints",
    of: |row| row.off_pixels_999,
    mean,
    mean_name: "error: geometric mean",
};
const MEDIAN: ErrorMeasure = ErrorMeasure {
    name: "time-median",
    title: "Time against median distance error",
    axis: "distance from the root, median of painted pixels, in pixels' footprints",
    of: |row| row.off_pixels_median,
    ..DISTANCE
};
const WRONG: ErrorMeasure = ErrorMeasure {
    name: "time-wrong",
    title: "Time against wrong pixels",
    axis: "wrong pixels (missed, phantom, wrong root), share of all",
    of: |row| Some(row.wrong_share()),
    // Shares can be 0, so their mean is arithmetic.
    mean: |shares| {
        let sum: f64 = shares.iter().sum();
        (!shares.is_empty()).then(|| sum / shares.len() as f64)
    },
    mean_name: "error: arithmetic mean",
};
const KINDS: [ErrorMeasure; 3] = [DISTANCE, MEDIAN, WRONG];

/// The charts over all surfaces: means over surfaces, with a thin line for each surface.
pub fn over_all(rows: &MeasuredRows<'_>) -> Vec<Figure> {
    let rows = rows.in_one_precision();
    let charts = KINDS.iter().map(|kind| chart(&rows, kind, None));
    charts.chain([claims(&rows)]).collect()
}

/// The charts of each single surface, with a thin line for each view.
pub fn by_surface(rows: &MeasuredRows<'_>) -> Vec<Figure> {
    let rows = rows.in_one_precision();
    let of_surface = |surface: &str| {
        let rows = rows.filter(|row| row.surface == surface);
        KINDS.map(|kind| chart(&rows, &kind, Some(surface)))
    };
    rows.surfaces().into_iter().flat_map(of_surface).collect()
}

/// The chart of one surface, or of all surfaces if `surface` is `None`.
fn chart(rows: &MeasuredRows<'_>, kind: &ErrorMeasure, surface: Option<&str>) -> Figure {
    let part = |row: &Row| if surface.is_some() { row.view.clone() } else { row.surface.clone() };
    let parts = distinct(rows.0.iter().map(|(row, _)| part(row)));
    let parts: Vec<MeasuredRows<'_>> =
        parts.iter().map(|name| rows.filter(|row| part(row) == *name)).collect();
    let families = families(rows);
    let series: Vec<PlotSeries> = families.iter().map(|one| of_family(&parts, one, kind)).collect();
    let points: Vec<[f64; 2]> = series.iter().flat_map(|s| s.marks.iter().map(|m| m.at)).collect();
    let front = front(&points).into_iter().map(|index| points[index]).collect();
    let thin = if surface.is_some() { "thin lines: views" } else { "thin lines: surfaces" };
    let bars = "bars from quartile to quartile";
    let lines = [thin, "time: geometric mean,", bars, kind.mean_name];
    let title = surface.map(|name| format!(": {name}")).unwrap_or_default();
    Figure {
        name: format!("{}-{}", kind.name, surface.unwrap_or("all")),
        title: format!("{}{title}", kind.title),
        x: kind.axis.to_owned(),
        y: "time to trace, ms".to_owned(),
        series,
        front: Some(("Pareto front".to_owned(), front)),
        notes: notes(rows, lines.into_iter().chain(letters(rows))),
        ..Figure::default()
    }
}

/// The series of a family: means over `parts`, surfaces or views, with a thin line for each part.
fn of_family(
    parts: &[MeasuredRows<'_>],
    family: &[Configuration],
    kind: &ErrorMeasure,
) -> PlotSeries {
    let mut behind = vec![Vec::new(); parts.len()];
    let mut marks = Vec::new();
    for one in family {
        let (mut times, mut errors) = (Vec::new(), Vec::new());
        for (part, line) in parts.iter().zip(&mut behind) {
            let rows = part.of_configuration(one);
            let values = |of: fn(&Row) -> Option<f64>| {
                rows.0.iter().filter_map(|(row, _)| of(row)).collect::<Vec<_>>()
            };
            let time = mean(&values(|row| Some(row.trace_ms)));
            if let (Some(time), Some(error)) = (time, (kind.mean)(&values(kind.of))) {
                line.push([error, time]);
                times.push(time);
                errors.push(error);
            }
        }
        if let (Some(time), Some(error)) = (mean(&times), (kind.mean)(&errors)) {
            marks.push(PlotMark { at: [error, time], bar: bar(&times), label: one.label() });
        }
    }
    PlotSeries { marks, behind, ..series(&family[0]) }
}

/// Chart of wrong claims. A bar's ends count undecided pixels as all right, and as all wrong.
fn claims(rows: &MeasuredRows<'_>) -> Figure {
    let (mut places, mut all) = (Vec::new(), Vec::new());
    let mut painted =
        PlotSeries { name: "as painted".to_owned(), color: 6, ..PlotSeries::default() };
    for family in families(rows) {
        let mut claimed =
            PlotSeries { shape: MarkShape::Bar, is_joined: false, ..series(&family[0]) };
        for one in &family {
            let of_one = rows.of_configuration(one);
            let sum = |count: fn(&Row) -> usize| {
                of_one.0.iter().map(|(row, _)| count(row)).sum::<usize>() as f64
            };
            let decided = sum(|row| row.looked_at - row.open).max(1.0);
            let low = sum(|row| row.false_claims) / decided;
            let high = low + sum(|row| row.undecided) / decided;
            let wrong = sum(|row| row.missed + row.phantom + row.wrong_root) / decided;
            let place = places.len() as f64;
            claimed.marks.push(PlotMark {
                at: [place, low],
                bar: Some([low, high]),
                ..PlotMark::default()
            });
            painted.marks.push(PlotMark { at: [place, wrong], ..PlotMark::default() });
            places.push(format!("{} {}", one.method.name, one.label()));
        }
        all.push(claimed);
    }
    all.push(painted);
    let lines = ["bars: as claimed, from all that is", "undecided being right to all wrong"];
    Figure {
        name: "claims-all".to_owned(),
        title: "Wrong pixels, as claimed and as painted".to_owned(),
        x: format!("method and its option ({})", letters(rows).join(", ")),
        y: "wrong pixels, share of all".to_owned(),
        places,
        series: all,
        notes: notes(rows, lines),
        ..Figure::default()
    }
}
