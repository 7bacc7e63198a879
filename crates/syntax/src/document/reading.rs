//! Reads a whole text: its surfaces in one graph, parameters, domain, view and notes.

use crate::document::curves::{Curve, Curves};
use crate::document::foreign_definitions::foreign_definitions;
use crate::document::heading::heading;
use crate::document::implied_coordinates;
use crate::document::implied_drawing::{drawn_by_program, implied_drawing};
use crate::document::likely_slips::likely_slips;
use crate::document::listed::{self, is_expression_list};
use crate::document::other_readings::with_other_readings;
use crate::document::patches::{Patch, Patches};
use crate::document::plane_curve::plane_curve_note;
use crate::document::polar_curves::polar_curves;
use crate::document::recursion::no_recursion;
use crate::document::solids_in_sums::{cylinder_of_openscad, solids_in_sums};
use crate::document::thin_zeros::thin_zeros_notes;
use crate::lower::condition::holds_zeros;
use crate::lower::constant::near_integers;
use crate::lower::lowering::Lowering;
use crate::picture::lines::{CollectedLines, PictureLines, SettingLine, setting_for};
use crate::picture::paint::{Contours, PointValues, SurfaceColor};
use crate::picture::scene::{Background, DomainLine, ViewLine};
use rustc_hash::{FxHashMap, FxHashSet};
use zeroset_dialect::program;
use zeroset_ir::{Constant, Graph, NodeId};
use zeroset_parser::lex::spelling::short_name;
use zeroset_parser::tree::ast::{CurveForm, CurveStatement, Definition, Expr, Name, Statement};
use zeroset_parser::tree::built_statement::BuiltStatement;
use zeroset_parser::tree::curve_statement::curve;
use zeroset_parser::tree::grammar::Rule;
use zeroset_parser::tree::print::Drawing;
use zeroset_parser::tree::scope::{NameMeaning, Scope};
use zeroset_parser::tree::statement::{ParsedStatement, build, lines, resolve_heads};
use zeroset_parser::{
    Error, ErrorKind, Errors, Fallible, Limits, MAX_ERRORS, MAX_NOTES, Note, NoteKind, Span,
};
use zeroset_style::Material;

/// Options for reading a text.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options<'a> {
    /// Overrides: names and the constant expressions that define them. If a name occurs twice, the
    /// later override counts.
    pub overrides: &'a [(String, String)],
    /// Names that count as used, since an [expression beside the text](crate::read_expression) uses
    /// them.
    pub used_beside: &'a [String],
    /// Value of the time `t`. This value replaces the document's value.
    pub time: Option<f64>,
    /// Limits on the text.
    pub limits: Limits,
}

/// The result of reading a text.
#[derive(Clone, Debug)]
pub struct Document {
    /// Functions of all surfaces in one graph, exactly as typed: nothing is simplified.
    pub graph: Graph,
    /// The equations and solids, in the order of the text; at least one, unless there are
    /// parametric surfaces, curves or points.
    pub surfaces: Vec<Surface>,
    /// The parametric surfaces.
    pub patches: Patches,
    /// The curves and points.
    pub curves: Curves,
    /// Sliders and time, by ascending parameter number.
    pub parameters: Vec<Parameter>,
    /// Contents of the `domain` line, if there is one.
    pub domain: Option<DomainLine>,
    /// Contents of the `view` line, if there is one.
    pub view: Option<ViewLine>,
    /// True if the text is in the manner of shaders or of POV-Ray, in which y points up. The
    /// default view then has y up.
    pub is_y_up: bool,
    /// Look of the picture, if a `look` line sets one.
    pub look: Option<&'static zeroset_style::Look>,
    /// Background, if a `background` line sets one.
    pub background: Option<Background>,
    /// Settings of the picture that have no field of their own here.
    pub picture: PictureLines,
    /// Places of all lines about the picture, in the order of the text.
    pub lines: Vec<SettingLine>,
    /// First line of the comment at the start of the text, if there is one.
    pub title: Option<String>,
    /// The remaining lines of the comment at the start of the text; empty without such a comment.
    pub doc: String,
    /// Notes on how the text was read, sorted by their places.
    pub notes: Vec<Note>,
}

