//! Lines that are typed, and the commands among them: one row per command, from which reading,
//! help, completion and suggestions are derived. What touches files is left to the caller.

use super::pipeline::Request;
use super::session::{Live, Refusal, Reply};
use super::status;
use crate::names::Named;
use crate::picture::{Precision, STEPS_RANGE, Settings, TOLERANCES, is_tolerance};
use crate::scene::{self, CameraChoice, DomainChoice};
use std::collections::HashSet;
use std::fmt::Write as _;
use zeroset_syntax::language_names;
use zeroset_trace::{LOOKS, Look, METHODS, Method, MethodOption, Region, StandardView};

/// What a line asks for.
enum Line<'a> {
    /// Nothing but spaces.
    Empty,
    /// Part of the document.
    Text(&'a str),
    /// A command and what follows its name.
    Command(&'static CommandRow, &'a str),
}

/// One command: how it is described and what it does.
pub struct CommandRow {
    /// Its name, without the colon.
    pub name: &'static str,
    /// What follows the name, in the notation of a manual.
    pub arguments: &'static str,
    /// One line on what it does.
    pub doc: &'static str,
    /// Carries it out; `None` if what follows the name is not as `arguments` says.
    run: fn(&Live, &str) -> Option<Result<Reply, Refusal>>,
}

/// The command that draws one more surface.
const ADD: &str = "add";

/// Every command, in the order of the help.
#[rustfmt::skip]
pub const COMMANDS: &[CommandRow] = &[
    CommandRow { name: "help", arguments: "[NAME]", doc: "what can be typed, or what a function or command is",
        run: |_, name| Some(help(name)) },
    CommandRow { name: "list", arguments: "", doc: "show the document",
        run: |live, rest| rest.is_empty().then(|| say(live.text())) },
    CommandRow { name: ADD, arguments: "FORMULA", doc: "draw one more surface beside the others",
        run: |live, formula| Some(live.commit(&given(formula)?, true)) },
    CommandRow { name: "set", arguments: "NAME = VALUE", doc: "give a name a value",
        run: set },
    CommandRow { name: "domain", arguments: "auto|R|X0,X1,Y0,Y1,Z0,Z1", doc: "set the domain that is shown",
        run: |live, domain| Some(look_at(live, domain.parse().ok()?)) },
    CommandRow { name: "view", arguments: "iso|front|back|left|right|top|bottom", doc: "look from this side",
        run: |live, name| StandardView::named(name).map(|view| look_from(live, view)) },
    CommandRow { name: "look", arguments: "[NAME]", doc: "how surfaces are lit, and what they stand on",
        run: |live, name| Some(look(live, name)) },
    CommandRow { name: "shadows", arguments: "[on|off]", doc: "whether what is in the way of light takes it away",
        run: |live, choice| Some(shadows(live, optional(choice, switch)?)) },
    CommandRow { name: "method", arguments: "[NAME]", doc: "how rays are traced",
        run: |live, name| Some(method(live, name)) },
    CommandRow { name: "tolerance", arguments: "[PIXELS]", doc: "how far a hit may be from where it is drawn, in pixels",
        run: |live, pixels| Some(tolerance(live, optional(pixels, |pixels| pixels.parse().ok())?)) },
    CommandRow { name: "steps", arguments: "[N]", doc: "samples on a ray's way through the domain, or steps along it at most",
        run: |live, number| Some(steps(live, optional(number, |number| number.parse().ok())?)) },
    CommandRow { name: "depth", arguments: "[N]", doc: "how often a ray's way through the domain is halved",
        run: |live, number| Some(depth(live, optional(number, |number| number.parse().ok())?)) },
    CommandRow { name: "precision", arguments: "[auto|f32|f64]", doc: "kernel precision: f64 is slower but resolves more",
        run: |live, name| Some(precision(live, optional(name, Precision::named)?)) },
    CommandRow { name: "time", arguments: "T", doc: "set the time t",
        run: |live, time| Some(set_time(live, scene::number(time)?)) },
    CommandRow { name: "load", arguments: "FILE|NAME", doc: "draw a file or a surface of the gallery",
        run: |_, from| Some(Ok(Reply::Load(given(from)?))) },
    CommandRow { name: "save", arguments: "[FILE.zset]", doc: "write the document",
        run: |_, to| Some(Ok(Reply::Save(given(to)))) },
    CommandRow { name: "png", arguments: "[FILE.png]", doc: "write the picture, and show the command that reproduces it",
        run: |_, to| Some(Ok(Reply::Png(given(to)))) },
    CommandRow { name: "explain", arguments: "[code]", doc: "how the document was read, simplified and compiled",
        run: |_, what| matches!(what, "" | "code").then(|| Ok(Reply::Explain { code: !what.is_empty() })) },
    CommandRow { name: "status", arguments: "", doc: "what the picture shows and what it took",
        run: |live, rest| rest.is_empty().then(|| say(status::describe(&live.snapshot()))) },
    CommandRow { name: "quit", arguments: "", doc: "end",
        run: |_, rest| rest.is_empty().then_some(Ok(Reply::Quit)) },
];

