//! The command `zeroset measure`.

use super::arguments::MeasureArgs;
use super::long_work::LongWork;
use super::output::print;
use super::render::{budget, in_threads};
use super::report::ms;
use super::subject::{self, Subject};
use super::{interrupt, notes};
use anyhow::{Context, Result, anyhow, bail, ensure};
use serde_json::{Value, json};
use std::process::ExitCode;
use std::time::{Duration, Instant};
use zeroset_interval::Interval;
use zeroset_live::Rendering;
use zeroset_measure::{Measured, Measures, Quantity, RELATIVE, Request, measures};
use zeroset_render::limit::Limit;
use zeroset_scene::curves::UNPROVEN;
use zeroset_scene::patches::NO_MEASURE;
use zeroset_scene::view::Clipping;

/// The note on measures that take long.
const LONG: &str = "the measures are being narrowed; a larger --relative ends that sooner, --volume \
                    and the like ask for some alone, and --budget 60 ends it after a minute";

pub fn run(arguments: &MeasureArgs) -> Result<ExitCode> {
    let begun = Instant::now();
    let relative = arguments.relative.unwrap_or(RELATIVE);
    ensure!(
        relative > 0.0 && relative.is_finite(),
        "--relative needs a finite number above 0, such as 1e-3"
    );
    let asked = asked(arguments);
    let budget = budget(arguments.budget)?;
    interrupt::listen("nothing is printed")?;
    let density = arguments.density.as_deref().map(|formula| ("--density", formula));
    let (subject, density) = Subject::read_beside(&arguments.document, density)?;
    subject.show_notes();
    let request = Request {
        quantities: &asked,
        relative,
        density: density.as_ref(),
        has_area_bounds: arguments.area,
    };
    let wanted = Limit { budget, begun: Some(begun), ..Limit::default() }.wanted();
    let long = LongWork::begin(LONG);
    let found = in_threads(arguments.threads, || {
        let (document, cut) = (&subject.document, Clipping::default());
        measures(document, subject.domain, cut, &request, &wanted)
            .map_err(|error| anyhow!(error.advise(&|ends| format!("--domain={ends}"))))
    })?;
    drop(long);
    let Some(found) = found else {
        let seconds = budget.unwrap_or_default().as_secs_f64();
        bail!(
            "the measures were not done within {seconds} s: a larger --budget or a larger \
             --relative may do"
        );
    };
    if let Some(searched) = found.searched {
        notes::note(&subject::describe_domain(&searched, &found.region));
    }
    found.remarks.iter().for_each(|remark| notes::note(remark));
    if !subject.document.curves.is_empty() {
        notes::note(UNPROVEN);
    }
    if !subject.document.patches.is_empty() {
        notes::note(NO_MEASURE);
    }
    if arguments.json {
        print(&format!("{}\n", report(&found, &request, subject.parse)))?;
    } else {
        print(&found.text(&request))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// The measures that the options name, or all.
fn asked(arguments: &MeasureArgs) -> Vec<Quantity> {
    let is_asked = |quantity: &Quantity| match quantity {
        Quantity::Volume => arguments.volume,
        Quantity::Mass => arguments.mass,
        Quantity::Centroid => arguments.centroid,
        Quantity::Inertia => arguments.inertia,
        Quantity::Ends => arguments.ends,
        Quantity::Area => arguments.area,
        Quantity::Shape => arguments.shape,
    };
    let asked: Vec<Quantity> = Quantity::ALL.into_iter().filter(is_asked).collect();
    if asked.is_empty() { Quantity::ALL.to_vec() } else { asked }
}

/// The measures of a picture's surfaces, as lines of text.
///
/// # Errors
/// If the surfaces cannot be measured, or `wanted` returns false.
pub fn of_picture(seen: &Rendering, wanted: &(dyn Fn() -> bool + Sync)) -> Result<String> {
    let request = &seen.request;
    let cut = Clipping { plane: request.clip, ..Clipping::default() };
    let found = measures(&seen.document, request.domain, cut, &Request::ALL, wanted)
        .map_err(|error| anyhow!(error.advise(&|ends| format!(":domain {ends}"))))?;
    Ok(found.context("not measured: the session has ended")?.text(&Request::ALL))
}

/// The report that `--json` prints.
fn report(found: &Measured, request: &Request<'_>, parse: Duration) -> Value {
    let (low, high) = (found.region.low(), found.region.high());
    let surfaces: Vec<Value> =
        found.surfaces.iter().map(|(name, of)| entry(name, of, request)).collect();
    json!({
        "surfaces": surfaces,
        "domain": [low.x, high.x, low.y, high.y, low.z, high.z],
        "domain_found": found.searched.map(|found| found.describe()),
        "ms": {
            "parse": ms(parse),
            "simplify": ms(found.simplify),
            "measure": ms(found.measure),
        },
    })
}

/// The report on one surface, without what was not asked for. Intervals are lists of two numbers.
fn entry(name: &str, measures: &Measures, request: &Request<'_>) -> Value {
    let pair = |interval: Interval| [interval.lo, interval.hi];
    let each = |all: [Interval; 3]| all.map(pair);
    let (solid, weighted) = (measures.solid.as_ref(), measures.weighted.as_ref());
    let inertia = measures.inertia();
    let pieces = &measures.shape.pieces;
    let counts = measures.counts();
    let mut entry = json!({ "name": name });
    let all = entry.as_object_mut().expect("an object");
    for quantity in request.quantities.iter().filter(|one| request.has(**one)) {
        let values = match quantity {
            Quantity::Volume => json!({
                "volume": solid.map(|solid| pair(solid.volume)),
                "boxes": solid.map(|solid| solid.boxes),
            }),
            Quantity::Mass => json!({
                "mass": weighted.map(|solid| pair(solid.volume)),
                "mass_boxes": weighted.map(|solid| solid.boxes),
            }),
            Quantity::Centroid => json!({
                "centroid": inertia.map(|inertia| each(inertia.centroid)),
            }),
            Quantity::Inertia => json!({
                "inertia": inertia.map(|inertia| json!({
                    "xx": pair(inertia.moments[0]),
                    "yy": pair(inertia.moments[1]),
                    "zz": pair(inertia.moments[2]),
                    "yz": pair(inertia.products[0].negated()),
                    "zx": pair(inertia.products[1].negated()),
                    "xy": pair(inertia.products[2].negated()),
                })),
            }),
            Quantity::Ends => json!({
                "low": measures.ends.map(|ends| each(ends[0])),
                "high": measures.ends.map(|ends| each(ends[1])),
            }),
            Quantity::Area => json!({
                "area_bounds": measures.area_bounds.map(|area| {
                    // JSON has no infinite number.
                    json!([area.low, area.high.is_finite().then_some(area.high)])
                }),
                "area": counts.map(|_| measures.area),
                "area_change": counts.map(|_| measures.area_change),
            }),
            Quantity::Shape => json!({
                "pieces": counts.map(|(pieces, _)| pieces),
                "hollows": counts.map(|(_, hollows)| hollows),
                "genus": pieces.iter().map(|piece| piece.genus).collect::<Vec<_>>(),
                "shape_proven": measures.unproven == 0,
                "unproven": measures.unproven,
            }),
        };
        if let Value::Object(values) = values {
            all.extend(values);
        }
    }
    entry
}
