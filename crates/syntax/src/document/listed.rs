//! Turns an expression list into a document with one solid.

use crate::document::reading::{
    Document, DocumentReader, Options, ParameterKind, Surface, SurfaceKind, picture, style,
};
use crate::list::line::{Line, is_list};
use crate::list::reader::ExpressionList;
use crate::lower::builders::Moves;
use crate::lower::condition::or_outside;
use crate::picture::paint::PointValues;
use rustc_hash::FxHashSet;
use zeroset_ir::display;
use zeroset_parser::lex::spelling::short_name;
use zeroset_parser::{Errors, Note, NoteKind};

/// Longest formula that stands for a list where the surface is named, in bytes.
const LONGEST_ECHO: usize = 200;

/// Returns whether `text` is read as an expression list: the format of fidget and of the Prospero
/// challenge, in which each line names one value, as in `_2 mul _1 _0`.
///
/// The first line decides that is neither a comment nor about the picture. It must define a
/// constant or a coordinate, or have a name of hexadecimal digits after `_`.
pub fn is_expression_list(text: &str) -> bool {
    is_list(text)
}

/// Reads a document from an expression list. Lines about the picture may stand between its lines.
pub(crate) fn read(text: &str, options: &Options<'_>) -> Result<Document, Errors> {
    let list = crate::list::reader::read(text, &options.limits)?;
    let settings = only(text, &list.settings);
    DocumentReader::new(&settings, options).read_list(text, list)
}

/// The text with all characters replaced by spaces, except on `lines`. Places stay the same. Empty
/// if there are no lines.
fn only(text: &str, lines: &[Line<'_>]) -> String {
    let Some(last) = lines.last() else { return String::new() };
    let mut kept = String::with_capacity(last.range().end);
    for line in lines {
        let range = line.range();
        kept.extend(std::iter::repeat_n(' ', range.start - kept.len()));
        kept.push_str(&text[range]);
    }
    kept
}

impl DocumentReader<'_> {
    /// Reads the lines about the picture, and adds them to the solid of `list`.
    fn read_list(mut self, text: &str, list: ExpressionList<'_>) -> Result<Document, Errors> {
        if !list.settings.is_empty() {
            self.statements()?;
        }
        let settings = std::mem::take(&mut self.settings);
        let used = settings.used.iter().chain(self.options.used_beside);
        let used: FxHashSet<&str> = used.map(String::as_str).collect();
        let overrides = self.overrides(&[], &used);
        let (names, parameters) = self.parameters(&[], &overrides, &[], used.contains("t"));
        self.check()?;
        let time = parameters.iter().find(|p| p.kind == ParameterKind::Time).map(|p| p.number);
        let points = parameters.len() as u32;
        let values = PointValues::new(names, points, time, &self.options.limits);
        let ExpressionList { mut graph, root, name, span, .. } = list;
        let name = short_name(name);
        let formula = display(&graph, root, &[]);
        let shown = if formula.len() <= LONGEST_ECHO { formula.as_str() } else { &name };
        // A solid's function has a value everywhere: a positive one outside the solid.
        let root = or_outside(&mut graph, &mut Vec::new(), &Moves::default(), root, 1);
        let plain = Surface::equation(root, span, format!("{shown} <= 0"));
        let mut surfaces = [Surface { kind: SurfaceKind::Solid, holds_zeros: Some(true), ..plain }];
        style(&mut surfaces, &mut [], &mut [], &settings, &values)?;
        let picture = picture(&settings, &values)?;
        self.notes.push(Note { span, kind: NoteKind::ExpressionList { name } });
        Ok(self.document(text, graph, surfaces.into(), parameters, settings, picture))
    }
}
