//! The table of commands, and the parsing of entered lines. Help, completion and suggestions are
//! derived from the table. Reading and writing files is left to the caller.

use super::edit::LineGoal;
use super::help::help;
use super::pipeline::{Axes, Request};
use super::reply::{Refusal, Reply, refused, say};
use super::session::Live;
use super::settings::{look, method, option, shadows, switch};
use super::values::{TIME, defined};
use super::{cut, status};
use std::sync::LazyLock;
use zeroset_scene::camera::CameraChoice;
use zeroset_scene::number;
use zeroset_scene::view::DomainChoice;
use zeroset_space::Region;
use zeroset_style::{OPACITY, StandardView, settings};
use zeroset_trace::{OPTIONS, TraceOptions};

enum Line<'a> {
    /// Only whitespace.
    Empty,
    /// A formula, a definition or a setting, to be entered into the document.
    Text(&'a str),
    /// A command and its arguments.
    Command(&'static CommandRow, &'a str),
}

/// What commands are used for. The help lists them in this order.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    /// Changing the document.
    Document,
    /// Choosing what the picture shows, and how.
    View,
    /// Reading and writing files.
    Files,
    /// Finding out about the surfaces.
    Questions,
    /// Choosing how surfaces are found.
    Methods,
    /// Using the program.
    Program,
}

impl Purpose {
    /// All uses, with their titles.
    pub(super) const ALL: [(Self, &str); 6] = [
        (Self::Document, "Change the document"),
        (Self::View, "Look at it"),
        (Self::Files, "Open and save"),
        (Self::Questions, "Measure and ask"),
        (Self::Methods, "Choose how surfaces are found"),
        (Self::Program, "Use the prompt"),
    ];
}

/// A command: its description and its function.
#[derive(Clone, Copy)]
pub struct CommandRow {
    /// Name, without the colon.
    pub name: &'static str,
    /// Arguments, in the notation of a manual page.
    pub arguments: &'static str,
    /// One line of help.
    pub doc: &'static str,
    /// The use under which the help lists the command.
    pub(super) purpose: Purpose,
    /// The command as it may be typed.
    pub(super) example: &'static str,
    /// Runs the command. Returns `None` if the arguments do not match `arguments`.
    run: fn(&Live, &str) -> Option<Result<Reply, Refusal>>,
}

/// Name of the command that adds a surface.
const ADD: &str = "add";

/// Name of the command that replaces one formula.
const EDIT: &str = "edit";

/// Name of the command that chooses the method. Commands of method options follow in [`COMMANDS`].
const METHOD: &str = "method";

/// All commands, in the order of the help, including those of settings and method options.
pub static COMMANDS: LazyLock<Vec<CommandRow>> = LazyLock::new(|| {
    let options = OPTIONS.iter().filter(|option| !option.command.is_empty());
    let rows = options.map(|option| CommandRow {
        name: option.command,
        arguments: option.arguments,
        doc: option.prompt_help,
        purpose: Purpose::Methods,
        example: "",
        // Never called, since [`Live::enter`] sets method options itself.
        run: |_, _| None,
    });
    let choices = settings().filter(|row| is_written(row.word)).map(|row| CommandRow {
        name: row.word,
        arguments: row.values.notation(),
        doc: row.help,
        purpose: Purpose::View,
        example: "",
        // Never called, since [`Live::enter`] writes the line itself.
        run: |_, _| None,
    });
    let method = ROWS.iter().position(|row| row.name == METHOD).unwrap_or(0);
    let (before, after) = ROWS.split_at(method);
    let (method, after) = after.split_at(1);
    let (before, method, after) = (before.iter(), method.iter(), after.iter());
    before
        .copied()
        .chain(choices)
        .chain(method.copied())
        .chain(rows)
        .chain(after.copied())
        .collect()
});