impl Live {
    /// Shows what the document would be if `line`, which is still being typed, were entered. A
    /// command shows nothing new.
    pub fn type_line(&self, line: &str) {
        match read(line) {
            Ok(Line::Text(formula)) => self.show_typed(Some(formula), false),
            Ok(Line::Command(row, formula)) if row.name == ADD && !formula.is_empty() => {
                self.show_typed(Some(formula), true);
            }
            Ok(Line::Empty | Line::Command(..)) | Err(_) => self.show_typed(None, false),
        }
    }

    /// Enters a line: a part of the document, or a command.
    ///
    /// # Errors
    /// If the document would be wrong, or the command is.
    pub fn enter(&self, line: &str) -> Result<Reply, Refusal> {
        match read(line).map_err(Refusal::Command)? {
            Line::Empty => {
                self.refresh();
                Ok(Reply::Done)
            }
            Line::Text(line) => self.commit(line, false),
            Line::Command(row, arguments) => (row.run)(self, arguments)
                .unwrap_or_else(|| Err(Refusal::Command(format!("usage: {}", row.usage())))),
        }
    }
}

// What the shape of a result asks for, everywhere the same.
#[allow(clippy::unnecessary_wraps)]
fn say(text: String) -> Result<Reply, Refusal> {
    Ok(Reply::Say(text))
}

fn refused<T>(message: String) -> Result<T, Refusal> {
    Err(Refusal::Command(message))
}

/// The text, if there is one.
fn given(text: &str) -> Option<String> {
    (!text.is_empty()).then(|| text.to_owned())
}

/// What may be left out: `Some(None)` if it is, `None` if it is wrong.
#[allow(clippy::option_option)] // an argument left out, and one that cannot be read
fn optional<T>(text: &str, read: impl FnOnce(&str) -> Option<T>) -> Option<Option<T>> {
    if text.is_empty() { Some(None) } else { read(text).map(Some) }
}

fn set(live: &Live, text: &str) -> Option<Result<Reply, Refusal>> {
    let (name, value) = text.split_once('=').or_else(|| text.split_once(' '))?;
    let (name, value) = (name.trim(), value.trim());
    let plain = |c: char| c.is_alphanumeric() || c == '_';
    let valid = !name.is_empty() && name.chars().all(plain) && !value.is_empty();
    // One definition, not the beginning of a document.
    if !valid || value.contains(['\n', ';', '=']) {
        return None;
    }
    Some(match (name, scene::number(value)) {
        ("t", Some(time)) => set_time(live, time),
        ("t", None) => refused(format!("'{value}' is not a finite number")),
        _ => live.set(name, value),
    })
}

fn set_time(live: &Live, time: f64) -> Result<Reply, Refusal> {
    live.change(|request| request.time = Some(time));
    // A document that is wrong is taken to depend on it.
    if live.request().read().map_or(true, |document| scene::depends_on_time(&document)) {
        return Ok(Reply::Done);
    }
    say("noted; nothing that is drawn depends on the time t".to_owned())
}

