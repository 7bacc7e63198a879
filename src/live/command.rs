//! Lines that begin with a colon, as data: one row per command, from which reading, help, completion and suggestions are
//! derived. Nothing is carried out here.

use crate::picture::Precision;
use crate::scene::DomainChoice;
use zeroset_trace::StandardView;

/// What a line asks for.
#[derive(Clone, Debug, PartialEq)]
pub enum Line<'a> {
    /// Nothing but spaces.
    Empty,
    /// Part of the document.
    Text(&'a str),
    /// A command.
    Command(Command),
}

/// A command, its arguments read.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// What can be typed, or what a name means.
    Help(Option<String>),
    /// Show the document.
    List,
    /// Draw one more surface.
    Add(String),
    /// Give a name a value.
    Set {
        /// The name.
        name: String,
        /// An expression.
        value: String,
    },
    /// Where to look.
    Domain(DomainChoice),
    /// From which side to look.
    View(StandardView),
    /// How rays are traced; `None` asks which are there.
    Method(Option<String>),
    /// The largest slab that counts as a hit, in world units; `None` asks for it.
    Tolerance(Option<f64>),
    /// In which floats kernels compute; `None` asks for it.
    Precision(Option<Precision>),
    /// The value of t.
    Time(f64),
    /// Take the document from a file or the gallery.
    Load(String),
    /// Write the document to a file; `None` for the one it came from.
    Save(Option<String>),
    /// Write the picture to a file; `None` for a name not yet in use.
    Png(Option<String>),
    /// How the document was read and compiled, with the code or without.
    Explain {
        /// Whether the code is asked for.
        code: bool,
    },
    /// What the picture is of and what it took.
    Status,
    /// End.
    Quit,
}

/// One command as it is described and read.
pub struct Row {
    /// Its name, without the colon.
    pub name: &'static str,
    /// What follows the name, in the notation of a manual.
    pub arguments: &'static str,
    /// One line on what it does.
    pub doc: &'static str,
    read: fn(&str) -> Option<Command>,
}

fn some(text: &str) -> Option<String> {
    (!text.is_empty()).then(|| text.to_owned())
}

fn finite(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.is_finite())
}

/// Every command, in the order of the help.
#[rustfmt::skip]
pub const COMMANDS: &[Row] = &[
    Row { name: "help", arguments: "[NAME]", doc: "what can be typed, or what a function or command is",
        read: |text| Some(Command::Help(some(text))) },
    Row { name: "list", arguments: "", doc: "show the document",
        read: |text| text.is_empty().then_some(Command::List) },
    Row { name: "add", arguments: "FORMULA", doc: "draw one more surface beside the others",
        read: |text| Some(Command::Add(some(text)?)) },
    Row { name: "set", arguments: "NAME = VALUE", doc: "give a name a value",
        read: set },
    Row { name: "domain", arguments: "auto|R|X0,X1,Y0,Y1,Z0,Z1", doc: "where to look",
        read: |text| domain(text).map(Command::Domain) },
    Row { name: "view", arguments: "iso|front|back|left|right|top|bottom", doc: "look from this side",
        read: |text| StandardView::named(text).map(Command::View) },
    Row { name: "method", arguments: "[NAME]", doc: "how rays are traced",
        read: |text| Some(Command::Method(some(text))) },
    Row { name: "tolerance", arguments: "[LENGTH]", doc: "how finely surfaces are located, in world units",
        read: |text| Some(Command::Tolerance(match text {
            "" => None,
            _ => Some(finite(text).filter(|length| *length > 0.0)?),
        })) },
    Row { name: "precision", arguments: "[f32|f64]", doc: "in which floats is computed: f64 is slower and finer",
        read: |text| Some(Command::Precision(match text {
            "" => None,
            _ => Some(precision(text)?),
        })) },
    Row { name: "time", arguments: "T", doc: "set the time t",
        read: |text| Some(Command::Time(finite(text)?)) },
    Row { name: "load", arguments: "FILE|NAME", doc: "draw a file or a surface of the gallery",
        read: |text| Some(Command::Load(some(text)?)) },
    Row { name: "save", arguments: "[FILE.zset]", doc: "write the document",
        read: |text| Some(Command::Save(some(text))) },
    Row { name: "png", arguments: "[FILE.png]", doc: "write the picture, and show the command that makes it again",
        read: |text| Some(Command::Png(some(text))) },
    Row { name: "explain", arguments: "[code]", doc: "how the document was read, simplified and compiled",
        read: |text| matches!(text, "" | "code").then_some(Command::Explain { code: !text.is_empty() }) },
    Row { name: "status", arguments: "", doc: "what the picture shows and what it took",
        read: |text| text.is_empty().then_some(Command::Status) },
    Row { name: "quit", arguments: "", doc: "end",
        read: |text| text.is_empty().then_some(Command::Quit) },
];

fn precision(text: &str) -> Option<Precision> {
    [Precision::F32, Precision::F64].into_iter().find(|one| one.to_string() == text)
}