/// The commands that have a function of their own.
#[rustfmt::skip]
const ROWS: &[CommandRow] = &[
    CommandRow { name: "help", arguments: "[NAME]", doc: "what can be typed, or what a function or command is",
        purpose: Purpose::Program, example: ":help min",
        run: |_, name| Some(help(name)) },
    CommandRow { name: "list", arguments: "", doc: "show the document",
        purpose: Purpose::Document, example: ":list",
        run: |live, rest| rest.is_empty().then(|| say(live.text())) },
    CommandRow { name: ADD, arguments: "FORMULA", doc: "draw one more surface beside the others",
        purpose: Purpose::Document, example: ":add z = 0",
        run: |live, formula| Some(live.commit(&given(formula)?, LineGoal::Add)) },
    CommandRow { name: EDIT, arguments: "N FORMULA", doc: "replace the N-th formula",
        purpose: Purpose::Document, example: ":edit 1 z = x",
        run: |live, rest| { let (number, formula) = numbered(rest)?; Some(live.commit(formula, LineGoal::Edit(number))) } },
    CommandRow { name: "delete", arguments: "[N]", doc: "delete the N-th surface; without a number, list them",
        purpose: Purpose::Document, example: ":delete 2",
        run: |live, number| Some(delete(live, optional(number, |number| number.parse().ok())?)) },
    CommandRow { name: "hide", arguments: "N", doc: "hide the N-th surface or curve",
        purpose: Purpose::Document, example: ":hide 1",
        run: |live, number| Some(done(live.hide(number.parse().ok()?, true))) },
    CommandRow { name: "show", arguments: "[N]", doc: "show the N-th surface or curve again; without a number, all",
        purpose: Purpose::Document, example: ":show 1",
        run: |live, number| Some(done(match optional(number, |number| number.parse().ok())? {
            Some(number) => live.hide(number, false),
            None => live.show_all(),
        })) },
    CommandRow { name: "opacity", arguments: "N SHARE", doc: "how opaque the N-th surface is, as 50% or 0.5",
        purpose: Purpose::Document, example: ":opacity 1 50%",
        run: |live, rest| { let (number, share) = rest.split_once(' ')?; Some(done(live.set_opacity(number.parse().ok()?, OPACITY.values.read(share.trim(), number::number).ok()?))) } },
    CommandRow { name: "move", arguments: "N TO", doc: "move the N-th surface to another place in the list",
        purpose: Purpose::Document, example: ":move 2 1",
        run: |live, rest| { let (from, to) = rest.split_once(' ')?; Some(done(live.move_surface(from.parse().ok().filter(|from| *from > 0)?, to.trim().parse().ok().filter(|to| *to > 0)?))) } },
    CommandRow { name: "clear", arguments: "", doc: "delete the whole document",
        purpose: Purpose::Document, example: ":clear",
        run: |live, rest| rest.is_empty().then(|| { live.clear(); Ok(Reply::Done) }) },
    CommandRow { name: "undo", arguments: "", doc: "undo the last step",
        purpose: Purpose::Document, example: ":undo",
        run: |live, rest| rest.is_empty().then(|| if live.undo() { Ok(Reply::Done) } else { refused("there is nothing to undo".to_owned()) }) },
    CommandRow { name: "redo", arguments: "", doc: "redo what was undone",
        purpose: Purpose::Document, example: ":redo",
        run: |live, rest| rest.is_empty().then(|| if live.redo() { Ok(Reply::Done) } else { refused("there is nothing to redo".to_owned()) }) },
    CommandRow { name: "set", arguments: "NAME = VALUE", doc: "give a name a value",
        purpose: Purpose::Document, example: ":set r = 2",
        run: set },
    CommandRow { name: "domain", arguments: "auto|R|X0,X1,Y0,Y1,Z0,Z1", doc: "set the domain that is shown",
        purpose: Purpose::View, example: ":domain 3",
        run: |live, domain| Some(look_at(live, domain.parse().ok()?)) },
    CommandRow { name: "clip", arguments: "[A,B,C,D|off]", doc: "keep only A*x + B*y + C*z <= D",
        purpose: Purpose::View, example: ":clip 1,0,0,0",
        run: |live, plane| cut::clip(live, plane) },
    CommandRow { name: "view", arguments: "iso|front|back|left|right|top|bottom", doc: "look from this side",
        purpose: Purpose::View, example: ":view top",
        run: |live, name| StandardView::named(name).map(|view| look_from(live, view)) },
    CommandRow { name: "look", arguments: "[NAME]", doc: "lighting and background",
        purpose: Purpose::View, example: ":look paper",
        run: |live, name| Some(look(live, name)) },
    CommandRow { name: "shadows", arguments: "[on|off]", doc: "cast shadows",
        purpose: Purpose::View, example: ":shadows on",
        run: |live, choice| Some(shadows(live, optional(choice, switch)?)) },
    CommandRow { name: "aspect", arguments: "auto|equal", doc: "scale axes for display, or keep all alike",
        purpose: Purpose::View, example: ":aspect equal",
        run: |live, rest| write(live, "aspect", rest) },
    CommandRow { name: "background", arguments: "COLOR|transparent", doc: "color behind the surfaces, or none",
        purpose: Purpose::View, example: ":background white",
        run: |live, rest| write(live, "background", rest) },
    CommandRow { name: "light", arguments: "X,Y,Z", doc: "where the light is",
        purpose: Purpose::View, example: ":light 4,-3,6",
        run: |live, rest| write(live, "light", rest) },
    CommandRow { name: "contours", arguments: "[EXPRESSION][, DISTANCE]", doc: "lines of equal value on the surfaces",
        purpose: Purpose::View, example: ":contours z, 0.5",
        run: |live, rest| write(live, "contours", rest) },
    CommandRow { name: "color", arguments: "[N] COLOR", doc: "color of the N-th surface, or of all",
        purpose: Purpose::View, example: ":color tomato",
        run: |live, rest| match numbered(rest) {
            Some((number, color)) => Some(done(live.set_color(number, color))),
            None => write(live, "color", rest),
        } },
    CommandRow { name: "material", arguments: "matte|satin|gloss|metal|glass", doc: "how all surfaces reflect light",
        purpose: Purpose::View, example: ":material metal",
        run: |live, rest| write(live, "material", rest) },
    CommandRow { name: "title", arguments: "TEXT", doc: "a title at the top",
        purpose: Purpose::View, example: ":title A torus",
        run: |live, rest| write(live, "title", rest) },
    CommandRow { name: METHOD, arguments: "[NAME]", doc: "how rays are traced",
        purpose: Purpose::Methods, example: ":method march",
        run: |live, name| Some(method(live, name)) },
    CommandRow { name: "time", arguments: "T", doc: "set the time t",
        purpose: Purpose::View, example: ":time 0.5",
        run: |live, time| number::number(time).map(|_| live.set(TIME, time)) },
    CommandRow { name: "load", arguments: "FILE|NAME", doc: "draw a file or a surface of the gallery",
        purpose: Purpose::Files, example: ":load torus.zset",
        run: |_, from| Some(Ok(Reply::Load(given(from)?))) },
    CommandRow { name: "gallery", arguments: "", doc: "choose among the pictures of the gallery; without a window, list them",
        purpose: Purpose::Files, example: ":gallery",
        run: |_, rest| rest.is_empty().then_some(Ok(Reply::Gallery)) },
    CommandRow { name: "save", arguments: "[FILE.zset]", doc: "write the document",
        purpose: Purpose::Files, example: ":save torus.zset",
        run: |_, to| Some(Ok(Reply::Save(given(to)))) },
    CommandRow { name: "png", arguments: "[FILE.png]", doc: "write the picture, and show the command that reproduces it",
        purpose: Purpose::Files, example: ":png torus.png",
        run: |_, to| Some(Ok(Reply::Png(given(to)))) },
    CommandRow { name: "mesh", arguments: "FILE.stl|obj|ply|3mf|glb [TOLERANCE]|on|off", doc: "write the surfaces as triangles of proven shape; on, off: mesh lines",
        purpose: Purpose::Files, example: ":mesh torus.stl 0.01",
        run: |live, to| if switch(to).is_some() { write(live, "mesh", to) } else { mesh(to).map(Ok) } },
    CommandRow { name: "measure", arguments: "", doc: "volume, centroid, inertia, area and shape of the surfaces",
        purpose: Purpose::Questions, example: ":measure",
        run: |_, rest| rest.is_empty().then_some(Ok(Reply::Measure)) },
    CommandRow { name: "explain", arguments: "[code]", doc: "how the document was read, simplified and compiled",
        purpose: Purpose::Questions, example: ":explain",
        run: |_, what| matches!(what, "" | "code").then(|| Ok(Reply::Explain { code: !what.is_empty() })) },
    CommandRow { name: "status", arguments: "", doc: "what the picture shows and what it took",
        purpose: Purpose::Questions, example: ":status",
        run: |live, rest| rest.is_empty().then(|| say(status::describe(&live.snapshot()))) },
    CommandRow { name: "tips", arguments: "on|off", doc: "show tips in the window, each once",
        purpose: Purpose::Program, example: ":tips off",
        run: |_, choice| switch(choice).map(|wanted| Ok(Reply::Tips(wanted))) },
    CommandRow { name: "quit", arguments: "", doc: "end",
        purpose: Purpose::Program, example: ":quit",
        run: |_, rest| rest.is_empty().then_some(Ok(Reply::Quit)) },
];

