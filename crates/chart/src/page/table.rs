//! A table of each configuration's means over all surfaces and views.

use super::escaped;
use crate::groups::grouped;
use crate::plot::written;
use crate::quantile::geometric_mean;
use crate::row::Row;

/// The table as HTML, with a line for each configuration and size.
pub fn table(rows: &[Row]) -> String {
    let mut text = vec![HEAD.to_owned()];
    let kind = |row: &&Row| (row.configuration().ok(), row.size);
    for ((configuration, size), rows) in grouped(rows, kind) {
        let Some(configuration) = configuration else { continue };
        let mean = |value: fn(&Row) -> f64| {
            geometric_mean(&rows.iter().map(|row| value(row)).collect::<Vec<_>>()).unwrap_or(0.0)
        };
        let sum = |count: fn(&Row) -> usize| rows.iter().map(|row| count(row)).sum::<usize>();
        let off = rows.iter().filter_map(|row| row.off_pixels_max).fold(0.0, f64::max);
        let cells = [
            escaped(&configuration.to_string()),
            format!("{size}"),
            format!("{:.2}", mean(|row| row.trace_ms)),
            format!("{:.2}", mean(|row| row.shade_ms.max(1e-6))),
            format!("{:.1}", mean(|row| row.cold_ms)),
            sum(|row| row.looked_at - row.open).to_string(),
            sum(|row| row.open).to_string(),
            sum(|row| row.missed).to_string(),
            sum(|row| row.phantom).to_string(),
            sum(|row| row.wrong_root).to_string(),
            sum(|row| row.undecided).to_string(),
            sum(|row| row.false_claims).to_string(),
            if off > 0.0 { written(off) } else { "0".to_owned() },
        ];
        text.push(format!("<tr><td>{}</td></tr>\n", cells.join("</td><td>")));
    }
    text.push("</table>\n".to_owned());
    text.concat()
}

const HEAD: &str = "<p>Times in ms are geometric means over surfaces and views; pixels are sums; the greatest distance from a \
root is in pixels' footprints.</p>\n<table>\n<tr><th>method</th><th>size</th><th>trace</th><th>shade</th><th>first</th>\
<th>pixels</th><th>open</th><th>missed</th><th>phantom</th><th>wrong root</th><th>undecided</th><th>false claims</th>\
<th>farthest</th></tr>\n";