/// An equation or solid to draw.
#[derive(Clone, Debug)]
pub struct Surface {
    /// The function whose zeros are drawn.
    pub root: NodeId,
    /// Kind: an equation or a solid.
    pub kind: SurfaceKind,
    /// For a solid, whether it holds the points at which its function is 0. This matters where the
    /// function is 0 on an open set. `None` if the condition has both `<` and `<=`.
    pub holds_zeros: Option<bool>,
    /// Place of the statement in the text.
    pub span: Span,
    /// The statement as it was read, in standard notation.
    pub echo: String,
    /// Color from the last `color` line above the surface. But if the document's last `color` line
    /// is below all surfaces, the first `color` line below this surface counts.
    pub color: Option<SurfaceColor>,
    /// Opacity from 0 to 1: the share of light that the surface blocks. The `color` line sets it,
    /// or else an `opacity` line, which the rule for `color` lines selects. The default is the
    /// opacity of the material.
    pub opacity: f64,
    /// Material from a `material` line, which the rule for `color` lines selects.
    pub material: &'static Material,
    /// True if a `hidden` line hides the surface. The rule for `color` lines selects the line.
    pub hidden: bool,
}

impl Surface {
    /// An equation without style lines.
    pub fn equation(root: NodeId, span: Span, echo: String) -> Self {
        Self {
            root,
            kind: SurfaceKind::Equation,
            holds_zeros: None,
            span,
            echo,
            color: None,
            opacity: 1.0,
            material: Default::default(),
            hidden: false,
        }
    }

    /// The statement as it was read, in one line.
    pub fn line(&self) -> String {
        in_one_line(&self.echo)
    }
}

/// A text without line breaks.
pub(crate) fn in_one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A surface of a document, however it is given.
#[derive(Clone, Copy, Debug)]
pub struct DrawnSurface<'a> {
    /// Place of the statement in the text.
    pub span: Span,
    /// The statement as it was read, in standard notation.
    pub echo: &'a str,
    /// True for the boundary of a solid.
    pub is_solid: bool,
    /// As [`Surface::color`].
    pub color: Option<&'a SurfaceColor>,
    /// As [`Surface::opacity`].
    pub opacity: f64,
    /// As [`Surface::material`].
    pub material: &'static Material,
    /// As [`Surface::hidden`].
    pub hidden: bool,
}

impl<'a> DrawnSurface<'a> {
    /// The surface's statement, in one line.
    pub fn line(&self) -> String {
        in_one_line(self.echo)
    }

    fn of_surface(one: &'a Surface) -> Self {
        Self {
            span: one.span,
            echo: &one.echo,
            is_solid: one.kind == SurfaceKind::Solid,
            color: one.color.as_ref(),
            opacity: one.opacity,
            material: one.material,
            hidden: one.hidden,
        }
    }

    fn of_patch(one: &'a Patch) -> Self {
        Self {
            span: one.span,
            echo: &one.echo,
            is_solid: false,
            color: one.color.as_ref(),
            opacity: one.opacity,
            material: one.material,
            hidden: one.hidden,
        }
    }
}

/// Kind of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SurfaceKind {
    /// The zero set of an equation's function.
    Equation,
    /// The solid of an inequality, in which the function is ≤ 0.
    Solid,
}

/// A named number of a document. Its value may change without recompiling.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Name of the parameter.
    pub name: String,
    /// Number of the parameter in the graph.
    pub number: u32,
    /// Value of the parameter.
    pub value: Constant,
    /// Range of a slider, or the range of time that an animation repeats, if the text gives one.
    pub range: Option<(Constant, Constant)>,
    /// Kind: a slider or time.
    pub kind: ParameterKind,
    /// Place of the parameter's definition, if the text defines it.
    pub span: Option<Span>,
}

/// Kind of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterKind {
    /// A slider, which the user moves.
    Slider,
    /// Time, which the clock moves.
    Time,
}

