//! One document and its picture, as all who type, drag and look share them.

use super::command::{self, COMMANDS, Command, Line};
use super::draft::entered;
use super::orbit::Orbit;
use super::pipeline::{Pipeline, View, Wish};
use crate::picture::{Precision, Settings};
use crate::program::{Program, ProgramError};
use crate::scene::{CameraChoice, DomainChoice};
use std::fmt::Write as _;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use zeroset_interval::Interval;
use zeroset_syntax::ast::Statement;
use zeroset_syntax::{ErrorKind, Errors, Limits, Options, ParameterKind, language_names, parse};
use zeroset_trace::{HalfSpace, METHODS, Method, Region, UndecidedStyle};

/// What to begin with.
#[derive(Clone, Debug, Default)]
pub struct Start {
    /// What the text is called in messages.
    pub name: String,
    /// The document; empty if there is none yet.
    pub text: String,
    /// Names with values that replace those of the text.
    pub overrides: Vec<(String, String)>,
    /// The time, whatever the text says.
    pub time: Option<f64>,
    /// Where to look.
    pub domain: DomainChoice,
    /// What to cut away.
    pub clip: Option<HalfSpace>,
    /// From where to look.
    pub choice: CameraChoice,
    /// How pictures are made.
    pub settings: Settings,
}

/// A document that is typed and turned, and its picture.
///
/// All methods may be called from any thread.
pub struct Live {
    desk: Mutex<Desk>,
    pipeline: Pipeline,
}

struct Desk {
    /// The wish for the document as entered.
    wish: Wish,
    /// The text last wished for, with what is being typed.
    shown: Arc<str>,
    /// The last text that could be read, from which typing goes on when a watched file no longer can.
    good: Arc<str>,
    revision: u64,
}

impl Desk {
    /// What a line is entered into.
    fn base(&self) -> &str {
        let limits = Limits::default();
        if parse(&self.wish.text, &limits).is_ok() { &self.wish.text } else { &self.good }
    }
}

/// What a line that was entered leads to.
#[derive(Clone, Debug, PartialEq)]
pub enum Reply {
    /// It is done.
    Done,
    /// It is done, and this is to be shown.
    Say(String),
    /// The caller is to find this text and hand it to [`Live::load`].
    Load(String),
    /// The caller is to write [`Live::text`] to this file, or to where it came from.
    Save(Option<String>),
    /// The caller is to write the picture to this file, or to one with a new name.
    Png(Option<String>),
    /// The caller is to show how the document was read and compiled, with the code or without.
    Explain {
        /// Whether the code is asked for.
        code: bool,
    },
    /// The caller is to end.
    Quit,
}

/// Why a line was not entered. Nothing has changed then.
#[derive(Debug)]
pub enum Refusal {
    /// The document would be wrong.
    Text {
        /// What it would be.
        text: String,
        /// What is wrong with it.
        errors: Errors,
    },
    /// A formula would have no surface: it is constant, or defined nowhere.
    Program(ProgramError),
    /// The command is wrong.
    Command(String),
}

impl Refusal {
    /// What is wrong, with carets under a text.
    pub fn render(&self, color: bool) -> String {
        match self {
            Self::Text { text, errors } => errors.render(None, text, color),
            Self::Program(error) => format!("error: {error}"),
            Self::Command(message) => format!("error: {message}"),
        }
    }
}

impl std::fmt::Display for Refusal {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Text { errors, .. } => write!(f, "{errors}"),
            Self::Program(error) => write!(f, "{error}"),
            Self::Command(message) => f.write_str(message),
        }
    }
}

impl std::error::Error for Refusal {}