/// Words that are commands even without a colon, unless the document defines them, and the names
/// of their commands.
const BARE_WORDS: [(&str, &str); 3] = [("help", "help"), ("quit", "quit"), ("exit", "quit")];

/// A file name, and a tolerance after it if the line ends in a number. `None` if the name is
/// missing.
fn mesh(line: &str) -> Option<Reply> {
    let number = |text: &str| number::number(text).filter(|length| *length > 0.0);
    let split = line.rsplit_once(' ').and_then(|(to, last)| Some((to.trim(), number(last)?)));
    let (to, tolerance) = split.map_or((line, None), |(to, length)| (to, Some(length)));
    Some(Reply::Mesh { to: given(to)?, tolerance })
}

impl Live {
    /// Previews a line that is being typed: draws the document as it would be after entering
    /// `line`. Commands other than `:add` and `:edit` are not previewed.
    pub fn type_line(&self, line: &str) {
        match self.read(line) {
            Ok(Line::Text(formula)) => self.show_typed(Some(formula), LineGoal::Replace),
            Ok(Line::Command(row, formula)) if row.name == ADD && !formula.is_empty() => {
                self.show_typed(Some(formula), LineGoal::Add);
            }
            Ok(Line::Command(row, rest))
                if row.name == EDIT
                    && let Some((number, formula)) = numbered(rest) =>
            {
                self.show_typed(Some(formula), LineGoal::Edit(number));
            }
            Ok(Line::Empty | Line::Command(..)) | Err(_) => {
                self.show_typed(None, LineGoal::Replace);
            }
        }
    }

