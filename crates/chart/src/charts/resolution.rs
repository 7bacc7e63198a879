//! Time against resolution.

use super::{MeasuredRows, bar, families, mean, notes, series};
use crate::groups::distinct;
use crate::plot::{Figure, PlotMark};

/// Chart of the time per pixel against the size, for each method's middle configuration. `None` if
/// the rows have a single size.
pub fn chart(rows: &MeasuredRows<'_>) -> Option<Figure> {
    let rows = rows.in_one_precision();
    let mut sizes = distinct(rows.0.iter().map(|(row, _)| row.size));
    sizes.sort_unstable();
    if sizes.len() < 2 {
        return None;
    }
    let mut all = Vec::new();
    for family in families(&rows) {
        let one = &family[family.len() / 2];
        let of_one = rows.of_configuration(one);
        let mut line = series(one);
        line.name = one.to_string();
        for (place, &size) in sizes.iter().enumerate() {
            let of_size = of_one.filter(|row| row.size == size);
            let pixels = (size * size) as f64;
            let values = of_size.by_surface(|row| Some(row.trace_ms * 1e6 / pixels));
            if let Some(y) = mean(&values) {
                let at = [place as f64, y];
                line.marks.push(PlotMark { at, bar: bar(&values), label: String::new() });
            }
        }
        all.push(line);
    }
    let lines = ["geometric mean over surfaces,", "bars from quartile to quartile"];
    let mut notes = notes(&rows, lines);
    // The second note names one size only, so it is removed.
    notes.remove(1);
    Some(Figure {
        name: "time-size".to_owned(),
        title: "Time a pixel against resolution".to_owned(),
        x: "pixels in a row".to_owned(),
        places: sizes.iter().map(usize::to_string).collect(),
        y: "time to trace, ns a pixel".to_owned(),
        series: all,
        notes,
        ..Figure::default()
    })
}