fn look_at(live: &Live, domain: DomainChoice) -> Result<Reply, Refusal> {
    if let DomainChoice::Bounds([x0, x1, y0, y1, z0, z1]) = domain
        && let Err(error) = Region::new([x0, y0, z0].into(), [x1, y1, z1].into())
    {
        return refused(error.to_string());
    }
    live.change(|request| request.domain = domain);
    Ok(Reply::Done)
}

#[allow(clippy::unnecessary_wraps)] // as all commands
fn look_from(live: &Live, view: StandardView) -> Result<Reply, Refusal> {
    live.change(|request: &mut Request| {
        let projection = request.choice.projection;
        request.orbit = None;
        request.choice = CameraChoice { view: Some(view), projection, ..CameraChoice::default() };
    });
    Ok(Reply::Done)
}

fn method(live: &Live, name: &str) -> Result<Reply, Refusal> {
    if name.is_empty() {
        let rows = METHODS.iter().map(|row| (row.name, row.help));
        return say(listed(rows, live.settings().method.name));
    }
    let Some(method) = Method::named(name) else {
        let names: Vec<&str> = METHODS.iter().map(|row| row.name).collect();
        return refused(format!("no method named '{name}'; there is {}", names.join(", ")));
    };
    live.change(|request| request.settings.method = method);
    Ok(Reply::Done)
}

fn look(live: &Live, name: &str) -> Result<Reply, Refusal> {
    if name.is_empty() {
        let rows = LOOKS.iter().map(|row| (row.name, row.help));
        let used = live.snapshot().rendering.map(|seen| seen.model.look(&live.settings()));
        return say(listed(rows, used.unwrap_or_default().name));
    }
    let Some(look) = Look::named(name) else {
        let names: Vec<&str> = LOOKS.iter().map(|row| row.name).collect();
        return refused(format!("no look named '{name}'; there is {}", names.join(", ")));
    };
    live.change(|request| request.settings.look = Some(look));
    Ok(Reply::Done)
}

fn shadows(live: &Live, wanted: Option<bool>) -> Result<Reply, Refusal> {
    if let Some(wanted) = wanted {
        live.change(|request| {
            let settings = &mut request.settings;
            settings.shadow_depth = wanted.then(|| settings.usual_shadow_depth());
        });
    }
    let state = if live.settings().shadow_depth.is_some() { "on" } else { "off" };
    say(format!("shadows {state}"))
}

fn switch(word: &str) -> Option<bool> {
    match word {
        "on" => Some(true),
        "off" => Some(false),
        _ => None,
    }
}

/// Rows of a table by name and help, that in use with a star.
fn listed<'a>(rows: impl Iterator<Item = (&'a str, &'a str)>, used: &str) -> String {
    let line = |(name, help)| {
        let mark = if name == used { '*' } else { ' ' };
        format!("{mark} {name:8} {help}")
    };
    rows.map(line).collect::<Vec<_>>().join("\n")
}