impl Document {
    /// All surfaces by their numbers: equations and solids, then parametric surfaces.
    pub fn drawn_surfaces(&self) -> impl Iterator<Item = DrawnSurface<'_>> {
        let patches = self.patches.all.iter().map(DrawnSurface::of_patch);
        self.surfaces.iter().map(DrawnSurface::of_surface).chain(patches)
    }

    /// The line that begins with `word` and applies to [surface](Self::drawn_surfaces) number
    /// `surface`, if there is one.
    pub fn line_for(&self, word: &str, surface: usize) -> Option<&SettingLine> {
        let place = self.drawn_surfaces().nth(surface)?.span.start;
        let last = last_drawing(&self.surfaces, &self.patches.all, &self.curves.all);
        let lines = self.lines.iter().filter(|line| line.word == word);
        let lines: Vec<_> = lines.map(|line| (line.span.start, line)).collect();
        setting_for(&lines, place, last).copied()
    }
}

/// Reads a document. Its errors have no hints yet.
pub(crate) fn read(text: &str, options: &Options<'_>) -> Result<Document, Errors> {
    if is_expression_list(text) {
        return listed::read(text, options);
    }
    with_other_readings(text, options, |reader| reader.read())
}

/// Returns the statements of a text, with every name resolved. For an expression list, there are no
/// statements.
///
/// # Errors
/// Fails if a statement or a line about the picture has an error. Each gives at most one error.
pub fn parse(text: &str, limits: &Limits) -> Result<Vec<Statement>, Errors> {
    let options = Options { limits: *limits, ..Options::default() };
    if is_expression_list(text) {
        return listed::read(text, &options).map(|_| Vec::new());
    }
    let (built, _) = with_other_readings(text, &options, |mut reader| reader.statements())?;
    Ok(built.into_iter().map(|built| built.statement).collect())
}

pub(crate) struct DocumentReader<'a> {
    text: &'a str,
    pub options: &'a Options<'a>,
    pub(crate) notes: Vec<Note>,
    pub errors: Vec<Error>,
    pub(crate) settings: CollectedLines,
    /// True if a bracket that is open at the end of its line is closed there.
    pub(crate) closes_brackets: bool,
    is_y_up: bool,
    /// Names of definitions that are not in the text.
    generated: FxHashSet<String>,
}

impl<'a> DocumentReader<'a> {
    pub(crate) fn new(text: &'a str, options: &'a Options<'a>) -> Self {
        Self {
            text,
            options,
            notes: Vec::new(),
            errors: Vec::new(),
            settings: CollectedLines::default(),
            closes_brackets: false,
            is_y_up: false,
            generated: FxHashSet::default(),
        }
    }

