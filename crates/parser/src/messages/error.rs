//! Errors as data: what is wrong, at which place, why, and what to write instead.
//!
//! Nothing here draws carets or knows lines; `render` does both.

use crate::span::Span;
use std::fmt;

/// The errors of a text and its overrides; at least one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Errors(Vec<Error>);

/// Largest number of errors that are reported. Reading stops at this number of errors.
pub const MAX_ERRORS: usize = 20;

impl Errors {
    /// At most [`MAX_ERRORS`] of `errors`, in the order of their places. `errors` is not empty.
    pub fn new(mut errors: Vec<Error>) -> Self {
        debug_assert!(!errors.is_empty());
        errors.truncate(MAX_ERRORS);
        errors.sort_by_key(|error| (error.origin.clone(), error.span));
        Self(errors)
    }

    /// Sets the advice on the error with this index, and the line that it says to write, if any.
    pub fn advise(&mut self, index: usize, advice: String, correction: Option<String>) {
        if let Some(error) = self.0.get_mut(index) {
            (error.advice, error.correction) = (Some(advice), correction);
        }
    }

    /// Keeps the error with this index, of which the others are consequences.
    pub fn keep_only(&mut self, index: usize) {
        if index < self.0.len() {
            self.0.swap(0, index);
            self.0.truncate(1);
        }
    }

    /// The document's errors in the order of their places, then the errors of overrides.
    pub fn iter(&self) -> std::slice::Iter<'_, Error> {
        self.0.iter()
    }
}

impl<'a> IntoIterator for &'a Errors {
    type Item = &'a Error;
    type IntoIter = std::slice::Iter<'a, Error>;
    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl From<Box<Error>> for Errors {
    fn from(error: Box<Error>) -> Self {
        Self(vec![*error])
    }
}

impl fmt::Display for Errors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, error) in self.0.iter().enumerate() {
            if index > 0 {
                f.write_str("\n")?;
            }
            write!(f, "{}", error.kind)?;
        }
        Ok(())
    }
}

impl std::error::Error for Errors {}

/// An error in a document or an override.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error {
    /// The place that the error's caret marks.
    pub span: Span,
    /// Kind of the error.
    pub kind: ErrorKind,
    /// A suggested correction, if one is known.
    pub suggestion: Option<Suggestion>,
    /// Text that `span` refers to.
    pub origin: Origin,
    /// Advice that takes the place of the usual advice on an error of this kind.
    pub advice: Option<String>,
    /// The line to write in place of the statement with the error, if the advice gives one.
    pub correction: Option<String>,
}

/// The text in which an error lies.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum Origin {
    /// The document.
    #[default]
    Document,
    /// An override, as the whole text `name=value`.
    Override(String),
}

/// A change that may turn the text into what its writer meant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Suggestion {
    /// Place of the text to replace.
    pub span: Span,
    /// Replacement text.
    pub replacement: String,
}

/// Kind of an error. Its `Display` is the error's message.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs)] // each message says what its variant means and names its fields
pub enum ErrorKind {
    // ---- limits
    #[error("the text is {bytes} bytes long; at most {limit} are read")]
    TooLong { bytes: usize, limit: usize },
    #[error("the text has more than {limit} numbers, names and signs")]
    TooManySymbols { limit: usize },
    #[error("the text draws more than {limit} surfaces")]
    TooManySurfaces { limit: usize },
    #[error("this is nested more than {limit} levels deep")]
    TooDeep { limit: usize },
    #[error("what is nested here takes more stack than this thread has left")]
    NoStack,
    #[error("with its definitions expanded, the formula has more than {limit} operations")]
    TooLarge { limit: usize },
    #[error("the text is not valid UTF-8: byte {offset} cannot be read")]
    NotUtf8 { offset: usize },

    // ---- empty texts
    #[error("there is no formula here")]
    Empty,
    #[error("nothing to draw: the text has only definitions")]
    NothingToDraw { last: String, is_number: bool, parameters: Option<usize> },

    // ---- characters and brackets
    #[error("`{character}` has no meaning in a formula")]
    UnexpectedCharacter { character: char },
    #[error("`{}` is never closed", bracket(*.open))]
    Unclosed { open: char, at: Span },
    #[error("`{}` closes nothing", bracket(*.close))]
    Unopened { close: char },
    #[error("`{}` is closed by `{}`", bracket(*.open), bracket(*.close))]
    Mismatched { open: char, close: char },
    #[error("`|` is never closed")]
    UnclosedBar,
    #[error("there is nothing between these bars")]
    EmptyBars,
    #[error("these bars can be paired in two ways")]
    AmbiguousBars,
    #[error("these brackets are empty")]
    EmptyBrackets,

