//! Calls of Python's libraries that draw a surface or a curve: for each, the arguments that hold
//! the formula and the level.

use crate::program_words::Words;
use zeroset_parser::lex::token::Token;
use zeroset_parser::lex::token_kind::TokenKind::{Equals, OpenBracket, Unknown};

/// A place at which a call holds a value.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Source {
    /// The argument at this index. Arguments with a keyword do not count.
    At(usize),
    /// The last argument without a keyword.
    Last,
    /// The argument with this keyword.
    Key(&'static str),
    /// The object before the dot, as in `grid.contour()`.
    Receiver,
}

/// Kind of a drawing.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Drawn {
    /// A surface on which a formula has a value.
    Level,
    /// The graph of a formula over x and y.
    Height,
    /// A curve through three lists of coordinates.
    Curve,
}

/// A call that draws.
pub(crate) struct DrawingCall {
    pub word: &'static str,
    pub drawn: Drawn,
    /// Places of the formula. The first one that exists in a call is used.
    pub formula: &'static [Source],
    /// Places of the level or of a list of levels.
    pub level: &'static [Source],
}

use Source::{At, Key, Last, Receiver};

const fn level(
    word: &'static str,
    formula: &'static [Source],
    level: &'static [Source],
) -> DrawingCall {
    DrawingCall { word, drawn: Drawn::Level, formula, level }
}

const fn height(word: &'static str, formula: &'static [Source]) -> DrawingCall {
    DrawingCall { word, drawn: Drawn::Height, formula, level: &[] }
}

const fn curve(word: &'static str) -> DrawingCall {
    DrawingCall { word, drawn: Drawn::Curve, formula: &[], level: &[] }
}

/// Formula and level of scikit-image, `PyMCubes` and K3D.
const VOLUME: &[Source] = &[Key("volume"), Key("scalar_field"), At(0)];
const LEVEL: &[Source] = &[Key("level"), Key("isovalue"), At(1)];

/// The calls that draw.
#[rustfmt::skip] // one row a line
pub(crate) const DRAWING_CALLS: &[DrawingCall] = &[
    level("Isosurface", &[Key("value")], &[]),
    level("Volume", &[Key("value")], &[]),
    level("marching_cubes", VOLUME, LEVEL),
    level("marching_cubes_lewiner", VOLUME, LEVEL),
    level("marching_cubes_classic", VOLUME, LEVEL),
    level("marching_cubes_func", &[At(5)], &[At(6)]),
    level("surface_nets", VOLUME, LEVEL),
    level("contour3d", &[Key("scalars"), Last], &[Key("contours")]),
    level("iso_surface", &[At(0)], &[Key("contours")]),
    level("plot_isosurface", &[At(0)], &[Key("level")]),
    level("isosurface", &[Receiver], &[Key("value"), Key("isovalue"), Key("threshold"), At(0)]),
    level("contour", &[Key("scalars"), At(2), Receiver], &[Key("levels"), Key("isosurfaces"), At(3), At(0)]),
    level("ImplicitSurface", &[Key("func"), Key("f"), Key("function"), At(0)], &[]),
    level("plot_implicit_3d", &[Receiver], &[]),
    level("plot_implicit_2d", &[Receiver], &[]),
    height("plot_surface", &[Key("Z"), At(2)]),
    height("plot_wireframe", &[Key("Z"), At(2)]),
    height("contour3D", &[At(2)]),
    height("contourf", &[At(2)]),
    height("Surface", &[Key("z"), At(2)]),
    height("StructuredGrid", &[At(2)]),
    height("surf", &[At(2), At(0)]),
    height("mesh", &[At(2)]),
    curve("Scatter3d"),
    curve("plot"),
    curve("plot3D"),
    curve("plot3d"),
];

/// Functions that put a formula into an object: `vol = Volume(s)`.
pub(crate) const WRAPPERS: &[&str] = &["Volume", "wrap", "scalar_field"];

/// A call in a program: its row, the object before the dot, and its arguments.
pub(crate) struct PythonCall {
    pub row: &'static DrawingCall,
    pub name: Token,
    pub receiver: Option<Token>,
    pub positional: Vec<Vec<Token>>,
    /// Arguments with their keywords.
    pub named: Vec<Vec<Token>>,
}

impl PythonCall {
    pub(crate) fn new(
        row: &'static DrawingCall,
        name: Token,
        receiver: Option<Token>,
        arguments: Vec<Vec<Token>>,
    ) -> Self {
        let is_named = |part: &Vec<Token>| {
            part[0].kind.is_name() && part.get(1).is_some_and(|sign| sign.kind == Equals)
        };
        let (named, mut positional): (Vec<_>, Vec<Vec<Token>>) =
            arguments.into_iter().partition(is_named);
        // PyVista's `contour([0.5], values)`: the levels come first, and there is no grid.
        if let [levels, value, ..] = positional.as_slice()
            && row.word == "contour"
            && levels[0].kind == OpenBracket
        {
            positional = vec![levels.clone(), levels.clone(), value.clone(), levels.clone()];
        }
        Self { row, name, receiver, positional, named }
    }

    /// Takes the argument with the keyword `name`.
    pub(crate) fn take(&mut self, words: Words<'_>, name: &str) -> Option<Vec<Token>> {
        let index = self.named.iter().position(|part| words.word(part[0]) == name)?;
        Some(self.named.remove(index).split_off(2)).filter(|value| !value.is_empty())
    }

    /// The first of `sources` that the call has, and the value there.
    pub(crate) fn find(
        &mut self,
        words: Words<'_>,
        sources: &'static [Source],
    ) -> Option<(Vec<Token>, Source)> {
        sources.iter().find_map(|source| {
            let value = match source {
                At(index) => self.positional.get(*index).cloned(),
                Last => self.positional.last().cloned(),
                Key(name) => self.take(words, name),
                Receiver => self.receiver.map(|name| vec![name]),
            };
            // A string names a value and is no formula.
            let is_text =
                |value: &Vec<Token>| matches!(value.as_slice(), [] | [Token { kind: Unknown, .. }]);
            Some((value.filter(|value| !is_text(value))?, *source))
        })
    }
}
