//! Reads lists of other systems, and the values that loops over lists and ranges give to their
//! variables.

use crate::control_flow::MAX_STEPS;
use crate::known_numbers::{number_expr, steps};
use crate::language::Language;
use crate::program_reader::{Frame, ProgramReader};
use crate::program_words::{Words, is_type};
use zeroset_parser::lex::token::{Token, in_brackets, outside, span_of, split};
use zeroset_parser::lex::token_kind::TokenKind::{self, *};
use zeroset_parser::{Error, ErrorKind, Fallible, Span};

/// Functions that turn a list into an array or into another list.
const LISTS: &[&str] = &["array", "asarray", "list", "tuple", "stack"];

/// Largest number of names that are followed to find a list.
const MAX_NAMES: usize = 4;

/// An element of a list: one value, or several, such as the coordinates of a point.
#[derive(Clone)]
pub(crate) struct Element {
    typed: Vec<Token>,
    /// The values, and their names in an object such as `{x: 1, r: 2}`.
    pub parts: Vec<(Option<Token>, Vec<Token>)>,
    /// True for a list without a constructor such as `vec3`.
    pub is_list: bool,
}

impl Element {
    /// An element with one value.
    pub(crate) fn single(typed: Vec<Token>) -> Self {
        Self { parts: vec![(None, typed.clone())], typed, is_list: false }
    }

    /// A list of values, some with names.
    pub(crate) fn of_parts(parts: Vec<(Option<Token>, Vec<Token>)>) -> Self {
        let values: Vec<Vec<Token>> = parts.iter().map(|(_, part)| part.clone()).collect();
        Self { typed: in_brackets(&separated(&values)), parts, is_list: true }
    }

    /// The element's tokens. Those of a list are in round brackets.
    pub(crate) fn value(&self) -> Vec<Token> {
        if !self.is_list {
            return self.typed.clone();
        }
        let parts: Vec<Vec<Token>> = self.parts.iter().map(|(_, part)| part.clone()).collect();
        in_brackets(&separated(&parts))
    }

    /// The element's tokens in brackets.
    pub(crate) fn tokens(&self) -> Vec<Token> {
        if self.is_list { self.value() } else { in_brackets(&self.typed) }
    }
}

/// The values of a loop's variables in one iteration.
pub(crate) type Bindings = Vec<(Token, Element)>;

impl Words<'_> {
    /// The list in a call such as `np.array([1, 2])`. Other tokens stay as they are.
    pub(crate) fn unwrapped_list(self, tokens: &[Token]) -> &[Token] {
        let is_path = |token: &&Token| token.kind.is_name() || self.is_dot(**token);
        let (head, call) = tokens.split_at(tokens.iter().take_while(is_path).count());
        let is_list = head.last().is_some_and(|last| LISTS.contains(&self.word(*last)));
        match Self::inside(call).filter(|_| is_list) {
            Some(inner) => &inner[..outside(inner, Comma).unwrap_or(inner.len())],
            None => tokens,
        }
    }

    /// The values of a list in brackets. Round brackets hold a list if there is a comma. An object
    /// and a generator are no lists.
    pub(crate) fn list_items(self, tokens: &[Token]) -> Option<Vec<Vec<Token>>> {
        let inner = Self::inside(tokens)?;
        let has_comma = outside(inner, Comma).is_some();
        let is_list = match tokens[0].kind {
            OpenBracket => true,
            OpenBrace => outside(inner, Colon).is_none(),
            _ => has_comma,
        };
        (is_list && !self.has(inner, "for")).then(|| split(inner, Comma))
    }
}

