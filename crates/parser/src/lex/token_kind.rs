//! Kinds of tokens, and the character for each kind that the grammar reads.

use crate::settings::SettingKind;

/// Declares [`TokenKind`]. Each row is a kind and its character in the grammar.
macro_rules! token_kinds {
    ($($(#[$doc:meta])* $kind:ident = $character:literal,)*) => {
        /// Kind of a token. All spellings of a sign have the same kind.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum TokenKind {
            $($(#[$doc])* #[doc = concat!("Written ", stringify!($character), " in the grammar.")] $kind,)*
        }

        impl TokenKind {
            /// The character for this kind in the grammar.
            pub const fn as_char(self) -> char {
                match self {
                    $(Self::$kind => $character,)*
                }
            }

            /// The kind whose character in the grammar is `character`.
            pub(crate) const fn of_char(character: char) -> Option<Self> {
                match character {
                    $($character => Some(Self::$kind),)*
                    _ => None,
                }
            }
        }
    };
}

// The only list of kinds. The grammar does not read every kind. The other kinds are dropped or
// changed before the grammar reads a statement.
token_kinds! {
    // Names and numbers. A `Name` has no fixed meaning.
    Name = 'a', X = 'x', Y = 'y', Z = 'z', Number = '0', VulgarFraction = '½',
    /// A single digit as a part of a fraction or as a radicand.
    Digit = '1',
    /// A value that a program computed before the statement.
    Saved = 'e',
    /// Superscript digits, perhaps after a superscript sign.
    Superscript = '²',

    // Operators.
    Plus = '+', Minus = '-', Star = '*', Slash = '/', Caret = '^', Factorial = '!',
    SquareRoot = '√', CubeRoot = '∛', Remainder = '٪',
    /// The scalar product of two lists.
    DotProduct = '⊙',
    /// Components of a vector, as in `p.xz`.
    Component = '‧',
    /// A function after its first argument, as in `a.sin()`.
    Method = '⋄',

    // Conditions.
    Equals = '=', NotEqual = '≠', Less = '<', LessEqual = '≤', Greater = '>', GreaterEqual = '≥',
    And = '∧', Or = '∨', Not = '¬', In = '∈',

    // Brackets.
    OpenParen = '(', CloseParen = ')', OpenBracket = '[', CloseBracket = ']',
    OpenBrace = '{', CloseBrace = '}', OpenFloor = '⌊', CloseFloor = '⌋',
    OpenCeiling = '⌈', CloseCeiling = '⌉', OpenChoice = '⦃', CloseChoice = '⦄',
    OpenList = '⟨', CloseList = '⟩', OpenMatrix = '⟦',
    /// The end of an environment that is a matrix or a choice.
    CloseMatrix = '⟧',
    OpenBar = '|', CloseBar = '¦',
    /// A bar that may open or close. `pair_bars` decides its role.
    Bar = '❘',

    // Choices, ranges and sums.
    Comma = ',', Colon = ':', Semicolon = ';', QuestionMark = '⸮', Otherwise = 'O',
    /// Stands between a value and its condition.
    If = '¿',
    /// Stands between the ends of a range.
    Dots = '‥',
    /// Stands between an index and its range.
    CountFrom = '≔',
    /// `for` and `range` in a generator.
    For = '∀', RangeCall = 'N',

    // Commands of LaTeX: `\frac`, `\sqrt`, `\over`, `\sum`, `\prod`, `\\`, `&`, `_`.
    Fraction = 'F', Root = 'R', Over = '÷', BigSum = 'Σ', BigProduct = 'Π', RowEnd = '␤',
    Ampersand = '&', Underscore = '_',
    /// A command for upright letters, such as `\mathrm`. A name follows in braces.
    Upright = 'T',
    /// The ends of an environment that aligns lines.
    OpenAlignment = '⇥', CloseAlignment = '⇤',

    // Words that begin lines about the picture. `SettingWord` is for words without their own kind.
    DomainWord = 'd', ViewWord = 'v', ColorWord = 'c', LookWord = 'l', BackgroundWord = 'b',
    SettingWord = 's', Auto = 'u', HexColor = '#', Percent = '%',
    /// The name of a view, such as `front`.
    Preset = 'p',
    /// A word before a vector, such as `eye`, and a word before a number, such as `fov`.
    VectorKey = 'k', NumberKey = 'n',

    // The words `curve` and `point` at the start of a statement, typed or implied, and a label.
    CurveWord = 'q', PointWord = 'o', Label = '§',
    /// The word before the two ends of a segment.
    SegmentWord = 'g',

    // All other kinds. `Blank` is space, comments and markup.
    Blank = ' ', LineEnd = '\n', At = '@',
    /// A character without a meaning in this language.
    Unknown = '?',
}

/// Opening brackets, each with its closing bracket.
const BRACKETS: [(TokenKind, TokenKind); 8] = [
    (OpenParen, CloseParen),
    (OpenBracket, CloseBracket),
    (OpenBrace, CloseBrace),
    (OpenFloor, CloseFloor),
    (OpenCeiling, CloseCeiling),
    (OpenChoice, CloseChoice),
    (OpenList, CloseList),
    (OpenMatrix, CloseMatrix),
];

use TokenKind::*;

impl TokenKind {
    /// The kind of a word that begins a line about `setting`.
    pub fn of_setting(setting: SettingKind) -> Self {
        match setting {
            SettingKind::Domain => DomainWord,
            SettingKind::View => ViewWord,
            SettingKind::Color => ColorWord,
            SettingKind::Look => LookWord,
            SettingKind::Background => BackgroundWord,
            _ => SettingWord,
        }
    }

    /// Returns whether this word begins a line about the picture.
    pub fn is_setting(self) -> bool {
        matches!(self, DomainWord | ViewWord | ColorWord | LookWord | BackgroundWord | SettingWord)
    }

    /// Returns whether this is a name, or a word that may be used as a name.
    pub fn is_name(self) -> bool {
        self.is_setting()
            || matches!(self, Name | X | Y | Z | Root | Auto | Preset | VectorKey | NumberKey)
    }

    /// Returns whether this is the coordinate x, y or z.
    pub fn is_axis(self) -> bool {
        matches!(self, X | Y | Z)
    }

    /// Returns whether this is `+`, `-`, `*` or `/`.
    pub fn is_arithmetic(self) -> bool {
        matches!(self, Plus | Minus | Star | Slash)
    }

    /// Returns whether this compares two values by their order.
    pub fn is_inequality(self) -> bool {
        matches!(self, Less | LessEqual | Greater | GreaterEqual)
    }

    /// Returns whether this compares two values.
    pub fn is_relation(self) -> bool {
        matches!(self, Equals | NotEqual) || self.is_inequality()
    }

    /// Returns whether this is `and`, `or` or `not`.
    pub(crate) fn is_logical(self) -> bool {
        matches!(self, And | Or | Not)
    }

    /// Returns whether this is an operator, a relation or a comma.
    pub fn is_operator(self) -> bool {
        self.is_arithmetic()
            || self.is_relation()
            || matches!(self, Caret | Superscript | SquareRoot | CubeRoot | Comma)
            || self.is_logical()
            || self == In
    }

    /// Returns whether an operand can end with a token of this kind.
    pub fn ends_operand(self) -> bool {
        matches!(
            self,
            Number | Digit | VulgarFraction | Superscript | Component | Factorial | Saved
        ) || self.is_name()
            || self.is_closer()
    }

    /// Returns whether an operand can begin with a token of this kind.
    pub fn begins_operand(self) -> bool {
        matches!(self, Number | VulgarFraction | Fraction | SquareRoot | CubeRoot | Not | Saved)
            || matches!(self, BigSum | BigProduct)
            || self.is_name()
            || self.closer().is_some()
    }

    /// The bracket that closes this opening bracket; `None` for any other kind.
    pub fn closer(self) -> Option<Self> {
        BRACKETS.iter().find(|(open, _)| *open == self).map(|(_, close)| *close)
    }

    /// Returns whether this is a closing bracket.
    pub fn is_closer(self) -> bool {
        BRACKETS.iter().any(|(_, close)| *close == self)
    }
}