    /// Builds the trees of all statements, and the scope in which names are resolved. Collects
    /// lines about the picture in `settings`.
    pub(crate) fn statements(&mut self) -> Result<(Vec<BuiltStatement>, Scope), Errors> {
        let program = program(self.text, &self.options.limits, self.closes_brackets)?;
        self.is_y_up = program.is_y_up;
        let mut lines = lines(self.text, &program.statements)?;
        let mut scope = Scope::default();
        scope.in_degrees = program.in_degrees;
        scope.in_steps = program.in_steps;
        scope.conditions = program.conditions;
        for (name, _) in self.options.overrides {
            scope.define(name, None);
        }
        let alone = implied_coordinates::make_definitions_equations(
            self.text,
            &mut lines,
            &scope,
            program.in_steps,
        );
        let phi = NoteKind::CoordinateAlone { name: "phi".to_owned() };
        let has_angle = alone.iter().any(|note| note.kind == phi);
        self.notes.extend(alone);
        resolve_heads(self.text, &mut lines, &mut scope, &mut self.notes);
        for synthesized in &program.synthesized {
            if let Statement::Define(Definition { name, parameters, .. }) = &synthesized.statement {
                scope.define(&name.text, parameters.as_ref().map(Vec::len));
            }
        }
        scope.suggest_only(self.text, self.options.overrides);
        self.notes.extend(program.notes.iter().cloned());
        let (mut built, notes) = implied_coordinates::implied(
            self.text,
            &lines,
            &mut scope,
            program.in_steps,
            &self.options.limits,
            has_angle,
        );
        self.notes.extend(notes);
        let (defined, notes) =
            foreign_definitions(self.text, &lines, &mut scope, &self.options.limits);
        built.extend(defined);
        self.notes.extend(notes);
        // Lines about the picture come last, since a color may use the parameters of surfaces.
        let (settings, lines): (Vec<_>, Vec<_>) = lines.into_iter().partition(is_setting);
        for line in lines {
            let result = if line.is_curve() {
                curve(self.text, line, &scope, &self.options.limits)
            } else {
                build(self.text, line, &scope, &self.options.limits)
            };
            built.extend(self.ok_or_record(result));
            if self.errors.len() >= MAX_ERRORS {
                break;
            }
        }
        let all = built.iter().chain(&program.synthesized);
        self.settings.parameters = all.filter_map(patch_parameters).flatten().cloned().collect();
        for line in settings {
            let result = self.settings.read(self.text, line, &scope, &self.options.limits);
            self.ok_or_record(result);
            if self.errors.len() >= MAX_ERRORS {
                break;
            }
        }
        for synthesized in &program.synthesized {
            let is_unknown = |name: &&String| {
                !matches!(
                    scope.meaning(name, &[]),
                    NameMeaning::Value(_) | NameMeaning::Function(_)
                )
            };
            if let Some(name) = synthesized.used.iter().filter(is_unknown).min() {
                let kind = ErrorKind::UnknownName { name: short_name(name), letter: None };
                self.errors.push(*Error::new(synthesized.span, kind));
                break;
            }
        }
        self.check()?;
        built.extend(program.synthesized.iter().cloned());
        let mut built = needed(built, &program.generated);
        self.generated.clone_from(&program.generated);
        if let Some((drawn, note)) = drawn_by_program(&program, &built) {
            built.push(drawn);
            self.notes.push(note);
        }
        Ok((built, scope))
    }

    /// The value of `result`, or `None` after recording the error of `result`. The rounds of a
    /// loop have the same error at the same place, which is recorded once.
    pub(crate) fn ok_or_record<T>(&mut self, result: Fallible<T>) -> Option<T> {
        let record = |error: Box<Error>| {
            if !self.errors.contains(&error) {
                self.errors.push(*error);
            }
        };
        result.map_err(record).ok()
    }

    /// Fails if errors were recorded.
    pub(crate) fn check(&mut self) -> Result<(), Errors> {
        match std::mem::take(&mut self.errors) {
            errors if errors.is_empty() => Ok(()),
            errors => Err(Errors::new(errors)),
        }
    }

    /// Sorts the notes by their places, and drops repeated notes and notes beyond the limit.
    fn sort_notes(&mut self) {
        self.notes.sort_by_key(|note| note.span);
        // A note that explains a name is given once, for all uses of the name.
        let mut seen = FxHashSet::default();
        self.notes.retain(|note| !note.kind.explains_a_name() || seen.insert(note.kind.clone()));
        // There is a limit on notes, because each is printed with its line, perhaps the whole text.
        if let Some(note) = self.notes.get(MAX_NOTES) {
            let span = note.span;
            self.notes.truncate(MAX_NOTES);
            self.notes.push(Note { span, kind: NoteKind::More });
        }
    }

