//! The command `zeroset measure`.

use super::arguments::MeasureArgs;
use super::output::print;
use super::render::{budget, in_threads};
use super::subject::{self, Subject};
use super::{interrupt, notes};
use anyhow::{Result, bail, ensure};
use serde_json::{Value, json};
use std::fmt::Write;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use zeroset_interval::Interval;
use zeroset_measure::{Inertia, Measures, RELATIVE, measure};
use zeroset_render::limit::Limit;
use zeroset_scene::domain::AutoDomain;
use zeroset_scene::program::Program;
use zeroset_scene::view::{self, Clipping};
use zeroset_space::Region;

pub fn run(arguments: &MeasureArgs) -> Result<ExitCode> {
    let begun = Instant::now();
    let relative = arguments.relative.unwrap_or(RELATIVE);
    ensure!(
        relative > 0.0 && relative.is_finite(),
        "--relative needs a finite number above 0, such as 1e-3"
    );
    let budget = budget(arguments.budget)?;
    interrupt::listen("nothing is printed")?;
    let subject = Subject::read(&arguments.document)?;
    subject.show_notes();
    let wanted = Limit { budget, begun: Some(begun), ..Limit::default() }.wanted();
    let found = in_threads(arguments.threads, || measured(&subject, relative, &wanted))?;
    let Some(found) = found else {
        let seconds = budget.unwrap_or_default().as_secs_f64();
        bail!(
            "the measures were not done within {seconds} s: a larger --budget or a larger \
             --relative may do"
        );
    };
    if let Some(searched) = found.searched {
        notes::note(&subject::describe_domain(&searched));
    }
    if arguments.json {
        print(&format!("{}\n", found.report()))?;
    } else {
        print(&found.text(relative))?;
    }
    Ok(ExitCode::SUCCESS)
}

/// The measures of all visible surfaces.
struct Found {
    surfaces: Vec<(String, Measures)>,
    region: Region,
    searched: Option<AutoDomain>,
    parse: Duration,
    simplify: Duration,
    measure: Duration,
}

