//! Translates the statements of a program, in order, to statements of this language.

use crate::arrays::Array;
use crate::blocks::ProgramStep;
use crate::effects::is_doubled;
use crate::formats::{foreign_text, is_mathmod};
use crate::language::{Language, join_bars};
use crate::mathmod;
use crate::plot_commands::restrict;
use crate::program::{ForeignStatement, ForeignText, PastedProgram};
use crate::program_words::{Words, begins_name, is_whole_type, size_of};
use crate::scopes::Declared;
use zeroset_parser::lex::arrangement::{arrange, trim};
use zeroset_parser::lex::curve_form::marked_curve;
use zeroset_parser::lex::decimal_comma::doubts;
use zeroset_parser::lex::open_brackets::scan_lines;
use zeroset_parser::lex::scanner::{is_python, scan};
use zeroset_parser::lex::token_kind::TokenKind::{
    self, Colon, Equals, Number, OpenBrace, OpenParen, Unknown,
};
use zeroset_parser::tree::raw_statement::{Head, RawStatement, ValueConversion};

use rustc_hash::{FxHashMap, FxHashSet};
use std::cell::Cell;
use std::rc::Rc;
use zeroset_parser::lex::spelling::short_name;
use zeroset_parser::lex::token::{Token, closing, outside};
use zeroset_parser::tree::aliases::Aliases;
use zeroset_parser::tree::ast::{Expr, ExprKind, LETTERS, Name, NamedValue, Statement};
use zeroset_parser::tree::built_statement::BuiltStatement;
use zeroset_parser::tree::scope::{Conditions, coordinate};
use zeroset_parser::{Error, ErrorKind, Fallible, Limits, Note, NoteKind, Span};

/// The variables of a function's body, or of the text outside functions.
#[derive(Clone, Default)]
pub(crate) struct Frame {
    /// Name and parameters of the function; `None` outside functions.
    pub function: Option<Head>,
    pub aliases: Aliases,
    /// Variables that were declared or assigned, each with its number of components.
    pub set: Vec<(String, usize)>,
    /// Counters of loops. Their values are tracked while they are known.
    pub counters: FxHashSet<String>,
    /// Integer variables.
    pub integers: FxHashSet<String>,
    /// Declarations so far, each with the earlier meaning of its name.
    pub declared: Vec<Declared>,
    /// Number of enclosing branches and loops.
    pub nested: usize,
    /// Number of enclosing inlined calls.
    pub depth: usize,
    /// Prefix of the names that an inlined call generates.
    pub prefix: Option<String>,
    /// True if a statement for the function's result was already added.
    pub has_result: bool,
}

/// A function whose body replaces calls of it: it changes variables of its caller, returns nothing,
/// or has default values.
#[derive(Default)]
pub(crate) struct Procedure {
    pub parameters: Vec<ProcedureParameter>,
    pub body: Vec<ProgramStep>,
    /// True if the body uses variables outside functions that some function changes.
    pub uses_globals: bool,
    /// True if the body changes such variables.
    pub changes_globals: bool,
}

pub(crate) struct ProcedureParameter {
    pub name: Name,
    pub size: usize,
    /// True if the parameter is an integer.
    pub is_whole: bool,
    pub default: Option<Vec<Token>>,
    /// True if the argument's value is copied to the parameter when the function begins.
    pub is_in: bool,
    /// True if the parameter's final value is copied back to the argument.
    pub is_out: bool,
}

/// A macro. Its body replaces each call.
pub(crate) struct Macro {
    pub parameters: Option<Vec<String>>,
    pub body: Vec<Token>,
}

