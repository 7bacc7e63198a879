//! A whole text read: surfaces in one graph, parameters, domain, view and notes.

use crate::dialect::program_reader::program;
use crate::document::heading::heading;
use crate::document::implied_coordinates;
use crate::document::implied_drawing::{drawn_by_program, implied_drawing};
use crate::document::recursion::no_recursion;
use crate::lex::spelling::short_name;
use crate::limits::Limits;
use crate::lower::constant::near_integers;
use crate::lower::lowering::Lowering;
use crate::messages::error::{Error, ErrorKind, Errors, Fallible, MOST};
use crate::messages::note::{MOST_NOTES, Note, NoteKind};
use crate::picture::lines::{CollectedLines, PictureLines, SettingLine, placed};
use crate::picture::paint::{Contours, PointValues, SurfaceColor};
use crate::picture::scene::{DomainLine, SrgbColor, ViewLine};
use crate::span::Span;
use crate::tree::ast::{Definition, Expr, Name, Statement};
use crate::tree::built_statement::BuiltStatement;
use crate::tree::grammar::Rule;
use crate::tree::print::Drawing;
use crate::tree::scope::{NameMeaning, Scope};
use crate::tree::statement::{build, lines, settle_heads};
use rustc_hash::{FxHashMap, FxHashSet};
use zeroset_ir::{Constant, Graph, NodeId};

/// What reading depends on beside the text.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options<'a> {
    /// Names with constant expressions that replace or supply their values, in order.
    pub overrides: &'a [(String, String)],
    /// The time `t`, whatever the document says.
    pub time: Option<f64>,
    /// How much is read.
    pub limits: Limits,
}

/// A text as it was read.
#[derive(Clone, Debug)]
pub struct Document {
    /// All surfaces in one graph, exactly as typed: nothing is simplified.
    pub graph: Graph,
    /// What is drawn, in the order of the text; at least one.
    pub surfaces: Vec<Surface>,
    /// Sliders and time, by ascending number.
    pub parameters: Vec<Parameter>,
    /// The `domain` line, if there is one.
    pub domain: Option<DomainLine>,
    /// The `view` line, if there is one.
    pub view: Option<ViewLine>,
    /// How it is to be lit, if a line says so.
    pub look: Option<&'static zeroset_style::Look>,
    /// What is shown where nothing is, if a line says so.
    pub background: Option<SrgbColor>,
    /// What else is said of the picture.
    pub picture: PictureLines,
    /// Where all of that is said, in the order of the text.
    pub lines: Vec<SettingLine>,
    /// The first comment's first line, if the text starts with a comment.
    pub title: Option<String>,
    /// The rest of that comment, line breaks kept; empty if there is none.
    pub doc: String,
    /// Notes, in the order of their places.
    pub notes: Vec<Note>,
}

/// One thing to draw.
#[derive(Clone, Debug)]
pub struct Surface {
    /// The function whose zeros are drawn.
    pub root: NodeId,
    /// Whether it bounds a solid.
    pub kind: SurfaceKind,
    /// Where it was typed.
    pub span: Span,
    /// How it was read.
    pub echo: String,
    /// The color of the last `color` line above it, if there is one; of the first below it where
    /// the last such line of the document follows all drawings.
    pub color: Option<SurfaceColor>,
    /// How much of the light from behind it stops, within [0, 1]: what its `color` line says, or
    /// else the `opacity` line that is in the same place; else 1.
    pub opacity: f64,
    /// Whether it is not to be seen: what the `hidden` line in the same place says.
    pub hidden: bool,
}

/// What a surface is the surface of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceKind {
    /// An equation: only its zeros.
    Equation,
    /// An inequality: the solid where the function is ≤ 0.
    Solid,
}

/// A value that may change without recompiling.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its number in the graph.
    pub number: u32,
    /// Its value.
    pub value: Constant,
    /// The ends of its slider, or of the loop of time.
    pub range: Option<(Constant, Constant)>,
    /// Whether it is time.
    pub kind: ParameterKind,
    /// Where it was defined, if the text does so.
    pub span: Option<Span>,
}

/// What moves a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterKind {
    /// The user.
    Slider,
    /// The clock.
    Time,
}