    /// Leaves out definitions whose names are defined again. Only the last definition of a name
    /// counts, even for statements above that definition.
    pub(crate) fn last_definitions<'d>(
        &mut self,
        definitions: &[(&'d Definition, &'d BuiltStatement)],
    ) -> Vec<(&'d Definition, &'d BuiltStatement)> {
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
        last.into_iter().map(|index| definitions[index]).collect()
    }

    fn read(mut self) -> Result<Document, Errors> {
        let (built, scope) = self.statements()?;
        let mut definitions: Vec<(&Definition, &BuiltStatement)> = Vec::new();
        let mut drawings: Vec<&BuiltStatement> = Vec::new();
        let mut curves: Vec<&BuiltStatement> = Vec::new();
        for one in &built {
            self.notes.extend(one.notes.iter().cloned());
            match &one.statement {
                Statement::Define(definition) => definitions.push((definition, one)),
                Statement::Draw { .. } => drawings.push(one),
                Statement::Curve(_) => curves.push(one),
            }
        }
        self.notes.extend(solids_in_sums(&built));
        self.notes.extend(likely_slips(self.text, &built, scope.in_degrees));
        self.notes.extend(cylinder_of_openscad(self.text, &built));
        self.notes.extend(polar_curves(&built, &self.options.limits));
        let definitions = self.last_definitions(&definitions);
        no_recursion(&definitions)?;
        let settings = std::mem::take(&mut self.settings);
        let used = built.iter().flat_map(|b| &b.used).chain(&settings.used);
        let used: FxHashSet<&str> =
            used.chain(self.options.used_beside).map(String::as_str).collect();
        let drawn: Vec<&BuiltStatement> = drawings.iter().chain(&curves).copied().collect();
        let implied =
            drawn.is_empty().then(|| implied_drawing(self.text, &definitions, &self.generated));
        let drawn_name = match &implied {
            Some(Ok((statement, _))) => statement.used.iter().next(),
            _ => None,
        };
        if !drawn.is_empty() || drawn_name.is_some() {
            let is_used = |name: &String| used.contains(name.as_str()) || drawn_name == Some(name);
            let unused = definitions.iter().filter(|(d, _)| !is_used(&d.name.text));
            // Each note compares its name with all known names, so there is a limit on such notes.
            let notes = unused.take(MAX_ERRORS).map(|(d, _)| unused_note(d, &scope));
            self.notes.extend(notes);
        }
        let overrides = self.overrides(&definitions, &used);
        let is_timed = settings.used.contains("t");
        let (names, parameters) = self.parameters(&definitions, &overrides, &drawn, is_timed);
        self.check()?;
        let time = parameters.iter().find(|p| p.kind == ParameterKind::Time).map(|p| p.number);
        let points = parameters.len() as u32;
        let limits =
            Limits { nodes: self.options.limits.nodes_for(self.text.len()), ..self.options.limits };
        let (patches, curves): (Vec<&BuiltStatement>, _) =
            curves.iter().partition(|one| patch_parameters(one).is_some());
        let mut values = PointValues::new(names.clone(), points, time, &limits);
        let own = patches.iter().filter_map(|one| patch_parameters(one));
        values.patches.extend(own.map(|own| own.each_ref().map(|name| name.text.as_str())));
        let lowered = |names| {
            let mut lowering = Lowering::new(names, time, &limits);
            lowering.multiplies_to_numbers = scope.in_degrees;
            lowering
        };
        let mut patches = if patches.is_empty() {
            Patches::default()
        } else {
            self.patches(&patches, lowered(names.clone()), points)?
        };
        let mut curves = self.curves(&curves, lowered(names.clone()), points)?;
        let mut lowering = lowered(names);
        let mut surfaces = Vec::new();
        let limit = self.options.limits.surfaces;
        if let Some(drawing) = drawings.get(limit) {
            let start = Span::at(drawing.span.start);
            return Err(Error::new(start, ErrorKind::TooManySurfaces { limit }).into());
        }
        for drawing in &drawings {
            surfaces.extend(self.ok_or_record(surface(&mut lowering, drawing)));
        }
        self.check()?;
        let implied = implied.transpose()?;
        if let Some((statement, note)) = &implied {
            self.notes.push(note.clone());
            surfaces.push(surface(&mut lowering, statement)?);
        }
        without_placeholders(&mut lowering, &mut surfaces);
        style(&mut surfaces, &mut patches.all, &mut curves.all, &settings, &values)?;
        let picture = picture(&settings, &values)?;
        self.notes.append(&mut lowering.notes);
        self.notes.extend(near_integer_notes(&lowering.graph, &surfaces));
        let thin = thin_zeros_notes(&lowering.graph, &surfaces, &parameters);
        if curves.is_empty() && patches.is_empty() && thin.is_empty() {
            self.notes.extend(plane_curve_note(&lowering.graph, &surfaces, &self.generated));
        }
        self.notes.extend(thin);
        let text = self.text;
        let document = self.document(text, lowering.graph, surfaces, parameters, settings, picture);
        Ok(Document { patches, curves, ..document })
    }

    /// The document of these surfaces. `text` has its title. The notes are sorted.
    pub(crate) fn document(
        mut self,
        text: &str,
        graph: Graph,
        surfaces: Vec<Surface>,
        parameters: Vec<Parameter>,
        settings: CollectedLines,
        picture: PictureLines,
    ) -> Document {
        self.sort_notes();
        let (title, doc) = heading(text);
        Document {
            graph,
            surfaces,
            patches: Patches::default(),
            curves: Curves::default(),
            parameters,
            domain: settings.domain,
            view: settings.view,
            is_y_up: self.is_y_up,
            look: settings.look,
            background: settings.background,
            picture,
            lines: settings.lines,
            title,
            doc,
            notes: self.notes,
        }
    }
}