#[derive(Default)]
pub(crate) struct ProgramReader<'a> {
    pub words: Words<'a>,
    pub limits: Limits,
    /// Names that the text uses, and names that were generated.
    pub taken: FxHashSet<String>,
    pub language: Language,
    /// Integer variables outside functions.
    pub integers: FxHashSet<String>,
    /// Variables that the current expression read so far.
    pub reads: Vec<String>,
    /// Nesting depth of the current expression.
    pub expression_depth: usize,
    /// Number of saved values.
    pub saved_count: u32,
    /// Numbers of the saved values that are integers.
    pub whole_values: FxHashSet<u32>,
    /// Numbers of components of the parameters of typed functions.
    pub signatures: FxHashMap<String, Vec<usize>>,
    /// Functions that return integers.
    pub whole_functions: FxHashSet<String>,
    /// Variables outside functions that functions change.
    pub mutable: FxHashSet<String>,
    /// Bodies of functions that are also defined. A call with names of parameters, or with
    /// default values of some, is replaced by the body.
    pub bodies: FxHashMap<String, Rc<Procedure>>,
    /// Names that have a definition.
    pub defined_names: FxHashSet<String>,
    pub macros: FxHashMap<String, Macro>,
    pub procedures: FxHashMap<String, Rc<Procedure>>,
    /// Names that the text defines, each with its number of parameters.
    pub arities: FxHashMap<String, usize>,
    /// True if the text makes a grid of coordinates.
    pub has_grid: bool,
    /// Arrays that names stand for.
    pub arrays: FxHashMap<String, Array>,
    /// Arrays whose sizes were declared. Statements set their elements.
    pub declared_arrays: FxHashSet<String>,
    /// Ends of the ranges that names stand for.
    pub ranges: FxHashMap<String, [Vec<Token>; 2]>,
    /// Rows of numbers that names stand for.
    pub rows: FxHashMap<String, Vec<Token>>,
    /// True if the text is a program in Python.
    pub is_python: bool,
    /// True if calls of libraries draw, so `z = …` names a value.
    pub draws_by_calls: bool,
    /// Values that statements outside functions assigned to names.
    pub assigned: FxHashMap<String, Vec<Token>>,
    /// Formulas that objects of a notebook stand for, such as grids with scalars.
    pub fields: FxHashMap<String, Vec<Token>>,
    /// Statements that were left out. A drawing must not need them.
    pub unread: Vec<Unread>,
    /// Known values of variables outside functions.
    pub constants: FxHashMap<String, f64>,
    /// Number of statements and iterations that ran in loops, branches and inlined calls.
    pub steps: usize,
    /// Number of tokens that macros expanded to.
    pub expanded_tokens: Cell<usize>,
    pub program: PastedProgram,
}

/// A statement that was left out.
pub(crate) struct Unread {
    /// A name for the value of the statement.
    pub key: String,
    /// The names that the statement defines.
    pub names: Vec<String>,
    /// The reason.
    pub error: Box<Error>,
}

pub(crate) type Statements = std::vec::IntoIter<Vec<Token>>;

