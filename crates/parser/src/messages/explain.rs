//! Explains errors in words, and advises on corrections.

use crate::messages::error::ErrorKind::{self, *};
use crate::messages::error::{Error, Suggestion};
use crate::settings::setting;
use crate::span::Span;
use zeroset_style::{COLOR_MAPS, LOOKS, VIEWS};

/// Largest number of characters in a quoted correction.
const MAX_QUOTED: usize = 60;

impl Error {
    /// A few words to show at the error's caret.
    pub fn label(&self) -> Option<&'static str> {
        Some(match &self.kind {
            Unclosed { open, at } if *at != self.span => match open {
                '(' => "missing `)`",
                '[' => "missing `]`",
                '{' => "missing `}`",
                '⌊' => "missing `⌋`",
                '⌈' => "missing `⌉`",
                _ => "missing bracket",
            },
            Unclosed { .. } => "opened here",
            UnclosedBar => "this bar",
            MissingAfter { .. } => "expected a value after this",
            MissingBefore { .. } => "expected a value before this",
            TooDeep { .. } | NoStack => "nesting limit exceeded here",
            UnknownName { .. } => "no value has this name",
            UnknownFunction { .. } => "no function has this name",
            SeveralEquals => "the second one",
            ConditionAsValue => "this is true or false, not a number",
            ValueAsCondition { .. } => "this is a number",
            _ => return None,
        })
    }

    /// Another place that explains the error, with a few words to show there.
    pub(crate) fn second_label(&self) -> Option<(Span, &'static str)> {
        match &self.kind {
            Unclosed { at, .. } if *at != self.span => Some((*at, "opened here")),
            _ => None,
        }
    }

    /// The reason why the text is an error.
    pub fn reason(&self) -> Option<&'static str> {
        Some(match &self.kind {
            TooLong { .. } | TooManySymbols { .. } | TooDeep { .. } => {
                "the limit keeps parsing fast and safe on any input"
            }
            ListTooLarge { .. } => "the limit keeps memory and time within bounds",
            NoOperation { .. } | OperandCount { .. } => {
                "a line has a name, an operation and its operands: `_2 mul _1 _0`"
            }
            UnknownOperation { .. } => {
                "the text is read as an expression list, which knows the operations of fidget"
            }
            OperationOfBits { .. } => "it mixes the bits of floats, which real numbers do not have",
            UndefinedOperand { .. } | DefinedBelow { .. } => {
                "an operand is the name of a line above"
            }
            RepeatedLine { .. } => "each line defines a value with a name of its own",
            NotADecimal { .. } => "a constant is a real number",
            TooManySurfaces { .. } => "each line that is not a definition draws a surface",
            TooLarge { .. } => "each use of a definition inserts a copy of it",
            NotUtf8 { .. } => "formulas are UTF-8 text",
            NothingToDraw { .. } => {
                "a line `name = …` is a definition; any other line is drawn, \
                 and so is a function of (x, y, z) or (x, y)"
            }
            UnexpectedCharacter { character } => return character_reason(*character),
            AmbiguousBars => {
                "opening and closing bars look alike, so this has more than one reading"
            }
            NumberAfterFactor | LostSuperscript { .. } => {
                "a number goes before what it multiplies; \
                 after it, it is often a superscript lost in copying"
            }
            NumberAfterNumber => "a product of two numbers needs an explicit `*`",
            Tuple | Vector => {
                "a surface is one equation between numbers, in x, y and z, or three coordinates with \
                 the ranges of two parameters"
            }
            Calculus => "there are derivatives, as in `diff(f, x)` and `f'(x)`, but no integrals",
            Program { .. } => "a formula is read as a whole, not run step by step",
            IntegerDivision => "it begins a comment, and what follows looks like a divisor",
            RangeNotWhole => "a sum is written out before anything is drawn",
            TooManyTerms { .. } => "each term becomes a part of the formula",
            Comma => "commas separate the arguments of a function, inside its brackets",
            NeedsArgument { count: 1, .. } if self.suggestion.is_some() => {
                "an argument without brackets cannot start with a sign"
            }
            Complex => "`i` is the imaginary unit, unless the text defines it",
            NotAFunction { .. } => "brackets after a value multiply, and a product has no commas",
            InversePower { .. } => {
                "`^-1` means the inverse only for sin, cos, tan, sinh, cosh and tanh"
            }
            Reserved { is_function: true, .. } => "it is a function of the language",
            Reserved { .. } => "it is a word of the language",
            Recursion { .. } => {
                "a definition is expanded where it is used, and this would never end"
            }
            EquationInCondition => {
                "an equation describes a surface; \
                 `and`, `or` and `not` combine solids, which have an inside"
            }
            SeveralEquals | MixedChain => {
                "an equation sets two sides equal; only inequalities form chains"
            }
            UnequalOutsideBraces => "the complement of a surface has no boundary to draw",
            RestrictionIsEquation => "two surfaces meet in a curve",
            CurveCoordinate { .. } => "the points come from the parameter, not from coordinates",
            MixedRestriction => {
                "the boundary would belong to one part of the region and not to the other"
            }
            DefinitionIsCondition => "a definition is used in place of a number",
            RestrictedDefinition => "braces go after a formula that is drawn",
            NotConstant { .. } => "sliders, ranges and settings need a value known in advance",
            UndefinedConstant => "it is undefined or too large, like 1/0 or 9^9^9^9",
            OverrideCoordinate { .. } | CoordinateFunction { .. } => {
                "x, y and z are the coordinates of space"
            }
            ConditionAsValue => {
                "comparisons combine with `and`, `or` and `not`, not with arithmetic"
            }
            _ => return None,
        })
    }

    /// Advice on what to write. `text` is the text in which the error lies.
    pub fn help(&self, text: &str) -> Option<String> {
        if self.advice.is_some() {
            return self.advice.clone();
        }
        if let UnexpectedCharacter { character } = self.kind
            && let Some(help) = character_help(character)
        {
            return Some(help.to_owned());
        }
        let Some(meant) = &self.suggestion else {
            return self.advice(text);
        };
        let replacement = &meant.replacement;
        Some(match &self.kind {
            Unopened { .. } => return self.advice(text),
            UnknownName { name, .. } if is_clause(name) => return self.advice(text),
            UnknownName { .. }
            | UnknownFunction { .. }
            | UnknownOverride { .. }
            | UnknownOperation { .. }
            | BadColor
            | BadColorMap
            | BadSetting { .. }
            | BadLook => format!("did you mean `{replacement}`?"),
            UnexpectedCharacter { .. } => format!("write `{replacement}`"),
            _ => match text.get(meant.span.range()) {
                // A short sign alone is unclear, so the advice also shows the replaced text.
                Some(typed)
                    if !typed.is_empty()
                        && meant.span == self.span
                        && typed.chars().count() <= 3 =>
                {
                    format!("write `{replacement}` in place of `{typed}`")
                }
                _ => format!("write `{}`", self.corrected(text, meant)),
            },
        })
    }

    /// Advice for an error without a suggestion.
    fn advice(&self, text: &str) -> Option<String> {
        Some(match &self.kind {
            UnknownName { name, .. } if is_clause(name) => {
                "to restrict a formula, write the condition in braces: `x + y = z {z > 0}`"
                    .to_owned()
            }
            UnknownName { name, letter: None } => {
                let line = text.get(statement(text, self.span).range()).unwrap_or_default();
                let is_equation = line.replace("<=", "").replace(">=", "").contains('=');
                // In an equation with x or y, r is hardly this distance.
                let distance = match name.as_str() {
                    "r" if !is_equation => {
                        "; for the distance from the z axis, write `r = sqrt(x^2 + y^2)`"
                    }
                    _ => "",
                };
                format!("give it a value with a line `{name} = 1` or with `-D {name}=1`{distance}")
            }
            UnknownName { name, letter: Some(letter) } => {
                let product = name.chars().map(String::from).collect::<Vec<_>>().join("*");
                format!(
                    "to read it as `{product}`, give `{letter}` a value \
                     with a line `{letter} = 1` or with `-D {letter}=1`"
                )
            }
            Recursion { cycle } if cycle.len() == 1 => {
                "write a sum as `sum(k = 1..5, …)`, a function applied again as `iterate(f, 5, x)`"
                    .to_owned()
            }
            UnknownFunction { name } if matches!(name.as_str(), "gamma" | "Gamma") => {
                "no proven bounds are known here; for whole numbers write the product, \
                 `product(k = 1..4, k)`"
                    .to_owned()
            }
            UnknownFunction { name } => {
                let parameters =
                    ["a", "b", "c", "d"][..self.arguments(text).clamp(1, 4)].join(", ");
                format!(
                    "define it with a line `{name}({parameters}) = …`, or give `{name}` a value \
                     to multiply with"
                )
            }
            NothingToDraw { last, parameters: Some(count), .. } => {
                let arguments = example_arguments(text, self.span, *count);
                format!(
                    "`{last}` is not built in, so this line defines it; to draw where it is 0, \
                     add a line that is just `{last}({})`",
                    arguments.join(", ")
                )
            }
            NothingToDraw { last, is_number: true, .. } => {
                format!("add a line that uses `{last}`, such as `x^2 + y^2 + z^2 = {last}^2`")
            }
            NothingToDraw { last, is_number: false, .. } => {
                format!("to draw where `{last}` is 0, add a line that is just `{last}`")
            }
            NeedsArgument { name, count: 1 } => format!("write `{name}(…)`"),
            UnknownOperation { known, .. } => format!("the operations are {known}"),
            NeedsArgument { name, .. } => {
                format!("write `{name}(…, …)`: without brackets a function takes only one argument")
            }
            WrongCount { usage, .. } => usage.clone()?,
            BuilderArgument { usage, .. } => usage.clone(),
            FormUsage { usage, .. } => format!("write it as in `{usage}`"),
            InversePower { name } => format!("for the reciprocal, write `1/{name}(…)`"),
            BadView => format!(
                "write `view front` ({}) or `view eye (2, -3, 1.5) target (0, 0, 0)`",
                VIEWS.map(|view| view.name).join(", ")
            ),
            BadVector { key } => format!("write `{key} (1, 2, 3)`"),
            BadDomain => setting("domain")?.hint.to_string(),
            BadColor => setting("color")?.hint.to_string(),
            BadLook => there_are(&LOOKS.map(|look| look.name)),
            BadSetting { hint, .. } => (*hint).to_owned(),
            BadColorMap => there_are(&COLOR_MAPS.map(|map| map.name)),
            kind => fixed_advice(kind)
                .or_else(|| order_advice(kind))
                .or_else(|| list_advice(kind))
                .or_else(|| curve_advice(kind))
                .or_else(|| foreign_advice(kind))?
                .to_owned(),
        })
    }

    /// The number of arguments in the brackets behind the error's place; 0 without brackets.
    fn arguments(&self, text: &str) -> usize {
        let behind = text.get(self.span.end..).unwrap_or_default().trim_start();
        let mut depth = 0_usize;
        let mut count = 0;
        for (at, sign) in behind.char_indices().take(200) {
            match sign {
                '(' | '[' | '{' => depth += 1,
                ')' | ']' | '}' => depth = depth.saturating_sub(1),
                ',' if depth == 1 => count += 1,
                _ => {}
            }
            if depth == 0 {
                return if at == 0 { 0 } else { count + 1 };
            }
        }
        0
    }

    /// The text at the error's place, corrected by `meant`. Gives only the replacement if the
    /// corrected text is empty, long or has several lines.
    fn corrected(&self, text: &str, meant: &Suggestion) -> String {
        let whole = match &self.kind {
            // The whole line, as far as it is the formula.
            Unclosed { at, .. } => statement(text, *at),
            Mismatched { .. } => statement(text, self.span),
            _ => self.span.to(meant.span),
        };
        let (Some(before), Some(after)) =
            (text.get(whole.start..meant.span.start), text.get(meant.span.end..whole.end))
        else {
            return meant.replacement.clone();
        };
        let corrected = format!("{before}{}{after}", meant.replacement);
        if corrected.is_empty()
            || corrected.chars().count() > MAX_QUOTED
            || corrected.contains('\n')
        {
            return meant.replacement.clone();
        }
        corrected
    }
}

