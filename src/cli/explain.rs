//! `zeroset explain`.

use super::arguments::ExplainArgs;
use super::notes;
use super::output::print;
use super::subject::Subject;
use anyhow::Result;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::process::ExitCode;
use zeroset::picture::Precision;
use zeroset::program::Program;
use zeroset::scene;
use zeroset::zeros::ZeroKernel;
use zeroset_eval::{Real, Step, Tape};
use zeroset_interval::Interval;
use zeroset_ir::display;
use zeroset_jit::{Kind, intermediate_code};

pub fn run(arguments: &ExplainArgs) -> Result<ExitCode> {
    let subject = Subject::read(&arguments.document)?;
    let text = match arguments.precision {
        Precision::F32 => explain::<f32>(&subject, arguments.code)?,
        Precision::F64 => explain::<f64>(&subject, arguments.code)?,
    };
    print(&text)?;
    Ok(ExitCode::SUCCESS)
}

/// How a document is read, simplified and compiled to kernels of `T`: what can be read first, and
/// the code last, if it is asked for.
///
/// # Errors
/// If no code can be made.
pub fn explain<T: Real>(subject: &Subject, with_code: bool) -> Result<String> {
    let document = &subject.document;
    let mut text = String::new();
    for note in &document.notes {
        let source = &subject.source;
        let shown = note.render(Some(&source.name), &source.text, notes::coloured_output());
        writeln!(text, "{shown}\n")?;
    }
    // A formula without a surface can be explained too; nothing is then assumed of its domain.
    let domain = match scene::region(document, subject.domain, None) {
        Ok((region, _)) => scene::bounds(&region),
        Err(_) => [Interval::ENTIRE; 3],
    };
    let [x, y, z] = domain;
    writeln!(text, "domain      x in {}, y in {}, z in {}", range(x), range(y), range(z))?;
    let mut code = String::new();
    for parameter in &document.parameters {
        let value = parameter.value.bounds();
        writeln!(text, "parameter   {} = {}", parameter.name, range(value))?;
    }
    let program = Program::unchecked(document, domain)?;
    let names: Vec<&str> = document.parameters.iter().map(|p| p.name.as_str()).collect();
    for (index, surface) in document.surfaces.iter().enumerate() {
        let root = program.roots()[index];
        writeln!(text, "\nread as     {}", surface.echo)?;
        writeln!(text, "simplified  {}", display(program.graph(), root, &names))?;
        let interval = program.routine::<T>(index).tape;
        let gradient = program.gradient_routine::<T>(index)?.tape;
        if let Some((graph, [numerator, denominator, _])) = program.cleared(index)? {
            let show = |node| display(&graph, node, &names);
            writeln!(text, "cleared     {}  over  {}", show(numerator), show(denominator))?;
        }
        writeln!(text, "forms       {}", forms(&program.zero_kernel::<T>(index)?))?;
        writeln!(text, "operations  {}", operations(&interval))?;
        let bytes = [
            program.interval_kernel::<T>(index)?.code_bytes(),
            program.point_kernel::<T>(index)?.code_bytes(),
            program.gradient_kernel::<T>(index)?.code_bytes(),
        ];
        writeln!(
            text,
            "code        interval {} bytes, point {} bytes, gradient {} bytes ({} operations)",
            bytes[0],
            bytes[1],
            bytes[2],
            gradient.operations(),
        )?;
        if with_code {
            let shown = intermediate_code(&interval, Kind::Interval)?;
            writeln!(code, "\ninterval kernel of {}\n{shown}", surface.echo)?;
        }
    }
    let (before, after) = program.nodes();
    writeln!(text, "\nnodes       {before} as typed, {after} simplified")?;
    Ok(text + &code)
}

/// What is asked of a box, in turn, until something proves that it holds no zero.
fn forms<T: Real>(kernel: &ZeroKernel<T>) -> String {
    let mut forms = vec!["the function"];
    if kernel.has_numerator() {
        forms.push("its cleared form, so that poles are proven empty");
    }
    if kernel.has_branches() {
        forms.push("its branches one by one, so that jumps are proven empty");
    }
    format!("intervals of {}", forms.join(", then of "))
}

/// The value if the bounds enclose one number as tightly as they can, else the bounds.
fn range(bounds: Interval) -> String {
    if bounds.lo.next_up() >= bounds.hi {
        format!("{}", bounds.hi)
    } else {
        format!("[{}, {}]", bounds.lo, bounds.hi)
    }
}

/// How many of each operation: `7: 3 sqr, 2 +, 2 *`.
fn operations<T: Real>(tape: &Tape<T>) -> String {
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