/// Measures all visible surfaces. Returns `None` once `wanted` returns false.
fn measured(
    subject: &Subject,
    relative: f64,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Found>> {
    let document = &subject.document;
    let found =
        view::region_while(&mut None, document, subject.domain, Clipping::default(), wanted)?;
    let Some((region, searched)) = found else { return Ok(None) };
    let is_empty = searched.is_some_and(|found| found.finding.is_empty());
    ensure!(!is_empty, "nothing to measure: the surface is proven empty up to ±1e12");
    if let Some(found) = searched
        && !found.finding.is_bounded()
    {
        let domain = subject::domain_ends(&found);
        bail!(
            "the surface is not proven to be bounded, so its measures may be infinite: \
             --domain={domain} measures the part in a box"
        );
    }
    let clock = Instant::now();
    let program = Program::new(document, zeroset_mesh::domain(&region))?;
    program.remarks(document).iter().for_each(|remark| notes::note(remark));
    let simplify = clock.elapsed();
    let clock = Instant::now();
    let mut surfaces = Vec::new();
    for (index, surface) in document.surfaces.iter().enumerate() {
        if surface.hidden {
            continue;
        }
        let Some(measures) = measure(&program, index, &region, relative, wanted)? else {
            return Ok(None);
        };
        let name = surface.echo.split_whitespace().collect::<Vec<_>>().join(" ");
        surfaces.push((name, measures));
    }
    ensure!(!surfaces.is_empty(), "nothing to measure: every surface is hidden");
    let (parse, measure) = (subject.parse, clock.elapsed());
    Ok(Some(Found { surfaces, region, searched, parse, simplify, measure }))
}

impl Found {
    /// The measures as lines of text.
    fn text(&self, relative: f64) -> String {
        let mut text = String::new();
        for (number, (name, measures)) in self.surfaces.iter().enumerate() {
            if self.surfaces.len() > 1 {
                let gap = if number > 0 { "\n" } else { "" };
                _ = writeln!(text, "{gap}{name}");
            }
            for (label, value) in rows(measures, relative) {
                _ = writeln!(text, "{label:<12}{value}");
            }
        }
        text
    }

    /// The report that `--json` prints.
    fn report(&self) -> Value {
        let ms = |time: Duration| time.as_secs_f64() * 1e3;
        let (low, high) = (self.region.low(), self.region.high());
        let surfaces: Vec<Value> = self.surfaces.iter().map(|(name, of)| entry(name, of)).collect();
        json!({
            "surfaces": surfaces,
            "domain": [low.x, high.x, low.y, high.y, low.z, high.z],
            "domain_found": self.searched.map(|found| found.describe()),
            "ms": {
                "parse": ms(self.parse),
                "simplify": ms(self.simplify),
                "measure": ms(self.measure),
            },
        })
    }
}

/// The measures of one surface: what each is, and its value.
fn rows(measures: &Measures, relative: f64) -> Vec<(&'static str, String)> {
    let mut rows = Vec::new();
    let point = |of: &[Interval; 3]| of.map(digits).join(", ");
    if let Some(solid) = &measures.solid {
        let volume = solid.volume;
        let is_wide = volume.width() > 1.01 * relative * volume.lo;
        let rest = if is_wide { " (not narrower, with a million boxes)" } else { "" };
        rows.push(("volume", format!("{}{rest}", digits(volume))));
        if let Some(Inertia { centroid, moments, products }) = solid.inertia() {
            rows.push(("centroid", point(&centroid)));
            rows.push(("inertia", format!("xx, yy, zz: {}", point(&moments))));
            rows.push(("", format!("products yz, zx, xy: {}", point(&products))));
        }
    }
    match &measures.ends {
        Some([low, high]) => {
            rows.push(("from", point(low)));
            rows.push(("to", point(high)));
        }
        None => rows.push(("from, to", "not proven".to_owned())),
    }
    let Measures { area, area_change, .. } = measures;
    let area = Interval { lo: area - area_change, hi: area + area_change };
    rows.push(("area", format!("{}, estimated by two meshes", digits(area))));
    let shape = describe(measures);
    rows.push((
        "shape",
        match measures.unproven {
            0 => format!("{shape}: proven"),
            cells => format!("{shape} in a mesh, not proven in {cells} cells"),
        },
    ));
    rows
}

/// The pieces of a surface, in words.
fn describe(measures: &Measures) -> String {
    let pieces = &measures.shape.pieces;
    let hollows = pieces.iter().filter(|piece| piece.is_hollow).count();
    let of =
        |count: usize, one: &str| format!("{count} {one}{}", if count == 1 { "" } else { "s" });
    let mut shape = of(pieces.len(), "piece");
    if measures.solid.is_some() && hollows > 0 {
        shape = format!("{} with {}", of(pieces.len() - hollows, "piece"), of(hollows, "hollow"));
    }
    let genus: Option<Vec<String>> =
        pieces.iter().map(|piece| piece.genus.map(|genus| genus.to_string())).collect();
    match genus {
        Some(genus) if pieces.len() == 1 => format!("{shape}, genus {}", genus[0]),
        Some(genus) if !pieces.is_empty() && pieces.len() <= MOST_LISTED => {
            format!("{shape}, of genus {}", genus.join(", "))
        }
        None => format!("{shape} with a rim"),
        Some(_) => shape,
    }
}

/// Largest number of pieces whose genera are listed.
const MOST_LISTED: usize = 12;

/// The two ends of an interval, with as many digits as tell them apart, rounded outward.
fn digits(interval: Interval) -> String {
    let Interval { lo, hi } = interval;
    let width = hi - lo;
    if !width.is_finite() {
        return format!("{lo}..{hi}");
    }
    let size = lo.abs().max(hi.abs());
    // Two digits of the width. Below this, a digit of a float is no more than rounding.
    let least = width.max(size * 1e-15).max(f64::MIN_POSITIVE);
    let places = (1.0 - least.log10().floor()).clamp(0.0, 300.0) as usize;
    if size >= 1e9 || places > 18 {
        return format!("{:e}..{:e}", lo, hi);
    }
    let unit = 10.0_f64.powi(places as i32);
    // Adding 0 takes the sign from -0.
    let (lo, hi) = ((lo * unit).floor() / unit + 0.0, (hi * unit).ceil() / unit + 0.0);
    format!("{lo:.places$}..{hi:.places$}")
}

/// The report on one surface. Intervals are lists of two numbers.
fn entry(name: &str, measures: &Measures) -> Value {
    let pair = |interval: Interval| [interval.lo, interval.hi];
    let each = |all: [Interval; 3]| all.map(pair);
    let solid = measures.solid.as_ref();
    let inertia = solid.and_then(zeroset_measure::Solid::inertia);
    let pieces = &measures.shape.pieces;
    json!({
        "name": name,
        "volume": solid.map(|solid| pair(solid.volume)),
        "centroid": inertia.map(|inertia| each(inertia.centroid)),
        "inertia": inertia.map(|inertia| json!({
            "xx": pair(inertia.moments[0]),
            "yy": pair(inertia.moments[1]),
            "zz": pair(inertia.moments[2]),
            "yz": pair(inertia.products[0].negated()),
            "zx": pair(inertia.products[1].negated()),
            "xy": pair(inertia.products[2].negated()),
        })),
        "low": measures.ends.map(|ends| each(ends[0])),
        "high": measures.ends.map(|ends| each(ends[1])),
        "area": measures.area,
        "area_change": measures.area_change,
        "pieces": pieces.len(),
        "hollows": pieces.iter().filter(|piece| piece.is_hollow).count(),
        "genus": pieces.iter().map(|piece| piece.genus).collect::<Vec<_>>(),
        "shape_proven": measures.unproven == 0,
        "unproven": measures.unproven,
        "boxes": solid.map(|solid| solid.boxes),
    })
}
