//! The command `zeroset explain`.

use super::arguments::ExplainArgs;
use super::notes;
use super::output::print;
use super::subject::Subject;
use anyhow::Result;
use glam::DVec3;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::process::ExitCode;
use zeroset_eval::{FindZeros, KernelFloat, Step, Tape};
use zeroset_interval::Interval;
use zeroset_ir::{NodeId, display};
use zeroset_jit::intermediate_code;
use zeroset_render::model::make_kernels;
use zeroset_render::picture::{Precision, Settings};
use zeroset_scene::coordinate::coordinate;
use zeroset_scene::curves;
use zeroset_scene::program::{ClearedGraph, KernelSource, Program};
use zeroset_scene::view;
use zeroset_space::Region;
use zeroset_syntax::{CurveShape, Document, Format, SurfaceKind, emit};
use zeroset_trace::{Method, TraceOptions};

pub fn run(arguments: &ExplainArgs) -> Result<ExitCode> {
    let subject = Subject::read(&arguments.document)?;
    if let Some(format) = arguments.emit {
        return written(&subject, format);
    }
    let text = explain(&subject, <&Method>::default(), arguments.precision, arguments.code)?;
    print(&text)?;
    Ok(ExitCode::SUCCESS)
}

/// Prints the document in another format.
fn written(subject: &Subject, format: Format) -> Result<ExitCode> {
    let document = &subject.document;
    let text = emit(document, &subject.source.text, format)?;
    if !format.holds_kinds()
        && document.surfaces.iter().any(|one| one.kind == SurfaceKind::Equation)
    {
        let drawn = if format == Format::Vm { "the solid <= 0" } else { "where it is 0" };
        notes::note(&format!(
            "`{}` holds the function alone: read back, it draws {drawn}",
            format.name()
        ));
    }
    print(&text)?;
    Ok(ExitCode::SUCCESS)
}

/// Describes how a document is read, simplified and compiled to the kernels that a method starts
/// with. If `with_code` is set, the intermediate code comes last.
///
/// # Errors
/// If the document cannot be compiled.
pub fn explain(
    subject: &Subject,
    method: &'static Method,
    precision: Precision,
    with_code: bool,
) -> Result<String> {
    let make = match precision {
        Precision::Auto | Precision::F32 => explain_in::<f32>,
        Precision::F64 => explain_in::<f64>,
    };
    make(subject, method, precision, with_code)
}

