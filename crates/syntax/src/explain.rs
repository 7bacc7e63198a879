//! Why something is an error and what to do about it, in words.

use crate::error::{Error, ErrorKind, Suggestion};

/// Longest piece of corrected text that is quoted.
const QUOTED: usize = 60;

impl Error {
    /// A few words to stand at the caret.
    pub fn label(&self) -> Option<String> {
        let label = match &self.kind {
            ErrorKind::Unclosed { .. } => "opened here",
            ErrorKind::UnclosedBar => "this bar",
            ErrorKind::MissingAfter { .. } => "nothing follows that it could apply to",
            ErrorKind::MissingBefore { .. } => "nothing precedes that it could apply to",
            ErrorKind::TooDeep { .. } => "the level too many starts here",
            ErrorKind::UnknownName { .. } => "no value has this name",
            ErrorKind::UnknownFunction { .. } => "no function has this name",
            ErrorKind::SeveralEquals => "the second one",
            ErrorKind::ConditionAsValue => "this is true or false, not a number",
            ErrorKind::ValueAsCondition { .. } => "this is a number",
            _ => return None,
        };
        Some(label.to_owned())
    }

    /// Why this is an error.
    pub fn reason(&self) -> Option<String> {
        let reason = match &self.kind {
            ErrorKind::TooLong { .. }
            | ErrorKind::TooManySymbols { .. }
            | ErrorKind::TooDeep { .. } => {
                "the limit keeps reading quick and safe whatever is given"
            }
            ErrorKind::TooManySurfaces { .. } => {
                "each line that is not a definition draws a surface"
            }
            ErrorKind::TooLarge { .. } => "each use of a definition puts a copy of it in",
            ErrorKind::NotUtf8 { .. } => "formulas are text files in UTF-8",
            ErrorKind::NothingToDraw { .. } => {
                "a line `name = …` defines; only other lines, or a function of (x, y, z) or (x, y), draw"
            }
            ErrorKind::UnexpectedCharacter { character } => return character_reason(*character),
            ErrorKind::NestedBars | ErrorKind::AmbiguousBars => {
                "an opening bar looks like a closing one, so another reading is possible"
            }
            ErrorKind::NumberAfterFactor | ErrorKind::LostSuperscript { .. } => {
                "numbers stand in front of what they multiply; behind it they are often superscripts that were \
                 lost in copying"
            }
            ErrorKind::NumberAfterNumber => "between two numbers a product is always written out",
            ErrorKind::Tuple | ErrorKind::Vector => {
                "a surface is one equation in x, y and z; parametric forms and vectors are not read"
            }
            ErrorKind::Comma => "commas separate the arguments of a function, inside its brackets",
            ErrorKind::NeedsArgument { count: 1, .. } if self.suggestion.is_some() => {
                "an argument without brackets cannot start with a sign"
            }
            ErrorKind::Complex => "all values are real; `i` has no value here",
            ErrorKind::NotAFunction { .. } => {
                "after a value, brackets multiply, and a product has no commas"
            }
            ErrorKind::InversePower { .. } => {
                "only sin, cos, tan, sinh, cosh and tanh are read as inverses this way"
            }
            ErrorKind::Reserved { is_function: true, .. } => "it is a function of the language",
            ErrorKind::Reserved { .. } => "it is a word of the language",
            ErrorKind::Recursion { .. } => {
                "a definition is put in where it is used, and this would never end"
            }
            ErrorKind::EquationInCondition => {
                "an equation describes a surface; `and`, `or` and `not` combine solids, which have an inside"
            }
            ErrorKind::SeveralEquals | ErrorKind::MixedChain => {
                "an equation sets two sides equal; only inequalities form chains"
            }
            ErrorKind::UnequalOutsideBraces => {
                "everything but a surface is no solid with a boundary"
            }
            ErrorKind::RestrictionIsEquation => {
                "where two surfaces meet is a curve, and a curve has no picture here"
            }
            ErrorKind::MixedRestriction => {
                "the edge would belong to the region in one part and not in the other"
            }
            ErrorKind::DefinitionIsCondition => "definitions are put in where numbers stand",
            ErrorKind::RestrictedDefinition => "braces belong behind a formula that is drawn",
            ErrorKind::NotConstant { .. } => {
                "sliders, ranges and settings need a value that is known beforehand"
            }
            ErrorKind::UndefinedConstant => "it is undefined or too large, as 1/0 or 9^9^9^9 are",
            ErrorKind::OverrideCoordinate { .. } => "x, y and z are where the picture is",
            ErrorKind::ConditionAsValue => {
                "comparisons combine with `and`, `or` and `not`, not with arithmetic"
            }
            _ => return None,
        };
        Some(reason.to_owned())
    }