    // ---- order of tokens
    #[error("a value is missing after `{sign}`")]
    MissingAfter { sign: String },
    #[error("a value is missing before `{sign}`")]
    MissingBefore { sign: String },
    #[error("a fraction needs two pairs of braces")]
    HalfFraction,
    #[error("the formula ends too early")]
    Unfinished,
    #[error("unexpected `{found}`")]
    Unexpected { found: String },
    #[error("a number cannot follow a name or a bracket")]
    NumberAfterFactor,
    #[error("two numbers in a row need an operator between them")]
    NumberAfterNumber,
    #[error("`{sign}` is not an operator of this language")]
    ForeignOperator { sign: String },
    #[error("a list of values is not a number")]
    Tuple,
    #[error("a vector is not a number")]
    Vector,
    #[error("two solids in a row need a function that joins them")]
    SolidsInARow,
    #[error("unexpected comma")]
    Comma,
    #[error("`{name}` begins a line of its own")]
    SettingInLine { name: String },
    #[error("there is no calculus here")]
    Calculus,
    #[error("a program's `{word}` is not read here")]
    Program { word: String },
    #[error("a program sets at most {limit} names")]
    TooManyNames { limit: usize },
    #[error("a program runs at most {limit} statements, its loops written out")]
    TooManySteps { limit: usize },
    #[error("how often this loop runs is not known")]
    LoopEnd,
    #[error("`{name}` changes what it is given")]
    OutParameter { name: String },
    #[error("a sign stands between what it joins")]
    Prefix,
    #[error("a condition in braces ends the formula")]
    RestrictionInside,
    #[error("there are no arrays")]
    Array,
    #[error("only a variable or its components can be set here")]
    Target,
    #[error("this changes `{name}`, which the same expression reads before")]
    Order { name: String },
    #[error("this call changes the outer `{name}`, but a variable here has the same name")]
    Hidden { name: String },
    #[error("`{name}` is defined twice, for different types")]
    Overloaded { name: String },
    #[error("operators on the bits of integers are not read")]
    Bits,
    #[error("this statement sets nothing")]
    NoEffect,
    #[error("`//` is no integer division")]
    IntegerDivision,

    // ---- vectors
    #[error("a vector of {size} components cannot be made of {given}")]
    VectorSize { size: usize, given: usize },
    #[error("vectors of {first} and of {second} components do not go together")]
    VectorSizes { first: usize, second: usize },
    #[error("this is a number and has no component `.{letters}`")]
    ComponentOfNumber { letters: String },
    #[error("a vector of {size} components has no `.{letter}`")]
    NoComponent { letter: char, size: usize },
    #[error("`cross` takes two vectors of three components")]
    CrossSize,
    #[error("a matrix cannot be used like this")]
    Matrix,
    #[error("a matrix is not a number")]
    MatrixValue,
    #[error("this is not a matrix")]
    NotAMatrix,
    #[error("a matrix of {size} rows and columns cannot be made of {given} numbers")]
    MatrixSize { size: usize, given: usize },
    #[error("a matrix has two to four rows, and as many values in each")]
    MatrixShape,