fn set(text: &str) -> Option<Command> {
    let (name, value) = text.split_once('=').or_else(|| text.split_once(' '))?;
    let (name, value) = (name.trim(), value.trim());
    let plain = |c: char| c.is_alphanumeric() || c == '_';
    let valid = !name.is_empty() && name.chars().all(plain) && !value.is_empty();
    // One definition, not the beginning of a document.
    let single = !value.contains(['\n', ';', '=']);
    (valid && single).then(|| Command::Set { name: name.to_owned(), value: value.to_owned() })
}

fn domain(text: &str) -> Option<DomainChoice> {
    if text == "auto" {
        return Some(DomainChoice::Auto);
    }
    let numbers: Option<Vec<f64>> = text.split(',').map(|part| finite(part.trim())).collect();
    match numbers?[..] {
        [r] => Some(DomainChoice::Bounds([-r, r, -r, r, -r, r])),
        [a, b, c, d, e, f] => Some(DomainChoice::Bounds([a, b, c, d, e, f])),
        _ => None,
    }
}

/// Reads a line. A command may be shortened to any beginning that only it has.
///
/// # Errors
/// One line that says what is wrong with a command, with a suggestion where there is one.
pub fn line(text: &str) -> Result<Line<'_>, String> {
    let text = text.trim();
    let Some(command) = text.strip_prefix(':') else {
        return Ok(if text.is_empty() { Line::Empty } else { Line::Text(text) });
    };
    let (name, arguments) = command.split_once(char::is_whitespace).unwrap_or((command, ""));
    let row = row(name)?;
    match (row.read)(arguments.trim()) {
        Some(command) => Ok(Line::Command(command)),
        None => Err(format!("usage: {}", row.usage())),
    }
}

impl Row {
    /// The command with what follows it.
    pub fn usage(&self) -> String {
        format!(":{} {}", self.name, self.arguments).trim_end().to_owned()
    }
}

/// The row of a command by its name or a beginning that only it has.
fn row(name: &str) -> Result<&'static Row, String> {
    if let Some(row) = COMMANDS.iter().find(|row| row.name == name) {
        return Ok(row);
    }
    let shortened: Vec<&Row> =
        COMMANDS.iter().filter(|row| !name.is_empty() && row.name.starts_with(name)).collect();
    if let [row] = shortened[..] {
        return Ok(row);
    }
    let shown: String = name.chars().take(20).collect();
    let options = if shortened.is_empty() {
        // A slip of the finger, not another word.
        let distance = |row: &&Row| strsim::damerau_levenshtein(row.name, &shown);
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

    fn command(text: &str) -> Command {
        match line(text) {
            Ok(Line::Command(command)) => command,
            other => panic!("{text:?} is read as {other:?}"),
        }
    }

    #[test]
    fn lines_are_told_apart() {
        assert_eq!(line("  "), Ok(Line::Empty));
        assert_eq!(line(" x+y "), Ok(Line::Text("x+y")));
        assert_eq!(command(":quit"), Command::Quit);
        assert_eq!(command(":q"), Command::Quit);
        assert_eq!(command(":help sin"), Command::Help(Some("sin".to_owned())));
        assert_eq!(command(":tolerance"), Command::Tolerance(None));
        assert_eq!(command(":tol 1e-3"), Command::Tolerance(Some(1e-3)));
        assert_eq!(
            command(":domain 2"),
            Command::Domain(DomainChoice::Bounds([-2.0, 2.0, -2.0, 2.0, -2.0, 2.0]))
        );
        for text in [":set r = 2", ":set r=2", ":set r 2"] {
            let set = Command::Set { name: "r".to_owned(), value: "2".to_owned() };
            assert_eq!(command(text), set, "{text}");
        }
        assert_eq!(command(":view top"), Command::View(StandardView::Top));
        assert_eq!(command(":precision f64"), Command::Precision(Some(Precision::F64)));
        assert_eq!(command(":prec"), Command::Precision(None));
        assert_eq!(command(":explain"), Command::Explain { code: false });
        assert_eq!(command(":explain code"), Command::Explain { code: true });
    }

    #[test]
    fn what_is_wrong_is_said_with_a_suggestion() {
        let message = |text: &str| line(text).expect_err(text);
        assert!(message(":hepl").ends_with("did you mean :help?"));
        assert!(message(":stauts").ends_with("did you mean :status?"));
        assert!(message(":s").contains("did you mean :set or :save or :status?"));
        assert!(message(":xylophone").ends_with(":help lists them"));
        assert!(message(":").contains(":help"));
        for text in [
            ":domain nonsense",
            ":domain 1,2",
            ":time",
            ":time inf",
            ":tolerance -1",
            ":tolerance nan",
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
    fn every_row_is_found_by_its_own_name() {
        for row in COMMANDS {
            assert_eq!(super::row(row.name).map(|found| found.name), Ok(row.name));
            assert!(row.doc.len() > 2 && !row.doc.ends_with('.'), "{}", row.name);
        }
    }
}
