//! Time against the number of parts, as measured beside rivals.
//!
//! `benches/rivals` measures and writes the rows. It is a workspace of its own, so its table is all
//! that this module knows of it.

use crate::arguments::PartsArguments;
use crate::error::ChartError;
use crate::groups::distinct;
use crate::plot::{Figure, MarkShape, PlotMark, PlotSeries};
use serde::Deserialize;
use std::path::Path;

/// The columns that the chart shows. Others are ignored.
#[derive(Clone, Debug, PartialEq, Deserialize)]
struct PartsRow {
    /// Name of the models that differ in their number of parts only.
    family: String,
    /// Number of parts. `None` for a model of no family.
    parts: Option<usize>,
    /// Name of the renderer.
    side: String,
    /// Time of a picture.
    milliseconds: f64,
    /// Half the interquartile range, as a share of the time.
    spread: f64,
}

/// Shapes of the families' marks, in the order of the families.
const SHAPES: [(MarkShape, &str); 3] = [
    (MarkShape::Disc, "discs"),
    (MarkShape::Square, "squares"),
    (MarkShape::Triangle, "triangles"),
];

/// Draws `parts.svg`, and says where it is.
///
/// # Errors
/// If the table cannot be read, has no models of several sizes, or the chart cannot be written.
pub fn parts(arguments: &PartsArguments) -> Result<String, ChartError> {
    let rows = read(&arguments.rows)?;
    let figure = figure(&rows);
    if figure.series.is_empty() {
        let why = "no model has several numbers of parts";
        return Err(ChartError::of_content(&arguments.rows)(why));
    }
    figure.save(&arguments.output)?;
    Ok(format!("the chart is in {}\n", arguments.output.display()))
}

fn read(path: &Path) -> Result<Vec<PartsRow>, ChartError> {
    let text = std::fs::read_to_string(path).map_err(ChartError::of_file(path))?;
    let mut table = csv::Reader::from_reader(text.as_bytes());
    table.deserialize().collect::<Result<_, _>>().map_err(ChartError::of_content(path))
}

/// A line for each renderer in each family that has models of several sizes.
fn figure(rows: &[PartsRow]) -> Figure {
    let points = |family: &str, side: Option<&str>| -> Vec<PlotMark> {
        let own = rows.iter().filter(|row| row.family == family);
        let own = own.filter(|row| side.is_none_or(|side| row.side == side));
        let mark = |row: &PartsRow| {
            let (time, off) = (row.milliseconds, row.milliseconds * row.spread);
            let bar = Some([time - off, time + off]);
            Some(PlotMark { at: [row.parts? as f64, time], bar, label: String::new() })
        };
        let mut marks: Vec<PlotMark> = own.filter_map(mark).collect();
        marks.sort_by(|a, b| a.at[0].total_cmp(&b.at[0]));
        marks
    };
    let is_several = |family: &&str| {
        let marks = points(family, None);
        marks.first().zip(marks.last()).is_some_and(|(few, many)| few.at[0] < many.at[0])
    };
    let mut families = distinct(rows.iter().map(|row| &*row.family));
    families.retain(is_several);
    let sides = distinct(rows.iter().map(|row| &*row.side));
    let (mut series, mut notes) = (Vec::new(), Vec::new());
    for (family, (shape, shape_name)) in families.iter().zip(SHAPES) {
        for (color, side) in sides.iter().enumerate() {
            let marks = points(family, Some(side));
            let is_named = notes.is_empty() && !marks.is_empty();
            let name = if is_named { (*side).to_owned() } else { String::new() };
            let behind = Vec::new();
            series.push(PlotSeries { name, color, shape, is_joined: true, marks, behind });
        }
        notes.push(format!("{shape_name}: {family}"));
    }
    notes.push("bars: the middle half of the rounds".to_owned());
    Figure {
        name: "parts".to_owned(),
        title: "Time of a picture of many parts".to_owned(),
        x: "parts".to_owned(),
        y: "time, ms (1 thread)".to_owned(),
        series,
        notes,
        ..Figure::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(family: &str, parts: Option<usize>, side: &str) -> PartsRow {
        let (family, side) = (family.to_owned(), side.to_owned());
        let milliseconds = parts.unwrap_or(1) as f64;
        PartsRow { family, parts, side, milliseconds, spread: 0.1 }
    }

    #[test]
    fn each_side_of_a_family_has_a_line_from_few_to_many() {
        let rows = [
            row("spheres", Some(100), "ours"),
            row("spheres", Some(10), "ours"),
            row("spheres", Some(10), "theirs"),
            row("sponge", Some(5), "ours"),
            row("file", None, "ours"),
        ];
        let figure = figure(&rows);
        let names: Vec<&str> = figure.series.iter().map(|series| &*series.name).collect();
        assert_eq!(names, ["ours", "theirs"]);
        let places: Vec<f64> = figure.series[0].marks.iter().map(|mark| mark.at[0]).collect();
        assert_eq!(places, [10.0, 100.0]);
        assert_eq!(figure.notes[0], "discs: spheres");
    }
}
