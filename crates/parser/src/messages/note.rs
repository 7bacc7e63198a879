//! Notes on how a text was read, for cases in which the writer may have meant something else.

use crate::span::Span;

/// Largest number of notes on one document.
pub const MAX_NOTES: usize = 40;

/// A note on how a place in a text was read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// The place that the note's caret marks.
    pub span: Span,
    /// Kind of the note.
    pub kind: NoteKind,
}

/// Kind of a note. Its `Display` is the note's message.
#[derive(Clone, Debug, PartialEq, Eq, Hash, thiserror::Error)]
#[allow(missing_docs)] // each message says what its variant means
pub enum NoteKind {
    #[error("read as `{read}`; for the other reading, write `{other}`")]
    ImplicitDivision { read: String, other: String },
    #[error("read as `{read}`; for the other reading, write `{other}`")]
    PowerScope { read: String, other: String },
    #[error("read as `{read}`; for the root, write `{root}`")]
    DividedPower { read: String, root: String },
    #[error(
        "`{name}^-1` is read as the inverse function `{inverse}`; \
         for the reciprocal, write `1/{name}(…)`"
    )]
    InverseFunction { name: String, inverse: String },
    #[error("`{name}` is read as the product `{product}`")]
    ProductOfNames { name: String, product: String },
    #[error("`{name}` is read as `{read}`")]
    ReadAs { name: String, read: &'static str },
    #[error("`{name}` is {meaning}")]
    ConstantUsed { name: &'static str, meaning: &'static str },
    #[error(
        "a power with exponent {exponent} is defined only for values >= 0; \
         `{other}` accepts negative values too"
    )]
    OddRoot { exponent: String, other: String },
    #[error(
        "`{name}` divides a function that is no distance by the length of its gradient, \
         so lengths are right to first order"
    )]
    DividedByGradient { name: &'static str },
    #[error("`{name}` is read as a function of the sequence `{read}`")]
    Sequence { name: String, read: String },
    #[error("`{radical}` applies only to the factor after it; use brackets to cover more")]
    RadicalScope { radical: char },
    #[error("`{name}` is defined again below; the last definition applies everywhere")]
    Redefined { name: String },
    #[error("`{name}` is defined and never used{}", did_you_mean(.meant.as_deref()))]
    Unused { name: String, meant: Option<String> },
    #[error(
        "the range of `{name}` is cut to a length of {length}, since it is infinite; \
         write its ends to see another part"
    )]
    CutRange { name: String, length: u8 },
    #[error("`{name}` is set to a value outside its range")]
    OutsideRange { name: String },
    #[error("`{name}` says how many terms there are, so it is a constant and no slider")]
    CountsTerms { name: String },
    #[error("only definitions here: drawing `{drawn}`")]
    DrawsFunction { drawn: String },
    #[error("`{name}` is built in, so this is drawn as an equation and defines nothing")]
    BuiltInOnTheLeft { name: String },
    #[error(
        "the exponent `{exponent}` may be a whole number but is not known to be one, \
         so the power is defined only for values >= 0; write it in digits to allow negative values"
    )]
    NearInteger { exponent: String },
    #[error("the comma is read as a decimal point: `{read}`")]
    DecimalComma { read: String },
    #[error(
        "the product of two vectors is taken component by component; \
         for the scalar product, write `dot(p, q)`"
    )]
    ProductOfVectors,
    #[error("it is 0 where no condition holds, as in Mathematica")]
    ZeroElsewhere,
    #[error("`X`, `Y` and `Z` are read as the coordinates x, y and z")]
    CapitalCoordinates,
    #[error("`sinc(a)` is sin(a)/a, and 1 at 0; for sin(pi*a)/(pi*a), write `sinc(pi*a)`")]
    Sinc,
    #[error(
        "the arc cotangent is pi/2 - atan(a), in (0, pi); for the other one, write `atan(1/a)`"
    )]
    ArcCotangent,
    #[error("numpy's `sinc(a)` is read as `sinc(pi*a)`, that is sin(pi*a)/(pi*a)")]
    SincOfNumpy,
    #[error("the angle of a point, as in Mathematica: `{read}`")]
    ArcTanOfPoint { read: String },
    #[error("the angles of this text are in degrees, as in OpenSCAD")]
    DegreesOfOpenscad,
    #[error(
        "the angles of this function are in radians, as in R; OpenSCAD has `;` after a function"
    )]
    RadiansOfR,
    #[error("`E` is read as Euler's number e")]
    CapitalE,
    #[error("{system}: `{definitions}`; for others, define them")]
    Coordinates { system: &'static str, definitions: String },
    #[error(
        "`{name}` is read as the point of space, `{name} = vec3(x, y, z)`; for another, define it"
    )]
    PointOfSpace { name: String },
    #[error("read as `{name}({read})`; brackets tell where the argument ends")]
    FunctionOfProduct { name: String, read: String },
    #[error("`a % b` is read as `mod(a, b)`, which has the sign of b")]
    Remainder,
    #[error("`{name}` is read as the time `t`")]
    TimeOfShaders { name: String },
    #[error("`log` is the natural logarithm; for the one to base 10, write `log10`")]
    NaturalLogarithm,
    #[error("`{name}` is left out: what is drawn is the distance function")]
    MainLeftOut { name: String },
    #[error("`{name}` is defined above, so this is drawn: where it has that value")]
    LevelOf { name: String },
    #[error(
        "the ranges of the plot are the domain: `domain {domain}`; such a line below gives another"
    )]
    PlotDomain { domain: String },
    #[error(
        "only the ranges of the first plot are the domain; these have no effect here: `{domain}`"
    )]
    PlotDomainLeftOut { domain: String },
    #[error(
        "the ranges of the plot are not read; write them as `domain x in [-2, 2], y in [-1, 1]`"
    )]
    PlotWithoutRanges,
    #[error(
        "what contains the surface is not read; write it as `domain x in [-2, 2], y in [-1, 1]`"
    )]
    ContainerIgnored,
    #[error("`{typed}` is read as two values; for a decimal number write `{decimal}`")]
    DoubtfulComma { typed: String, decimal: String },
    #[error("these parts of the plot have no effect here: {left}")]
    PlotPartsLeftOut { left: String },
    #[error("the plot gives no level, so this is drawn where the function is 0")]
    PlotWithoutLevel,
    #[error("lines of equal value are drawn as a graph, `z = f`; for one such line, write `f = 1`")]
    LinesAsGraph,
    #[error("only the formula and its ranges are read; these have no effect here: {left}")]
    FileLeftOut { left: String },
    #[error("`{name}` takes its shape at {axis} = 0, so {axis} has no effect within it")]
    ShapeAtZero { name: &'static str, axis: char },
    #[error("an expression list: drawn is the solid `{name} <= 0`, as in fidget")]
    ExpressionList { name: String },
    #[error("what only styles the picture, such as `{example}`, is left out")]
    StyleLeftOut { example: String },
    #[error(
        "what neither defines nor draws anything that is shown is left out, such as `{example}` \
         (statements: {count})"
    )]
    StatementsLeftOut { count: usize, example: String },
    #[error("the label `{label}:` has no effect; a title is a line `title {label}`")]
    LabelLeftOut { label: String },
    #[error("the names of the plot are the coordinates: `{read}`")]
    PlotNames { read: String },
    #[error("read as in {system}: `{read}`; for another, define it")]
    ForeignDefinition { system: &'static str, read: String },
    #[error(
        "`{axis}` does not occur, so the surface extends along it; the curve in the plane \
         {axis} = 0 is `curve {equation}, {axis} = 0`, with `view {view}`"
    )]
    PlaneCurve { axis: char, equation: String, view: &'static str },
    #[error("this is 0 only {place}, and so no surface{}", drawn_by(.line.as_deref()))]
    ThinZeros { place: &'static str, line: Option<String> },
    #[error(
        "no other line uses `{name}`, so this is drawn as a surface; beside a line that uses it, \
         it is a value"
    )]
    CoordinateAlone { name: String },
    #[error(
        "beside the other coordinates of this text, `{name}` is one, so this is drawn as a surface"
    )]
    CoordinateAmongOthers { name: String },
    #[error("`r` is defined and never used; to draw the cylinder, write `{line}`")]
    UnusedRadius { line: String },
    #[error(
        "`r` is never negative here, and `{angle}` goes from -pi to pi, so parts of the polar curve \
         are missing; all of it is `{line}`"
    )]
    PolarCurve { angle: String, line: String },
    #[error("read as `{read}`; for a power with the exponent {exponent}, write `{other}`")]
    FractionAsPower { read: String, exponent: String, other: String },
    #[error(
        "this is a slab, which is drawn beside the others; to keep a part of a surface, write \
         `{line}`"
    )]
    SlabBeside { line: String },
    #[error("marks of a list are left out: {typed}")]
    MarksOfList { typed: String },
    #[error("`{typed}` is the number of the equation and is left out; a factor stands in front")]
    NumberOfEquation { typed: String },
    #[error(
        "this line goes on with the line above; for a formula of its own, write `= 0` at its end"
    )]
    LineGoesOn,
    #[error("read as the curve on which both equations hold, `{read}`")]
    CommonCurve { read: String },
    #[error("the value of a root comes first, so this is read as `{read}`")]
    RootOf { read: String },
    #[error("numbers are added here, and no solids are joined; for that, write `{meant}`")]
    SolidsInSum { meant: String },
    #[error(
        "`cylinder(r, h)` has the radius first, and then half the height; in OpenSCAD, the height \
         is first"
    )]
    CylinderOfOpenscad,
    #[error("`{typed}` is read as a factor; leave it out if it only numbers the line")]
    NumberOfList { typed: String },
    #[error(
        "this line begins with a minus sign and is a formula of its own; one that goes on with the \
         line above is indented"
    )]
    LineWithMinus,
    #[error("the angle {number} is in radians; for degrees, write `{number}°`")]
    LargeAngle { number: String },
    #[error("a bracket is open at the end of the line, which is read as `{read}`")]
    BracketClosed { read: String },
    #[error("this is nowhere 0, so there is nothing to draw")]
    NoZeros,
    #[error("further notes omitted")]
    More,
}

impl NoteKind {
    /// Returns whether the note explains a name. One such note serves for all uses of the name.
    pub fn explains_a_name(&self) -> bool {
        matches!(
            self,
            Self::ConstantUsed { .. }
                | Self::ProductOfNames { .. }
                | Self::ReadAs { .. }
                | Self::CapitalCoordinates
                | Self::CapitalE
                | Self::Sinc
                | Self::ArcCotangent
                | Self::ZeroElsewhere
                | Self::NaturalLogarithm
                | Self::Remainder
                | Self::TimeOfShaders { .. }
                | Self::ProductOfVectors
                | Self::DegreesOfOpenscad
                | Self::RadiansOfR
                | Self::DividedByGradient { .. }
                | Self::Sequence { .. }
        )
    }
}

fn did_you_mean(meant: Option<&str>) -> String {
    meant.map_or_else(String::new, |meant| format!("; did you mean `{meant}`?"))
}

fn drawn_by(line: Option<&str>) -> String {
    line.map_or_else(String::new, |line| format!("; to see it, write `{line}`"))
}

impl Note {
    /// The note's message, in one line.
    pub fn message(&self) -> String {
        self.kind.to_string()
    }
}