impl ProgramReader<'_> {
    /// The values of a list, a tuple, an array, or a name that stands for one.
    pub(crate) fn list_values(&self, tokens: &[Token]) -> Option<Vec<Vec<Token>>> {
        if let [name] = tokens
            && let Some(array) = self.arrays.get(self.words.word(*name))
        {
            return Some(array.elements.iter().map(Element::value).collect());
        }
        let mut tokens = tokens;
        for _ in 0..MAX_NAMES {
            tokens = match tokens {
                [name] => self.assigned.get(self.words.word(*name))?,
                _ => self.words.unwrapped_list(tokens),
            };
        }
        // The order in a set of Python is not known.
        let is_set = self.language == Language::Python && tokens.first()?.kind == OpenBrace;
        self.words.list_items(tokens).filter(|_| !is_set)
    }

    /// An element of a list.
    pub(crate) fn element(&self, tokens: &[Token]) -> Element {
        let named = |part: &Vec<Token>| match part.as_slice() {
            [name, colon, value @ ..] if colon.kind == Colon && !value.is_empty() => {
                (Some(*name), value.to_vec())
            }
            part => (None, part.to_vec()),
        };
        let inner = Words::inside(tokens).filter(|inner| outside(inner, Comma).is_some());
        if let Some(inner) = inner {
            let parts = split(inner, Comma).iter().map(named).collect();
            return Element { typed: tokens.to_vec(), ..Element::of_parts(parts) };
        }
        let mut element = Element::single(tokens.to_vec());
        if let Some((first, rest)) = tokens.split_first()
            && is_type(self.words.word(*first))
            && let Some(inner) = Words::inside(rest)
        {
            element.parts = split(inner, Comma).into_iter().map(|part| (None, part)).collect();
        }
        element
    }

    /// The elements of a list, or of lists that are numbered or paired, as in `enumerate(a)` and
    /// `zip(a, b)`. `None` for other tokens.
    pub(crate) fn elements(&mut self, values: &[Token], frame: &mut Frame) -> Option<Vec<Element>> {
        let (word, rest) = values.split_first()?;
        let first_number = match self.words.word(*word) {
            "enumerate" => Some(Some(0.0)),
            "ipairs" | "pairs" => Some(Some(1.0)),
            "zip" => Some(None),
            _ => None,
        };
        let Some((number, inner)) = first_number.zip(Words::inside(rest)) else {
            if let Some(array) = self.arrays.get(self.words.word(*word)).filter(|_| rest.is_empty())
            {
                return Some(array.elements.clone());
            }
            return Some(self.list_values(values)?.iter().map(|one| self.element(one)).collect());
        };
        let lists = split(inner, Comma).into_iter().map(|list| self.elements(&list, frame));
        let lists: Vec<Vec<Element>> = lists.collect::<Option<_>>()?;
        let mut rows = Vec::new();
        for index in 0..lists.iter().map(Vec::len).min()? {
            let number = number.map(|first| self.number(first + index as f64, word.span, frame));
            let values = lists.iter().map(|list| list[index].typed.clone());
            let parts = number.map(|number| vec![number]).into_iter().chain(values);
            rows.push(Element::of_parts(parts.map(|part| (None, part)).collect()));
        }
        Some(rows)
    }

    /// A token for a known number.
    pub(crate) fn number(&mut self, number: f64, span: Span, frame: &mut Frame) -> Token {
        self.saved(number_expr(number, span), span, number.fract() == 0.0, frame)
    }

    /// The values of a loop's variables in each iteration over a list or a range.
    pub(crate) fn rounds(
        &mut self,
        pattern: &[Token],
        values: &[Token],
        frame: &mut Frame,
    ) -> Fallible<Vec<Bindings>> {
        let span = span_of(values).unwrap_or_default();
        let refused = || Error::new(span, ErrorKind::LoopEnd);
        if !pattern.iter().any(|token| token.kind.is_name()) {
            return Err(pattern
                .first()
                .map_or_else(refused, |first| self.words.unsupported(*first)));
        }
        let elements = match self.range_numbers(values, span, frame)? {
            Some(numbers) => {
                let number = |number| Element::single(vec![self.number(number, span, frame)]);
                numbers.into_iter().map(number).collect()
            }
            None => self.elements(values, frame).ok_or_else(refused)?,
        };
        let round = |element| self.bindings_of(pattern, element).ok_or_else(refused);
        elements.iter().map(round).collect()
    }

    /// The names in a pattern such as `a, b`, `i, (a, b)` or `{x, r}`, each with its part of an
    /// element.
    pub(crate) fn bindings_of(&self, pattern: &[Token], element: &Element) -> Option<Bindings> {
        let is_object = pattern.first()?.kind == OpenBrace;
        let pattern = Words::inside(pattern).unwrap_or(pattern);
        if let [name] = pattern
            && !is_object
        {
            return name.kind.is_name().then(|| vec![(*name, element.clone())]);
        }
        let names = split(pattern, Comma);
        if !is_object && (names.len() < 2 || names.len() != element.parts.len()) {
            return None;
        }
        let mut all = Vec::new();
        for (index, name) in names.iter().enumerate() {
            let part = if is_object {
                let word = self.words.word(name[0]);
                let own = |key: &Token| self.words.word(*key) == word;
                element.parts.iter().find(|(key, _)| key.as_ref().is_some_and(own))?
            } else {
                element.parts.get(index)?
            };
            all.extend(self.bindings_of(name, &self.element(&part.1))?);
        }
        Some(all)
    }

    /// The numbers of Python's `range(low, high, step)`, or of `[low : step : high]`, which has its
    /// end, as in `OpenSCAD`. `None` for other tokens.
    pub(crate) fn range_numbers(
        &mut self,
        tokens: &[Token],
        span: Span,
        frame: &mut Frame,
    ) -> Fallible<Option<Vec<f64>>> {
        let Some((first, rest)) = tokens.split_first() else { return Ok(None) };
        let inner = Words::inside(tokens).filter(|_| first.kind == OpenBracket).unwrap_or_default();
        let mut parts = split(inner, Colon);
        let is_closed = parts.len() > 1;
        if !is_closed && self.words.word(*first) != "range" {
            return Ok(None);
        }
        if !is_closed {
            parts = split(Words::inside(rest).unwrap_or_default(), Comma);
        }
        let known = parts.iter().map(|part| self.known_value(part, frame));
        let (low, high, step) = match known.collect::<Option<Vec<f64>>>().as_deref() {
            Some([low, high]) if !is_closed || low <= high => (*low, *high, 1.0),
            Some([low, step, high]) if is_closed && *step != 0.0 => (*low, *high, *step),
            Some([high]) if !is_closed => (0.0, *high, 1.0),
            Some([low, high, step]) if !is_closed && *step != 0.0 => (*low, *high, *step),
            _ => return Err(Error::new(span, ErrorKind::LoopEnd)),
        };
        let limit = MAX_STEPS;
        let too_many = || Error::new(span, ErrorKind::TooManySteps { limit });
        steps(low, high, step, is_closed, limit).ok_or_else(too_many).map(Some)
    }
}