    /// What to write instead. `text` is the text that the error's spans are places of.
    #[allow(clippy::too_many_lines)] // one arm for each kind of error
    pub fn help(&self, text: &str) -> Option<String> {
        let meant = self.suggestion.as_ref();
        let help = match &self.kind {
            ErrorKind::UnknownName { name, .. }
                if matches!(name.as_str(), "for" | "if" | "where" | "when") =>
            {
                "to restrict a formula, write the condition in braces: `x + y = z {z > 0}`"
                    .to_owned()
            }
            ErrorKind::UnknownName { name, letter } => match (meant, letter) {
                (Some(meant), _) => format!("did you mean `{}`?", meant.replacement),
                (None, Some(letter)) => {
                    let product: Vec<String> = name.chars().map(String::from).collect();
                    format!(
                        "to read it as `{}`, give `{letter}` a value with a line `{letter} = 1` or with `-D {letter}=1`",
                        product.join("*")
                    )
                }
                (None, None) => {
                    format!("give it a value with a line `{name} = 1` or with `-D {name}=1`")
                }
            },
            ErrorKind::UnknownFunction { name } => match meant {
                Some(meant) => format!("did you mean `{}`?", meant.replacement),
                None => format!(
                    "define it with a line `{name}(a) = …`, or give `{name}` a value to multiply with"
                ),
            },
            ErrorKind::UnknownOverride { .. } | ErrorKind::BadColor if meant.is_some() => {
                format!("did you mean `{}`?", meant?.replacement)
            }
            ErrorKind::Empty => "write an equation such as `x^2 + y^2 + z^2 = 1`".to_owned(),
            ErrorKind::NothingToDraw { last, parameters: Some(count), .. } => {
                let arguments =
                    ["x", "y", "z"].iter().cycle().take(*count).copied().collect::<Vec<_>>();
                format!(
                    "`{last}` is no function of the language, so this line defines it; to draw where it is 0, add a line \
                     that is just `{last}({})`",
                    arguments.join(", ")
                )
            }
            ErrorKind::NothingToDraw { last, is_number: true, .. } => {
                format!("add a line that uses `{last}`, such as `x^2 + y^2 + z^2 = {last}^2`")
            }
            ErrorKind::NothingToDraw { last, is_number: false, .. } => {
                format!("to draw where `{last}` is 0, add a line that is just `{last}`")
            }
            ErrorKind::UnexpectedCharacter { character } => {
                return character_help(*character, meant);
            }
            ErrorKind::Unopened { .. } => "remove it, or open a bracket before it".to_owned(),
            ErrorKind::NestedBars | ErrorKind::AmbiguousBars | ErrorKind::UnclosedBar => {
                "write `abs(…)` in place of bars".to_owned()
            }
            ErrorKind::EmptyBars => "an absolute value is written `|x|`, a choice `or`".to_owned(),
            ErrorKind::Comma if meant.is_none() => {
                "draw several surfaces with one line each".to_owned()
            }
            ErrorKind::Tuple => {
                "write one equation in x, y and z; a product is written with `*`".to_owned()
            }
            ErrorKind::Vector => {
                "write an equation in x, y and z, such as `x^2 + y^2 = z`".to_owned()
            }
            ErrorKind::Complex => "rewrite the formula with real and imaginary parts".to_owned(),
            ErrorKind::NeedsArgument { name, count: 1 } if meant.is_none() => {
                format!("write `{name}(…)`")
            }
            ErrorKind::NeedsArgument { name, .. } if meant.is_none() => {
                format!("write `{name}(…, …)`: without brackets a function takes one argument only")
            }
            ErrorKind::WrongCount { usage, .. } => usage.clone()?,
            ErrorKind::InversePower { name } => format!("write `1/{name}(…)` for the reciprocal"),
            ErrorKind::Reserved { .. } => "choose another name".to_owned(),
            ErrorKind::TooManySurfaces { .. } => "draw some of them at a time".to_owned(),
            ErrorKind::ZerothRoot => {
                "the second argument of `root(a, n)` says which root to take".to_owned()
            }
            ErrorKind::ConditionAsValue => {
                "compare outside of the arithmetic, as in `x + 1 < y`".to_owned()
            }
            ErrorKind::ValueAsCondition { .. } => {
                "compare it with something, as in `x^2 + y^2 < 1`".to_owned()
            }
            ErrorKind::EquationInCondition => {
                "use `<=` or `>=`, or restrict the equation: `x + y = z {z > 0}`".to_owned()
            }
            ErrorKind::SeveralEquals => "draw two equations with one line each".to_owned(),
            ErrorKind::MixedChain => "restrict the equation: `x + y = z {z < 1}`".to_owned(),
            ErrorKind::UnequalOutsideBraces => {
                "exclude points from an equation: `x*y = 1 {x != 0}`".to_owned()
            }
            ErrorKind::RestrictionNotCondition => {
                "compare it with something, as in `{z > 0}`".to_owned()
            }
            ErrorKind::RestrictionIsEquation => {
                "use `<`, `<=`, `>`, `>=` or `!=` in braces".to_owned()
            }
            ErrorKind::MixedRestriction => {
                "use `<` and `>` throughout, or `<=` and `>=` throughout".to_owned()
            }
            ErrorKind::DefinitionIsCondition => {
                "define left minus right, `d = x^2 - 1`, and draw `d <= 0`".to_owned()
            }
            ErrorKind::RangeOutsideDefinition => {
                "to limit a coordinate, write a line such as `domain x in [-2, 2]`".to_owned()
            }
            ErrorKind::HalfFraction => "write `\\frac{a}{b}`".to_owned(),
            ErrorKind::BadRange => "write `r = 2 in [0, 5]`".to_owned(),
            ErrorKind::EmptyRange => "write the smaller number first".to_owned(),
            ErrorKind::OutsideRange => "choose a value between the ends".to_owned(),
            kind => match (setting_help(kind), meant) {
                (Some(help), _) => help,
                (None, Some(meant)) => match text.get(meant.span.range()) {
                    // A sign alone says little without the one it replaces.
                    Some(typed)
                        if !typed.is_empty()
                            && meant.span == self.span
                            && typed.chars().count() <= 3 =>
                    {
                        format!("write `{}` in place of `{typed}`", meant.replacement)
                    }
                    _ => format!("write `{}`", self.corrected(text, meant)),
                },
                (None, None) => return None,
            },
        };
        Some(help)
    }

