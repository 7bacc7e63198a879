//! Charts of options: work against tolerance and depth, and time by precision.

use super::{MeasuredRows, bar, color, families, mean, notes, series, shape};
use crate::grid::Configuration;
use crate::groups::distinct;
use crate::plot::{Figure, PlotMark, PlotSeries};
use crate::quantile::quantile;
use crate::row::Row;
use zeroset_trace::{MethodOption, Precision};

/// Charts of work against each numeric option, and one that compares precisions.
pub fn charts(rows: &MeasuredRows<'_>) -> Vec<Figure> {
    let read = rows.0.iter().flat_map(|(_, one)| one.method.reads.iter().copied());
    let work = distinct(read).into_iter().filter_map(|option| work(rows, option));
    work.chain(precisions(rows)).collect()
}

/// Number of lanes evaluated per pixel. Lanes of gradient kernels do not count.
fn lanes(row: &Row) -> Option<f64> {
    let lanes = row
        .work()
        .into_iter()
        .filter(|(name, _)| name.ends_with("lanes") && !name.starts_with("gradient"));
    let lanes: u64 = lanes.map(|(_, number)| number).sum();
    Some(lanes as f64 / (row.size * row.size) as f64).filter(|lanes| *lanes > 0.0)
}

/// A figure of the lanes per pixel at each value of an option, with a line for each family.
fn work(rows: &MeasuredRows<'_>, option: MethodOption) -> Option<Figure> {
    let mut numbers: Vec<f64> = rows.0.iter().filter_map(|(_, one)| one.number(option)).collect();
    numbers.sort_by(f64::total_cmp);
    numbers.dedup();
    // Whole option values are placed evenly, not on a logarithmic axis.
    let is_counted = numbers.iter().all(|number| number.fract() == 0.0);
    let mut all = Vec::new();
    for family in families(rows) {
        let mut line = series(&family[0]);
        // Bars of several precisions would overlap. Only `auto`, or no precision, has bars.
        let has_bars = matches!(family[0].precision, None | Some(Precision::Auto));
        for one in &family {
            let Some(number) = one.number(option) else { continue };
            let place = numbers.iter().position(|other| *other == number);
            let x = if is_counted { place.unwrap_or(0) as f64 } else { number };
            let values = rows.of_configuration(one).by_surface(lanes);
            if let Some(y) = mean(&values) {
                let bar = bar(&values).filter(|_| has_bars);
                line.marks.push(PlotMark { at: [x, y], bar, ..PlotMark::default() });
            }
        }
        line.marks.sort_by(|a, b| a.at[0].total_cmp(&b.at[0]));
        if line.marks.len() > 1 {
            all.push(line);
        }
    }
    let lines = [
        "geometric mean over surfaces,",
        "bars from quartile to quartile",
        "",
        "f: in boxes, on tiles,",
        "along segments, at points",
    ];
    let names = numbers.iter().map(f64::to_string).collect();
    let figure = Figure {
        name: format!("work-{}", option.name),
        title: format!("Work against {}", option.name),
        x: option.axis.to_owned(),
        y: "evaluations of f a pixel (lanes of kernels)".to_owned(),
        places: if is_counted { names } else { Vec::new() },
        series: all,
        notes: notes(rows, lines),
        ..Figure::default()
    };
    (!figure.series.is_empty()).then_some(figure)
}

/// Times in `f64` and `auto` relative to `f32`, surface by surface.
fn precisions(rows: &MeasuredRows<'_>) -> Option<Figure> {
    let surfaces = rows.surfaces();
    let mut all: Vec<PlotSeries> = Vec::new();
    for family in families(rows) {
        let Some(precision) = family[0].precision.filter(|p| *p != Precision::F32) else {
            continue;
        };
        let method = family[0].method;
        let ratios = |surface: &str| -> Vec<f64> {
            let time = |one: &Configuration| {
                rows.of_configuration(one).mean_on(surface, |row| Some(row.trace_ms))
            };
            let ratio = |one: &Configuration| {
                Some(time(one)? / time(&Configuration { precision: Some(Precision::F32), ..*one })?)
            };
            family.iter().filter_map(ratio).collect()
        };
        let marks = surfaces.iter().enumerate().filter_map(|(place, surface)| {
            let ratios = ratios(surface);
            // Marks of one surface stand side by side, so that none covers another.
            let x = place as f64 + 0.12 * (all.len() as f64 - 1.5);
            Some(PlotMark { at: [x, mean(&ratios)?], bar: range(&ratios), label: String::new() })
        });
        let marks: Vec<PlotMark> = marks.collect();
        if !marks.is_empty() {
            let name = format!("{}, {precision}", method.name);
            let (color, shape) = (color(method.name), shape(Some(precision)));
            all.push(PlotSeries { name, color, shape, marks, ..PlotSeries::default() });
        }
    }
    let lines = ["geometric mean over options,", "bars from least to greatest"];
    let figure = Figure {
        name: "precision".to_owned(),
        title: "Time by precision, over that of f32".to_owned(),
        x: "surface".to_owned(),
        y: "time to trace, times that of f32".to_owned(),
        places: surfaces.into_iter().map(str::to_owned).collect(),
        series: all,
        level: Some(1.0),
        notes: notes(rows, lines),
        ..Figure::default()
    };
    (!figure.series.is_empty()).then_some(figure)
}

/// The least and the greatest value.
fn range(values: &[f64]) -> Option<[f64; 2]> {
    Some([quantile(values, 0.0)?, quantile(values, 1.0)?])
}