/// The sign that joins the values of a list in a function such as `sum`. A comma for functions such
/// as `max`, which take the values as their arguments.
pub(crate) fn joint_of(word: &str) -> Option<TokenKind> {
    Some(match word {
        "sum" | "Sum" | "fsum" => Plus,
        "prod" | "product" => Star,
        "min" | "max" | "minimum" | "maximum" | "amin" | "amax" => Comma,
        _ => return None,
    })
}

/// The values in brackets, with `sign` between them, in brackets.
pub(crate) fn joined(values: &[Vec<Token>], sign: TokenKind) -> Vec<Token> {
    let values: Vec<Vec<Token>> = values.iter().map(|value| in_brackets(value)).collect();
    in_brackets(&with_signs(&values, sign))
}

/// The values with commas between them.
pub(crate) fn separated(values: &[Vec<Token>]) -> Vec<Token> {
    with_signs(values, Comma)
}

/// The values with `sign` between them.
pub(crate) fn with_signs(values: &[Vec<Token>], sign: TokenKind) -> Vec<Token> {
    let mut all: Vec<Token> = Vec::new();
    for value in values {
        if let Some(first) = value.first().filter(|_| !all.is_empty()) {
            all.push(Token::new(sign, Span::at(first.span.start)));
        }
        all.extend(value);
    }
    all
}
