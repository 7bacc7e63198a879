//! The table has a row per surface and renderer. A summary has a row per renderer.

use crate::measure::Times;
use crate::reference::Errors;
use crate::side::EnclosureCalls;
use std::fmt::Write as _;

/// Results of one renderer on one surface.
pub struct Row {
    /// Name of the renderer.
    pub side: String,
    pub times: Times,
    /// Errors of the last picture, if they are measured.
    pub errors: Option<Errors>,
    /// Calls that computed bounds of f for the last picture, if they are counted.
    pub enclosure_calls: Option<EnclosureCalls>,
    /// The renderer's time divided by that of each method, in the order of the columns.
    pub ratios: Vec<f64>,
    /// Reason why the picture is not exactly the zero set, if it is not.
    pub remark: Option<String>,
}

/// All rows so far. Each is printed when it is added.
pub struct Report {
    methods: Vec<String>,
    rows: Vec<(&'static str, Row)>,
}

impl Report {
    /// Prints the head of the table. Each of `methods` gets a column of ratios.
    pub fn new(methods: Vec<String>) -> Self {
        let mut head = format!("{:12}{:14}{:>10}{:>7}", "surface", "side", "ms", "± %");
        for method in &methods {
            write!(head, "{:>10}", format!("/{method}")).expect("text");
        }
        println!("{head}{:>10}{:>8}{:>10}{:>11}", "rootless", "missed", "off", "boxes");
        Self { methods, rows: Vec::new() }
    }

    pub fn add(&mut self, surface: &'static str, row: Row) {
        let mark = if row.remark.is_some() { "*" } else { "" };
        let name = format!("{}{mark}", row.side);
        let (ms, spread) = (row.times.median() * 1e3, row.times.spread() * 100.0);
        let mut line = format!("{surface:12}{name:14}{ms:10.2}{spread:7.1}");
        for ratio in &row.ratios {
            write!(line, "{ratio:10.2}").expect("text");
        }
        let [rootless, missed] =
            [|errors: &Errors| errors.rootless, |errors: &Errors| errors.missed]
                .map(|count| row.errors.as_ref().map_or("-".to_owned(), |e| count(e).to_string()));
        let off = row.errors.and_then(|errors| errors.distance);
        let off = off.map_or("-".to_owned(), |off| format!("{off:.1e}"));
        let boxes = row.enclosure_calls.map_or("-".to_owned(), |enclosure_calls| {
            format!("{:.2} M", enclosure_calls.calls as f64 * enclosure_calls.lanes / 1e6)
        });
        println!("{line}{rootless:>10}{missed:>8}{off:>10}{boxes:>11}");
        self.rows.push((surface, row));
    }

    /// Prints each renderer's geometric mean and worst ratio to every method, then all remarks.
    pub fn summarise(&self) {
        println!(
            "\nGeometric mean and worst (least) ratio to each method over the surfaces that a side can draw:\n"
        );
        let mut head = format!("{:14}{:>9}", "side", "surfaces");
        for method in &self.methods {
            write!(head, "{:>10}{:>9} on {:10}", format!("/{method}"), "worst", "").expect("text");
        }
        println!("{head}{:>10}{:>8}", "rootless", "missed");
        let mut sides: Vec<&str> = Vec::new();
        for (_, row) in &self.rows {
            if !sides.contains(&row.side.as_str()) {
                sides.push(&row.side);
            }
        }
        for side in sides {
            let rows = self.rows.iter().filter(|(_, row)| row.side == side);
            let rows: Vec<_> = rows.filter(|(_, row)| row.remark.is_none()).collect();
            let mut line = format!("{side:14}{:9}", rows.len());
            for method in 0..self.methods.len() {
                let ratios = rows.iter().map(|(surface, row)| (row.ratios[method], *surface));
                let Some((least, place)) = ratios.clone().min_by(|a, b| a.0.total_cmp(&b.0)) else {
                    continue;
                };
                let mean = ratios.map(|(ratio, _)| ratio.ln()).sum::<f64>() / rows.len() as f64;
                write!(line, "{:10.2}{least:9.2} on {place:10}", mean.exp()).expect("text");
            }
            let sum = |count: fn(&Errors) -> usize| {
                rows.iter().filter_map(|(_, row)| row.errors.as_ref()).map(count).sum::<usize>()
            };
            println!("{line}{:10}{:8}", sum(|e| e.rootless), sum(|e| e.missed));
        }
        let mut remarks: Vec<(&str, &str)> = Vec::new();
        for (surface, row) in &self.rows {
            if let Some(remark) =
                row.remark.as_deref().filter(|r| !remarks.contains(&(*surface, *r)))
            {
                remarks.push((surface, remark));
            }
        }
        if !remarks.is_empty() {
            println!();
        }
        for (surface, remark) in remarks {
            println!("* {surface}: {remark}");
        }
    }
}