/// Arguments with which a function is drawn that is defined at `name`: the coordinates, or the
/// point of space for a parameter whose type is a vector.
fn example_arguments(text: &str, name: Span, count: usize) -> Vec<&'static str> {
    let behind = text.get(name.end..).unwrap_or_default().trim_start();
    let list = behind.strip_prefix('(').and_then(|rest| rest.split_once(')'));
    let typed: Vec<&str> = list.map(|(list, _)| list.split(',').collect()).unwrap_or_default();
    let size =
        |parameter: &&str| ["vec2", "vec3"].into_iter().find(|size| parameter.contains(size));
    if typed.len() != count || !typed.iter().any(|one| size(one).is_some()) {
        let coordinates = ["x", "y", "z"].into_iter().chain(std::iter::repeat("1"));
        return coordinates.take(count).collect();
    }
    let first = typed.iter().position(|one| size(one).is_some());
    let argument = |(index, one)| match (size(one), first == Some(index)) {
        (Some("vec2"), true) => "vec2(x, y)",
        (Some(_), true) => "vec3(x, y, z)",
        (Some("vec2"), false) => "vec2(1, 1)",
        (Some(_), false) => "vec3(1, 1, 1)",
        (None, _) => "1",
    };
    typed.iter().enumerate().map(argument).collect()
}