impl Document {
    /// The line with this first word that holds for a surface, by number, if there is one.
    pub fn line_for(&self, word: &str, surface: usize) -> Option<&SettingLine> {
        let place = self.surfaces.get(surface)?.span.start;
        let last = self.surfaces.last()?.span.start;
        let lines = self.lines.iter().filter(|line| line.word == word);
        let lines: Vec<_> = lines.map(|line| (line.span.start, line)).collect();
        placed(&lines, place, last).copied()
    }
}

/// Reads a document: one line or a whole file.
///
/// # Errors
/// What is wrong with the text or with an override: at least one error, at most one for
/// each statement.
pub fn read(text: &str, options: &Options<'_>) -> Result<Document, Errors> {
    DocumentReader::new(text, options).read()
}

/// Reads a document from bytes that should be UTF-8.
///
/// # Errors
/// As [`read`], and where the bytes are not UTF-8.
pub fn read_bytes(bytes: &[u8], options: &Options<'_>) -> Result<Document, Errors> {
    match std::str::from_utf8(bytes) {
        Ok(text) => read(text, options),
        Err(error) => {
            let offset = error.valid_up_to();
            Err(Error::new(Span::at(offset), ErrorKind::NotUtf8 { offset }).into())
        }
    }
}

/// The statements of a text, with every name resolved.
///
/// # Errors
/// What is wrong with the text: at least one error, at most one for each statement.
/// `domain`, `view` and `color` lines are checked by the grammar only.
pub fn parse(text: &str, limits: &Limits) -> Result<Vec<Statement>, Errors> {
    let options = Options { limits: *limits, ..Options::default() };
    let mut reader = DocumentReader::new(text, &options);
    let (built, _) = reader.statements()?;
    Ok(built.into_iter().map(|built| built.statement).collect())
}

/// What is known of a text while it is read.
pub(crate) struct DocumentReader<'a> {
    text: &'a str,
    pub options: &'a Options<'a>,
    pub(crate) notes: Vec<Note>,
    pub errors: Vec<Error>,
    settings: CollectedLines,
}

impl<'a> DocumentReader<'a> {
    fn new(text: &'a str, options: &'a Options<'a>) -> Self {
        Self {
            text,
            options,
            notes: Vec::new(),
            errors: Vec::new(),
            settings: CollectedLines::default(),
        }
    }

    /// The trees of all statements and the names they see; what is said of the picture goes to
    /// the settings.
    fn statements(&mut self) -> Result<(Vec<BuiltStatement>, Scope), Errors> {
        let program = program(self.text, &self.options.limits)?;
        let mut lines = lines(self.text, &program.statements)?;
        let mut scope = Scope::default();
        for (name, _) in self.options.overrides {
            scope.define(name, None);
        }
        implied_coordinates::settle(self.text, &mut lines, &scope);
        settle_heads(self.text, &mut lines, &mut scope, &mut self.notes);
        for made in &program.synthesized {
            if let Statement::Define(Definition { name, parameters, .. }) = &made.statement {
                scope.define(&name.text, parameters.as_ref().map(Vec::len));
            }
        }
        self.notes.extend(program.notes.iter().cloned());
        let (mut built, notes) = implied_coordinates::implied(
            self.text,
            &lines,
            &mut scope,
            program.in_steps,
            &self.options.limits,
        );
        self.notes.extend(notes);
        for line in lines {
            let result = if line.pair.as_rule() == Rule::line {
                build(self.text, line, &scope, &self.options.limits).map(|b| built.push(b))
            } else {
                self.settings.read(self.text, line, &scope, &self.options.limits)
            };
            self.kept(result);
            if self.errors.len() >= MOST {
                break;
            }
        }
        for made in &program.synthesized {
            let is_unknown = |name: &&String| {
                !matches!(
                    scope.meaning(name, &[]),
                    NameMeaning::Value(_) | NameMeaning::Function(_)
                )
            };
            if let Some(name) = made.used.iter().filter(is_unknown).min() {
                let kind = ErrorKind::UnknownName { name: short_name(name), letter: None };
                self.errors.push(*Error::new(made.span, kind));
                break;
            }
        }
        self.check()?;
        built.extend(program.synthesized.iter().cloned());
        let mut built = needed(built, &program.generated);
        if let Some((drawn, note)) = drawn_by_program(&program, &built) {
            built.push(drawn);
            self.notes.push(note);
        }
        Ok((built, scope))
    }

    /// What there is, unless it is an error, which is kept.
    pub(crate) fn kept<T>(&mut self, result: Fallible<T>) -> Option<T> {
        result.map_err(|error| self.errors.push(*error)).ok()
    }

