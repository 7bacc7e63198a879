//! Kinds of tokens, and the character that stands for each in the grammar.

use crate::settings::SettingKind;

/// Declares [`TokenKind`] from rows of a kind and its character.
macro_rules! token_kinds {
    ($($(#[$doc:meta])* $kind:ident = $character:literal,)*) => {
        /// Kind of a token, whichever spelling was typed.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum TokenKind {
            $($(#[$doc])* $kind,)*
        }

        impl TokenKind {
            /// The character that stands for this kind in the grammar.
            pub(crate) const fn as_char(self) -> char {
                match self {
                    $(Self::$kind => $character,)*
                }
            }

            /// The kind that `character` stands for in the grammar.
            pub(crate) const fn of_char(character: char) -> Option<Self> {
                match character {
                    $($character => Some(Self::$kind),)*
                    _ => None,
                }
            }
        }
    };
}

// The only list of kinds. A kind that no rule of the grammar names is dropped, or turned into
// another one, before the grammar reads its statement.
token_kinds! {
    // Names and numbers. `Name` has no fixed meaning.
    Name = 'a', X = 'x', Y = 'y', Z = 'z', Number = '0', VulgarFraction = '½',
    /// One digit as a part of a fraction or below a root.
    Digit = '1',
    /// Superscript digits, perhaps with a sign.
    Superscript = '²',

    // Operators.
    Plus = '+', Minus = '-', Star = '*', Slash = '/', Caret = '^', Factorial = '!',
    SquareRoot = '√', CubeRoot = '∛', Remainder = '٪',
    /// The scalar product of two lists.
    DotProduct = '⊙',
    /// `.xz`: components of a vector.
    Component = '‧',
    /// `.sin`: a function after its first argument.
    Method = '⋄',

    // Conditions.
    Equals = '=', NotEqual = '≠', Less = '<', LessEqual = '≤', Greater = '>', GreaterEqual = '≥',
    And = '∧', Or = '∨', Not = '¬', In = '∈',

    // Brackets.
    OpenParen = '(', CloseParen = ')', OpenBracket = '[', CloseBracket = ']',
    OpenBrace = '{', CloseBrace = '}', OpenFloor = '⌊', CloseFloor = '⌋',
    OpenCeiling = '⌈', CloseCeiling = '⌉', OpenChoice = '⦃', CloseChoice = '⦄',
    OpenList = '⟨', CloseList = '⟩', OpenMatrix = '⟦',
    /// The end of an environment, which closes a matrix or a choice.
    CloseMatrix = '⟧',
    OpenBar = '|', CloseBar = '¦',
    /// A bar whose role is not decided yet.
    Bar = '❘',

    // Choices, ranges and sums.
    Comma = ',', Colon = ':', Semicolon = ';', QuestionMark = '⸮', Otherwise = 'O',
    /// Separates a value from its condition.
    If = '¿',
    /// Separates the ends of a range.
    Dots = '‥',
    /// Separates an index from its range.
    CountFrom = '≔',
    /// `for` and `range` in a generator.
    For = '∀', RangeCall = 'N',

    // Commands of LaTeX: `\frac`, `\sqrt`, `\over`, `\sum`, `\prod`, `\\`, `&`, `_`.
    Fraction = 'F', Root = 'R', Over = '÷', BigSum = 'Σ', BigProduct = 'Π', RowEnd = '␤',
    Ampersand = '&', Underscore = '_',
    /// Upright letters: a name follows in braces.
    Upright = 'T',
    /// The ends of an environment that only aligns.
    OpenAlignment = '⇥', CloseAlignment = '⇤',

    // Words that begin lines about the picture. `SettingWord` is any word without its own kind.
    DomainWord = 'd', ViewWord = 'v', ColorWord = 'c', LookWord = 'l', BackgroundWord = 'b',
    SettingWord = 's', Auto = 'u', HexColor = '#', Percent = '%',
    /// A named direction of view.
    Preset = 'p',
    /// A word before a vector, such as `eye`, and one before a number, such as `fov`.
    VectorKey = 'k', NumberKey = 'n',

    // Everything else. `Blank` is space, comments and markup.
    Blank = ' ', LineEnd = '\n', At = '@',
    /// A character without a meaning.
    Unknown = '?',
}

/// Pairs of opening and closing brackets.
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
    /// The kind of the word that begins a line about `setting`.
    pub(crate) fn of_setting(setting: SettingKind) -> Self {
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
    pub(crate) fn is_setting(self) -> bool {
        matches!(self, DomainWord | ViewWord | ColorWord | LookWord | BackgroundWord | SettingWord)
    }

    /// Returns whether this is a name, or a word that may also be a name.
    pub(crate) fn is_name(self) -> bool {
        self.is_setting()
            || matches!(self, Name | X | Y | Z | Root | Auto | Preset | VectorKey | NumberKey)
    }

    /// Returns whether this is a coordinate.
    pub(crate) fn is_axis(self) -> bool {
        matches!(self, X | Y | Z)
    }

    /// Returns whether this is an operator between two numbers, other than a power.
    pub(crate) fn is_arithmetic(self) -> bool {
        matches!(self, Plus | Minus | Star | Slash)
    }

    pub(crate) fn is_inequality(self) -> bool {
        matches!(self, Less | LessEqual | Greater | GreaterEqual)
    }

    pub(crate) fn is_relation(self) -> bool {
        matches!(self, Equals | NotEqual) || self.is_inequality()
    }

    /// Returns whether this is `and`, `or` or `not`.
    pub(crate) fn is_logical(self) -> bool {
        matches!(self, And | Or | Not)
    }

    /// Returns whether this is an operator, a relation or a comma.
    pub(crate) fn is_operator(self) -> bool {
        self.is_arithmetic()
            || self.is_relation()
            || matches!(self, Caret | Superscript | SquareRoot | CubeRoot | Comma)
            || self.is_logical()
            || self == In
    }

    /// Returns whether an operand can end with this token.
    pub(crate) fn ends_operand(self) -> bool {
        matches!(self, Number | Digit | VulgarFraction | Superscript | Component | Factorial)
            || self.is_name()
            || self.is_closer()
    }

    /// Returns whether an operand can begin with this token.
    pub(crate) fn begins_operand(self) -> bool {
        matches!(self, Number | VulgarFraction | Fraction | SquareRoot | CubeRoot | Not)
            || matches!(self, BigSum | BigProduct)
            || self.is_name()
            || self.closer().is_some()
    }

    /// The bracket that closes this one.
    pub(crate) fn closer(self) -> Option<Self> {
        BRACKETS.iter().find(|(open, _)| *open == self).map(|(_, close)| *close)
    }

    /// Returns whether this is a closing bracket.
    pub(crate) fn is_closer(self) -> bool {
        BRACKETS.iter().any(|(_, close)| *close == self)
    }
}