/// The place of the statement around `at`, if it is on one line.
pub(crate) fn statement(text: &str, at: Span) -> Span {
    let breaks = ['\n', '\r', ';', '#'];
    let (before, after) = (text.get(..at.start), text.get(at.end..));
    let (before, after) = (before.unwrap_or_default(), after.unwrap_or_default());
    let first = before.rfind(breaks).map_or(0, |end| end + 1);
    let length = after.find(breaks).unwrap_or(after.len());
    let blank = before[first..].len() - before[first..].trim_start().len();
    Span::new(first + blank, at.end + after[..length].trim_end().len())
}

/// Returns whether a word begins a condition in other languages.
fn is_clause(word: &str) -> bool {
    matches!(word, "for" | "if" | "where" | "when")
}

/// Advice on a plot or a text of another system that cannot be read.
fn foreign_advice(kind: &ErrorKind) -> Option<&'static str> {
    Some(match kind {
        PlotOption { .. } => {
            "write a level into the formula, as in `f - 1`, and a condition behind it in braces: `f {z > 0}`"
        }
        NoFormula => {
            "write the formula in place of this, as in `f = x^2 + y^2 - z^2`, and draw `f = 1`"
        }
        PlotVariables => {
            "write the formula in x, y and z, and the ranges as `domain x in [-2, 2], y in [-1, 1]`"
        }
        Format { help, .. } => help,
        PlotCoordinates => {
            "write the equation with `rho`, `theta` and `phi` (distance from the origin, angle around z, angle from z), \
             or with `r`, `theta` and `z`"
        }
        _ => return None,
    })
}

