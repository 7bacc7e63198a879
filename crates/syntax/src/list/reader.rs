//! Reads an expression list to nodes of a graph, line by line.

use crate::list::line::{Line, lines};
use crate::list::opcode::{Meaning, OPCODES, opcode};
use rustc_hash::FxHashMap;
use zeroset_interval::Interval;
use zeroset_ir::{Constant, Graph, NodeId};
use zeroset_parser::lex::spelling::short_name;
use zeroset_parser::tree::scope::nearest;
use zeroset_parser::{Error, ErrorKind, Fallible, Limits, Span};

/// A list as it was read.
pub(crate) struct ExpressionList<'a> {
    pub graph: Graph,
    /// The value of the last line.
    pub root: NodeId,
    /// The name of the last line.
    pub name: &'a str,
    /// The place of the last line.
    pub span: Span,
    /// The lines about the picture.
    pub settings: Vec<Line<'a>>,
}

/// Reads the list `text`. Lines about the picture are left to the caller.
///
/// # Errors
/// Stops at the first error: later ones could follow from it.
pub(crate) fn read<'a>(text: &'a str, limits: &Limits) -> Fallible<ExpressionList<'a>> {
    if text.len() > limits.bytes {
        let kind = ErrorKind::TooLong { bytes: text.len(), limit: limits.bytes };
        return Err(Error::new(Span::at(0), kind));
    }
    let mut graph = Graph::new();
    let mut values: FxHashMap<&str, (NodeId, u32)> = FxHashMap::default();
    let mut last = None;
    let mut settings = Vec::new();
    for line in lines(text) {
        if line.is_setting() {
            settings.push(line);
            continue;
        }
        let (name, place) = line.words().next().expect("a line has a word");
        let node = value(&mut graph, line, &values, text)?;
        if graph.len() > limits.nodes {
            let kind = ErrorKind::ListTooLarge { limit: limits.nodes };
            return Err(Error::new(line.span(), kind));
        }
        let number = u32::try_from(line.number).unwrap_or(u32::MAX);
        if let Some((_, earlier)) = values.insert(name, (node, number)) {
            let kind = ErrorKind::RepeatedLine { name: short_name(name), line: earlier as usize };
            return Err(Error::new(place, kind));
        }
        last = Some((node, name, line.span()));
    }
    let (root, name, span) =
        last.ok_or_else(|| Error::new(Span::at(text.len()), ErrorKind::Empty))?;
    Ok(ExpressionList { graph, root, name, span, settings })
}

/// The value that a line defines.
fn value(
    graph: &mut Graph,
    line: Line<'_>,
    values: &FxHashMap<&str, (NodeId, u32)>,
    text: &str,
) -> Fallible<NodeId> {
    let mut words = line.words();
    let (name, place) = words.next().expect("a line has a word");
    let Some((operation, operation_place)) = words.next() else {
        return Err(Error::new(place, ErrorKind::NoOperation { name: short_name(name) }));
    };
    let Some(row) = opcode(operation) else {
        let kind = ErrorKind::UnknownOperation { name: short_name(operation), known: known() };
        let meant = nearest(operation, OPCODES.iter().map(|row| row.name));
        return Err(Error::new(operation_place, kind).suggest_optional(operation_place, meant));
    };
    if let Meaning::OfBits(_) = row.meaning {
        let kind = ErrorKind::OperationOfBits { name: row.name };
        return Err(Error::new(operation_place, kind));
    }
    let expected = row.operands();
    // The operands used are at most two.
    let mut operands = [("", operation_place); 2];
    let mut given = 0;
    for (word, place) in words {
        if given == expected {
            let given = line.words().count() - 2;
            let kind = ErrorKind::OperandCount { name: row.name, expected, given };
            return Err(Error::new(Span::new(place.start, line.span().end), kind));
        }
        operands[given] = (word, place);
        given += 1;
    }
    if given < expected {
        let kind = ErrorKind::OperandCount { name: row.name, expected, given };
        let place = Span::new(operation_place.start, line.span().end);
        return Err(Error::new(place, kind));
    }
    let node = |(word, place): (&str, Span)| match values.get(word) {
        Some((node, _)) => Ok(*node),
        None => Err(undefined(word, place, line, text)),
    };
    Ok(match &row.meaning {
        Meaning::Constant => {
            let (word, place) = operands[0];
            let constant = number(word).ok_or_else(|| not_a_number(word, place))?;
            graph.constant(constant)
        }
        Meaning::Variable(axis) => graph.variable(*axis),
        Meaning::Native(op) => match expected {
            1 => graph.apply(*op, &[node(operands[0])?]),
            _ => graph.apply(*op, &[node(operands[0])?, node(operands[1])?]),
        },
        Meaning::OfOne(apply) => apply(graph, node(operands[0])?),
        Meaning::OfTwo(apply) => apply(graph, node(operands[0])?, node(operands[1])?),
        Meaning::OfBits(_) => unreachable!("refused above"),
    })
}