fn tolerance(live: &Live, wanted: Option<f64>) -> Result<Reply, Refusal> {
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

fn steps(live: &Live, wanted: Option<u32>) -> Result<Reply, Refusal> {
    if let Some(steps) = wanted {
        if !STEPS_RANGE.contains(&steps) {
            let (least, most) = (STEPS_RANGE.start(), STEPS_RANGE.end());
            return refused(format!("steps are between {least} and {most}"));
        }
        live.change(|request| request.settings.steps = steps);
    }
    let settings = live.settings();
    let unread = unread(&settings, MethodOption::Steps);
    say(format!("{} steps on a ray's way through the domain{unread}", settings.steps))
}

fn depth(live: &Live, wanted: Option<u32>) -> Result<Reply, Refusal> {
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
fn precision(live: &Live, wanted: Option<Precision>) -> Result<Reply, Refusal> {
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

/// Reads a line. A command may be shortened to any prefix that only it has.
///
/// # Errors
/// One line that says what is wrong with a command, with a suggestion where there is one.
fn read(text: &str) -> Result<Line<'_>, String> {
    let text = text.trim();
    let Some(command) = text.strip_prefix(':') else {
        return Ok(if text.is_empty() { Line::Empty } else { Line::Text(text) });
    };
    let (name, arguments) = command.split_once(char::is_whitespace).unwrap_or((command, ""));
    Ok(Line::Command(row(name)?, arguments.trim()))
}

impl CommandRow {
    /// The command with what follows it.
    pub fn usage(&self) -> String {
        format!(":{} {}", self.name, self.arguments).trim_end().to_owned()
    }
}

/// The row of a command by its name or a prefix that only it has.
fn row(name: &str) -> Result<&'static CommandRow, String> {
    if let Some(row) = COMMANDS.iter().find(|row| row.name == name) {
        return Ok(row);
    }
    let shortened: Vec<&CommandRow> =
        COMMANDS.iter().filter(|row| !name.is_empty() && row.name.starts_with(name)).collect();
    if let [row] = shortened[..] {
        return Ok(row);
    }
    let shown: String = name.chars().take(20).collect();
    let options = if shortened.is_empty() {
        // A slip of the finger, not another word.
        let distance = |row: &&CommandRow| strsim::damerau_levenshtein(row.name, &shown);
        let nearest = COMMANDS.iter().min_by_key(distance).filter(|row| distance(row) <= 2);
        nearest.into_iter().collect()
    } else {
        shortened
    };
    let names: Vec<String> = options.iter().map(|row| format!(":{}", row.name)).collect();
    Err(if names.is_empty() {
        format!("there is no command :{shown}; :help lists them")
    } else {
        format!("there is no command :{shown}; did you mean {}?", names.join(" or "))
    })
}

/// What a function or a command is, or what can be typed if no name is given.
fn help(name: &str) -> Result<Reply, Refusal> {
    if name.is_empty() {
        return say(everything());
    }
    let bare = name.trim_start_matches(':');
    if let Some(row) = COMMANDS.iter().find(|row| row.name == bare) {
        return say(format!("{}: {}", row.usage(), row.doc));
    }
    let native = zeroset_ops::natives(name).map(|row| {
        let aliases = match row.aliases {
            [] => String::new(),
            aliases => format!(" (also {})", aliases.join(", ")),
        };
        format!("{}{aliases}: {}", row.name, row.doc)
    });
    let mut found: Vec<String> = native.collect();
    if found.is_empty() {
        found = zeroset_ops::composed(name)
            .map(|f| format!("{}({}): {}", f.name, f.parameters.join(", "), f.doc))
            .collect();
    }
    if found.is_empty() {
        found.extend(zeroset_ops::form(name).map(|form| format!("{}: {}", form.usage, form.doc)));
    }
    if !found.is_empty() {
        return say(found.join("\n"));
    }
    let commands = COMMANDS.iter().map(|row| row.name);
    let nearest = language_names()
        .chain(commands)
        .map(|other| {
            // Of names equally near, the one that was typed in full and more.
            (strsim::damerau_levenshtein(other, bare), !bare.starts_with(other), other)
        })
        .min()
        .filter(|(distance, _, other)| *distance <= 2 && other.len() > *distance);
    let hint = match nearest {
        Some((0, ..)) | None => ":help lists everything".to_owned(),
        Some((.., other)) => format!("did you mean {other}?"),
    };
    refused(format!("no function or command named '{name}'; {hint}"))
}

fn everything() -> String {
    let mut text =
        String::from("Type a formula such as x^2+y^2+z^2 = 1, a definition such as r = 2, or:\n");
    let width = COMMANDS.iter().map(|row| row.usage().len()).max().unwrap_or(0);
    for row in COMMANDS {
        let _ = writeln!(text, "  {:width$}  {}", row.usage(), row.doc);
    }
    text.push_str("Functions (:help NAME tells more):");
    let mut column = usize::MAX;
    let mut told = HashSet::new();
    for name in zeroset_ops::names().filter(|name| told.insert(*name)) {
        if column.saturating_add(name.len() + 1) > 96 {
            text.push_str("\n ");
            column = 1;
        }
        column += name.len() + 1;
        let _ = write!(text, " {name}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn command(text: &str) -> (&'static str, &str) {
        match read(text) {
            Ok(Line::Command(row, arguments)) => (row.name, arguments),
            _ => panic!("{text:?} is no command"),
        }
    }

    fn message(text: &str) -> String {
        let live = Live::new(Request::default());
        live.enter(text).expect_err(text).to_string()
    }

    #[test]
    fn lines_are_told_apart() {
        assert!(matches!(read("  "), Ok(Line::Empty)));
        assert!(matches!(read(" x+y "), Ok(Line::Text("x+y"))));
        assert_eq!(command(":quit"), ("quit", ""));
        assert_eq!(command(":q"), ("quit", ""));
        assert_eq!(command(" :help  sin "), ("help", "sin"));
        assert_eq!(command(":tol 1e-3"), ("tolerance", "1e-3"));
        assert_eq!(command(":de 12"), ("depth", "12"));
    }

    #[test]
    fn what_follows_a_command_is_read() {
        let live = Live::new(Request::default());
        for (line, expected) in [
            (":save", Reply::Save(None)),
            (":png a.png", Reply::Png(Some("a.png".to_owned()))),
            (":explain", Reply::Explain { code: false }),
            (":explain code", Reply::Explain { code: true }),
            (":q", Reply::Quit),
        ] {
            assert_eq!(live.enter(line).expect(line), expected, "{line}");
        }
        live.enter(":domain 2").expect("a domain");
        let bounds = [-2.0, 2.0, -2.0, 2.0, -2.0, 2.0];
        assert_eq!(live.request().domain, DomainChoice::Bounds(bounds));
        live.enter(":view top").expect("a view");
        assert_eq!(live.request().choice.view, Some(StandardView::Top));
        live.enter(":prec f64").expect("a precision");
        assert_eq!(live.settings().precision, Precision::F64);
        for line in [":set r = 2", ":set r=2", ":set r 2"] {
            live.load("", "", false);
            live.enter(line).expect(line);
            assert_eq!(live.text(), "r = 2", "{line}");
        }
        for (line, time) in [(":time 1/4", 0.25), (":set t = -1/8", -0.125), (":time 2", 2.0)] {
            live.enter(line).expect(line);
            assert_eq!(live.request().time, Some(time), "{line}");
        }
    }

    #[test]
    fn what_is_wrong_is_said_with_a_suggestion() {
        assert!(message(":hepl").ends_with("did you mean :help?"));
        assert!(message(":stauts").ends_with("did you mean :status?"));
        assert!(
            message(":s").contains("did you mean :set or :shadows or :steps or :save or :status?")
        );
        assert!(message(":xylophone").ends_with(":help lists them"));
        assert!(message(":").contains(":help"));
        assert!(message(":help qqqqqq").starts_with("no function or command named 'qqqqqq'"));
        for text in [":tolerance -1", ":tolerance 0", ":tolerance nan", ":tolerance 101"] {
            assert!(message(text).contains("above 0"), "{text}");
        }
        assert!(message(":depth 0").contains("between 1 and 20, or 40 after :precision f64"));
        assert!(message(":set t = soon").contains("'soon' is not a finite number"));
        for text in [
            ":domain nonsense",
            ":domain 1,2",
            ":time",
            ":time inf",
            ":tolerance fine",
            ":depth -1",
            ":depth 1.5",
            ":view up",
            ":precision f16",
            ":explain all",
            ":set",
            ":set r =",
            ":set r = 1\nx",
            ":quit now",
            ":add",
        ] {
            assert!(message(text).starts_with("usage: :"), "{text}");
        }
    }

    #[test]
    fn every_name_that_completes_has_help_and_is_listed_once() {
        let list = everything();
        let (_, listed) = list.split_once("tells more):").expect("a list of functions");
        let listed: Vec<&str> = listed.split_whitespace().collect();
        for name in zeroset_ops::names() {
            let Ok(Reply::Say(text)) = help(name) else { panic!("no help on {name}") };
            assert!(!text.is_empty(), "{name}");
            assert_eq!(listed.iter().filter(|other| **other == name).count(), 1, "{name}");
        }
    }

    #[test]
    fn every_row_is_found_by_its_own_name() {
        for row in COMMANDS {
            assert_eq!(super::row(row.name).map(|found| found.name), Ok(row.name));
            assert!(row.doc.len() > 2 && !row.doc.ends_with('.'), "{}", row.name);
        }
    }
}