    /// Enters a line: a formula, definition or setting of the document, or a command.
    ///
    /// # Errors
    /// If the document would have errors, or the command is wrong.
    pub fn enter(&self, line: &str) -> Result<Reply, Refusal> {
        match self.read(line).map_err(Refusal::Command)? {
            Line::Empty => {
                self.refresh();
                Ok(Reply::Done)
            }
            Line::Text(line) => self.commit(line, LineGoal::Replace),
            Line::Command(row, arguments) => {
                if let Some(row) = OPTIONS.iter().find(|option| option.command == row.name) {
                    return option(self, row, arguments);
                }
                let result = if is_written(row.name) {
                    write(self, row.name, arguments)
                } else {
                    (row.run)(self, arguments)
                };
                result.unwrap_or_else(|| Err(Refusal::Command(format!("usage: {}", row.usage()))))
            }
        }
    }

    /// As [`read`], but words such as `quit` are commands, too, unless the document defines them.
    fn read<'a>(&self, line: &'a str) -> Result<Line<'a>, String> {
        let line = read(line)?;
        let Line::Text(word) = line else { return Ok(line) };
        let Some((_, command)) = BARE_WORDS.iter().find(|(bare, _)| *bare == word) else {
            return Ok(line);
        };
        let request = self.request();
        let is_set = request.overrides.iter().any(|(name, _)| name == word);
        if is_set || defined(&request.text).iter().any(|name| name == word) {
            return Ok(line);
        }
        Ok(Line::Command(row(command)?, ""))
    }
}