impl Live {
    /// Starts to make pictures of a document.
    pub fn new(start: Start) -> Self {
        let Start { name, text, overrides, time, domain, clip, choice, settings } = start;
        let text: Arc<str> = text.into();
        let wish =
            Wish { name, text, overrides, time, domain, clip, choice, orbit: None, settings };
        let shown = Arc::clone(&wish.text);
        let desk = Desk { good: Arc::clone(&shown), shown, wish: wish.clone(), revision: 0 };
        let live = Self { desk: Mutex::new(desk), pipeline: Pipeline::new(wish) };
        live.change(|_| {});
        live
    }

    fn lock(&self) -> MutexGuard<'_, Desk> {
        // Every write leaves the desk whole, so a panic elsewhere does not spoil it.
        self.desk.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What can be seen now.
    pub fn view(&self) -> View {
        self.pipeline.view()
    }

    /// Waits until the fine picture of everything asked for so far, or what is wrong with it, is there, and tells whether
    /// it came to that in time.
    pub fn wait(&self, timeout: Duration) -> bool {
        let revision = self.lock().revision;
        self.pipeline.wait(timeout, |view, _| view.settled >= revision)
    }

    /// Waits until something newer than the picture or fault with this number can be seen, and tells whether it came to
    /// that in time.
    pub fn wait_for_news(&self, timeout: Duration, seen: u64) -> bool {
        self.pipeline.wait(timeout, |view, _| {
            let frame = view.frame.as_ref().map_or(0, |frame| frame.revision);
            frame.max(view.fault.as_ref().map_or(0, |fault| fault.revision)) > seen
        })
    }

    /// Number of the latest wish for a picture.
    pub fn revision(&self) -> u64 {
        self.lock().revision
    }

    /// What the picture is to show when nothing more is typed.
    pub fn shown(&self) -> Wish {
        self.lock().wish.clone()
    }

    /// The document as entered so far.
    pub fn text(&self) -> String {
        self.lock().wish.text.to_string()
    }

    /// What the document is called.
    pub fn name(&self) -> String {
        self.lock().wish.name.clone()
    }

    /// How pictures are made at present.
    pub fn settings(&self) -> Settings {
        self.lock().wish.settings.clone()
    }

    /// Shows what the document would be if `line`, which is still being typed, were entered. A command shows nothing new.
    pub fn type_line(&self, line: &str) {
        let mut desk = self.lock();
        let shown: Arc<str> = match command::line(line) {
            Ok(Line::Text(typed)) => entered(desk.base(), typed, false).into(),
            Ok(Line::Command(Command::Add(typed))) => entered(desk.base(), &typed, true).into(),
            Ok(Line::Empty | Line::Command(_)) | Err(_) => Arc::clone(&desk.wish.text),
        };
        if shown != desk.shown {
            self.show(&mut desk, shown);
        }
    }

    /// Enters a line: a part of the document, or a command.
    ///
    /// # Errors
    /// If the document would be wrong, or the command is.
    pub fn enter(&self, line: &str) -> Result<Reply, Refusal> {
        match command::line(line).map_err(Refusal::Command)? {
            Line::Empty => {
                self.change(|_| {});
                Ok(Reply::Done)
            }
            Line::Text(line) => self.commit(line, false),
            Line::Command(command) => self.carry_out(command),
        }
    }

    fn commit(&self, line: &str, adding: bool) -> Result<Reply, Refusal> {
        let mut desk = self.lock();
        let text = entered(desk.base(), line, adding);
        let options =
            Options { overrides: &desk.wish.overrides, time: desk.wish.time, ..Options::default() };
        let reply = match zeroset_syntax::read(&text, &options) {
            Ok(document) => {
                Program::new(&document, [Interval::ENTIRE; 3]).map_err(Refusal::Program)?;
                Reply::Done
            }
            // A definition may come before the formula that needs it.
            Err(errors) if errors.iter().all(waits) => {
                Reply::Say("noted; nothing is drawn yet".to_owned())
            }
            Err(errors) => return Err(Refusal::Text { text, errors }),
        };
        desk.wish.text = text.into();
        desk.good = Arc::clone(&desk.wish.text);
        if reply == Reply::Done {
            let shown = Arc::clone(&desk.wish.text);
            self.show(&mut desk, shown);
        }
        Ok(reply)
    }