/// The names of all operations that are read.
fn known() -> String {
    let read = OPCODES.iter().filter(|row| !matches!(row.meaning, Meaning::OfBits(_)));
    read.map(|row| row.name).collect::<Vec<_>>().join(", ")
}

/// The exact value of a decimal with an optional sign.
fn number(word: &str) -> Option<Constant> {
    let Some(size) = word.strip_prefix('-') else {
        return Constant::decimal(word.strip_prefix('+').unwrap_or(word));
    };
    let size = Constant::decimal(size)?;
    if let Some(value) = size.exact() {
        return Some(Constant::rational(-value));
    }
    let Interval { lo, hi } = size.bounds();
    Some(Constant::enclosed(Interval { lo: -hi, hi: -lo }))
}

/// The error for a constant that is no decimal.
fn not_a_number(word: &str, place: Span) -> Box<Error> {
    let (sign, size) = match word.strip_prefix('-') {
        Some(size) => ("-", size),
        None => ("", word),
    };
    let digits = size.strip_prefix("0x").or_else(|| size.strip_prefix("0X"));
    let hexadecimal = digits.and_then(|digits| u64::from_str_radix(digits, 16).ok());
    let meant = hexadecimal.map(|value| format!("{sign}{value}")).or_else(|| {
        let plain = size.replace('_', "").replace(',', ".");
        let plain = plain.trim_end_matches(['f', 'F', 'd', 'L']);
        Constant::decimal(plain).map(|_| format!("{sign}{}", short_name(plain)))
    });
    let kind = ErrorKind::NotADecimal { text: short_name(word) };
    Error::new(place, kind).suggest_optional(place, meant)
}

