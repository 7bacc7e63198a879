//! The command `zeroset mesh`.

use super::arguments::MeshArgs;
use super::claims;
use super::long_work::LongWork;
use super::output::{OutputFile, print};
use super::render::{budget, in_threads};
use super::report::ms;
use super::subject::{self, Subject};
use super::{UNDECIDED, interrupt, notes};
use anyhow::{Context, Result, bail, ensure};
use glam::DVec3;
use npyz::WriterBuilder;
use serde_json::{Value, json};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};
use zeroset_export::{FORMATS, Format, Meshes, Object, Quality, Unit, meshes};
use zeroset_live::Rendering;
use zeroset_mesh::{Crossings, Mesh, Unproven, least_for_single};
use zeroset_render::limit::Limit;
use zeroset_scene::blank::{Blank, ends};
use zeroset_scene::coordinate::{coordinate, decimal};
use zeroset_scene::curves::UNPROVEN;
use zeroset_scene::domain::AutoDomain;
use zeroset_scene::view::Clipping;
use zeroset_syntax::Document;

/// The note on a mesh that takes long.
const LONG: &str = "the mesh is being made and proven; --estimate makes one without proofs, a larger \
                    --tolerance one of fewer triangles, and --budget 60 ends the work after a minute";

pub fn run(arguments: &MeshArgs) -> Result<ExitCode> {
    let begun = Instant::now();
    let tolerance = arguments.tolerance;
    ensure!(
        tolerance.is_none_or(|tolerance| tolerance > 0.0 && tolerance.is_finite()),
        "--tolerance needs a finite number above 0"
    );
    let quality = Quality {
        tolerance,
        is_estimated: arguments.estimate,
        is_full: arguments.detail == "full",
    };
    let budget = budget(arguments.budget)?;
    interrupt::listen("nothing is written")?;
    let files = Files::create(arguments)?;
    let subject = Subject::read(&arguments.document)?;
    subject.show_notes();
    let wanted = Limit { budget, begun: Some(begun), ..Limit::default() }.wanted();
    let long = LongWork::begin(LONG);
    let found = in_threads(arguments.threads, || {
        Ok(meshes(&subject.document, subject.domain, Clipping::default(), quality, &wanted)?)
    })?;
    drop(long);
    let Some(found) = found else {
        let seconds = budget.unwrap_or_default().as_secs_f64();
        bail!(
            "the mesh was not done within {seconds} s: a larger --budget or a larger --tolerance \
             may do"
        );
    };
    if let Some(searched) = found.searched {
        notes::note(&subject::describe_domain(&searched, &found.region));
    }
    let claims = files.claims.is_some().then(|| claims(&found, &subject, arguments)).transpose()?;
    if found.is_empty() {
        bail!("nothing to write: {}", why_empty(&found, &subject.document));
    }
    for remark in remarks(&found, files.format()) {
        notes::note(&remark);
    }
    if !subject.document.curves.is_empty() {
        notes::note(UNPROVEN);
    }
    if arguments.unit.is_some() && !files.format().is_some_and(|format| format.has_unit) {
        notes::note(&format!("--unit changes nothing: only {} have units", listed(|f| f.has_unit)));
    }
    let objects = &found.objects;
    let clock = Instant::now();
    let held = interrupt::hold();
    files.finish(objects, arguments.unit, claims)?;
    drop(held);
    if arguments.json {
        print(&format!("{}\n", report(&found, &subject, clock.elapsed())))?;
    } else {
        lines(&found).for_each(|line| notes::say(&line));
    }
    let is_proven = objects.iter().all(|object| object.mesh.is_proven());
    let is_failed = arguments.strict && !is_proven;
    Ok(if is_failed { ExitCode::from(UNDECIDED) } else { ExitCode::SUCCESS })
}