    // ---- choices, sums, iteration
    #[error("a piece of a choice has no condition")]
    PieceWithoutCondition,
    #[error("this is not how `{name}` is written")]
    FormUsage { name: &'static str, usage: &'static str },
    #[error("this must be a constant whole number")]
    RangeNotWhole,
    #[error("the first argument of `{name}` must be a whole number from 0 to {limit}")]
    NumberInSequence { name: &'static str, limit: i64 },
    #[error("a parametric surface needs the ranges of its two parameters")]
    Parametric,
    #[error("a curve takes two equations")]
    CurveEquations,
    #[error("the curve's parameter has no range")]
    CurveRange,
    #[error("a point of space has three coordinates, not {given}")]
    PointSize { given: usize },
    #[error("`{name}` has no value here")]
    CurveCoordinate { name: &'static str },
    #[error("the text draws more than {limit} curves and points")]
    TooManyCurves { limit: usize },
    #[error("this plots in coordinates of its own")]
    PlotCoordinates,
    #[error("the option `{name}` changes the surface, and is not read")]
    PlotOption { name: String },
    #[error("here is no formula that can be read")]
    NoFormula,
    #[error("the variables of this plot cannot be matched with the coordinates")]
    PlotVariables,
    #[error("of a text of {format}, {read}")]
    Format { format: &'static str, read: &'static str, help: &'static str },
    #[error("this is no equation but the name of a solid")]
    Solid { formula: &'static str },
    #[error("these words are no part of a formula")]
    Remark,
    #[error("this is a formula in words")]
    InWords,
    #[error("the step of a sum must be 1 or more")]
    SeriesStep,
    #[error("there are at most {limit} terms or repetitions")]
    TooManyTerms { limit: i64 },

    // ---- names
    #[error("`{name}` is not defined")]
    UnknownName {
        name: String,
        /// The only letter without a value, if the name may be a product of its letters.
        letter: Option<char>,
    },
    #[error("there is no function `{name}`")]
    UnknownFunction { name: String },
    #[error("`{name}` runs a name and a number together")]
    LostSuperscript { name: String },
    #[error("`{name}` is no variable to differentiate by")]
    NotAVariable { name: String },
    #[error("there is no variable to differentiate by")]
    WhichVariable,
    #[error("a derivative is of order 1 to {limit}")]
    DerivativeOrder { limit: usize },
    #[error("this is a complex number, where a real one is needed")]
    Complex,
    #[error("`{name}` has no value for complex numbers")]
    ComplexFunction { name: &'static str },
    #[error("`{name}` has no value for quaternions")]
    QuaternionFunction { name: &'static str },
    #[error("vectors and matrices hold no complex numbers")]
    ComplexAmongVectors,
    #[error("the whole power of a complex number is at most {limit}")]
    ComplexExponent { limit: u64 },
    #[error("`{name}` is a value, not a function")]
    NotAFunction { name: String },
    #[error("`{name}` is a function and needs {}", plural(*.count))]
    NeedsArgument { name: String, count: usize },
    #[error("`{name}` takes {expected}, not {given}")]
    WrongCount { name: String, expected: String, given: usize, usage: Option<String> },
    #[error("`{argument}` of `{name}` must be {needs}, and this is {given}")]
    BuilderArgument {
        name: &'static str,
        argument: &'static str,
        needs: &'static str,
        given: &'static str,
        usage: String,
    },
    #[error("`{name}^-1` could mean the inverse or the reciprocal")]
    InversePower { name: String },
    #[error("`{name}` cannot be redefined")]
    Reserved { name: String, is_function: bool },
    #[error("a function has at most {limit} parameters")]
    TooManyParameters { limit: usize },
    #[error("two parameters are named `{name}`")]
    DuplicateParameter { name: String },
    #[error("{}", recursion(.cycle))]
    Recursion { cycle: Vec<String> },
    #[error("there is no zeroth root")]
    ZerothRoot,

    // ---- conditions
    #[error("a comparison cannot be used as a number")]
    ConditionAsValue,
    #[error("`{word}` applies only to comparisons")]
    ValueAsCondition { word: &'static str },
    #[error("an equation cannot be part of `and`, `or` or `not`")]
    EquationInCondition,
    #[error("an equation has only one `=`")]
    SeveralEquals,
    #[error("`=` cannot be mixed with `<` or `>`")]
    MixedChain,
    #[error("`!=` is allowed only in braces")]
    UnequalOutsideBraces,
    #[error("a restriction needs a comparison such as `z > 0`")]
    RestrictionNotCondition,
    #[error("an equation cannot restrict another one")]
    RestrictionIsEquation,
    #[error("`or` in braces cannot join strict and non-strict comparisons")]
    MixedRestriction,
    #[error("`{name}` is a coordinate and cannot be a function")]
    CoordinateFunction { name: String },
    #[error("a definition names a value, not a comparison")]
    DefinitionIsCondition,
    #[error("`in [low, high]` belongs to a definition such as `r = 2 in [0, 5]`")]
    RangeOutsideDefinition,
    #[error("braces restrict what is drawn, not a definition")]
    RestrictedDefinition,

    // ---- constants
    #[error("this must be a constant, but `{name}` varies")]
    NotConstant { name: String },
    #[error("this has no value")]
    UndefinedConstant,
    #[error("`in` needs a range in square brackets")]
    BadRange,
    #[error("the lower end must be below the upper end")]
    EmptyRange,
    #[error("the value lies outside its range")]
    OutsideRange,

    // ---- overrides
    #[error("`{name}` does not occur in the formula")]
    UnknownOverride { name: String },
    #[error("`{name}` is not a name that can be set")]
    OverrideNotAName { name: String },
    #[error("`{name}` is a coordinate and cannot be set")]
    OverrideCoordinate { name: String },
    #[error("`{name}` is a function and cannot be set to a number")]
    OverrideFunction { name: String },

    // ---- expression lists
    #[error("`{name}` has no operation")]
    NoOperation { name: String },
    #[error("there is no operation `{name}`")]
    UnknownOperation { name: String, known: String },
    #[error("`{name}` is no function of real numbers")]
    OperationOfBits { name: &'static str },
    #[error("`{name}` takes {}, not {given}", operands(*.expected))]
    OperandCount { name: &'static str, expected: usize, given: usize },
    #[error("no line defines `{name}`")]
    UndefinedOperand { name: String },
    #[error("`{name}` is defined only in line {line}")]
    DefinedBelow { name: String, line: usize },
    #[error("`{name}` is already defined, in line {line}")]
    RepeatedLine { name: String, line: usize },
    #[error("`{text}` is not a decimal number")]
    NotADecimal { text: String },
    #[error("the list has more than {limit} operations")]
    ListTooLarge { limit: usize },

    // ---- domain, view and color lines
    #[error("the size of a domain must be greater than 0")]
    EmptyDomain,
    #[error("this is not a domain")]
    BadDomain,
    #[error("the range of `{axis}` is given twice")]
    RepeatedAxis { axis: char },
    #[error("this is not a view")]
    BadView,
    #[error("`{key}` takes three numbers")]
    BadVector { key: String },
    #[error("this is not a color")]
    BadColor,
    #[error("this is not a look")]
    BadLook,
    #[error("there is no such color map")]
    BadColorMap,
    #[error("this is not what `{word}` takes")]
    BadSetting { word: &'static str, hint: &'static str },
}

/// The text of a bracket for a message. The brackets of a LaTeX environment appear as commands.
fn bracket(symbol: char) -> String {
    match symbol {
        '⦃' | '⟦' => r"\begin{…}".to_owned(),
        '⦄' | '⟧' => r"\end{…}".to_owned(),
        _ => symbol.to_string(),
    }
}

/// The phrase for `count` arguments, such as "2 arguments".
pub fn plural(count: usize) -> String {
    match count {
        1 => "an argument".to_owned(),
        _ => format!("{count} arguments"),
    }
}

/// The phrase for `count` operands of a list's line, such as "two operands".
fn operands(count: usize) -> &'static str {
    ["no operand", "one operand", "two operands"].get(count).copied().unwrap_or("more operands")
}

/// Largest number of names of a cycle that a message lists.
const LONGEST_CYCLE: usize = 6;

fn recursion(cycle: &[String]) -> String {
    match cycle {
        [only] => format!("`{only}` is defined in terms of itself"),
        [first, rest @ ..] => {
            let mut others: Vec<String> =
                rest.iter().chain([first]).map(|name| format!("`{name}`")).collect();
            if others.len() > LONGEST_CYCLE {
                others.drain(LONGEST_CYCLE - 2..others.len() - 1);
                others.insert(LONGEST_CYCLE - 2, "…".to_owned());
            }
            format!(
                "these definitions are circular: `{first}` uses {}",
                others.join(", which uses ")
            )
        }
        [] => String::new(),
    }
}

/// Result of most functions that read texts. Errors are rare and large, so they are boxed.
pub type Fallible<T> = Result<T, Box<Error>>;

impl Error {
    /// An error of the document at `span`, without a suggestion.
    pub fn new(span: Span, kind: ErrorKind) -> Box<Self> {
        let origin = Origin::Document;
        Box::new(Self { span, kind, suggestion: None, origin, advice: None, correction: None })
    }

    /// Adds the suggestion to replace `span` by `replacement`.
    pub fn suggest(mut self: Box<Self>, span: Span, replacement: impl Into<String>) -> Box<Self> {
        self.suggestion = Some(Suggestion { span, replacement: replacement.into() });
        self
    }

    /// Adds the suggestion to replace `span` by `meant`, unless `meant` is `None`.
    pub fn suggest_optional(self: Box<Self>, span: Span, meant: Option<String>) -> Box<Self> {
        match meant {
            Some(meant) => self.suggest(span, meant),
            None => self,
        }
    }

    /// The error's message, in one line.
    pub fn message(&self) -> String {
        self.kind.to_string()
    }
}