fn done(result: Result<(), Refusal>) -> Result<Reply, Refusal> {
    result.map(|()| Reply::Done)
}

/// A number and the text after it.
fn numbered(text: &str) -> Option<(usize, &str)> {
    let (number, rest) = text.split_once(' ')?;
    Some((number.parse().ok()?, rest.trim())).filter(|(_, rest)| !rest.is_empty())
}

/// Returns the text, or `None` if it is empty.
fn given(text: &str) -> Option<String> {
    (!text.is_empty()).then(|| text.to_owned())
}

/// Parses an optional argument: `Some(None)` if it is missing, `None` if it is malformed.
#[allow(clippy::option_option)] // tells a missing argument from a malformed one
fn optional<T>(text: &str, read: impl FnOnce(&str) -> Option<T>) -> Option<Option<T>> {
    if text.is_empty() { Some(None) } else { read(text).map(Some) }
}

fn set(live: &Live, text: &str) -> Option<Result<Reply, Refusal>> {
    let (name, value) = text.split_once('=').or_else(|| text.split_once(' '))?;
    let (name, value) = (name.trim(), value.trim());
    let plain = |c: char| c.is_alphanumeric() || c == '_';
    let valid = !name.is_empty() && name.chars().all(plain) && !value.is_empty();
    // Accept one definition only.
    if !valid || value.contains(['\n', ';', '=']) {
        return None;
    }
    Some(match (name, number::number(value)) {
        (TIME, None) => refused(format!("'{value}' is not a finite number")),
        _ => live.set(name, value),
    })
}

fn delete(live: &Live, number: Option<usize>) -> Result<Reply, Refusal> {
    if let Some(number) = number {
        return live.delete(number);
    }
    let echoes = live.request().read().map_or(Vec::new(), |document| {
        let surfaces = document.drawn_surfaces().map(|surface| surface.echo.to_owned());
        surfaces.chain(document.curves.all.iter().map(|curve| curve.echo.clone())).collect()
    });
    let lines: Vec<String> = (1..)
        .zip(&echoes)
        .map(|(number, echo): (usize, &String)| format!("{number}  {echo}"))
        .collect();
    say(if lines.is_empty() { "nothing is drawn".to_owned() } else { lines.join("\n") })
}

/// Returns whether a command without a function of its own writes a setting's line.
fn is_written(name: &str) -> bool {
    settings().any(|row| row.is_line && row.word == name) && ROWS.iter().all(|row| row.name != name)
}

/// Writes a setting's line into the document. Returns `None` without arguments. After a line about
/// axes, the window's key for axes no longer overrides the document.
fn write(live: &Live, word: &str, arguments: &str) -> Option<Result<Reply, Refusal>> {
    let line = format!("{word} {}", given(arguments)?);
    let written = live.commit(&line, LineGoal::Replace);
    if word == "axes" && written.is_ok() && live.request().axes != Axes::Usual {
        live.set_axes(Axes::Usual);
    }
    Some(written)
}

/// Changes the domain that the picture shows.
fn look_at(live: &Live, domain: DomainChoice) -> Result<Reply, Refusal> {
    if let DomainChoice::Bounds([x0, x1, y0, y1, z0, z1]) = domain
        && let Err(error) = Region::new([x0, y0, z0].into(), [x1, y1, z1].into())
    {
        return refused(error.to_string());
    }
    live.change(|request| request.domain = domain);
    Ok(Reply::Done)
}

