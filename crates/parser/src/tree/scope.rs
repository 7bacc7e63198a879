//! Meanings of names. A name is looked up first among the parameters of the current function, then
//! among the document's names, then among the language's names.

use crate::tree::ast::{Function, Name, NamedValue};
use crate::tree::foreign_functions::foreign_function;
use crate::tree::special_forms::logic;
use rustc_hash::{FxHashMap, FxHashSet};
use zeroset_ir::{Axis, NamedConstant};
use zeroset_ops::{COMPOSED, Notation, Op, SpecialForm, TABLE, builders, form, names, natives};

/// The names that a statement can see.
#[derive(Clone, Debug, Default)]
pub struct Scope {
    /// Names that the document or an override defines, each with its number of parameters. A value
    /// has `None` in place of the number.
    defined: FxHashMap<String, Option<usize>>,
    /// Defined names that are not in the text, such as the names of steps of programs. They are
    /// never suggested.
    unwritten: FxHashSet<String>,
    /// Coordinates that the text uses without defining them. They have a standard definition.
    implied: Vec<&'static str>,
    /// Names that the document defines as vectors, as far as the form of a definition shows.
    pub(crate) vectors: FxHashSet<String>,
    /// True if internal operations may be called, which only the language's own prelude may do.
    internal: bool,
    /// True if the trigonometry of the text is in degrees, as in `OpenSCAD`.
    pub in_degrees: bool,
    /// True if the text is a program, whose statements are run in order.
    pub in_steps: bool,
    /// Rules for conditions that are used as numbers.
    pub conditions: Conditions,
}

/// Rules for conditions that are used as numbers, by the language of a text.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Conditions {
    /// A condition is no number.
    #[default]
    Apart,
    /// A condition in a sum or a product is 1 where it holds, else 0.
    Numbers,
    /// As `Numbers`. Also, a number is a condition that holds where it is 1/2 or more, and a
    /// remainder has the sign of the dividend.
    OfMathMod,
}

/// Largest size of a name that is tried as a product of letters, in bytes.
const MAX_PRODUCT_NAME: usize = 64;

/// Names of other languages, each with its equivalent here. Products of letters take precedence.
const FOREIGN_NAMES: &[(&str, &str)] = &[
    ("tg", "tan"),
    ("ctg", "cot"),
    ("cotg", "cot"),
    ("sh", "sinh"),
    ("ch", "cosh"),
    ("th", "tanh"),
    ("cth", "coth"),
    ("arctg", "atan"),
    ("arcctg", "acot"),
    ("arsh", "asinh"),
    ("arch", "acosh"),
    ("arth", "atanh"),
    ("lg", "log10"),
    ("M_PI", "pi"),
    ("M_E", "e"),
    ("golden_ratio", "phi"),
    ("cabs", "abs"),
    ("max_symbolic", "max"),
    ("min_symbolic", "min"),
];

/// The meaning of `name` in this language alone. Names from other languages have no meaning.
pub fn built_in(name: &str) -> NameMeaning {
    if FOREIGN_NAMES.iter().any(|(elsewhere, _)| *elsewhere == name) {
        return NameMeaning::Unknown;
    }
    Scope::default().meaning(name, &[])
}

/// Returns whether this language reads calls of `name`.
pub fn is_function(name: &str) -> bool {
    built_in(name) != NameMeaning::Unknown
        || logic(name).is_some()
        || form(name).is_some()
        || foreign_function(name, false).is_some()
        || FOREIGN_NAMES.iter().any(|(elsewhere, _)| *elsewhere == name)
}

/// The name in this language of a function called by a foreign name. Constants are left out.
pub(crate) fn read_as(name: &str, callee: &Callee) -> Option<&'static str> {
    let found =
        FOREIGN_NAMES.iter().find(|(elsewhere, _)| *elsewhere == name).map(|(_, here)| *here);
    found.filter(|here| callee.name() == *here)
}

/// The meaning of a name in a scope.
#[derive(Clone, Debug, PartialEq)]
pub enum NameMeaning {
    /// A number.
    Value(NamedValue),
    /// A function.
    Function(Callee),
    /// A product of values whose names are single letters.
    Product,
    /// A name without a meaning.
    Unknown,
}

