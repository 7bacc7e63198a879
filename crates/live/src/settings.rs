//! The commands that say how pictures are made: each sets what is given, and tells how it is.

use super::reply::{Refusal, Reply, refused, say};
use super::session::Live;
use zeroset_render::names::Named;
use zeroset_render::picture::{Precision, STEPS_RANGE, Settings, TOLERANCES, is_tolerance};
use zeroset_style::{LOOKS, Look};
use zeroset_trace::{METHODS, Method, MethodOption};

pub(super) fn method(live: &Live, name: &str) -> Result<Reply, Refusal> {
    let Some(method) = Method::named(name) else {
        let rows = METHODS.iter().map(|row| (row.name, row.help));
        return listed("method", name, rows, live.settings().method.name);
    };
    live.change(|request| request.settings.method = method);
    Ok(Reply::Done)
}

pub(super) fn look(live: &Live, name: &str) -> Result<Reply, Refusal> {
    let Some(look) = Look::named(name) else {
        let rows = LOOKS.iter().map(|row| (row.name, row.help));
        let used = live.snapshot().rendering.map(|seen| seen.model.look(&live.settings()));
        return listed("look", name, rows, used.unwrap_or_default().name);
    };
    live.change(|request| request.settings.look = Some(look));
    Ok(Reply::Done)
}

pub(super) fn shadows(live: &Live, wanted: Option<bool>) -> Result<Reply, Refusal> {
    if let Some(wanted) = wanted {
        live.change(|request| {
            let settings = &mut request.settings;
            settings.shadow_depth = wanted.then(|| settings.usual_shadow_depth());
        });
    }
    let state = if live.settings().shadow_depth.is_some() { "on" } else { "off" };
    say(format!("shadows {state}"))
}

pub(super) fn switch(word: &str) -> Option<bool> {
    match word {
        "on" => Some(true),
        "off" => Some(false),
        _ => None,
    }
}

/// What is said where no row of a table has this name: without one, all rows by name and help, that
/// in use with a star.
fn listed<'a>(
    kind: &str,
    name: &str,
    rows: impl Iterator<Item = (&'a str, &'a str)>,
    used: &str,
) -> Result<Reply, Refusal> {
    if !name.is_empty() {
        let names: Vec<&str> = rows.map(|(name, _)| name).collect();
        return refused(format!("no {kind} named '{name}'; there is {}", names.join(", ")));
    }
    let line = |(name, help)| {
        let mark = if name == used { '*' } else { ' ' };
        format!("{mark} {name:8} {help}")
    };
    say(rows.map(line).collect::<Vec<_>>().join("\n"))
}

pub(super) fn tolerance(live: &Live, wanted: Option<f64>) -> Result<Reply, Refusal> {
    if let Some(pixels) = wanted {
        if !is_tolerance(pixels) {
            return refused(format!("{pixels}: {TOLERANCES}"));
        }
        live.change(|request| request.settings.tolerance = pixels);
    }
    let settings = live.settings();
    let unread = unread(&settings, MethodOption::Tolerance);
    say(format!("hits are within {} pixels of where they are drawn{unread}", settings.tolerance))
}

pub(super) fn steps(live: &Live, wanted: Option<u32>) -> Result<Reply, Refusal> {
    if let Some(steps) = wanted {
        if !STEPS_RANGE.contains(&steps) {
            let (least, most) = (STEPS_RANGE.start(), STEPS_RANGE.end());
            return refused(format!("steps are between {least} and {most}"));
        }
        live.change(|request| request.settings.steps = steps);
    }
    let settings = live.settings();
    let unread = unread(&settings, MethodOption::Steps);
    say(format!("{} steps on a ray's path through the domain{unread}", settings.steps))
}

pub(super) fn depth(live: &Live, wanted: Option<u32>) -> Result<Reply, Refusal> {
    let most = live.settings().precision.max_depth();
    if let Some(depth) = wanted {
        if !(1..=most).contains(&depth) {
            let hint = if most < Precision::F64.max_depth() {
                format!(", or {} after :precision f64", Precision::F64.max_depth())
            } else {
                String::new()
            };
            return refused(format!("a depth is between 1 and {most}{hint}"));
        }
        live.change(|request| request.settings.max_depth = depth);
    }
    let settings = live.settings();
    let unread = unread(&settings, MethodOption::Depth);
    let slabs = live.snapshot().rendering.map_or_else(String::new, |seen| {
        let extent = 2.0 * seen.model.region().half_extent();
        format!(": slabs of at most {:.2e}", extent * 0.5_f64.powi(settings.max_depth as i32))
    });
    say(format!("depth {} of at most {most}{slabs}{unread}", settings.max_depth))
}

/// Slabs that are too thin for the new floats become as thin as they can be.
pub(super) fn precision(live: &Live, wanted: Option<Precision>) -> Result<Reply, Refusal> {
    if let Some(precision) = wanted {
        live.change(|request| {
            request.settings.precision = precision;
            request.settings.max_depth = request.settings.max_depth.min(precision.max_depth());
        });
    }
    let settings = live.settings();
    let Settings { precision, max_depth, .. } = settings;
    if settings.method.reads.contains(&MethodOption::Depth) {
        let most = precision.max_depth();
        return say(format!("{precision}: depth {max_depth} of at most {most} (:depth sets it)"));
    }
    let help = Precision::NAMES.iter().find(|row| row.0 == precision).map_or("", |row| row.2);
    say(format!("{precision}: {help}"))
}

/// A remark on an option that the method does not look at.
fn unread(settings: &Settings, option: MethodOption) -> String {
    let method = settings.method;
    if method.reads.contains(&option) {
        return String::new();
    }
    let names = METHODS.iter().filter(|row| row.reads.contains(&option)).map(|row| row.name);
    let names: Vec<&str> = names.collect();
    let verb = if names.len() == 1 { "does" } else { "do" };
    format!("; the method {} does not use that, but {} {verb}", method.name, names.join(", "))
}
