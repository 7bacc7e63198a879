//! The cost of sound rounding as a figure.

use super::{RigourRow, Workload, name};
use crate::groups::distinct;
use crate::plot::{Figure, MarkShape, PlotMark, PlotSeries};
use crate::quantile::{geometric_mean, quantile};
use zeroset_jit::comparison::Arithmetic;

/// The pairs of workload and precision that have rows, in the order of the axis.
pub fn places(rows: &[RigourRow]) -> Vec<(Workload, &'static str)> {
    let asked = [Workload::Boxes, Workload::Segments, Workload::Tiles, Workload::Picture];
    let all = asked.into_iter().flat_map(|asked| ["f32", "f64"].map(|floats| (asked, floats)));
    let is_there = |(asked, floats): &(Workload, &str)| {
        rows.iter().any(|row| row.asked == *asked && row.precision == *floats)
    };
    all.filter(is_there).collect()
}

/// The rows of one workload, precision and arithmetic, one row per surface.
pub fn of<'a>(
    rows: &'a [RigourRow],
    asked: Workload,
    precision: &str,
    arithmetic: Arithmetic,
) -> Vec<&'a RigourRow> {
    let is_of = |row: &&RigourRow| {
        row.asked == asked && row.precision == precision && row.arithmetic == name(arithmetic)
    };
    rows.iter().filter(is_of).collect()
}

/// Figure of times relative to the unsound arithmetic.
pub fn figure(rows: &[RigourRow]) -> Figure {
    let places = places(rows);
    let series = |arithmetic, called: &str, color, shape, aside: f64| {
        let marks = places.iter().enumerate().filter_map(|(place, (asked, precision))| {
            let rows = of(rows, *asked, precision, arithmetic);
            let values: Vec<f64> = rows.iter().map(|row| row.times_unsound).collect();
            let bar = [quantile(&values, 0.0)?, quantile(&values, 1.0)?];
            let mean = geometric_mean(&values)?;
            // Series stand side by side, so that none covers another.
            let at = [place as f64 + aside, mean];
            Some(PlotMark { at, bar: Some(bar), label: format!("{mean:.2}") })
        });
        PlotSeries {
            name: called.to_owned(),
            color,
            shape,
            marks: marks.collect(),
            ..PlotSeries::default()
        }
    };
    let number = distinct(rows.iter().map(|row| row.surface.as_str())).len();
    let size = rows.first().map_or(0, |row| row.size);
    let notes = [
        "1: to nearest and left so, no terms".to_owned(),
        "for rounding in forms (not sound)".to_owned(),
        String::new(),
        format!("{number} surface{}, 1 thread,", if number == 1 { "" } else { "s" }),
        format!("pictures of {size}×{size} by affine"),
        "geometric mean over surfaces,".to_owned(),
        "bars from least to greatest".to_owned(),
    ];
    Figure {
        name: "rigour".to_owned(),
        title: "The price of rigour".to_owned(),
        x: "what is asked of kernels, whole pictures, and in which floats".to_owned(),
        y: "time, as a multiple of that without rigour".to_owned(),
        places: places.iter().map(|(asked, precision)| format!("{asked} {precision}")).collect(),
        series: vec![
            series(Arithmetic::Widened, "to nearest, then widened", 1, MarkShape::Square, -0.12),
            series(Arithmetic::Upward, "rounded up (zeroset)", 0, MarkShape::Disc, 0.12),
        ],
        level: Some(1.0),
        notes: notes.into(),
        ..Figure::default()
    }
}