#[allow(clippy::unnecessary_wraps)] // same signature as all commands
fn look_from(live: &Live, view: &'static StandardView) -> Result<Reply, Refusal> {
    live.change(|request: &mut Request| {
        let projection = request.choice.projection;
        request.orbit = None;
        request.choice = CameraChoice { view: Some(view), projection, ..CameraChoice::default() };
    });
    Ok(Reply::Done)
}

/// Parses a line. A command may be shortened to any unique prefix.
///
/// # Errors
/// A one-line message about a wrong command, with a suggestion if there is one.
fn read(text: &str) -> Result<Line<'_>, String> {
    let text = text.trim();
    let Some(command) = text.strip_prefix(':') else {
        return Ok(if text.is_empty() { Line::Empty } else { Line::Text(text) });
    };
    let (name, arguments) = command.split_once(char::is_whitespace).unwrap_or((command, ""));
    Ok(Line::Command(row(name)?, arguments.trim()))
}

impl CommandRow {
    /// Returns the command with its arguments, as the help shows them.
    pub fn usage(&self) -> String {
        format!(":{} {}", self.name, self.arguments).trim_end().to_owned()
    }

    /// Returns the command as it may be typed. The example of a method option is its default.
    pub(super) fn as_typed(&self) -> String {
        let option = OPTIONS.iter().find(|option| option.command == self.name);
        let choice = settings().find(|choice| choice.word == self.name);
        let option = option.map(|option| (option.get)(&TraceOptions::default()));
        match option.or(choice.map(|choice| choice.example.to_owned())) {
            Some(value) => format!(":{} {value}", self.name),
            None => self.example.to_owned(),
        }
    }
}