/// Advice on parts that stand in the wrong order or place.
fn order_advice(kind: &ErrorKind) -> Option<&'static str> {
    Some(match kind {
        Prefix => "what is `(+ a b)` in prefix notation is `a + b` here",
        RestrictionInside => "write a choice there, as in `z = {x > 0: x, 0} + y`",
        SolidsInARow => "write `union(a, b)`, `intersect(a, b)` or `subtract(a, b)`",
        Remark => "write a remark behind `#`",
        _ => return None,
    })
}

/// Advice on curves and points, and on formulas that draw a curve.
fn curve_advice(kind: &ErrorKind) -> Option<&'static str> {
    Some(match kind {
        CurveEquations => {
            "write both with a comma between them: `curve x^2 + y^2 = 1, z = x`; \
             a curve with a parameter is `(cos t, sin t, t/5) for t in [0, 20]`"
        }
        CurveRange => "write `for t in [0, 20]` behind the coordinates",
        PointSize { .. } => "write `(1, 2, 3)`",
        CurveCoordinate { .. } => {
            "write the coordinates in terms of the parameter alone; \
             where two surfaces meet is `curve x^2 + y^2 = 1, z = x`"
        }
        Complex => {
            "take `abs(…)`, `re(…)`, `im(…)` or `arg(…)` of it, or define `i = 1`; \
             where it is 0 is a curve: write `curve` before it"
        }
        RestrictionIsEquation => {
            "use `<`, `<=`, `>`, `>=` or `!=` in braces, or draw the curve: `curve x^2 + y^2 = 1, z = x`"
        }
        _ => return None,
    })
}

