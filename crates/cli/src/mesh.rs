//! The command `zeroset mesh`.

use super::arguments::MeshArgs;
use super::mesh_file::{FORMATS, Format, Object};
use super::output::{OutputFile, print};
use super::render::{budget, in_threads};
use super::subject::{self, Subject};
use super::{UNDECIDED, interrupt, notes};
use anyhow::{Context, Result, bail, ensure};
use npyz::WriterBuilder;
use serde_json::{Value, json};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};
use zeroset_mesh::{MOST_CELLS, Mesh, Options, TOLERANCE, Unproven, mesh};
use zeroset_render::limit::Limit;
use zeroset_scene::blank::Blank;
use zeroset_scene::domain::AutoDomain;
use zeroset_scene::program::Program;
use zeroset_scene::view::{self, Clipping};
use zeroset_space::Region;

pub fn run(arguments: &MeshArgs) -> Result<ExitCode> {
    let begun = Instant::now();
    let tolerance = arguments.tolerance;
    ensure!(
        tolerance.is_none_or(|tolerance| tolerance > 0.0 && tolerance.is_finite()),
        "--tolerance needs a finite number above 0"
    );
    let budget = budget(arguments.budget)?;
    interrupt::listen("nothing is written")?;
    let files = Files::create(arguments)?;
    let subject = Subject::read(&arguments.document)?;
    subject.show_notes();
    let wanted = Limit { budget, begun: Some(begun), ..Limit::default() }.wanted();
    let found = in_threads(arguments.threads, || meshed(&subject, tolerance, &wanted))?;
    let Some(found) = found else {
        let seconds = budget.unwrap_or_default().as_secs_f64();
        bail!(
            "the mesh was not done within {seconds} s: a larger --budget or a larger --tolerance \
             may do"
        );
    };
    if let Some(searched) = found.searched {
        notes::note(&subject::describe_domain(&searched));
    }
    let Found { objects, .. } = &found;
    if objects.iter().all(|object| object.mesh.triangles.is_empty()) {
        bail!("nothing to write: {}", found.why_empty(&subject));
    }
    found.remark(files.format());
    let clock = Instant::now();
    let held = interrupt::hold();
    files.finish(objects)?;
    drop(held);
    if arguments.json {
        print(&format!("{}\n", found.report(&subject, clock.elapsed())))?;
    } else {
        for object in objects.iter().filter(|object| !object.mesh.triangles.is_empty()) {
            let name = if objects.len() > 1 { &*object.name } else { "" };
            notes::say(&describe(name, &object.mesh, found.tolerance));
        }
    }
    let is_proven = objects.iter().all(|object| is_shape_proven(object) && object.mesh.far == 0);
    let is_failed = arguments.strict && !is_proven;
    Ok(if is_failed { ExitCode::from(UNDECIDED) } else { ExitCode::SUCCESS })
}

/// The files to write, opened before the work starts.
struct Files {
    mesh: Option<(&'static Format, OutputFile)>,
    unproven: Option<OutputFile>,
}

impl Files {
    fn create(arguments: &MeshArgs) -> Result<Self> {
        let MeshArgs { output, cells_unproven, json, .. } = arguments;
        ensure!(
            output.is_some() || cells_unproven.is_some() || *json,
            "nothing to write: add -o part.stl, or --json, --cells-unproven"
        );
        let is_standard = cells_unproven.as_deref() == Some(Path::new("-"));
        ensure!(!(is_standard && *json), "only one thing can be written to standard output");
        let open = |path: &PathBuf| {
            let format = Format::of(path).with_context(|| {
                let known = FORMATS.map(|format| format!(".{}", format.name.to_lowercase()));
                format!(
                    "cannot write '{}': a mesh file ends in {}",
                    path.display(),
                    known.join(", ")
                )
            })?;
            Ok::<_, anyhow::Error>((format, OutputFile::create(path)?))
        };
        let mesh = output.as_ref().map(open).transpose()?;
        let unproven = cells_unproven.as_deref().map(OutputFile::create).transpose()?;
        if let (Some((_, one)), Some(other)) = (&mesh, &unproven) {
            ensure!(!one.is_same(other), "one file is given for two outputs");
        }
        Ok(Self { mesh, unproven })
    }

    fn format(&self) -> Option<&'static Format> {
        self.mesh.as_ref().map(|(format, _)| *format)
    }