/// Returns whether a line is one about the picture.
fn is_setting(line: &ParsedStatement<'_>) -> bool {
    line.pair.as_rule() != Rule::line && !line.is_curve()
}

/// The parameters of a parametric surface; `None` if the statement draws none.
fn patch_parameters(one: &BuiltStatement) -> Option<&[Name; 2]> {
    match &one.statement {
        Statement::Curve(CurveStatement { form: CurveForm::Patch { parameters, .. }, .. }) => {
            Some(parameters)
        }
        _ => None,
    }
}

/// The settings that have no field of their own in a document.
pub(crate) fn picture<'a>(
    settings: &'a CollectedLines,
    values: &PointValues<'a>,
) -> Fallible<PictureLines> {
    let mut picture = settings.picture.clone();
    if let Some(Contours { value, step }) = &settings.contours {
        let value = value.as_ref().map(|value| values.value(value, None)).transpose()?;
        picture.contours = Some(Contours { value, step: step.clone() });
    }
    Ok(picture)
}

/// Sets the color, opacity and visibility of each surface, and the color, width and visibility of
/// each curve, from the lines that apply to it.
pub(crate) fn style<'a>(
    surfaces: &mut [Surface],
    patches: &mut [Patch],
    curves: &mut [Curve],
    settings: &'a CollectedLines,
    values: &PointValues<'a>,
) -> Fallible<()> {
    let last = last_drawing(surfaces, patches, curves);
    let surfaces =
        surfaces.iter_mut().map(|Surface { span, color, opacity, material, hidden, .. }| {
            (span.start, color, opacity, material, hidden)
        });
    let patches =
        patches.iter_mut().map(|Patch { span, color, opacity, material, hidden, .. }| {
            (span.start, color, opacity, material, hidden)
        });
    let surfaces = surfaces.map(|one| (None, one));
    let patches = patches.enumerate().map(|(patch, one)| (Some(patch), one));
    for (patch, one) in surfaces.chain(patches) {
        let (place, own_color, own_opacity, material, hidden) = one;
        let color = setting_for(&settings.colors, place, last);
        let typed = color.and_then(|(typed, _)| typed.as_ref());
        *own_color = typed.map(|typed| values.color(typed, patch)).transpose()?;
        let own = color.and_then(|(_, opacity)| *opacity);
        let opacity = own.or_else(|| setting_for(&settings.opacities, place, last).copied());
        *material = setting_for(&settings.materials, place, last).copied().unwrap_or_default();
        *own_opacity = opacity.unwrap_or(material.opacity);
        *hidden = setting_for(&settings.hidden, place, last) == Some(&true);
    }
    for curve in curves {
        let place = curve.span.start;
        let typed =
            setting_for(&settings.colors, place, last).and_then(|(typed, _)| typed.as_ref());
        curve.color = typed.map(|typed| values.color(typed, None)).transpose()?;
        curve.width = setting_for(&settings.widths, place, last).copied();
        curve.hidden = setting_for(&settings.hidden, place, last) == Some(&true);
    }
    Ok(())
}