/// Advice that depends only on the kind of the error.
fn fixed_advice(kind: &ErrorKind) -> Option<&'static str> {
    Some(match kind {
        Empty => "write an equation such as `x^2 + y^2 + z^2 = 1`",
        Unclosed { .. } => "write the bracket that closes it where it should end",
        Mismatched { .. } => "close each bracket by its own kind, the inner one first",
        Unopened { .. } => "remove it, or open a bracket before it",
        AmbiguousBars | UnclosedBar => "write `abs(…)` in place of bars",
        EmptyBars => "an absolute value is written `|x|`, a choice `or`",
        Comma => {
            "put each surface and each value on a line of its own; join conditions with `and`, \
             and restrict a formula in braces: `z = x*y {x < 1}`"
        }
        Tuple => {
            "write one equation in x, y and z; a product is written with `*`, a vector `vec2(x, y)`, \
             a curve `(cos t, sin t, t) for t in [0, 20]`"
        }
        Vector => "take its `length(…)`, or a component such as `.x`",
        Calculus => {
            "there are no integrals and no limits: write the antiderivative, or the value, as a \
             formula"
        }
        Program { .. } => {
            "write a choice as `c ? a : b`, a loop as `sum(k = 1..3, …)` or `iterate(f, 3, x)`"
        }
        TooManySteps { .. } => "let the loop end earlier",
        Array => "give each element a name of its own, or use a vector such as `vec3(a, b, c)`",
        LoopEnd => {
            "let it count between numbers, as in `for (int i = 0; i < 5; i++)` or `for i in range(5):`"
        }
        OutParameter { .. } => {
            "call it in a statement of its own, and give it names or components: `fold(p.xz);`"
        }
        NoEffect => "remove it, or set a name to its value",
        IntegerDivision => {
            "write `floor(a/b)` for a division, or put the comment on a line of its own"
        }
        VectorSize { .. } => "give as many numbers as it has components, or one for all",
        VectorSizes { .. } => "take components, as in `p.xy`",
        ComponentOfNumber { .. } => "a product is written `*`",
        NoComponent { .. } => "components are .x, .y, .z and .w, in this order",
        CrossSize => "write `cross(vec3(…), vec3(…))`",
        Matrix => {
            "add matrices of one size, or multiply with a number, a matrix or a vector: `m*p.xy`"
        }
        MatrixValue => "take its `determinant(…)`, or a component of `m*p`",
        NotAMatrix => "write a matrix column by column, as in `mat2(c, s, -s, c)`",
        MatrixSize { .. } => "give all elements, or one for the diagonal",
        MatrixShape => "a column of values is a vector; write out any other product",
        PieceWithoutCondition => {
            "write `{x < 0: a, b}`: conditions first, then a value for all other points"
        }
        RangeNotWhole => "write the number in digits, as in `sum(k = 1..5, sin(k x)/k)`",
        Target => "give a variable on the left of the sign, as in `d = 1.` or `p.xz = q`",
        Order { .. } => "write two statements: the order in one is not defined",
        Hidden { .. } | Overloaded { .. } => "give each of them a name of its own",
        Bits => "write `pow(a, b)` for a power, or arithmetic with `floor` and `mod`",
        NumberInSequence { .. } => "write the number in digits, or the formula itself",
        Parametric => {
            "write `(cos u cos v, sin u cos v, sin v) for u in [0, 2pi], v in [-pi/2, pi/2]`"
        }
        Solid { formula } => formula,
        InWords => {
            "write signs: `x^2` for x squared, `sqrt(x)` for a square root, `+`, `-`, `*`, `/`, and `=` for equals"
        }
        SeriesStep => "leave the step out, or let it be 1 or more",
        TooManyTerms { .. } => "end the range earlier",
        NotAVariable { .. } => "differentiate by `x`, `y`, `z`, `t`, a slider or a parameter",
        WhichVariable => "name the variable, as in `diff(x^2*y, x)`",
        DerivativeOrder { .. } => "write the order in digits, as in `diff(x^4, x, 2)`",
        ComplexFunction { .. } => "apply it to `re(…)`, `im(…)` or `abs(…)` of the number",
        QuaternionFunction { .. } => {
            "quaternions have `+`, `-`, `*`, `/`, whole powers, `abs`, `re`, `im` and `conj`"
        }
        ComplexAmongVectors => "take `re(…)` and `im(…)` of it",
        ComplexExponent { .. } => "lower the exponent",
        Reserved { .. } => "choose another name",
        TooManySurfaces { .. } | TooManyCurves { .. } => "draw fewer at a time",
        ZerothRoot => "the second argument of `root(a, n)` says which root to take",
        ConditionAsValue => "compare outside the arithmetic, as in `x + 1 < y`",
        ValueAsCondition { .. } => "compare it with something, as in `x^2 + y^2 < 1`",
        EquationInCondition => "use `<=` or `>=`, or restrict the equation: `x + y = z {z > 0}`",
        SeveralEquals => "to draw two equations, put each on a line of its own",
        MixedChain => "restrict the equation: `x + y = z {z < 1}`",
        UnequalOutsideBraces => "exclude points from an equation: `x*y = 1 {x != 0}`",
        RestrictionNotCondition => "compare it with something, as in `{z > 0}`",
        MixedRestriction => "use `<` and `>` throughout, or `<=` and `>=` throughout",
        DefinitionIsCondition => "define left minus right, `d = x^2 - 1`, and draw `d <= 0`",
        RangeOutsideDefinition => {
            "to limit a coordinate, write a line such as `domain x in [-2, 2]`"
        }
        HalfFraction => "write `\\frac{a}{b}`",
        BadRange => "write `r = 2 in [0, 5]`",
        EmptyRange => "write the smaller number first",
        OutsideRange => "choose a value between the ends",
        OverrideNotAName { .. } => "write `-D name=value`, such as `-D r=2`",
        OverrideCoordinate { .. } => "to crop the picture, set a domain",
        CoordinateFunction { .. } => "give the function another name, such as `f`",
        UnknownOverride { .. } => "use it in the formula, or drop the setting",
        OverrideFunction { .. } => "change its definition in the text instead",
        _ => return None,
    })
}