    /// Writes the files, the mesh last. If the mesh exists, so does the array.
    fn finish(self, objects: &[Object]) -> Result<()> {
        if let Some(file) = self.unproven {
            file.finish(|out| write_unproven(objects, out))?;
        }
        self.mesh.map_or(Ok(()), |(format, file)| file.finish(|out| (format.write)(objects, out)))
    }
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

/// The meshes of all visible surfaces.
struct Found {
    objects: Vec<Object>,
    region: Region,
    searched: Option<AutoDomain>,
    tolerance: f64,
    /// Notes on surfaces whose functions are constant in the domain.
    remarks: Vec<String>,
    /// True if no visible surface's function has a value in the domain.
    is_undefined: bool,
    simplify: Duration,
    mesh: Duration,
}

/// Makes the meshes. Returns `None` once `wanted` returns false.
fn meshed(
    subject: &Subject,
    tolerance: Option<f64>,
    wanted: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Found>> {
    let document = &subject.document;
    let cut = Clipping::default();
    let found = view::region_while(&mut None, document, subject.domain, cut, wanted)?;
    let Some((region, searched)) = found else { return Ok(None) };
    let clock = Instant::now();
    let program = Program::new(document, zeroset_mesh::domain(&region))?;
    let simplify = clock.elapsed();
    let tolerance = tolerance.unwrap_or(TOLERANCE * (region.high() - region.low()).length());
    let clock = Instant::now();
    let mut objects = Vec::new();
    let mut is_undefined = true;
    for (index, surface) in document.surfaces.iter().enumerate() {
        if surface.hidden {
            continue;
        }
        is_undefined &= program.is_undefined(index);
        let is_solid = program.is_solid(index);
        let options = Options { region, tolerance, is_solid, most_cells: MOST_CELLS };
        let Some(mesh) = mesh(&program, index, &options, wanted)? else {
            return Ok(None);
        };
        let name = surface.echo.split_whitespace().collect::<Vec<_>>().join(" ");
        objects.push(Object { name, mesh });
    }
    let mesh = clock.elapsed();
    let remarks = program.remarks(document);
    Ok(Some(Found { objects, region, searched, tolerance, remarks, is_undefined, simplify, mesh }))
}

impl Found {
    /// Says why no surface has a triangle.
    fn why_empty(&self, subject: &Subject) -> String {
        let Self { region, searched, is_undefined, .. } = self;
        let blank = Blank::find(&subject.document, region, *is_undefined, *searched);
        let cells: usize = self.objects.iter().map(|object| object.mesh.cells).sum();
        match blank {
            Blank::Missed if cells > 0 => format!(
                "the function changes its sign at no sample; {cells} cells may still hold a point \
                 of the surface"
            ),
            Blank::Missed => "the surface is proven to have no point in the domain".to_owned(),
            _ => blank.describe(&|ends| format!("--domain {ends}")),
        }
    }

    /// Notes what the files do not hold.
    fn remark(&self, format: Option<&Format>) {
        self.remarks.iter().for_each(|remark| notes::note(remark));
        for Object { name, mesh } in &self.objects {
            if mesh.triangles.is_empty() {
                notes::note(&format!("`{name}` has no triangle in this domain"));
            }
        }
        let Some(format) = format else { return };
        if self.objects.len() > 1 && !format.has_objects {
            let several = FORMATS.iter().filter(|format| format.has_objects);
            let several: Vec<&str> = several.map(|format| format.name).collect();
            notes::note(&format!(
                "{} keeps no surfaces apart: {} are one object here, and stay apart in {}",
                format.name,
                self.objects.len(),
                several.join(" or ")
            ));
        }
        let largest = self.region.low().abs().max(self.region.high().abs()).max_element();
        let rounding = largest * f64::from(f32::EPSILON) / 2.0;
        if format.is_single && rounding > ROUNDING * self.tolerance {
            notes::note(&format!(
                "{} rounds coordinates, by up to {rounding:.1e} here: formats with more digits do \
                 not",
                format.name
            ));
        }
    }

    /// The report that `--json` prints.
    fn report(&self, subject: &Subject, write: Duration) -> Value {
        let ms = |time: Duration| time.as_secs_f64() * 1e3;
        let Self { objects, region, tolerance, .. } = self;
        let surface = |object: &Object| {
            let mesh = &object.mesh;
            json!({
                "name": object.name,
                "vertices": mesh.vertices.len(),
                "triangles": mesh.triangles.len(),
                "closed": mesh.is_closed,
                "cells": mesh.cells,
                "unproven": mesh.unproven.len(),
                "far": mesh.far,
            })
        };
        let (low, high) = (region.low(), region.high());
        let surfaces: Vec<Value> = objects.iter().map(surface).collect();
        let sum = |key: &str| surfaces.iter().filter_map(|one| one[key].as_u64()).sum::<u64>();
        json!({
            "vertices": sum("vertices"),
            "triangles": sum("triangles"),
            "closed": surfaces.iter().all(|one| one["closed"] == true),
            "cells": sum("cells"),
            "unproven": sum("unproven"),
            "far": sum("far"),
            "tolerance": tolerance,
            "domain": [low.x, high.x, low.y, high.y, low.z, high.z],
            "domain_found": self.searched.map(|found| found.describe()),
            "ms": {
                "parse": ms(subject.parse),
                "simplify": ms(self.simplify),
                "mesh": ms(self.mesh),
                "write": ms(write),
            },
            "surfaces": surfaces,
        })
    }
}

/// Rounding of coordinates that goes without saying, as a share of the tolerance.
const ROUNDING: f64 = 0.01;

fn is_shape_proven(object: &Object) -> bool {
    object.mesh.unproven.is_empty()
}

/// Says in one line how large a mesh is, and what is proven of it.
fn describe(name: &str, mesh: &Mesh, tolerance: f64) -> String {
    let of = if name.is_empty() { String::new() } else { format!("`{name}`: ") };
    let closed = if mesh.is_closed { "closed" } else { "with an open rim" };
    let shape = match (&mesh.unproven[..], mesh.far) {
        ([], 0) => format!(
            "the shape is proven: isotopic to the surface in the domain, and within {tolerance:.2e} \
             of it"
        ),
        ([], far) => format!(
            "the shape is proven: isotopic to the surface in the domain; in {far} of {} cells the \
             distance is not proven to be within {tolerance:.2e}",
            mesh.cells
        ),
        ([first, ..], _) => {
            // One digit more than the tolerance shows.
            let digits = (1.0 - tolerance.log10()).ceil().clamp(0.0, 18.0) as usize;
            let unit = 10.0_f64.powi(digits as i32);
            // Adding 0 takes the sign from -0.
            let along = |along: f64| format!("{:.digits$}", (along * unit).round() / unit + 0.0);
            let place = first.centre.to_array().map(along).join(", ");
            format!(
                "the shape is not proven in {} of {} cells, one of them at ({place}): samples \
                 decide there",
                mesh.unproven.len(),
                mesh.cells
            )
        }
    };
    format!("{of}{} triangles, {closed}; {shape}", mesh.triangles.len())
}
