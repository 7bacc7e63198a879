//! Commands for picture settings. Each command sets the given value, or reports the current one.

use super::reply::{Refusal, Reply, refused, say};
use super::session::Live;
use zeroset_render::picture::Settings;
use zeroset_style::{LOOKS, Look};
use zeroset_trace::{DEPTH, METHODS, Method, MethodOption, PRECISION};

pub(super) fn method(live: &Live, name: &str) -> Result<Reply, Refusal> {
    let Some(method) = Method::named(name) else {
        let rows = METHODS.iter().map(|row| (row.name, row.help));
        return listed("method", name, rows, live.settings().method.name);
    };
    live.change(|request| request.settings.method = method);
    Ok(Reply::Done)
}

/// Selects a look by name. Lists all looks if no look has this name.
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
        live.change(|request| request.settings.choices.shadows = Some(wanted));
    }
    let state = if live.settings().choices.shadows == Some(true) { "on" } else { "off" };
    say(format!("shadows {state}"))
}

pub(super) fn switch(word: &str) -> Option<bool> {
    match word {
        "on" => Some(true),
        "off" => Some(false),
        _ => None,
    }
}

/// Refuses a `name` that is not in the table. Without a name, lists the table and marks `used`.
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

/// Sets a method option unless `text` is empty, and reports its value.
pub(super) fn option(live: &Live, option: &MethodOption, text: &str) -> Result<Reply, Refusal> {
    if !text.is_empty() {
        // A value that is refused must not start another picture.
        (option.set)(&mut live.settings().options, text)
            .map_err(|why| Refusal::Command(format!(":{} {text}: {why}", option.command)))?;
        live.change(|request| {
            let _ = (option.set)(&mut request.settings.options, text);
        });
    }
    let settings = live.settings();
    let is_deep = *option == PRECISION && settings.method.reads.contains(&DEPTH);
    let depth = is_deep.then(|| format!("; {}", (DEPTH.describe)(&settings.options)));
    let slabs = live.snapshot().rendering.filter(|_| *option == DEPTH).map(|seen| {
        let extent = 2.0 * seen.model.region().half_extent();
        format!(": slabs of at most {:.2e}", extent * 0.5_f64.powi(settings.options.depth as i32))
    });
    let unused_note = unused_note(&settings, option);
    say(format!(
        "{}{}{}{unused_note}",
        (option.describe)(&settings.options),
        depth.unwrap_or_default(),
        slabs.unwrap_or_default()
    ))
}

/// Returns a note if the current method does not use this option, or else an empty text.
fn unused_note(settings: &Settings, option: &MethodOption) -> String {
    let method = settings.method;
    if method.reads.contains(option) {
        return String::new();
    }
    let names = METHODS.iter().filter(|row| row.reads.contains(option)).map(|row| row.name);
    let names: Vec<&str> = names.collect();
    let verb = if names.len() == 1 { "does" } else { "do" };
    format!("; the method {} does not use that, but {} {verb}", method.name, names.join(", "))
}