/// Start of the last drawing in the text.
fn last_drawing(surfaces: &[Surface], patches: &[Patch], curves: &[Curve]) -> usize {
    let surfaces = surfaces.iter().map(|surface| surface.span.start);
    let patches = patches.iter().map(|patch| patch.span.start);
    surfaces.chain(patches).chain(curves.iter().map(|curve| curve.span.start)).max().unwrap_or(0)
}

/// Drops each generated definition that no other statement needs, directly or through definitions.
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

/// Notes on exponents that may be integers but are not known to be. Each note points to the first
/// surface that contains the exponent.
fn near_integer_notes(graph: &Graph, surfaces: &[Surface]) -> Vec<Note> {
    let mut left = near_integers(graph, MAX_NOTES);
    let mut notes = Vec::new();
    for surface in surfaces {
        if left.is_empty() {
            break;
        }
        let needed = graph.reachable(&[surface.root]);
        left.retain(|id| {
            if needed[id.index()] {
                // Printing repeats a shared node at each use, so only small exponents are quoted.
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

/// The note on an unused definition, which may be a formula with a typo in its left side.
fn unused_note(definition: &Definition, scope: &Scope) -> Note {
    let Name { text: name, span } = &definition.name;
    if let ("r", None, false, Some(radius)) =
        (name.as_str(), &definition.range, scope.in_steps, definition.body.number())
    {
        let line = match radius.parse::<u32>() {
            Ok(radius) if radius < 1000 => format!("x^2 + y^2 = {}", radius * radius),
            _ => format!("x^2 + y^2 = {radius}^2"),
        };
        return Note { span: *span, kind: NoteKind::UnusedRadius { line } };
    }
    let meant = scope.meant(name, definition.parameters.is_some());
    Note { span: *span, kind: NoteKind::Unused { name: short_name(name), meant } }
}

/// Drops the nodes that no surface needs, if some have placeholders.
pub(crate) fn without_placeholders(lowering: &mut Lowering<'_>, surfaces: &mut [Surface]) {
    if lowering.has_placeholders() {
        let roots: Vec<NodeId> = surfaces.iter().map(|surface| surface.root).collect();
        let (graph, roots) = zeroset_ir::compact(&lowering.graph, &roots);
        lowering.graph = graph;
        surfaces.iter_mut().zip(roots).for_each(|(surface, root)| surface.root = root);
    }
}

/// The surface that a statement draws.
pub(crate) fn surface<'a>(
    lowering: &mut Lowering<'a>,
    built: &'a BuiltStatement,
) -> Fallible<Surface> {
    let Statement::Draw { expr, restrictions } = &built.statement else {
        return Err(Error::new(built.span, ErrorKind::Empty));
    };
    let (root, kind) = lowering.complete(|lowering| {
        let (root, kind) = match lowering.equation(expr)? {
            Some(root) => (root, SurfaceKind::Equation),
            None => (lowering.solid(expr)?, SurfaceKind::Solid),
        };
        let root = restrictions.iter().try_fold(root, |root, condition| match kind {
            SurfaceKind::Equation => lowering.restrict(root, condition, &[]),
            SurfaceKind::Solid => lowering.cut(root, condition),
        })?;
        Ok((root, kind))
    })?;
    let root = lowering.in_place(root, built.span)?;
    let holds_zeros = holds_zeros(std::iter::once(expr).chain(restrictions));
    let plain = Surface::equation(root, built.span, echo(expr, restrictions));
    Ok(Surface { kind, holds_zeros, ..plain })
}

/// The text of a drawing as it was read. A formula without a relation gets `= 0`.
fn echo(expr: &Expr, restrictions: &[Expr]) -> String {
    if expr.is_condition() {
        return Drawing { expr, restrictions }.to_string();
    }
    let equation = expr.clone().equals(Expr::of_digits("0", expr.span));
    Drawing { expr: &equation, restrictions }.to_string()
}