/// A function in a call, before the number of arguments is known.
#[derive(Clone, Debug, PartialEq)]
pub enum Callee {
    /// A function that the document defines, with its number of parameters.
    Defined(String, usize),
    /// A function of the language, by the name under which it was found.
    BuiltIn(String),
    /// The logarithm to a base that is part of the name, as in `log_2`.
    Logarithm(String),
    /// A function of a sequence, and its number, which is part of the name, as in `T_4`.
    Numbered(&'static str, String),
    /// The derivative of a function of one argument, this many times.
    Derived(Box<Callee>, u8),
}

impl Callee {
    /// The name for messages.
    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Defined(name, _) | Self::BuiltIn(name) => name,
            Self::Logarithm(_) => "log",
            Self::Numbered(name, _) => name,
            Self::Derived(function, _) => function.name(),
        }
    }
}

impl Scope {
    /// The scope of the language's own prelude.
    pub fn prelude() -> Self {
        Self { internal: true, ..Self::default() }
    }

    /// Defines `name` as a function with this number of parameters or, for `None`, as a value. A
    /// later definition replaces an earlier one.
    pub fn define(&mut self, name: &str, parameters: Option<usize>) {
        self.defined.insert(name.to_owned(), parameters);
    }

    /// Limits suggestions of defined names to names that occur in `text` or in `others`.
    pub fn suggest_only(&mut self, text: &str, others: &[(String, String)]) {
        let words = text.split(|c: char| !(c.is_alphanumeric() || c == '_'));
        let written: FxHashSet<&str> =
            words.chain(others.iter().map(|(name, _)| name.as_str())).collect();
        let names = self.defined.keys().filter(|name| !written.contains(name.as_str()));
        self.unwritten = names.cloned().collect();
    }

    /// The meaning of `name`. `locals` are the function's parameters and the indices of sums.
    pub fn meaning(&self, name: &str, locals: &[Name]) -> NameMeaning {
        if let Some(value) = self.value(name, locals) {
            return NameMeaning::Value(value);
        }
        if let Some(Some(count)) = self.defined.get(name) {
            return NameMeaning::Function(Callee::Defined(name.to_owned(), *count));
        }
        if !signatures(name, self.internal).is_empty() {
            return NameMeaning::Function(Callee::BuiltIn(name.to_owned()));
        }
        if let Some(base) = name.strip_prefix("log_")
            && base.parse::<u32>().is_ok_and(|base| base >= 2)
        {
            return NameMeaning::Function(Callee::Logarithm(base.to_owned()));
        }
        let mut buffer = [0; 4];
        if name.len() <= MAX_PRODUCT_NAME
            && name.chars().all(|c| self.value(c.encode_utf8(&mut buffer), locals).is_some())
        {
            return NameMeaning::Product;
        }
        if let Some((_, here)) = FOREIGN_NAMES.iter().find(|(elsewhere, _)| *elsewhere == name) {
            return self.meaning(here, locals);
        }
        let lower = name.to_lowercase();
        if lower != name && lower.len() > 1 {
            if let Some(constant) = named_constant(&lower) {
                return NameMeaning::Value(NamedValue::Constant(constant));
            }
            if !signatures(&lower, false).is_empty() {
                return NameMeaning::Function(Callee::BuiltIn(lower));
            }
        }
        // C has variants of functions for the type `float`, such as `sqrtf`.
        if let Some(double) = name.strip_suffix('f').filter(|double| double.len() > 2)
            && !signatures(double, false).is_empty()
        {
            return NameMeaning::Function(Callee::BuiltIn(double.to_owned()));
        }
        NameMeaning::Unknown
    }

    /// The value that a name stands for. `None` if it stands for none.
    fn value(&self, name: &str, locals: &[Name]) -> Option<NamedValue> {
        if locals.iter().any(|local| local.text == name) {
            return Some(NamedValue::Local(name.to_owned()));
        }
        if let Some(axis) = coordinate(name) {
            return Some(NamedValue::Coordinate(axis));
        }
        match (name, self.defined.get(name)) {
            ("t", _) => Some(NamedValue::Time),
            (_, Some(None)) => Some(NamedValue::Defined(name.to_owned())),
            (_, Some(Some(_))) => None,
            (_, None) => match canonical(name).filter(|name| self.implied.contains(name)) {
                Some(name) => Some(NamedValue::Defined(name.to_owned())),
                None if matches!(name, "i" | "I" | "ⅈ" | "ί") => Some(NamedValue::ImaginaryUnit),
                None => named_constant(name).map(NamedValue::Constant),
            },
        }
    }

    /// Adds a name that the text uses without defining it.
    pub fn imply(&mut self, name: &'static str) {
        if canonical(name).is_some() {
            self.implied.push(name);
        } else {
            if name.starts_with("vec_") || name.starts_with("hat_") {
                self.vectors.insert(name.to_owned());
            }
            self.define(name, None);
        }
    }