    /// The text that the error points at, with the suggestion put in.
    fn corrected(&self, text: &str, meant: &Suggestion) -> String {
        let whole = self.span.to(meant.span);
        let (Some(before), Some(after)) =
            (text.get(whole.start..meant.span.start), text.get(meant.span.end..whole.end))
        else {
            return meant.replacement.clone();
        };
        let corrected = format!("{before}{}{after}", meant.replacement);
        if corrected.is_empty() || corrected.chars().count() > QUOTED || corrected.contains('\n') {
            return meant.replacement.clone();
        }
        corrected
    }
}

/// What to write instead in an override or in a `domain`, `view` or `color` line.
fn setting_help(kind: &ErrorKind) -> Option<String> {
    let help = match kind {
            ErrorKind::OverrideNotAName { .. } => "write `-D name=value`, such as `-D r=2`".to_owned(),
            ErrorKind::OverrideCoordinate { .. } => "to cut a picture, use a domain".to_owned(),
            ErrorKind::UnknownOverride { .. } => "use the name in the formula, or leave the setting out".to_owned(),
            ErrorKind::OverrideFunction { .. } => "change its line in the text instead".to_owned(),
            ErrorKind::BadDomain => "write `domain 3`, `domain auto`, `domain [-2, 2]`, \
                `domain x in [-2, 2], y in [-1, 1]` or six numbers"
                .to_owned(),
            ErrorKind::BadView => {
                "write `view front` (iso, back, left, right, top, bottom) or `view eye (2, -3, 1.5) target (0, 0, 0)`"
                    .to_owned()
            }
            ErrorKind::BadVector { key } => format!("write `{key} (1, 2, 3)`"),
            ErrorKind::BadColor => "write a name such as `orange`, or `#ff8800`".to_owned(),
            _ => return None,
    };
    Some(help)
}

fn character_reason(character: char) -> Option<String> {
    let reason = match character {
        '!' => "there is no factorial",
        '\'' | '′' | '’' | '∂' | '∫' | '∑' | '∏' => {
            "there are no derivatives, integrals or series"
        }
        '$' => "formulas stand without dollar signs",
        '∞' => "all values are finite",
        '±' => "a formula has one value at each point",
        '°' => "angles are in radians",
        '_' => "names start with a letter",
        '"' | '`' | '“' | '”' => "there is no quoted text",
        _ => return None,
    };
    Some(reason.to_owned())
}

fn character_help(character: char, meant: Option<&Suggestion>) -> Option<String> {
    let help = match character {
        '%' => "the remainder is written `mod(a, b)`",
        '&' => "write `and`",
        '~' => "write `not`, or `=`",
        '°' => "write `30*pi/180` for 30 degrees",
        '±' => "write two formulas, one a line, or square both sides",
        '≈' => "write `=`",
        '\\' => "a LaTeX command has a name, such as `\\sin`",
        '.' => "a product is written `*`",
        '$' => "leave the dollar signs out",
        _ => return meant.map(|meant| format!("write `{}`", meant.replacement)),
    };
    Some(help.to_owned())
}