    fn carry_out(&self, command: Command) -> Result<Reply, Refusal> {
        let refused = |message: String| Err(Refusal::Command(message));
        match command {
            Command::Help(name) => match name {
                None => Ok(Reply::Say(help())),
                Some(name) => help_on(&name).map(Reply::Say).map_err(Refusal::Command),
            },
            Command::List => Ok(Reply::Say(self.text())),
            Command::Add(line) => self.commit(&line, true),
            Command::Set { name, value } if name == "t" => match value.parse::<f64>() {
                Ok(time) if time.is_finite() => {
                    self.change(|wish| wish.time = Some(time));
                    Ok(Reply::Done)
                }
                _ => refused(format!("'{value}' is not a finite number")),
            },
            Command::Set { name, value } => self.set(&name, &value),
            Command::Domain(choice) => {
                if let DomainChoice::Bounds([x0, x1, y0, y1, z0, z1]) = choice
                    && let Err(error) = Region::new([x0, y0, z0].into(), [x1, y1, z1].into())
                {
                    return refused(error.to_string());
                }
                self.change(|wish| wish.domain = choice);
                Ok(Reply::Done)
            }
            Command::View(view) => {
                self.change(|wish| {
                    let projection = wish.choice.projection;
                    wish.orbit = None;
                    wish.choice =
                        CameraChoice { view: Some(view), projection, ..CameraChoice::default() };
                });
                Ok(Reply::Done)
            }
            Command::Method(None) => Ok(Reply::Say(methods(self.settings().method))),
            Command::Method(Some(name)) => match Method::named(&name) {
                Some(method) => {
                    self.change(|wish| wish.settings.method = method);
                    Ok(Reply::Done)
                }
                None => {
                    let names: Vec<&str> = METHODS.iter().map(|row| row.name).collect();
                    refused(format!("no method named '{name}'; there is {}", names.join(", ")))
                }
            },
            Command::Tolerance(length) => self.tolerance(length),
            Command::Precision(precision) => Ok(self.precision(precision)),
            Command::Time(time) => {
                self.change(|wish| wish.time = Some(time));
                Ok(if self.depends_on_time() {
                    Reply::Done
                } else {
                    Reply::Say("noted; nothing here depends on the time t".to_owned())
                })
            }
            Command::Load(from) => Ok(Reply::Load(from)),
            Command::Save(to) => Ok(Reply::Save(to)),
            Command::Png(to) => Ok(Reply::Png(to)),
            Command::Explain { code } => Ok(Reply::Explain { code }),
            Command::Status => Ok(Reply::Say(super::status::describe(&self.view()))),
            Command::Quit => Ok(Reply::Quit),
        }
    }

    /// Gives a name a value in the document; a slider keeps its range if the value lies within.
    fn set(&self, name: &str, value: &str) -> Result<Reply, Refusal> {
        let text = self.text();
        let statements = parse(&text, &Limits::default()).unwrap_or_default();
        let range = statements.iter().find_map(|one| match one {
            Statement::Define(definition) if definition.name.text == name => {
                let (low, high) = definition.range.as_ref()?;
                let part = |span: zeroset_syntax::Span| text.get(span.start..span.end);
                Some(format!(" in [{}, {}]", part(low.span)?, part(high.span)?))
            }
            Statement::Define(_) | Statement::Draw { .. } => None,
        });
        let definition = entered(&text, &format!("{name} = {value}"), false);
        let defines = |one: &Statement| match one {
            Statement::Define(definition) => definition.name.text == name,
            Statement::Draw { .. } => false,
        };
        if parse(&definition, &Limits::default()).is_ok_and(|all| !all.iter().any(defines)) {
            return Err(Refusal::Command(format!(
                "`{name}` has a fixed meaning and cannot be set"
            )));
        }
        // What was given on the command line would otherwise go on to hide the definition.
        let given = self.lock().wish.overrides.clone();
        self.lock().wish.overrides.retain(|(other, _)| other != name);
        let with_range = range.map(|range| self.commit(&format!("{name} = {value}{range}"), false));
        let result = match with_range {
            Some(Ok(reply)) => Ok(reply),
            Some(Err(_)) | None => self.commit(&format!("{name} = {value}"), false),
        };
        if result.is_err() {
            self.lock().wish.overrides = given;
        }
        result
    }

