//! Compile time and code against size, as figures.

use super::{FormulaSource, GrowthRow};
use crate::plot::{Figure, MarkShape, PlotMark, PlotSeries};

/// A quantity's name and its value in a row.
type Quantity = (&'static str, fn(&GrowthRow) -> f64);

/// The quantities that grow with size.
pub const QUANTITIES: [Quantity; 4] = [
    ("parse", |row| row.parse_ms),
    ("simplify", |row| row.simplify_ms),
    ("compile", |row| row.compile_ms),
    ("code", |row| row.code_bytes as f64),
];

/// Least number of nodes for fitting the exponent. Fixed costs dominate smaller formulas.
const FIT_FROM_NODES: usize = 100;

/// The exponent of growth: slope of the least-squares line through the logarithms. `None` if fewer
/// than two different sizes are at least [`FIT_FROM_NODES`].
pub fn slope(rows: &[GrowthRow], value: fn(&GrowthRow) -> f64) -> Option<f64> {
    let points: Vec<[f64; 2]> = rows
        .iter()
        .filter(|row| row.nodes >= FIT_FROM_NODES)
        .map(|row| [row.nodes as f64, value(row)].map(f64::ln))
        .collect();
    let mean = |axis: usize| points.iter().map(|at| at[axis]).sum::<f64>() / points.len() as f64;
    let [x, y] = [mean(0), mean(1)];
    let both: f64 = points.iter().map(|at| (at[0] - x) * (at[1] - y)).sum();
    let own: f64 = points.iter().map(|at| (at[0] - x).powi(2)).sum();
    (own > 0.0 && both.is_finite()).then_some(both / own)
}

/// Chart of the times to parse, simplify and compile.
pub fn times(rows: &[GrowthRow]) -> Figure {
    Figure {
        name: "compile-time".to_owned(),
        title: "From text to the kernels of a picture, by size".to_owned(),
        y: "time, ms (1 thread)".to_owned(),
        ..figure(rows, &QUANTITIES[..3])
    }
}

/// Chart of the size of the code.
pub fn code(rows: &[GrowthRow]) -> Figure {
    Figure {
        name: "compile-code".to_owned(),
        title: "Code of the kernels of a picture, by size".to_owned(),
        y: "machine code, bytes".to_owned(),
        ..figure(rows, &QUANTITIES[3..])
    }
}

fn figure(rows: &[GrowthRow], quantities: &[Quantity]) -> Figure {
    let mut series = Vec::new();
    for (color, (name, value)) in quantities.iter().enumerate() {
        let slope =
            slope(rows, *value).map_or(String::new(), |slope| format!(" ~ nodes^{slope:.2}"));
        for (source, shape) in [
            (FormulaSource::Gallery, MarkShape::Disc),
            (FormulaSource::Sum, MarkShape::Square),
            (FormulaSource::Product, MarkShape::Triangle),
        ] {
            let of_source = rows.iter().filter(|row| row.source == source);
            let mut marks: Vec<PlotMark> = of_source
                .map(|row| PlotMark { at: [row.nodes as f64, value(row)], ..PlotMark::default() })
                .collect();
            marks.sort_by(|a, b| a.at[0].total_cmp(&b.at[0]));
            let is_joined = source != FormulaSource::Gallery;
            let called = if is_joined { String::new() } else { format!("{name}{slope}") };
            series.push(PlotSeries {
                name: called,
                color,
                shape,
                is_joined,
                marks,
                ..PlotSeries::default()
            });
        }
    }
    let notes = [
        "discs: the gallery's surfaces",
        "squares: sums of squares of planes",
        "triangles: products of planes",
        "",
        "kernels: those that affine asks for",
    ];
    let mut notes: Vec<String> = notes.map(str::to_owned).into();
    notes.push(format!("exponents: from {FIT_FROM_NODES} nodes on"));
    let rounds = rows.first().map_or(0, |row| row.repeats);
    notes.push(format!("times: the least of {rounds} rounds"));
    let x = "nodes of the simplified graph".to_owned();
    Figure { x, series, notes, ..Figure::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(nodes: usize, parse_ms: f64) -> GrowthRow {
        let text = String::new;
        GrowthRow {
            name: text(),
            source: FormulaSource::Sum,
            nodes_typed: nodes,
            nodes,
            parse_ms,
            simplify_ms: 1.0,
            compile_ms: 1.0,
            kernels: 1,
            code_bytes: 1,
            forms: true,
            repeats: 1,
            seed: 1,
            version: text(),
            rustc: text(),
            flags: text(),
            processor: text(),
        }
    }

    #[test]
    fn the_slope_is_the_exponent() {
        let rows = [10, 100, 1000, 10_000].map(|n| row(n, 0.5 * (n as f64).powf(1.5)));
        let exponent = slope(&rows, QUANTITIES[0].1).expect("three sizes of 100 and more");
        assert!((exponent - 1.5).abs() < 1e-9, "{exponent}");
        assert_eq!(slope(&rows, QUANTITIES[1].1), Some(0.0));
        assert_eq!(slope(&rows[..2], QUANTITIES[0].1), None);
    }
}