/// Advice on errors in expression lists.
fn list_advice(kind: &ErrorKind) -> Option<&'static str> {
    Some(match kind {
        NoOperation { .. } => "write a line such as `_0 const 2.95`, `_1 var-x` or `_2 mul _1 _0`",
        OperandCount { expected: 0, .. } => "leave out the words after it",
        OperandCount { expected: 1, .. } => "write one name or number after it",
        OperandCount { .. } => "write the names of two lines after it",
        OperationOfBits { .. } => "replace it by a constant or a formula",
        UndefinedOperand { .. } => "add the line that defines it, or correct the name",
        DefinedBelow { .. } => "move that line above this one",
        RepeatedLine { .. } => "give one of the two lines another name",
        NotADecimal { .. } => "write a finite decimal, such as `2.95` or `-1.5e-3`",
        ListTooLarge { .. } => "draw a part of the model",
        _ => return None,
    })
}

fn character_reason(character: char) -> Option<&'static str> {
    Some(match character {
        '!' => "a factorial is one of a constant whole number",
        '\'' | '′' | '’' | '∂' | '∫' | '∑' | '∏' => {
            "there are no derivatives and integrals; write them out"
        }
        '∞' => "all values are finite",
        '±' => "a formula has one value at each point",
        '°' => "angles are in radians",
        '_' => "names start with a letter",
        '"' | '`' | '“' | '”' => "there is no quoted text",
        _ => return None,
    })
}

fn character_help(character: char) -> Option<&'static str> {
    Some(match character {
        '\'' | '′' | '’' => "write the derivative out; a name with a prime is written `x1`",
        '!' => "write the number in digits, as in `5!`; there is no gamma function",
        '"' | '`' | '“' | '”' => "write the formula without quotation marks",
        '@' => "a function is written `f(x, y) = …`",
        '$' => "dollar signs stand around a formula, not in it",
        '?' => "a choice is written `c ? a : b` or `{c: a, b}`",
        '%' => "the remainder is written `mod(a, b)`",
        '~' => "write `not`, or `=`",
        '_' => "a subscript is a part of a name, `x_1`; a norm is `length((x, y, z))`",
        '°' => "write `30*pi/180` for 30 degrees",
        '±' => "write two formulas, one a line, or square both sides",
        '\\' => "a quotient is written `x/y`; a LaTeX command has a name, such as `\\sin`",
        '.' => "a product is written `*`, a method as a function: `dot(a, b)`",
        _ => return None,
    })
}

/// The sentence "there are …" with a list of names.
fn there_are(names: &[&str]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    match quoted.split_last() {
        Some((last, rest)) => format!("there are {} and {last}", rest.join(", ")),
        None => String::new(),
    }
}