/// Translates a text, whether it is a program or not. With `closes_brackets`, a bracket that is
/// open at the end of its line is closed there, with a note.
///
/// # Errors
/// If the text exceeds a limit, or a statement of a program cannot be translated.
pub fn program(text: &str, limits: &Limits, closes_brackets: bool) -> Fallible<PastedProgram> {
    let foreign = foreign_text(text, limits)?;
    let is_foreign = foreign.is_some();
    let (mut statements, mut notes) = match is_foreign {
        true => (Vec::new(), Vec::new()),
        false if closes_brackets => scan_lines(text, limits)?,
        false => (scan(text, limits)?, Vec::new()),
    };
    let words = Words { text };
    let is_python = !is_foreign && is_python(text);
    if is_python {
        for tokens in &mut statements {
            *tokens = words.numpy(tokens);
        }
        statements.retain(|tokens| !tokens.is_empty());
    }
    words.join_bodies(&mut statements);
    words.join_cases(&mut statements);
    words.join_coordinates(&mut statements);
    let taken = statements
        .iter()
        .flatten()
        .map(|token| &text[token.span.range()])
        .collect::<FxHashSet<_>>();
    let in_steps = statements.iter().any(|tokens| words.is_step(tokens));
    if !in_steps && !is_foreign {
        notes.extend(statements.iter().flat_map(|tokens| doubts(text, tokens)));
    }
    let is_y_up = statements.iter().any(|tokens| words.has_y_up(tokens));
    let language = if is_python { Language::Python } else { Language::of(words, &statements) };
    if language.has_double_bars() {
        statements.iter_mut().for_each(join_bars);
    }
    let draws_by_calls = statements.iter().any(|tokens| words.draws_by_call(tokens));
    let draws = statements.iter().any(|tokens| words.is_drawing(tokens));
    let is_z = |token: &Token| matches!(words.word(*token), "z" | "Z");
    let uses_z = statements.iter().flatten().any(is_z);
    let mutable = words.mutable_globals(&statements, language);
    let mut reader = ProgramReader {
        words,
        limits: *limits,
        language,
        mutable,
        taken: taken.into_iter().map(str::to_owned).collect(),
        has_grid: ["meshgrid", "linspace", "arange", "plot3", "lines3d", "contour"]
            .iter()
            .any(|w| text.contains(w)),
        is_python,
        draws_by_calls,
        program: PastedProgram {
            in_steps: in_steps || is_python || draws_by_calls,
            is_y_up,
            in_degrees: language == Language::OpenScad,
            notes,
            ..PastedProgram::default()
        },
        ..ProgramReader::default()
    };
    let mut top = Frame::default();
    let mut statements = statements.into_iter();
    while let Some(tokens) = statements.next() {
        reader.outer_statement(tokens, &mut top, &mut statements, draws)?;
    }
    if let Some(foreign) = foreign {
        reader.foreign(foreign, &mut top)?;
    }
    reader.end(&top, Span::at(text.len()));
    reader.drop_unneeded()?;
    let mut program = reader.program;
    program.is_height = is_python && !uses_z;
    program.conditions = match () {
        () if is_mathmod(text) => Conditions::OfMathMod,
        () if is_python || text.contains("@(") => Conditions::Numbers,
        () => Conditions::Apart,
    };
    note_ignored_domains(&mut program.notes);
    Ok(program)
}

/// Corrects the notes on the domains of plots: only the first domain has an effect.
fn note_ignored_domains(notes: &mut [Note]) {
    let mut first = None;
    for note in notes {
        let NoteKind::PlotDomain { domain } = &note.kind else { continue };
        let domain = domain.clone();
        if domain != *first.get_or_insert(domain.clone()) {
            note.kind = NoteKind::PlotDomainLeftOut { domain };
        }
    }
}