/// The error for a name that no line above defines. A line below may.
fn undefined(word: &str, place: Span, line: Line<'_>, text: &str) -> Box<Error> {
    let defines = |other: &Line<'_>| other.words().next().is_some_and(|(name, _)| name == word);
    let below = lines(text).skip_while(|other| other.number < line.number).find(defines);
    let name = short_name(word);
    let kind = match below {
        Some(found) => ErrorKind::DefinedBelow { name, line: found.number },
        None => ErrorKind::UndefinedOperand { name },
    };
    Error::new(place, kind)
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_ir::display;

    fn shown(text: &str) -> String {
        let list = read(text, &Limits::default()).unwrap_or_else(|error| panic!("{error:?}"));
        display(&list.graph, list.root, &[])
    }

    fn error(text: &str) -> (String, ErrorKind, Option<String>) {
        let error = read(text, &Limits::default()).err().expect("an error");
        let meant = error.suggestion.map(|meant| meant.replacement);
        (text[error.span.range()].to_owned(), error.kind, meant)
    }

    #[test]
    fn every_operation_is_read_as_its_formula() {
        for (operation, formula) in [
            ("neg a", "-x"),
            ("abs a", "abs(x)"),
            ("recip a", "1/x"),
            ("sqrt a", "sqrt(x)"),
            ("square a", "sqr(x)"),
            ("floor a", "floor(x)"),
            ("ceil a", "ceil(x)"),
            ("round a", "sign(x)*floor(abs(x) + 0.5)"),
            ("sin a", "sin(x)"),
            ("cos a", "cos(x)"),
            ("tan a", "tan(x)"),
            ("asin a", "asin(x)"),
            ("acos a", "acos(x)"),
            ("atan a", "atan(x)"),
            ("exp a", "exp(x)"),
            ("ln a", "ln(x)"),
            ("not a", "select_negative(-abs(x), 0, 1)"),
            ("add a b", "x + y"),
            ("sub a b", "x - y"),
            ("mul a b", "x*y"),
            ("div a b", "x/y"),
            ("min a b", "min(x, y)"),
            ("max a b", "max(x, y)"),
            ("atan2 a b", "atan2(x, y)"),
            ("mod a b", "mod(x, abs(y))"),
            ("mod a c", "mod(x, 1.5)"),
            ("mod a d", "mod(x, abs(-2))"),
            ("compare a b", "sign(x - y)"),
            ("and a b", "select_negative(-abs(x), y, 0)"),
            ("or a b", "select_negative(-abs(x), x, y)"),
            ("var-z", "z"),
            ("const -.5e1", "-5"),
            ("const +1.", "1"),
            ("const 1e-3", "0.001"),
        ] {
            let text = format!("a var-x\nb var-y\nc const 1.5\nd const -2\n_ff {operation}\n");
            assert_eq!(shown(&text), formula, "{operation}");
        }
        let read: Vec<&str> = OPCODES.iter().map(|row| row.name).collect();
        assert_eq!(read.len(), 34, "a new operation needs its formula above: {read:?}");
    }

    #[test]
    fn a_bad_line_is_one_error_at_its_word() {
        use ErrorKind::*;
        let name = |text: &str| text.to_owned();
        for (line, place, kind, meant) in [
            ("b", "b", NoOperation { name: name("b") }, None),
            (
                "b sine a",
                "sine",
                UnknownOperation { name: name("sine"), known: known() },
                Some("sin"),
            ),
            ("b rand a", "rand", OperationOfBits { name: "rand" }, None),
            ("b mix a a", "mix", OperationOfBits { name: "mix" }, None),
            ("b add a", "add a", OperandCount { name: "add", expected: 2, given: 1 }, None),
            ("b var-x a", "a", OperandCount { name: "var-x", expected: 0, given: 1 }, None),
            ("b neg a a a", "a a", OperandCount { name: "neg", expected: 1, given: 3 }, None),
            ("b neg c", "c", DefinedBelow { name: name("c"), line: 3 }, None),
            ("b neg b", "b", DefinedBelow { name: name("b"), line: 2 }, None),
            ("b neg q", "q", UndefinedOperand { name: name("q") }, None),
            ("a neg a", "a", RepeatedLine { name: name("a"), line: 1 }, None),
            ("b const nan", "nan", NotADecimal { text: name("nan") }, None),
            ("b const -inf", "-inf", NotADecimal { text: name("-inf") }, None),
            ("b const 0x1F", "0x1F", NotADecimal { text: name("0x1F") }, Some("31")),
            ("b const -1,5", "-1,5", NotADecimal { text: name("-1,5") }, Some("-1.5")),
            ("b const 2.5f", "2.5f", NotADecimal { text: name("2.5f") }, Some("2.5")),
            ("b const --1", "--1", NotADecimal { text: name("--1") }, None),
            ("b const a", "a", NotADecimal { text: name("a") }, None),
        ] {
            let text = format!("a var-x\r\n{line}\r\nc const 1\r\n");
            let expected = (place.to_owned(), kind, meant.map(str::to_owned));
            assert_eq!(error(&text), expected, "{line}");
        }
        assert_eq!(error("# none").1, Empty);
    }

    #[test]
    fn limits_are_those_of_the_text() {
        let limits = Limits { nodes: 3, bytes: 40, ..Limits::default() };
        let kind = |text: &str| read(text, &limits).err().map(|error| error.kind);
        assert_eq!(kind("a var-x\nb neg a\nc neg b"), None);
        assert_eq!(
            kind("a var-x\nb neg a\nc neg b\nd neg c"),
            Some(ErrorKind::ListTooLarge { limit: 3 })
        );
        let long = "a var-x #".to_owned() + &" ".repeat(40);
        assert_eq!(kind(&long), Some(ErrorKind::TooLong { bytes: 49, limit: 40 }));
    }
}