/// Writes the surfaces of a picture to a file. Returns lines of text that say what is proven of the
/// meshes.
///
/// # Errors
/// If the file cannot be written, nothing is there to write, or `wanted` returns false.
pub fn of_picture(
    seen: &Rendering,
    to: &str,
    tolerance: Option<f64>,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Result<String> {
    let path = Path::new(to);
    let format = Format::of(path).map_err(anyhow::Error::msg)?;
    let file = OutputFile::create(path)?;
    let (request, document) = (&seen.request, &seen.document);
    let cut = Clipping { plane: request.clip, ..Clipping::default() };
    let quality = Quality { tolerance, ..Quality::default() };
    let found = meshes(document, request.domain, cut, quality, wanted)?;
    let found = found.context("not written: the session has ended")?;
    ensure!(!found.is_empty(), "nothing to write: {}", why_empty(&found, document));
    file.finish(|out| format.write(&found.objects, None, out))?;
    let remarks = remarks(&found, Some(format)).into_iter().map(|remark| format!("note: {remark}"));
    let saved = std::iter::once(format!("saved '{to}'"));
    let curves = (!document.curves.is_empty()).then(|| format!("note: {UNPROVEN}"));
    Ok(saved.chain(remarks).chain(curves).chain(lines(&found)).collect::<Vec<_>>().join("\n"))
}

/// The files to write, opened before the work starts.
struct Files {
    mesh: Option<(&'static Format, OutputFile)>,
    unproven: Option<OutputFile>,
    claims: Option<OutputFile>,
}

impl Files {
    fn create(arguments: &MeshArgs) -> Result<Self> {
        let MeshArgs { output, cells_unproven, claims, json, .. } = arguments;
        ensure!(
            output.is_some() || cells_unproven.is_some() || *json,
            "nothing to write: add -o part.stl, or --json, --cells-unproven"
        );
        let is_standard = |path: &Option<PathBuf>| path.as_deref() == Some(Path::new("-"));
        let standard = [is_standard(cells_unproven), is_standard(claims), *json];
        let count = standard.into_iter().filter(|is_used| *is_used).count();
        ensure!(count < 2, "only one thing can be written to standard output");
        let open = |path: &PathBuf| {
            let format = Format::of(path).map_err(anyhow::Error::msg)?;
            Ok::<_, anyhow::Error>((format, OutputFile::create(path)?))
        };
        let mesh = output.as_ref().map(open).transpose()?;
        let unproven = cells_unproven.as_deref().map(OutputFile::create).transpose()?;
        let claims = claims.as_deref().map(OutputFile::create).transpose()?;
        if let (Some((format, _)), Some(_)) = (&mesh, &claims) {
            ensure!(format.name == "PLY", "--claims are of a PLY file, which keeps all digits");
        }
        let all = [mesh.as_ref().map(|(_, file)| file), unproven.as_ref(), claims.as_ref()];
        let all: Vec<&OutputFile> = all.into_iter().flatten().collect();
        let is_twice = |(number, one): (usize, &&OutputFile)| {
            all[..number].iter().any(|other| one.is_same(other))
        };
        ensure!(!all.iter().enumerate().any(is_twice), "one file is given for two outputs");
        Ok(Self { mesh, unproven, claims })
    }

    fn format(&self) -> Option<&'static Format> {
        self.mesh.as_ref().map(|(format, _)| *format)
    }

    /// Writes the files, the mesh last. If the mesh exists, so do the others.
    fn finish(self, objects: &[Object], unit: Option<&Unit>, claims: Option<Value>) -> Result<()> {
        if let Some(file) = self.unproven {
            file.finish(|out| write_unproven(objects, out))?;
        }
        if let (Some(file), Some(claims)) = (self.claims, claims) {
            file.finish(|out| writeln!(out, "{claims}"))?;
        }
        self.mesh
            .map_or(Ok(()), |(format, file)| file.finish(|out| format.write(objects, unit, out)))
    }
}

/// The claims of the only surface.
fn claims(found: &Meshes, subject: &Subject, arguments: &MeshArgs) -> Result<Value> {
    let [object] = &found.objects[..] else {
        bail!("--claims are of one surface; hide the others");
    };
    let file = arguments.output.as_deref().and_then(Path::file_name).unwrap_or_default();
    let text = &subject.source.text;
    Ok(claims::of_mesh(object, found, &subject.document, text, &file.to_string_lossy()))
}

/// Writes center and size of each unproven cell: six numbers in `f64`.
fn write_unproven(objects: &[Object], out: &mut dyn Write) -> io::Result<()> {
    let cells: Vec<&Unproven> = objects.iter().flat_map(|object| &object.mesh.unproven).collect();
    let options = npyz::WriteOptions::<f64>::new().default_dtype().shape(&[cells.len() as u64, 6]);
    let mut array = options.writer(out).begin_nd()?;
    array.extend(
        cells.iter().flat_map(|cell| [cell.centre, cell.size]).flat_map(|p| p.to_array()),
    )?;
    array.finish()
}

/// Says why no surface has a triangle.
fn why_empty(found: &Meshes, document: &Document) -> String {
    let Meshes { region, searched, is_undefined, tolerance, .. } = found;
    let blank = Blank::find(document, region, *is_undefined, *searched);
    let cells: usize = found.objects.iter().map(|object| object.mesh.cells).sum();
    let is_estimated = found.objects.iter().any(|object| object.mesh.is_estimated);
    let place = |found: Option<AutoDomain>| found.map(|found| format!("--domain {}", ends(&found)));
    match blank {
        Blank::NoCurve => "there are curves and points alone".to_owned(),
        Blank::Missed { found, .. } if cells > 0 => format!(
            "the function changes its sign at no sample; {cells} cells may still hold a point of \
             the surface, which may be thinner than {tolerance:.2e} there: try a smaller \
             --tolerance{}",
            place(found).map(|place| format!(", or {place}")).unwrap_or_default()
        ),
        Blank::Missed { .. } if is_estimated => {
            "the estimated bounds leave no point in the domain; without --estimate, that is proven, \
             or the surface found"
                .to_owned()
        }
        Blank::Missed { found, .. } => format!(
            "the surface is proven to have no point in the domain{}",
            place(found).map(|place| format!("; try {place}")).unwrap_or_default()
        ),
        _ => blank.describe(&|ends| format!("--domain {ends}")),
    }
}

/// Notes on properties of the surfaces that the files do not hold.
fn remarks(found: &Meshes, format: Option<&Format>) -> Vec<String> {
    let mut remarks = found.remarks.clone();
    for Object { name, mesh, .. } in &found.objects {
        if mesh.triangles.is_empty() {
            remarks.push(format!("`{name}` has no triangle in this domain"));
        }
        if mesh.turned > 0 {
            remarks.push(format!(
                "`{name}`: its function is below 0 outside; the triangles face outside all the same"
            ));
        }
    }
    let Some(format) = format else { return remarks };
    if found.objects.len() > 1 && !format.has_objects {
        remarks.push(format!(
            "{} keeps no surfaces apart: {} are one object here, and {} keep them apart",
            format.name,
            found.objects.len(),
            listed(|format| format.has_objects)
        ));
    }
    if format.is_single && found.objects.iter().any(|object| !object.mesh.is_single) {
        remarks.push(rounding(found, format));
    }
    remarks
}

/// Says that `f32` are too coarse for a mesh, and the offset, the tolerance and the formats with
/// which coordinates have enough digits.
fn rounding(found: &Meshes, format: &Format) -> String {
    let ends = [found.region.low(), found.region.high()];
    let largest = ends[0].abs().max(ends[1].abs()).max_element();
    let rounding = largest * f64::from(f32::EPSILON) / 2.0;
    let walls = found.objects.iter().filter(|object| !object.mesh.is_single);
    let wall = walls.filter_map(|object| object.mesh.wall).fold(f64::INFINITY, f64::min);
    let least = least_for_single(ends);
    let mut advice = Vec::new();
    if least <= found.tolerance.min(wall) {
        advice.push("without --detail full, it is".to_owned());
    } else {
        // The nearest offset of few digits. Rounding it must not move the ends past a power of two.
        let unit = largest.log10().ceil() as i32 - OFFSET_DIGITS;
        let offset = ((ends[0] + ends[1]) * -0.5).to_array().map(|along| decimal(along, unit));
        let moved = ends.map(|end| end + DVec3::from_array(offset));
        if least_for_single(moved) <= found.tolerance.min(wall) {
            let listed = offset.map(coordinate).join(", ");
            advice.push(format!("moved by ({listed}), about the origin, it is"));
        }
        if least <= wall {
            advice.push(format!("with --tolerance {least} it is"));
        }
    }
    advice.push(format!("{} have more digits", listed(|format| !format.is_single)));
    format!(
        "{} rounds coordinates, by up to {rounding:.1e} here, which is not proven to keep the \
         shape: {}",
        format.name,
        advice.join("; ")
    )
}

/// Number of digits of an offset that a note names.
const OFFSET_DIGITS: i32 = 4;

/// The report that `--json` prints.
fn report(found: &Meshes, subject: &Subject, write: Duration) -> Value {
    let Meshes { objects, region, tolerance, .. } = found;
    let surface = |object: &Object| {
        let mesh = &object.mesh;
        json!({
            "name": object.name,
            "vertices": mesh.vertices.len(),
            "triangles": mesh.triangles.len(),
            "closed": mesh.is_closed,
            "estimated": mesh.is_estimated,
            "cells": mesh.cells,
            "unproven": mesh.unproven.len(),
            "far": mesh.far,
            "crossing": mesh.crossings.map(|found| found.crossing),
            "touching": mesh.crossings.map(|found| found.touching + found.flat),
        })
    };
    let (low, high) = (region.low(), region.high());
    let surfaces: Vec<Value> = objects.iter().map(surface).collect();
    let sum = |key: &str| surfaces.iter().filter_map(|one| one[key].as_u64()).sum::<u64>();
    json!({
        "vertices": sum("vertices"),
        "triangles": sum("triangles"),
        "closed": surfaces.iter().all(|one| one["closed"] == true),
        "estimated": surfaces.iter().any(|one| one["estimated"] == true),
        "cells": sum("cells"),
        "unproven": sum("unproven"),
        "far": sum("far"),
        "tolerance": tolerance,
        "domain": [low.x, high.x, low.y, high.y, low.z, high.z],
        "domain_found": found.searched.map(|found| found.describe()),
        "ms": {
            "parse": ms(subject.parse),
            "simplify": ms(found.simplify),
            "mesh": ms(found.mesh),
            "write": ms(write),
        },
        "surfaces": surfaces,
    })
}

/// The names of formats, in a sentence.
fn listed(holds: impl Fn(&&Format) -> bool) -> String {
    let names: Vec<&str> = FORMATS.iter().filter(holds).map(|format| format.name).collect();
    let (last, others) = names.split_last().unwrap_or((&"", &[]));
    if others.is_empty() { (*last).to_owned() } else { format!("{} and {last}", others.join(", ")) }
}

/// One line for each surface that has triangles.
fn lines(found: &Meshes) -> impl Iterator<Item = String> {
    let objects = found.objects.iter().filter(|object| !object.mesh.triangles.is_empty());
    objects.map(|object| {
        let name = if found.objects.len() > 1 { &*object.name } else { "" };
        describe(name, &object.mesh, found.tolerance)
    })
}

/// Says in one line how large a mesh is, and what is proven of it.
fn describe(name: &str, mesh: &Mesh, tolerance: f64) -> String {
    let of = if name.is_empty() { String::new() } else { format!("`{name}`: ") };
    let closed = if mesh.is_closed { "closed" } else { "with an open rim" };
    let shape = match (&mesh.unproven[..], mesh.far) {
        ([], 0) if mesh.is_parametric => {
            format!("at the same parameters, within {tolerance:.2e} of the surface: proven")
        }
        ([], far) if mesh.is_parametric => format!(
            "in {far} of {} cells, it is not proven to be within {tolerance:.2e} of the surface",
            mesh.cells
        ),
        (gaps, far) if mesh.is_parametric => format!(
            "in {} of {} cells the surface may have a gap, and in {far} others the triangles are \
             not proven to be within {tolerance:.2e} of it",
            gaps.len(),
            mesh.cells
        ),
        _ if mesh.is_estimated => "nothing is proven: bounds were estimated".to_owned(),
        ([], 0) => format!(
            "the shape is proven: isotopic to the surface in the domain, and within {tolerance:.2e} \
             of it"
        ),
        ([], far) => format!(
            "the shape is proven: isotopic to the surface in the domain; in {far} of {} cells the \
             distance is not proven to be within {tolerance:.2e}",
            mesh.cells
        ),
        ([first, ..], _) => format!(
            "the shape is not proven in {} of {} cells, one of them at {}: samples decide there",
            mesh.unproven.len(),
            mesh.cells,
            point(first.centre, tolerance)
        ),
    };
    let crossings = mesh.crossings.map(|found| format!("; {}", meetings(&found, tolerance)));
    let crossings = crossings.unwrap_or_default();
    format!("{of}{} triangles, {closed}; {shape}{crossings}", mesh.triangles.len())
}

/// Says whether triangles cross or touch.
fn meetings(found: &Crossings, tolerance: f64) -> String {
    let &Crossings { crossing, touching, flat, place } = found;
    if found.is_none() {
        return "no two triangles cross or touch: proven".to_owned();
    }
    let place = place.map(|at| format!(", one of them at {}", point(at, tolerance)));
    let what = match (crossing, touching) {
        (0, 0) => None,
        (0, _) => Some("it touches itself, or crosses itself along edges"),
        _ => Some("it crosses itself"),
    };
    let pairs = crossing + touching;
    let pairs = what.map(|what| {
        format!("{what}: {pairs} pairs of triangles meet{}", place.unwrap_or_default())
    });
    let areas = (flat > 0).then(|| format!("{flat} triangles are not proven to have an area"));
    pairs.into_iter().chain(areas).collect::<Vec<_>>().join("; ")
}

/// The coordinates of a point, with one digit more than a tolerance shows.
fn point(at: DVec3, tolerance: f64) -> String {
    let digits = (1.0 - tolerance.log10()).ceil().clamp(0.0, 18.0) as usize;
    let unit = 10.0_f64.powi(digits as i32);
    // Adding 0 takes the sign from -0.
    let along = |along: f64| format!("{:.digits$}", (along * unit).round() / unit + 0.0);
    format!("({})", at.to_array().map(along).join(", "))
}