impl ProgramReader<'_> {
    /// Reads a statement of the text. `draws` is true if the text has plot commands.
    fn outer_statement(
        &mut self,
        tokens: Vec<Token>,
        frame: &mut Frame,
        following: &mut Statements,
        draws: bool,
    ) -> Fallible<()> {
        if let Some(statements) = self.package_surface(&tokens)? {
            let none = Statements::default;
            let mut read = |tokens| self.statement(tokens, frame, &mut none());
            return statements.into_iter().try_for_each(&mut read);
        }
        if self.is_python {
            return self.notebook_statement(tokens, frame, following);
        }
        if !draws || !self.words.is_aside(&tokens) {
            return self.statement(tokens, frame, following);
        }
        let place = tokens.iter().find(|token| token.kind == Unknown);
        let error = Error::new(place.map_or(Span::default(), |t| t.span), ErrorKind::NoFormula);
        let names = self.defined_by(&tokens);
        self.leave_out(&tokens, &names, error, frame);
        Ok(())
    }

    /// Adds the statements of a text in another format.
    fn foreign(&mut self, foreign: ForeignText, frame: &mut Frame) -> Fallible<()> {
        self.program.notes.extend(foreign.notes);
        let is_constant = |one: &&ForeignStatement| {
            one.head.as_ref().is_some_and(|head| head.parameters.is_none())
        };
        for ForeignStatement { tokens, head, .. } in foreign.statements.iter().filter(is_constant) {
            let name = head.as_ref().map(|head| head.name.text.clone());
            self.assigned.extend(name.map(|name| (name, tokens.clone())));
        }
        let (boxes, text) = (&foreign.boxes, self.words.text);
        let are_known = self.boxes(boxes, foreign.span)?;
        let are_alike = boxes.iter().all(|one| mathmod::are_alike(text, &boxes[0], one));
        let mut own_boxes = boxes.iter();
        for ForeignStatement { mut tokens, head, mut aliases } in foreign.statements {
            // Each surface ends at its own box.
            if head.is_none()
                && let Some(own) = own_boxes.next().filter(|_| are_known && !are_alike)
            {
                let condition = self.in_box(own, &mut aliases);
                restrict(&mut tokens, &condition);
            }
            match &head {
                None if aliases.count() == 0 => {
                    self.statement(tokens, frame, &mut Statements::default())?;
                    continue;
                }
                _ => {}
            }
            self.push(tokens, head, None, &aliases, false)?;
        }
        Ok(())
    }

    /// Reads a statement. A function or loop may take more statements from `following` as its body.
    pub(crate) fn statement(
        &mut self,
        tokens: Vec<Token>,
        frame: &mut Frame,
        following: &mut Statements,
    ) -> Fallible<()> {
        let tokens = self.expanded(tokens, 0)?;
        let Some(tokens) = self.with_arrays(tokens, frame)? else { return Ok(()) };
        let mut tokens = Words::with_matrices(tokens);
        let Some(first) = tokens.first().copied() else {
            return Ok(());
        };
        self.words.apply_signs(&mut tokens);
        if self.expands(&mut tokens, frame)? {
            return Ok(());
        }
        if frame.function.is_none() && self.outside_of_formulas(&tokens, frame)? {
            return Ok(());
        }
        if let Some(sign) = self.words.prefixed(&tokens) {
            return Err(Error::new(sign.span, ErrorKind::Prefix));
        }
        if first.kind.is_setting() && frame.function.is_none() {
            return self.plain(tokens, frame, false);
        }
        if frame.function.is_none()
            && let Some(statements) = self.words.unwrap_statement(&tokens)
        {
            // Each unwrapped statement has fewer wrappers, so the recursion ends.
            return statements
                .into_iter()
                .try_for_each(|tokens| self.statement(tokens, frame, &mut Statements::default()));
        }
        if self.of_other_system(&tokens, frame, following)? {
            return Ok(());
        }
        let word = self.words.word(first);
        match word {
            "import" | "from" if begins_name(tokens.get(1)) => return Ok(()),
            "for" | "while" | "if" if self.words.is_control(&tokens) => {
                return self.control(tokens, frame, following);
            }
            "for" | "while" | "if" if self.words.is_indented_control(&tokens) => {
                return self.indented_control(tokens, frame, following);
            }
            "struct" | "switch" | "do" | "else" | "elif"
                if Words::is_command(&tokens) || self.words.is_control(&tokens) =>
            {
                return Err(self.words.unsupported(first));
            }
            "def" if tokens.len() > 3 => return self.python_function(&tokens, following),
            "return" if tokens.len() > 1 => {
                tokens.remove(0);
                let tokens = self.run_effects(tokens, frame)?;
                return self.result(tokens, frame);
            }
            "#define" if tokens.len() > 1 => {
                self.macro_of(&tokens[1..]);
                return Ok(());
            }
            "function"
                if tokens.len() > 2
                    && !self.words.has_body(&tokens)
                    && begins_name(tokens.get(1)) =>
            {
                tokens.remove(0);
                return self.openscad_function(tokens, frame);
            }
            "difference" | "union" | "intersection" | "translate" | "rotate" | "hull"
                if tokens.get(1..).and_then(closing).is_some_and(|end| {
                    tokens.get(end + 2).is_some_and(|next| next.kind == OpenBrace)
                }) =>
            {
                let formula = "write `subtract(a, b)`, `union(a, b)` or `intersect(a, b)` of solids such as `sphere(1)`; a move is `translate(a, 1, 0, 0)`";
                return Err(Error::new(first.span, ErrorKind::Solid { formula }));
            }
            "draw_surface"
                if tokens.len() == 1 && frame.function.is_none() && self.words.sets_surface() =>
            {
                self.draw_surfer(first.span);
                return Ok(());
            }
            "let" if tokens.get(1).is_some_and(|token| token.kind == OpenParen) => {
                return self.bindings(tokens, frame);
            }
            _ => {}
        }
        if self.words.has_body(&tokens) {
            return self.functions(tokens, frame, following);
        }
        let types = self.words.types(&tokens);
        if types > 0 {
            return self.typed(&tokens, types, frame);
        }
        if self.runs(&tokens, frame)? {
            return Ok(());
        }
        let in_steps = self.program.in_steps || frame.function.is_some();
        if in_steps && self.step(&tokens, frame)? {
            return Ok(());
        }
        if let Some((name, parameters, value)) = self.words.lambda(&tokens) {
            return self.lambda(name, parameters, value, frame);
        }
        self.plain(tokens, frame, true)
    }

    /// Expands the lists of a statement outside functions, and records the value that it assigns.
    /// Returns true if it was expanded to several statements, which were read.
    fn expands(&mut self, tokens: &mut Vec<Token>, frame: &mut Frame) -> Fallible<bool> {
        if frame.function.is_some() || frame.nested > 0 {
            return Ok(false);
        }
        if let Some(statements) = self.manipulated(tokens) {
            let read = |tokens| self.statement(tokens, frame, &mut Statements::default());
            return statements.into_iter().try_for_each(read).map(|()| true);
        }
        *tokens = self.expanded_lists(std::mem::take(tokens), frame)?;
        if !self.is_python {
            self.record_assigned(tokens);
        }
        Ok(false)
    }

    /// Draws the value that a script of Surfer gives to `surface`.
    fn draw_surfer(&mut self, span: Span) {
        let value = NamedValue::Defined("surface".to_owned());
        let expr = Expr::new(ExprKind::Name(value), span);
        let statement = Statement::Draw { expr, restrictions: Vec::new() };
        self.program.synthesized.push(BuiltStatement::synthesized(statement, span));
    }

    /// Reads a declaration whose first tokens are `types`.
    fn typed(&mut self, tokens: &[Token], types: usize, frame: &mut Frame) -> Fallible<()> {
        let word = self.words.word(tokens[0]);
        let size = tokens[..types].iter().map(|t| size_of(self.words.word(*t))).max();
        let is_whole = tokens[..types].iter().any(|t| is_whole_type(self.words.word(*t)));
        // Python's `global` would change a variable of another function. JavaScript's `var`
        // has the scope of the whole function.
        if self.language == Language::Python && matches!(word, "global" | "nonlocal") {
            return Err(self.words.unsupported(tokens[0]));
        }
        let mark = frame.declared.len();
        self.declarations(&tokens[types..], size.unwrap_or(1), is_whole, frame)?;
        if word == "var" && self.language == Language::Script {
            frame.declared.truncate(mark);
        }
        Ok(())
    }

    /// Runs a statement that assigns or changes variables. Returns false for any other statement.
    fn runs(&mut self, tokens: &[Token], frame: &mut Frame) -> Fallible<bool> {
        match self.language {
            Language::Typed | Language::Script
                if frame.is_inner() || (0..tokens.len()).any(|at| is_doubled(tokens, at)) =>
            {
                self.run_expression(tokens, frame)
            }
            Language::Python if frame.is_inner() => self.run_python(tokens, frame),
            Language::Python => self.run_top_python(tokens, frame),
            Language::OpenScad if !frame.is_inner() => {
                let Some((_, None, value)) = self.words.assignment(tokens) else {
                    return Ok(false);
                };
                if self.words.lambda(tokens).is_some() || tokens[0].kind.is_axis() {
                    return Ok(false);
                }
                // The value of `a *= 2` has more tokens than the statement.
                let Some(left) = tokens.len().checked_sub(value.len()) else { return Ok(false) };
                let mut all = tokens[..left].to_vec();
                all.extend(self.assignment(&value, frame)?.tokens);
                self.reads.clear();
                self.plain(all, frame, true).map(|()| true)
            }
            _ => Ok(self.run_counter_assignment(tokens, frame)),
        }
    }

    /// The statement of a curve or a point, if `tokens` are one.
    fn curve(&self, tokens: &[Token]) -> Option<Vec<Token>> {
        let mut tokens = tokens.to_vec();
        trim(self.words.text, &mut tokens);
        if self.arity(tokens[0]).is_some() {
            // Only a sum that moves over a range, as `p + t*(1, 2, 3) for t in [0, 1]`.
            let is_path = outside(&tokens, Equals).is_none()
                && !matches!(self.words.word(tokens[0]), "curve" | "point")
                && tokens.iter().any(|token| token.kind == TokenKind::In);
            return marked_curve(self.words.text, &tokens).filter(|_| is_path);
        }
        marked_curve(self.words.text, &tokens).or_else(|| self.words.segment(&tokens))
    }

    /// Reads a plot, a grid, or a statement that only styles the picture. Returns false for any
    /// other statement.
    fn outside_of_formulas(&mut self, tokens: &[Token], frame: &mut Frame) -> Fallible<bool> {
        if self.listed_curve(tokens, frame)? || self.contour_command(tokens, frame)? {
            return Ok(true);
        }
        if self.surface_over_grids(tokens, frame)? {
            return Ok(true);
        }
        if let Some(surface) = self.parametric_surface_splot(tokens) {
            return self.plain(surface, frame, false).map(|()| true);
        }
        let set = ["urange", "trange"].iter().find_map(|name| self.ranges.get(*name));
        if let Some(curve) = self.words.parametric_splot(tokens, set) {
            return self.plain(curve, frame, false).map(|()| true);
        }
        if self.adds_plots(tokens)
            || self.surface_list(tokens, frame)?
            || self.command_over_list(tokens, frame)?
        {
            return Ok(true);
        }
        let mut list = None;
        let curve = match self.curve(tokens) {
            None if self.arity(tokens[0]).is_none() => {
                let listed = self.with_listed_point(tokens);
                let own = listed.map(|(own, name)| {
                    list = name;
                    own
                });
                self.words.curve_command(own.as_deref().unwrap_or(tokens))?
            }
            found => found.map(|curve| (curve, None)),
        };
        if let Some((curve, note)) = curve {
            self.program.notes.extend(note);
            let curve = self.with_own_values(curve, list);
            return self.plain(curve, frame, false).map(|()| true);
        }
        if self.names_region(tokens) {
            return Ok(true);
        }
        let mut with_rows = self.with_rows(self.with_typed_formula(tokens)?);
        let regions = self.plot_regions(&mut with_rows)?;
        let mut plots = self.words.plots(&with_rows)?;
        // The text may define the name of a plot command otherwise.
        if !plots.is_empty() && self.arity(tokens[0]).is_none() {
            let place = tokens[0].span;
            for formula in plots.iter_mut().flat_map(|plot| &mut plot.formulas) {
                for region in &regions {
                    restrict(formula, region);
                }
            }
            plots.into_iter().try_for_each(|plot| self.draw(plot, place, frame))?;
            return Ok(true);
        }
        if self.grid(tokens, frame)? {
            return Ok(true);
        }
        if !self.words.is_style(tokens) || self.arity(tokens[0]).is_some() {
            return Ok(false);
        }
        let span = tokens[0].span.to(tokens[tokens.len() - 1].span);
        let is_style = |note: &Note| matches!(note.kind, NoteKind::StyleLeftOut { .. });
        if !self.program.notes.iter().any(is_style) {
            let example = short_name(&self.words.text[span.range()]);
            self.program.notes.push(Note { span, kind: NoteKind::StyleLeftOut { example } });
        }
        Ok(true)
    }

    /// Adds a statement unchanged. With `is_step`, a function's body may not hold a mere value.
    pub(crate) fn plain(
        &mut self,
        tokens: Vec<Token>,
        frame: &Frame,
        is_step: bool,
    ) -> Fallible<()> {
        let mut tokens = tokens;
        if frame.function.is_some() && is_step && self.words.assignment(&tokens).is_none() {
            return Err(Error::new(tokens[0].span, ErrorKind::NoEffect));
        }
        if let [name, equals, number] = tokens.as_slice()
            && equals.kind == Equals
            && number.kind == Number
            && !self.mutable.contains(self.words.word(*name))
            && let Some(value) = self.known_value(&[*number], &Frame::default())
        {
            self.constants.insert(self.words.word(*name).to_owned(), value);
        }
        self.words.patterns(&mut tokens);
        self.push(tokens, None, None, &frame.aliases, false)
    }

    /// Adds a statement whose value is `tokens` to the program. With `head`, the statement defines
    /// a name.
    pub(crate) fn push(
        &mut self,
        tokens: Vec<Token>,
        head: Option<Head>,
        conversion: Option<ValueConversion>,
        aliases: &Aliases,
        is_height: bool,
    ) -> Fallible<()> {
        if tokens.is_empty() {
            let unfinished = |head: Head| Err(Error::new(head.name.span, ErrorKind::Unfinished));
            return head.map_or(Ok(()), unfinished);
        }
        let changing = |token: &&Token| {
            let procedure = self.procedures.get(self.words.word(**token));
            procedure.is_some_and(|procedure| procedure.parameters.iter().any(|given| given.is_out))
        };
        if let Some(token) = tokens.iter().find(changing) {
            let name = self.words.word(*token).to_owned();
            return Err(Error::new(token.span, ErrorKind::OutParameter { name }));
        }
        if let [label, colon, _, ..] = tokens.as_slice()
            && head.is_none()
            && (label.kind, colon.kind) == (TokenKind::Name, Colon)
        {
            let label = self.words.word(*label).to_owned();
            let kind = NoteKind::LabelLeftOut { label };
            self.program.notes.push(Note { span: tokens[0].span, kind });
        }
        self.record_arity(&tokens, head.as_ref());
        if let Some(lexed) = arrange(self.words.text, tokens, &self.limits)? {
            let aliases = aliases.clone();
            self.defined_names.extend(head.iter().map(|head| head.name.text.clone()));
            self.program.statements.push(RawStatement {
                lexed,
                head,
                aliases,
                conversion,
                is_height,
            });
        }
        Ok(())
    }

    /// Reads an assignment of a program. Returns false if `tokens` must be read as a formula.
    pub(crate) fn step(&mut self, tokens: &[Token], frame: &mut Frame) -> Fallible<bool> {
        if let Some((left, right)) = Words::parallel(tokens) {
            // All values are computed before any variable changes.
            let within = frame.aliases.clone();
            for (name, value) in left.into_iter().zip(right) {
                self.assign_within(self.words.name(name), 1, value, None, &within, frame)?;
            }
            return Ok(true);
        }
        if let Some((names, value)) = Words::unpacked(tokens) {
            let within = frame.aliases.clone();
            for (name, letter) in names.into_iter().zip(LETTERS.chars()) {
                let (name, part) = (self.words.name(name), Some(ValueConversion::Part(letter)));
                self.assign_within(name, 1, value.to_vec(), part, &within, frame)?;
            }
            return Ok(true);
        }
        if let Some((name, letters, value)) = self.words.assignment(tokens) {
            let name = self.words.name(name);
            let known = frame.set.iter().rfind(|(set, _)| *set == name.text);
            let size = known.map_or(3, |(_, size)| *size);
            let is_set = frame.function.is_some() || known.is_some() || letters.is_some();
            // `x = 3` is an equation unless the program has declared x.
            let is_coordinate = name.text == "t" || coordinate(&name.text).is_some();
            if is_coordinate && !is_set && !self.draws_by_calls {
                return self.plain(tokens.to_vec(), frame, true).map(|()| true);
            }
            // `tz = …` names a value in a program. Elsewhere `tz` is a product.
            let is_product =
                name.text.len() > 1 && name.text.chars().all(|letter| "xyzt".contains(letter));
            let is_steps = is_set || is_coordinate || is_product || self.words.is_step(tokens);
            if is_steps || self.words.has(&value, &name.text) {
                let within = frame.aliases.clone();
                let before = frame.meaning(&name.text);
                let write = letters.map(|letters| ValueConversion::Write { letters, before, size });
                return self.assign_within(name, size, value, write, &within, frame).map(|()| true);
            }
            let is_number = matches!(value.as_slice(), [only] if only.kind == Number);
            if frame.function.is_none() && !is_number && self.words.lambda(tokens).is_none() {
                self.program.last_value = Some(name.clone());
            }
            frame.set.push((name.text, size));
        }
        Ok(false)
    }
}