    /// Fails if there were errors.
    fn check(&mut self) -> Result<(), Errors> {
        match std::mem::take(&mut self.errors) {
            errors if errors.is_empty() => Ok(()),
            errors => Err(Errors::new(errors)),
        }
    }

    fn read(mut self) -> Result<Document, Errors> {
        let (built, scope) = self.statements()?;
        let mut definitions: Vec<(&Definition, &BuiltStatement)> = Vec::new();
        let mut drawings: Vec<&BuiltStatement> = Vec::new();
        for one in &built {
            self.notes.extend(one.notes.iter().cloned());
            match &one.statement {
                Statement::Define(definition) => definitions.push((definition, one)),
                Statement::Draw { .. } => drawings.push(one),
            }
        }
        // The last definition of a name counts, everywhere.
        let mut last: FxHashMap<&str, usize> = FxHashMap::default();
        for (index, (definition, _)) in definitions.iter().enumerate() {
            if let Some(before) = last.insert(&definition.name.text, index) {
                let earlier = &definitions[before].0.name;
                let name = earlier.text.clone();
                self.notes.push(Note { span: earlier.span, kind: NoteKind::Redefined { name } });
            }
        }
        let mut last: Vec<usize> = last.into_values().collect();
        last.sort_unstable();
        definitions = last.into_iter().map(|index| definitions[index]).collect();
        no_recursion(&definitions)?;
        let settings = std::mem::take(&mut self.settings);
        let used: FxHashSet<&str> =
            built.iter().flat_map(|b| &b.used).chain(&settings.used).map(String::as_str).collect();
        if !drawings.is_empty() {
            let unused = definitions.iter().filter(|(d, _)| !used.contains(d.name.text.as_str()));
            // Each is compared with every name, so a bound keeps hostile texts cheap.
            let notes = unused.take(MOST).map(|(d, _)| unused_note(d, &scope));
            self.notes.extend(notes);
        }
        let overrides = self.overrides(&definitions, &used);
        let is_timed = settings.used.contains("t");
        let (names, parameters) = self.parameters(&definitions, &overrides, &drawings, is_timed);
        self.check()?;
        let time = parameters.iter().find(|p| p.kind == ParameterKind::Time).map(|p| p.number);
        let points = parameters.len() as u32;
        let values = PointValues::new(names.clone(), points, time, &self.options.limits);
        let mut lowering = Lowering::new(names, time, &self.options.limits);
        let mut surfaces = Vec::new();
        let limit = self.options.limits.surfaces;
        if let Some(drawing) = drawings.get(limit) {
            let start = Span::at(drawing.span.start);
            return Err(Error::new(start, ErrorKind::TooManySurfaces { limit }).into());
        }
        for drawing in &drawings {
            surfaces.extend(self.kept(surface(&mut lowering, drawing)));
        }
        self.check()?;
        let implied;
        if surfaces.is_empty() {
            let (statement, note) = implied_drawing(&definitions)?;
            self.notes.push(note);
            implied = statement;
            surfaces.push(surface(&mut lowering, &implied)?);
        }
        style(&mut surfaces, &settings, &values)?;
        let mut picture = settings.picture;
        if let Some(Contours { value, step }) = &settings.contours {
            let value = value.as_ref().map(|value| values.value(value)).transpose()?;
            picture.contours = Some(Contours { value, step: step.clone() });
        }
        self.notes.append(&mut lowering.notes);
        self.notes.extend(near_integer_notes(&lowering.graph, &surfaces));
        self.notes.sort_by_key(|note| note.span);
        // One note on a name is enough.
        let mut seen = FxHashSet::default();
        self.notes.retain(|note| !note.kind.is_about_a_name() || seen.insert(note.kind.clone()));
        // Each is drawn with the line that it is about, which may be the whole text.
        if let Some(note) = self.notes.get(MOST_NOTES) {
            let span = note.span;
            self.notes.truncate(MOST_NOTES);
            self.notes.push(Note { span, kind: NoteKind::More });
        }
        let (title, doc) = heading(self.text);
        Ok(Document {
            graph: lowering.graph,
            surfaces,
            parameters,
            domain: settings.domain,
            view: settings.view,
            look: settings.look,
            background: settings.background,
            picture,
            lines: settings.lines,
            title,
            doc,
            notes: self.notes,
        })
    }
}

