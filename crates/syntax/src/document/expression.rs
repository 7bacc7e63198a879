//! Reads an expression beside a text, such as a density: names mean in it what they mean in the
//! text.

use crate::document::implied_coordinates::implied;
use crate::document::listed::is_expression_list;
use crate::document::other_readings::with_other_readings;
use crate::document::reading::{
    Document, DocumentReader, Options, ParameterKind, surface, without_placeholders,
};
use crate::document::recursion::no_recursion;
use crate::lower::lowering::Lowering;
use crate::picture::lines::{CollectedLines, PictureLines};
use rustc_hash::FxHashSet;
use zeroset_dialect::program;
use zeroset_parser::lex::arrangement::statements;
use zeroset_parser::lex::spelling::{plain_name, short_name};
use zeroset_parser::lex::token_kind::TokenKind;
use zeroset_parser::tree::ast::{Definition, Statement};
use zeroset_parser::tree::builder::Builder;
use zeroset_parser::tree::built_statement::BuiltStatement;
use zeroset_parser::tree::scope::Scope;
use zeroset_parser::tree::statement::lines;
use zeroset_parser::{Error, ErrorKind, Errors, Limits, Note};

/// Reads an expression with the names that `text` defines. The document's one surface has the
/// expression as its function. Its parameters are those of the text that are sliders, and time.
/// All errors and notes are on the expression, if `text` can be [read](crate::read).
///
/// # Errors
/// If the expression, the text or an override has errors.
///
/// ```
/// use zeroset_syntax::{Options, read_expression};
/// let text = "a = 2 in [1, 3]; x^2 + y^2 + z^2 <= a";
/// let density = read_expression(text, "1 + a x", &Options::default())?;
/// assert_eq!(density.surfaces[0].echo, "1 + a*x = 0");
/// assert_eq!(density.parameters[0].name, "a");
/// assert!(read_expression(text, "x < 1", &Options::default()).is_err());
/// # Ok::<(), zeroset_parser::Errors>(())
/// ```
pub fn read_expression(
    text: &str,
    expression: &str,
    options: &Options<'_>,
) -> Result<Document, Errors> {
    if is_expression_list(text) {
        let (built, scope) = (Vec::new(), Scope::default());
        return DocumentReader::new("", options).beside(built, scope, expression);
    }
    // Another reading of the text does not mend the expression.
    with_other_readings(text, options, |mut reader| {
        let (built, scope) = reader.statements()?;
        reader.notes.clear();
        Ok(reader.beside(built, scope, expression))
    })?
}

/// The names in an expression. The list is empty if the text cannot be divided into words.
pub fn names_in(expression: &str) -> Vec<String> {
    let words = statements(expression, &Limits::default()).unwrap_or_default();
    let words = words.iter().flat_map(|lexed| &lexed.tokens);
    let names = words.filter(|token| token.kind == TokenKind::Name);
    names.map(|token| plain_name(&expression[token.span.range()])).collect()
}

impl DocumentReader<'_> {
    /// Reads an expression with the definitions among statements.
    fn beside(
        mut self,
        mut built: Vec<BuiltStatement>,
        mut scope: Scope,
        text: &str,
    ) -> Result<Document, Errors> {
        let mut used: FxHashSet<String> = built.iter().flat_map(|one| one.used.clone()).collect();
        let limits = &self.options.limits;
        let (expression, defined, mut notes) = expression(text, &mut scope, limits)?;
        let is_definition = |one: &BuiltStatement| matches!(one.statement, Statement::Define(_));
        built.retain(is_definition);
        built.extend(defined);
        let definitions: Vec<(&Definition, &BuiltStatement)> = built
            .iter()
            .filter_map(|one| match &one.statement {
                Statement::Define(definition) => Some((definition, one)),
                Statement::Draw { .. } | Statement::Curve(_) => None,
            })
            .collect();
        let definitions = self.last_definitions(&definitions);
        no_recursion(&definitions)?;
        used.extend(expression.used.iter().cloned());
        let used: FxHashSet<&str> = used.iter().map(String::as_str).collect();
        let overrides = self.overrides(&definitions, &used);
        let (names, parameters) = self.parameters(&definitions, &overrides, &[&expression], false);
        self.check()?;
        let time =
            parameters.iter().find(|one| one.kind == ParameterKind::Time).map(|one| one.number);
        let mut lowering = Lowering::new(names, time, &self.options.limits);
        lowering.multiplies_to_numbers = scope.in_degrees;
        let mut surfaces = vec![surface(&mut lowering, &expression)?];
        without_placeholders(&mut lowering, &mut surfaces);
        notes.extend(lowering.notes);
        self.notes = notes;
        let (lines, picture) = (CollectedLines::default(), PictureLines::default());
        Ok(self.document("", lowering.graph, surfaces, parameters, lines, picture))
    }
}

/// The only expression of a text as a drawing, the definitions that it implies, and notes.
fn expression(
    text: &str,
    scope: &mut Scope,
    limits: &Limits,
) -> Result<(BuiltStatement, Vec<BuiltStatement>, Vec<Note>), Errors> {
    let program = program(text, limits, false)?;
    let lines = lines(text, &program.statements)?;
    let (defined, mut notes) = implied(text, &lines, scope, false, limits, false);
    if let Some(second) = lines.get(1) {
        let span = second.raw.lexed.span;
        let found = short_name(&text[span.range()]);
        return Err(Error::new(span, ErrorKind::Unexpected { found }).into());
    }
    let lexed = &lines[0].raw.lexed;
    let mut builder = Builder::new(text, lexed, scope, &[], limits);
    let expr = builder.only_expression()?;
    notes.extend(program.notes);
    notes.append(&mut builder.notes);
    let (span, used) = (lexed.span, builder.used);
    let statement = Statement::Draw { expr, restrictions: Vec::new() };
    Ok((BuiltStatement { statement, span, notes: Vec::new(), used }, defined, notes))
}