fn explain_in<T: KernelFloat>(
    subject: &Subject,
    method: &'static Method,
    precision: Precision,
    with_code: bool,
) -> Result<String> {
    let document = &subject.document;
    let mut text = String::new();
    for note in &document.notes {
        let source = &subject.source;
        let shown =
            note.render(Some(&source.from.to_string()), &source.text, notes::colored_output());
        writeln!(text, "{shown}\n")?;
    }
    // A formula without a region is explained over all of space.
    let region = view::region(document, subject.domain, None).map(|(region, _)| region);
    if let Err(error) = &region {
        writeln!(text, "no surface  {error}")?;
    }
    let domain = region.as_ref().map_or([Interval::ENTIRE; 3], view::bounds);
    // Without a region, take any region: the kernels depend only on the domain.
    let region = region.or_else(|_| Region::new(-DVec3::ONE, DVec3::ONE))?;
    let [x, y, z] = domain.map(|ends| [ends.lo, ends.hi].map(coordinate).join(", "));
    writeln!(text, "domain      x in [{x}], y in [{y}], z in [{z}]")?;
    let mut code = String::new();
    for parameter in &document.parameters {
        let value = parameter.value.bounds();
        writeln!(text, "parameter   {} = {}", parameter.name, range(value))?;
    }
    let program = Program::drawn(document, domain)?.with_patches(document)?;
    let names: Vec<&str> = document.parameters.iter().map(|p| p.name.as_str()).collect();
    for (index, surface) in document.surfaces.iter().enumerate() {
        let root = program.roots()[index];
        writeln!(text, "\nread as     {}", surface.echo)?;
        let label = match (program.is_reduced(index), surface.kind) {
            (false, _) => "simplified",
            (true, SurfaceKind::Equation) => "same zeros",
            (true, SurfaceKind::Solid) => "same solid",
        };
        writeln!(text, "{label}  {}", display(program.graph(), root, &names))?;
        if program.is_filled(index) {
            writeln!(text, "removed     gaps that quotients leave")?;
        }
        if let Some(cleared) = program.cleared(index)? {
            let ClearedGraph { graph, numerator, denominator, removed, .. } = cleared;
            let show = |node: &NodeId| display(graph, *node, &names);
            if let Some(removed) = removed {
                let factor = show(removed);
                writeln!(text, "removed     {factor}, a factor above and below a quotient")?;
            }
            writeln!(text, "cleared     {}  over  {}", show(numerator), show(denominator))?;
        }
        // Compile the kernels that a picture needs, so that they can be listed below.
        let settings = Settings {
            options: TraceOptions { precision, ..TraceOptions::default() },
            method,
            ..Settings::default()
        };
        make_kernels::<T>(
            &program,
            index,
            surface.kind == SurfaceKind::Solid,
            &region,
            &settings,
            &|| true,
        )?;
        for (form, label) in
            [(KernelSource::Function, "operations"), (KernelSource::Gradient, "derivatives")]
        {
            if let Some(tape) = program.tape::<T>(index, form)? {
                writeln!(text, "{label}  {}", operations(&tape))?;
                if with_code && form == KernelSource::Function {
                    let shown = intermediate_code::<FindZeros, T>(&tape)?;
                    writeln!(code, "\nzeros kernel of {}\n{shown}", surface.echo)?;
                }
            }
        }
        for made in program.made().iter().filter(|made| made.surface == index) {
            writeln!(text, "kernel      {made}")?;
        }
    }
    explain_patches(&mut text, document, &program)?;
    let traced = curves::trace(document, &region);
    for (index, curve) in document.curves.all.iter().enumerate() {
        writeln!(text, "\nread as     {}", curve.echo)?;
        let pieces: Vec<usize> = traced
            .lines
            .iter()
            .filter(|line| line.number == index)
            .map(|line| line.at.len())
            .collect();
        let (vertices, pieces) = (pieces.iter().sum::<usize>(), pieces.len());
        if !matches!(curve.shape, CurveShape::Point { .. }) {
            writeln!(
                text,
                "traced      pieces: {pieces}, vertices: {vertices}; drawn, not proven"
            )?;
        }
    }
    for remark in &traced.remarks {
        writeln!(text, "note        {remark}")?;
    }
    let (before, after) = program.nodes();
    writeln!(text, "\nnodes       {before} as typed, {after} simplified")?;
    Ok(text + &code)
}

/// Adds how the parametric surfaces are read and compiled.
fn explain_patches(text: &mut String, document: &Document, program: &Program) -> Result<()> {
    let names: Vec<&str> = document.parameters.iter().map(|p| p.name.as_str()).collect();
    for (index, patch) in document.patches.all.iter().enumerate() {
        let surface = document.surfaces.len() + index;
        writeln!(text, "\nread as     {}", patch.echo)?;
        let Some(own) = program.patch(surface) else { continue };
        let coordinates = own.coordinates();
        for (axis, root) in ["x", "y", "z"].into_iter().zip(coordinates.roots()) {
            let shown = display(coordinates.graph(), *root, &names);
            let [u, v] = &patch.names;
            writeln!(text, "{axis}           {shown}, with x for {u} and y for {v}")?;
        }
        own.tree()?;
        if let Some(tape) = coordinates.tape::<f64>(0, KernelSource::Coordinates)? {
            writeln!(text, "operations  {}", operations(&tape))?;
        }
        for made in program.made().iter().filter(|made| made.surface == surface) {
            writeln!(text, "kernel      {made}")?;
        }
    }
    Ok(())
}

/// Formats the bounds of a parameter. Bounds that are equal or adjacent floats become one number,
/// the one with fewer digits.
fn range(bounds: Interval) -> String {
    let [low, high] = [bounds.lo, bounds.hi].map(|bound| bound.to_string());
    if bounds.lo.next_up() < bounds.hi {
        format!("[{low}, {high}]")
    } else if low.len() < high.len() {
        low
    } else {
        high
    }
}

/// Lists how often each operation occurs: `7: 3 sqr, 2 +, 2 *`.
fn operations<T: KernelFloat>(tape: &Tape<T>) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for step in tape.steps() {
        if let Step::Apply(op, _) = step {
            *counts.entry(op.row().name).or_default() += 1;
        }
    }
    let mut counts: Vec<_> = counts.into_iter().collect();
    counts.sort_by_key(|(name, count)| (std::cmp::Reverse(*count), *name));
    let parts: Vec<String> = counts.iter().map(|(name, count)| format!("{count} {name}")).collect();
    format!("{}: {}", tape.operations(), parts.join(", "))
}