    /// Returns whether the document or an override defines `name`.
    pub fn is_defined(&self, name: &str) -> bool {
        self.defined.contains_key(name)
    }

    /// The special form called `name`; `None` if a definition or a parameter hides it.
    pub(crate) fn form(&self, name: &str, locals: &[Name]) -> Option<&'static SpecialForm> {
        if self.is_defined(name) || locals.iter().any(|local| local.text == name) {
            return None;
        }
        form(name).or_else(|| form(&name.to_lowercase()))
    }

    /// The calls that `callee` allows.
    pub fn signatures(&self, callee: &Callee) -> Signatures {
        match callee {
            Callee::Defined(name, count) => {
                let function = Function::Defined(name.clone());
                Signatures(vec![Signature { function, count: *count, or_more: false }])
            }
            Callee::BuiltIn(name) => signatures(name, self.internal),
            Callee::Logarithm(_) => signatures("ln", false),
            // The number is not among the arguments.
            Callee::Numbered(name, _) => {
                let mut forms = signatures(name, false).0;
                forms.retain(|form| form.count == 2);
                for form in &mut forms {
                    form.count = 1;
                }
                Signatures(forms)
            }
            Callee::Derived(function, order) => {
                let mut forms = self.signatures(function).0;
                forms.retain(|form| form.count == 1);
                for form in &mut forms {
                    form.function = Function::Derived(Box::new(form.function.clone()), *order);
                }
                Signatures(forms)
            }
        }
    }

    /// The known name closest to `name`, if close enough. `functions` leaves out names of values.
    pub fn nearest(&self, name: &str, locals: &[Name], functions: bool) -> Option<String> {
        let own = self.defined.iter();
        let mut candidates: Vec<&str> = own
            .filter(|(name, parameters)| {
                (!functions || parameters.is_some()) && !self.unwritten.contains(*name)
            })
            .map(|(name, _)| name.as_str())
            .collect();
        let shorter = |name: &'static str| -> &str { name };
        candidates.extend(names().map(shorter));
        candidates.extend(ROOT_NAMES.iter().copied().map(shorter));
        if !functions {
            candidates.extend(["x", "y", "z", "t"]);
            candidates.extend(locals.iter().map(|local| local.text.as_str()));
            candidates.extend(NamedConstant::ALL.iter().map(|constant| shorter(constant.name())));
        }
        nearest(name, candidates.into_iter())
    }
}

/// The axis whose coordinate is called `name`.
pub fn coordinate(name: &str) -> Option<Axis> {
    Axis::ALL.into_iter().find(|axis| axis.name() == name)
}

/// The candidate closest to `name`, if few edits lead from one to the other. Ties go to the closest
/// length, so a swap of two letters wins over a lost letter. Further ties go to alphabetical order.
pub fn nearest<'a>(name: &str, candidates: impl Iterator<Item = &'a str>) -> Option<String> {
    // Comparing takes time in proportion to both lengths, so a very long `name` is not compared.
    const LONGEST: usize = 24;
    if name.len() > LONGEST {
        return None;
    }
    let lower = name.to_lowercase();
    let allowed = match lower.chars().count() {
        0 => return None,
        1..=2 => 0,
        3..=5 => 1,
        6..=8 => 2,
        _ => 3,
    };
    candidates
        .filter(|candidate| *candidate != name)
        .map(|candidate| {
            let edits = strsim::damerau_levenshtein(&lower, &candidate.to_lowercase());
            let length = candidate.chars().count().abs_diff(lower.chars().count());
            (edits, length, candidate)
        })
        .filter(|(edits, _, candidate)| {
            *edits <= allowed && *edits < candidate.chars().count().max(1)
        })
        .min()
        .map(|(_, _, candidate)| candidate.to_owned())
}

/// A function and its number of arguments, which is the least number if `or_more` is true.
struct Signature {
    function: Function,
    count: usize,
    or_more: bool,
}

/// The signatures of a function, by ascending number of arguments.
pub struct Signatures(Vec<Signature>);

impl Signatures {
    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The function for `count` arguments, if there is one.
    pub fn function(&self, count: usize) -> Option<Function> {
        let exact = self.0.iter().find(|form| form.count == count);
        let form = exact.or_else(|| self.0.iter().find(|form| form.or_more && form.count < count));
        form.map(|form| form.function.clone())
    }

    /// The smallest number of arguments of any signature.
    pub(crate) fn least(&self) -> usize {
        self.0.first().map_or(0, |form| form.count)
    }
}

