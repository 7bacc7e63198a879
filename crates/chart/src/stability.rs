//! Results of every method on formulas on which methods for implicit surfaces are known to fail.
//!
//! The cases are those of `tests/data/stability`. The reference is the certified tracer. The tracer
//! leaves some rays open, for example where f touches 0; for these, the reference is the roots
//! stored with the cases.

mod case;
mod outcome;
mod sheet;

pub use outcome::Outcome;

use crate::arguments::StabilityArguments;
use crate::difference::{difference, png};
use crate::error::ChartError;
use crate::errors::PixelErrors;
use crate::files::write;
use crate::grid::Configuration;
use crate::progress::progress;
use crate::reference::RootReference;
use case::{Case, named};
use image::RgbImage;
use serde::Serialize;
use sheet::Sheet;
use std::time::{Duration, Instant};
use zeroset_render::limit::Limit;
use zeroset_render::picture::Settings;
use zeroset_trace::{Method, RayGrid};

/// Side of the square pictures in pixels, as in the stored roots.
pub const SIDE: usize = 64;

/// The result of one method on one case.
#[derive(Clone, Debug, Serialize)]
pub struct Verdict {
    /// Name of the case.
    pub case: String,
    /// Name of the method. It runs with the precision `auto` and default options.
    pub method: String,
    /// Class of the result.
    pub outcome: Outcome,
    /// Time of the whole picture in milliseconds, compilation included.
    pub ms: f64,
    /// Errors that determine the class.
    pub errors: PixelErrors,
    /// The difficulty of the case's formula.
    pub hazard: String,
    /// Reason why there is no picture, if there is none.
    pub refusal: Option<String>,
}

/// Draws cases by methods, each picture within the time budget. Writes a table, rows and a contact
/// sheet, and returns the table.
///
/// # Errors
/// If there is no such case, or the directory cannot be written.
pub fn stability(arguments: &StabilityArguments) -> Result<String, ChartError> {
    let StabilityArguments { budget, output: directory, .. } = arguments;
    let (cases, methods) = (named(&arguments.cases)?, arguments.methods.chosen());
    let bar = progress(cases.len() * methods.len());
    let mut verdicts = Vec::new();
    let mut sheet = Sheet::new(cases.len(), &methods);
    for (row, case) in cases.iter().enumerate() {
        bar.set_message(case.slug.clone());
        let reference = case.reference(&directory.join("reference"));
        for (column, method) in methods.iter().enumerate() {
            let (verdict, pictures) = match &reference {
                Ok(reference) => judged(case, reference, method, *budget),
                Err(error) => (refused(case, method, error.to_string()), None),
            };
            sheet.add(row, column, &verdict, pictures.as_ref());
            verdicts.push(verdict);
            bar.inc(1);
        }
    }
    bar.finish_and_clear();
    let path = directory.join("stability.json");
    let json = serde_json::to_vec_pretty(&verdicts).map_err(ChartError::of_content(&path))?;
    write(&path, &json)?;
    let table = table(&verdicts, &methods);
    write(&directory.join("stability.txt"), table.as_bytes())?;
    write(&directory.join("stability.png"), &png(&sheet.into_image())?)?;
    Ok(table)
}

fn refused(case: &Case, method: &Method, why: String) -> Verdict {
    Verdict {
        case: case.slug.clone(),
        method: method.name.to_owned(),
        outcome: Outcome::Refused,
        ms: 0.0,
        errors: PixelErrors::default(),
        hazard: case.hazard.clone(),
        refusal: Some(why),
    }
}

/// Draws a case by a method. Returns the verdict. If there is a picture, returns it and a picture
/// of its errors, too.
fn judged(
    case: &Case,
    reference: &RootReference,
    method: &'static Method,
    budget: Duration,
) -> (Verdict, Option<[RgbImage; 2]>) {
    let settings = Configuration::plain(method).settings(SIDE);
    let settings = Settings {
        limit: Limit { budget: Some(budget), ..Limit::default() },
        brackets: true,
        ..settings
    };
    let start = Instant::now();
    let drawn = case
        .view()
        .and_then(|(surface, view)| Ok((surface.picture(&view.camera, &settings)?, view)));
    let time = start.elapsed();
    let (picture, view) = match drawn {
        Ok(drawn) => drawn,
        Err(error) => return (refused(case, method, error.to_string()), None),
    };
    let errors =
        PixelErrors::new(reference, &RayGrid::new(&view.camera, SIDE, SIDE), &picture.buffer);
    let wrong = difference(reference, &picture.buffer);
    let shown = RgbImage::from_raw(SIDE as u32, SIDE as u32, picture.rgb).unwrap_or_default();
    let verdict = Verdict {
        outcome: Outcome::of(&errors, time >= budget),
        ms: time.as_secs_f64() * 1e3,
        errors,
        refusal: None,
        ..refused(case, method, String::new())
    };
    (verdict, Some([shown, wrong]))
}

/// A table with a line per case and a column per method, followed by the number of each outcome.
fn table(verdicts: &[Verdict], methods: &[&'static Method]) -> String {
    let line = |name: &str, cells: Vec<String>| format!("{name:20}{}\n", cells.concat());
    let names = methods.iter().map(|method| format!("{:32}", method.name)).collect();
    let mut text = vec![HEAD.to_owned(), line("", names)];
    for row in verdicts.chunks(methods.len().max(1)) {
        let cells = row.iter().map(|Verdict { outcome, errors, ms, .. }| {
            let PixelErrors { missed, phantom, wrong_root, undecided, false_claims, .. } = errors;
            let wrong = format!("{missed}/{phantom}/{wrong_root} {undecided} {false_claims}");
            format!("{:9} {wrong:15}{ms:6.0} ", outcome.name())
        });
        text.push(line(row.first().map_or("", |verdict| &verdict.case), cells.collect()));
    }
    text.push("\n".to_owned());
    for outcome in Outcome::ALL {
        let number = |method: &&Method| {
            let of_method = verdicts.iter().filter(|verdict| verdict.method == method.name);
            format!("{:<32}", of_method.filter(|verdict| verdict.outcome == outcome).count())
        };
        text.push(line(&outcome.name(), methods.iter().map(number).collect()));
    }
    let lines = text.concat();
    lines.lines().map(str::trim_end).collect::<Vec<_>>().join("\n") + "\n"
}

const HEAD: &str = "Formulas on which methods for implicit surfaces are known to fail, 64x64 rays, options by default, precision auto.
For each method: the outcome, pixels missed/phantom/at a wrong root, undecided, claimed wrongly, and milliseconds.

  sound     no more than 1 in 200 pixels is wrong and 1 in 50 roots missing, and what is painted is at the root
  holes     most of what is wrong are roots that are not painted, or not the first ones
  phantoms  most of what is wrong is painted where there is no root
  wall      likewise, on more than 1 in 20 pixels
  noise     both, or what is painted is not at the root
  slow      the time ran out
  refused   there is no picture
  unjudged  of no pixel it is certain that it shows a root, and of some it is not that they show none

";
