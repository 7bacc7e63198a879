//! A self-contained page: charts, tables, pictures with their errors, the machine and the commands.

mod pictures;
mod table;

use crate::charts::charts;
use crate::error::ChartError;
use crate::files::write;
use crate::plot::draw;
use crate::row::Row;
use crate::store::Store;
use std::path::PathBuf;

/// Writes the page `index.html` into the directory of the results; returns its path.
///
/// # Errors
/// If a chart cannot be drawn, a surface has no picture, or the page cannot be written.
pub fn write_page(store: &Store) -> Result<PathBuf, ChartError> {
    let [all, single] = charts(&store.rows);
    let mut page = vec![HEAD.to_owned(), "<h2>Over all surfaces</h2>\n".to_owned()];
    for chart in all {
        page.push(format!("<figure>{}</figure>\n", draw(&chart)?));
    }
    page.push(format!("<h2>In numbers</h2>\n{}", table::table(&store.rows)));
    page.push(format!("<h2>What is wrong with pictures</h2>\n{LEGEND}"));
    page.push(pictures::pictures(store)?);
    page.push("<h2>Surface by surface</h2>\n".to_owned());
    for chart in single {
        let (title, svg) = (escaped(&chart.title), draw(&chart)?);
        page.push(format!("<details><summary>{title}</summary><figure>{svg}</figure></details>\n"));
    }
    page.push(circumstances(store));
    page.push("</body>\n</html>\n".to_owned());
    let path = store.path("index.html");
    write(&path, page.concat().as_bytes())?;
    Ok(path)
}

/// The sections on the machine and the commands.
fn circumstances(store: &Store) -> String {
    let mut text = vec!["<h2>The machine</h2>\n<table>\n".to_owned()];
    if let Some(row) = store.rows.first() {
        let Row { version, rustc, flags, processor, processor_threads, threads, seed, .. } = row;
        let lines = [
            ("zeroset", version.clone()),
            ("compiler", rustc.clone()),
            ("flags", flags.clone()),
            ("processor", processor.clone()),
            ("its threads", processor_threads.to_string()),
            ("threads used", threads.to_string()),
            ("seed", seed.to_string()),
            ("measured again", format!("{} times, in interleaved random order", row.repeats)),
        ];
        for (name, value) in lines {
            text.push(format!("<tr><td>{name}</td><td>{}</td></tr>\n", escaped(&value)));
        }
    }
    let commands = escaped(&store.commands());
    text.push(format!("</table>\n<h2>The commands</h2>\n<pre>{commands}</pre>\n"));
    text.concat()
}

/// Escapes text for HTML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

const HEAD: &str = r#"<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>zeroset: speed against accuracy</title>
<style>
body { font: 15px/1.45 sans-serif; color: #222; max-width: 1060px; margin: 2em auto; padding: 0 1em; }
figure { margin: 1em 0; }
figure svg { width: 100%; height: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
td, th { padding: 0.15em 0.9em 0.15em 0; text-align: right; border-bottom: 1px solid #ddd; }
td:first-child, th:first-child { text-align: left; }
.pictures { display: flex; flex-wrap: wrap; gap: 0.8em; margin-bottom: 1.2em; }
.pictures div { width: 192px; font-size: 12px; }
.pictures img { width: 192px; height: 192px; image-rendering: pixelated; border: 1px solid #ccc; }
.pictures .wrong { margin-top: 4px; }
pre { white-space: pre-wrap; background: #f4f4f4; padding: 0.6em; }
b { padding: 0 0.35em; }
</style>
</head>
<body>
<h1>zeroset: speed against accuracy</h1>
<p>Every method, with each value of the options that it reads, against the certified tracer, which shares no code with any.
Times are medians. Pixels that the certified tracer leaves open count nowhere.</p>
"#;

const LEGEND: &str = "<p>Each method in the middle of its options, in the standard view; below, every pixel against the certified \
tracer: <b style=\"background:#d62728;color:#fff\">missed</b> <b style=\"background:#1f5fd6;color:#fff\">phantom</b> \
<b style=\"background:#f2c80f\">wrong root</b> <b style=\"background:#dcdcdc\">right</b> \
<b style=\"background:#8c8c8c;color:#fff\">left open by the tracer</b></p>\n";