impl std::fmt::Display for Signatures {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.0.iter().any(|form| form.or_more) {
            return write!(f, "{} or more arguments", self.least());
        }
        let counts: Vec<String> = self.0.iter().map(|form| form.count.to_string()).collect();
        let plural = if counts == ["1"] { "" } else { "s" };
        write!(f, "{} argument{plural}", counts.join(" or "))
    }
}

/// Names of the n-th root. A root is neither native nor composed, because its expansion depends on
/// whether n is odd.
pub const ROOT_NAMES: &[&str] = &["root", "nroot", "nthroot", "surd"];

/// Upper limit on the number of arguments of a builder, if each vector is written as three numbers.
const MOST_ARGUMENTS: usize = 12;

/// Returns whether an operation of two operands also combines more operands, from left to right.
pub(crate) fn is_variadic(op: Op) -> bool {
    matches!(op, Op::Min | Op::Max)
}

/// Letters that name sequences of functions, as in `T_4(x)`.
const SEQUENCES: &[(&str, &str)] = &[
    ("T", "chebyshev_t"),
    ("U", "chebyshev_u"),
    ("P", "legendre"),
    ("H", "hermite"),
    ("L", "laguerre"),
    ("J", "besselj"),
];

/// The function that a name such as `T_4` stands for, if a text does not define it.
pub(crate) fn numbered(name: &str) -> Option<Callee> {
    let (letter, number) = name.split_once('_')?;
    let is_number = !number.is_empty() && number.bytes().all(|digit| digit.is_ascii_digit());
    let (_, function) = SEQUENCES.iter().find(|(known, _)| *known == letter && is_number)?;
    Some(Callee::Numbered(function, number.to_owned()))
}

/// Returns whether a builder has this name.
pub(crate) fn is_builder(name: &str) -> bool {
    builders(name).next().is_some()
}

/// The signatures of the language's function called `name`; empty if there is no such function.
/// `internal` allows internal operations.
pub fn signatures(name: &str, internal: bool) -> Signatures {
    let form = |function, count| Signature { function, count, or_more: false };
    let own = TABLE
        .iter()
        .filter(|row| internal && row.notation == Notation::Internal && row.name == name);
    let native = natives(name).chain(own).map(|row| Signature {
        or_more: is_variadic(row.op),
        ..form(Function::Native(row.op), row.op.arity())
    });
    let composed = COMPOSED.iter().enumerate();
    let composed = composed.filter(|(_, f)| f.name == name || f.aliases.contains(&name));
    let mut forms: Vec<Signature> = native.collect();
    for (index, composed) in composed {
        forms.push(form(Function::Composed(index), composed.parameters.len()));
        if composed.name == "hypot" {
            forms.push(Signature { function: Function::Length, count: 4, or_more: true });
        }
    }
    if ROOT_NAMES.contains(&name) {
        forms.push(form(Function::Root, 2));
    }
    if let Some(row) = builders(name).next() {
        let counts = (1..=MOST_ARGUMENTS).filter(|count| builders(name).any(|b| b.takes(*count)));
        forms.extend(counts.map(|count| form(Function::Builder(row.name), count)));
    }
    forms.sort_by_key(|form| form.count);
    Signatures(forms)
}

/// The canonical spelling of the coordinate called `name`: r, rho, theta or phi.
pub fn canonical(name: &str) -> Option<&'static str> {
    match name {
        "r" => Some("r"),
        "rho" | "ρ" | "varrho" => Some("rho"),
        "theta" | "θ" | "ϑ" | "vartheta" => Some("theta"),
        "phi" | "φ" | "ϕ" | "varphi" => Some("phi"),
        _ => None,
    }
}

/// The meaning of a constant, if a reader of the document may not know it.
pub fn meaning(constant: NamedConstant) -> Option<&'static str> {
    match constant {
        NamedConstant::Pi | NamedConstant::E => None,
        NamedConstant::Tau => Some("2*pi = 6.2831853…"),
        NamedConstant::Phi => Some("the golden ratio, (1 + sqrt(5))/2 = 1.6180339…"),
    }
}

/// The language's constant that is called `name`.
fn named_constant(name: &str) -> Option<NamedConstant> {
    match name {
        "pi" | "π" => Some(NamedConstant::Pi),
        "tau" | "τ" => Some(NamedConstant::Tau),
        "e" => Some(NamedConstant::E),
        "phi" | "φ" | "ϕ" | "varphi" => Some(NamedConstant::Phi),
        _ => None,
    }
}