/// Finds the row of a command by its name, by another word for it, or by a unique prefix.
fn row(name: &str) -> Result<&'static CommandRow, String> {
    let bare = BARE_WORDS.iter().find(|(bare, _)| *bare == name);
    let name = bare.map_or(name, |(_, command)| command);
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
        // Correct small typing errors only, and do not suggest other words.
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
        assert_eq!(command(":dep 12"), ("depth", "12"));
    }

    #[test]
    fn bare_words_are_commands_unless_the_document_defines_them() {
        let live = Live::new(Request::default());
        for word in ["quit", " exit ", ":exit"] {
            assert_eq!(live.enter(word).expect(word), Reply::Quit, "{word}");
        }
        assert!(matches!(live.enter("help"), Ok(Reply::Say(text)) if text.contains(":quit")));
        assert_eq!(live.text(), "");
        live.enter("quit = 3").expect("a definition");
        live.enter("x^2+y^2 = quit").expect("a surface");
        assert_ne!(live.enter("quit").ok(), Some(Reply::Quit));
        assert!(matches!(live.enter("help"), Ok(Reply::Say(_))));
    }

    #[test]
    fn what_follows_a_command_is_read() {
        let live = Live::new(Request::default());
        for (line, expected) in [
            (":save", Reply::Save(None)),
            (":png a.png", Reply::Png(Some("a.png".to_owned()))),
            (":mesh a.stl", Reply::Mesh { to: "a.stl".to_owned(), tolerance: None }),
            (
                ":mesh my part.stl 1e-2",
                Reply::Mesh { to: "my part.stl".to_owned(), tolerance: Some(0.01) },
            ),
            (":measure", Reply::Measure),
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
        assert_eq!(live.request().choice.view, StandardView::named("top"));
        live.enter(":prec f64").expect("a precision");
        assert_eq!(live.settings().options.precision, zeroset_trace::Precision::F64);
        for line in [":set r = 2", ":set r=2", ":set r 2"] {
            live.clear();
            live.enter(line).expect(line);
            assert_eq!(live.text(), "r = 2", "{line}");
        }
        for (line, text) in [
            (":time 1/4", "r = 2\nt = 1/4"),
            (":set t = -1/8", "r = 2\nt = -1/8"),
            ("t = 1 in [0, 2]", "r = 2\nt = 1 in [0, 2]"),
            (":time 20", "r = 2\nt = 20 in [0, 20]"),
        ] {
            live.enter(line).expect(line);
            assert_eq!(live.text(), text, "{line}");
        }
    }

    #[test]
    fn settings_of_the_document_have_commands() {
        let live = Live::new(Request::default());
        live.enter("x^2+y^2+z^2 = 1").expect("a surface");
        for row in COMMANDS.iter().filter(|row| row.purpose == Purpose::View) {
            if matches!(row.name, "domain" | "view" | "look" | "clip" | "shadows" | "time") {
                continue;
            }
            let typed = row.as_typed();
            let line = &typed[1..];
            live.clear();
            live.enter("x^2+y^2+z^2 = 1").expect("a surface");
            live.enter(&typed).expect(&typed);
            let with_colon = live.text();
            assert!(with_colon.lines().any(|one| one == line), "{with_colon}");
            live.enter(line).expect(line);
            assert_eq!(live.text(), with_colon);
            assert!(message(&format!(":{}", row.name)).starts_with("usage: :"), "{line}");
        }
        live.enter(":mesh on").expect("a setting");
        assert!(live.text().ends_with("\nmesh on"), "{}", live.text());
        let wrong = live.enter(":ground maybe").expect_err("no switch").to_string();
        assert!(wrong.contains("`ground`"), "{wrong}");
    }

    #[test]
    fn a_command_for_axes_overrides_the_key() {
        let live = Live::new(Request::default());
        live.enter("x^2+y^2+z^2 = 1").expect("a surface");
        live.set_axes(Axes::Off);
        live.enter(":axes on").expect("a setting");
        assert_eq!(
            (live.request().axes, live.text().lines().last()),
            (Axes::Usual, Some("axes on"))
        );
    }

    #[test]
    fn what_is_wrong_is_said_with_a_suggestion() {
        assert!(message(":hepl").ends_with("did you mean :help?"));
        assert!(message(":stauts").ends_with("did you mean :status?"));
        assert!(
            message(":s")
                .contains("did you mean :show or :set or :shadows or :steps or :save or :status?")
        );
        assert!(message(":xylophone").ends_with(":help lists them"));
        assert!(message(":").contains(":help"));
        assert!(message(":help qqqqqq").starts_with("no function or command named 'qqqqqq'"));
        for text in [":tolerance -1", ":tolerance 0", ":tolerance nan", ":tolerance 101"] {
            assert!(message(text).contains("above 0"), "{text}");
        }
        assert!(message(":tolerance fine").contains("'fine' is not a number"));
        assert!(message(":precision f16").contains("'f16' is not one of auto, f32, f64"));
        assert!(message(":depth 0").contains("between 1 and 20, or 40 in precision f64"));
        assert!(message(":set t = soon").contains("'soon' is not a finite number"));
        for text in [
            ":domain nonsense",
            ":domain 1,2",
            ":time",
            ":time inf",
            ":view up",
            ":explain all",
            ":set",
            ":set r =",
            ":set r = 1\nx",
            ":quit now",
            ":add",
            ":delete two",
            ":clip 1,2",
            ":clip none",
            ":tips maybe",
            ":undo 2",
        ] {
            assert!(message(text).starts_with("usage: :"), "{text}");
        }
    }

    #[test]
    fn every_row_is_found_by_its_own_name() {
        for row in COMMANDS.iter() {
            assert_eq!(super::row(row.name).map(|found| found.name), Ok(row.name));
            assert!(row.doc.len() > 2 && !row.doc.ends_with('.'), "{}", row.name);
        }
    }

    #[test]
    fn every_example_is_a_command() {
        for row in ROWS {
            let (name, arguments) = command(row.example);
            assert_eq!(name, row.name);
            let live = Live::new(Request::default());
            live.enter("x^2+y^2+z^2 = 1").expect("a surface");
            live.enter(":add z = 0").expect("a surface");
            // The row answers `None` if it does not understand the arguments.
            assert!((row.run)(&live, arguments).is_some(), "{}", row.example);
        }
    }
}