/// Gives surfaces what lines say that hold for them.
fn style<'a>(
    surfaces: &mut [Surface],
    settings: &'a CollectedLines,
    values: &PointValues<'a>,
) -> Fallible<()> {
    let last = surfaces.last().map_or(0, |surface| surface.span.start);
    for surface in surfaces {
        let place = surface.span.start;
        let color = placed(&settings.colors, place, last);
        let typed = color.and_then(|(typed, _)| typed.as_ref());
        surface.color = typed.map(|typed| values.color(typed)).transpose()?;
        let own = color.and_then(|(_, opacity)| *opacity);
        let opacity = own.or_else(|| placed(&settings.opacities, place, last).copied());
        surface.opacity = opacity.unwrap_or(1.0);
        surface.hidden = placed(&settings.hidden, place, last) == Some(&true);
    }
    Ok(())
}

/// What is used of what a program's branches and loops have made, and everything else.
fn needed(built: Vec<BuiltStatement>, generated: &FxHashSet<String>) -> Vec<BuiltStatement> {
    let name = |built: &BuiltStatement| match &built.statement {
        Statement::Define(definition) if generated.contains(&definition.name.text) => {
            Some(definition.name.text.clone())
        }
        _ => None,
    };
    let names: FxHashMap<String, usize> = built
        .iter()
        .enumerate()
        .filter_map(|(index, one)| name(one).map(|name| (name, index)))
        .collect();
    let mut keep: Vec<bool> = built.iter().map(|one| name(one).is_none()).collect();
    let mut open: Vec<usize> = (0..built.len()).filter(|index| keep[*index]).collect();
    while let Some(index) = open.pop() {
        for used in built[index].used.iter().filter_map(|name| names.get(name)) {
            if !std::mem::replace(&mut keep[*used], true) {
                open.push(*used);
            }
        }
    }
    let mut keep = keep.into_iter();
    built.into_iter().filter(|_| keep.next().unwrap_or(true)).collect()
}

/// Notes on exponents that are not known to be integers, each where it is first drawn.
fn near_integer_notes(graph: &Graph, surfaces: &[Surface]) -> Vec<Note> {
    let mut left = near_integers(graph, MOST_NOTES);
    let mut notes = Vec::new();
    for surface in surfaces {
        if left.is_empty() {
            break;
        }
        let needed = graph.reachable(&[surface.root]);
        left.retain(|id| {
            if needed[id.index()] {
                // What is shared would be written out each time.
                let nodes = graph.reachable(&[*id]).into_iter().filter(|needed| *needed).count();
                let exponent = match nodes {
                    0..=12 => short_name(&zeroset_ir::display(graph, *id, &[])),
                    _ => "…".to_owned(),
                };
                let kind = NoteKind::NearInteger { exponent };
                notes.push(Note { span: surface.span, kind });
            }
            !needed[id.index()]
        });
    }
    notes
}

/// The note on a definition that nothing uses: perhaps a formula with a typo in its left side.
fn unused_note(definition: &Definition, scope: &Scope) -> Note {
    let Name { text: name, span } = &definition.name;
    let meant = scope.meant(name, definition.parameters.is_some());
    Note { span: *span, kind: NoteKind::Unused { name: short_name(name), meant } }
}

/// The surface that a statement draws.
fn surface<'a>(lowering: &mut Lowering<'a>, built: &'a BuiltStatement) -> Fallible<Surface> {
    let Statement::Draw { expr, restrictions } = &built.statement else {
        return Err(Error::new(built.span, ErrorKind::Empty));
    };
    let (root, kind) = match lowering.equation(expr)? {
        Some(root) => (root, SurfaceKind::Equation),
        None => (lowering.solid(expr)?, SurfaceKind::Solid),
    };
    let root = restrictions.iter().try_fold(root, |root, condition| match kind {
        SurfaceKind::Equation => lowering.restrict(root, condition, &[]),
        SurfaceKind::Solid => lowering.cut(root, condition),
    })?;
    Ok(Surface {
        root,
        kind,
        span: built.span,
        echo: echo(expr, restrictions),
        color: None,
        opacity: 1.0,
        hidden: false,
    })
}

/// How a drawing was read; a plain formula shows the `= 0` it implies.
fn echo(expr: &Expr, restrictions: &[Expr]) -> String {
    if expr.is_condition() {
        return Drawing { expr, restrictions }.to_string();
    }
    let equation = expr.clone().equals(Expr::of_digits("0", expr.span));
    Drawing { expr: &equation, restrictions }.to_string()
}