    fn tolerance(&self, length: Option<f64>) -> Result<Reply, Refusal> {
        let Some(frame) = self.view().frame else {
            return Err(Refusal::Command("there is no picture yet".to_owned()));
        };
        let extent = 2.0 * frame.model.region().half_extent();
        if let Some(length) = length {
            let most = self.settings().precision.max_depth();
            let depth = (extent / length).log2().ceil().clamp(1.0, f64::from(most));
            self.change(|wish| wish.settings.max_depth = depth as u32);
        }
        let depth = self.settings().max_depth;
        let slab = extent * 0.5_f64.powi(depth as i32);
        Ok(Reply::Say(format!("depth {depth}: slabs of at most {slab:.2e}")))
    }

    /// Whether t occurs; a document that is wrong is taken to.
    fn depends_on_time(&self) -> bool {
        let Wish { text, overrides, .. } = self.lock().wish.clone();
        let options = Options { overrides: &overrides, ..Options::default() };
        zeroset_syntax::read(&text, &options).map_or(true, |document| {
            document.parameters.iter().any(|parameter| parameter.kind == ParameterKind::Time)
        })
    }

    /// Slabs that are too thin for the new floats become as thin as they can be.
    fn precision(&self, wanted: Option<Precision>) -> Reply {
        if let Some(precision) = wanted {
            self.change(|wish| {
                wish.settings.precision = precision;
                wish.settings.max_depth = wish.settings.max_depth.min(precision.max_depth());
            });
        }
        let Settings { precision, max_depth, .. } = self.settings();
        let most = precision.max_depth();
        Reply::Say(format!("{precision}: depth {max_depth} of at most {most} (:tolerance sets it)"))
    }

    /// Takes `text` for the document. The view stays if `again`: the text is the same document in a newer version.
    pub fn load(&self, name: &str, text: &str, again: bool) {
        let readable = parse(text, &Limits::default()).is_ok();
        if readable || !again {
            self.lock().good = text.into();
        }
        self.change(|wish| {
            name.clone_into(&mut wish.name);
            wish.text = text.into();
            if !again {
                wish.orbit = None;
                wish.choice = CameraChoice::default();
                wish.domain = DomainChoice::Document;
                wish.overrides.clear();
                wish.time = None;
            }
        });
    }

    /// Asks for pictures of this size, in pixels; nothing below 1 is taken.
    pub fn resize(&self, width: usize, height: usize) {
        let (width, height) = (width.max(1), height.max(1));
        let settings = self.settings();
        if (settings.width, settings.height) != (width, height) {
            self.change(|wish| {
                (wish.settings.width, wish.settings.height) = (width, height);
            });
        }
    }

    /// Turns, moves or zooms the view; nothing happens before there is a picture.
    pub fn turn(&self, turn: impl FnOnce(&mut Orbit)) {
        let Some(frame) = self.view().frame else { return };
        self.change(|wish| {
            // The orbit last wished for, not the one last seen: it may be ahead of the pictures.
            let orbit = wish
                .orbit
                .get_or_insert_with(|| Orbit::from_camera(&frame.camera, frame.model.region()));
            turn(orbit);
        });
    }

    /// Shows the whole domain's box from the same side; nothing happens before there is a picture.
    pub fn fit(&self) {
        let Some(frame) = self.view().frame else { return };
        let Settings { width, height, .. } = self.settings();
        self.turn(|orbit| orbit.fit(frame.model.region(), width, height));
    }

    /// Looks again from where the document says.
    pub fn reset_view(&self) {
        self.change(|wish| {
            wish.orbit = None;
            wish.choice = CameraChoice::default();
        });
    }

    /// Marks undecided pixels, or no longer.
    pub fn toggle_undecided(&self) {
        self.change(|wish| {
            wish.settings.undecided = match wish.settings.undecided {
                UndecidedStyle::Shade | UndecidedStyle::Miss => UndecidedStyle::Hatch,
                UndecidedStyle::Hatch | UndecidedStyle::Tint => UndecidedStyle::Shade,
            };
        });
    }

    /// Changes the wish and drops what is being typed, unless the change leaves the text alone.
    fn change(&self, change: impl FnOnce(&mut Wish)) {
        let mut desk = self.lock();
        let before = Arc::clone(&desk.wish.text);
        change(&mut desk.wish);
        let shown =
            Arc::clone(if before == desk.wish.text { &desk.shown } else { &desk.wish.text });
        self.show(&mut desk, shown);
    }

    fn show(&self, desk: &mut Desk, shown: Arc<str>) {
        desk.shown = shown;
        if desk.shown.trim().is_empty() {
            return;
        }
        let wish = Wish { text: Arc::clone(&desk.shown), ..desk.wish.clone() };
        desk.revision = self.pipeline.wish(wish);
    }
}

/// Whether an error only says that there is nothing to draw yet.
fn waits(error: &zeroset_syntax::Error) -> bool {
    matches!(error.kind, ErrorKind::NothingToDraw { .. })
}

fn help() -> String {
    let mut text =
        String::from("Type a formula such as x^2+y^2+z^2 = 1, a definition such as r = 2, or:\n");
    let width = COMMANDS.iter().map(|row| row.usage().len()).max().unwrap_or(0);
    for row in COMMANDS {
        let _ = writeln!(text, "  {:width$}  {}", row.usage(), row.doc);
    }
    let names: Vec<&str> = zeroset_ops::names().collect();
    text.push_str("Functions (:help NAME tells more):");
    let mut column = usize::MAX;
    for name in names {
        if column.saturating_add(name.len() + 1) > 96 {
            text.push_str("\n ");
            column = 1;
        }
        column += name.len() + 1;
        let _ = write!(text, " {name}");
    }
    text
}

/// What a function or a command is.
fn help_on(name: &str) -> Result<String, String> {
    let bare = name.trim_start_matches(':');
    if let Some(row) = COMMANDS.iter().find(|row| row.name == bare) {
        return Ok(format!("{}: {}", row.usage(), row.doc));
    }
    let native: Vec<String> = zeroset_ops::natives(name)
        .map(|row| {
            let aliases = match row.aliases {
                [] => String::new(),
                aliases => format!(" (also {})", aliases.join(", ")),
            };
            format!("{}{aliases}: {}", row.name, row.doc)
        })
        .collect();
    if !native.is_empty() {
        return Ok(native.join("\n"));
    }
    let composed: Vec<String> = zeroset_ops::composed(name)
        .map(|f| format!("{}({}): {}", f.name, f.parameters.join(", "), f.doc))
        .collect();
    if !composed.is_empty() {
        return Ok(composed.join("\n"));
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
    Err(match nearest {
        Some((0, ..)) | None => format!("nothing is known of '{name}'; :help lists everything"),
        Some((.., other)) => format!("nothing is known of '{name}'; did you mean {other}?"),
    })
}

/// The table of methods, a line each, the one in use marked.
fn methods(used: &Method) -> String {
    let line = |row: &Method| {
        let mark = if row == used { '*' } else { ' ' };
        format!("{mark} {:8} {}", row.name, row.help)
    };
    METHODS.iter().map(line).collect::<Vec<_>>().join("\n")
}
