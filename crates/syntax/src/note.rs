//! Remarks on how a text was read, where a reader might have meant something else.

use crate::span::Span;

/// Remarks on a document, at most.
pub(crate) const MOST_NOTES: usize = 40;

/// A remark, and the place it is about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// The place to point at.
    pub span: Span,
    /// What is remarked.
    pub kind: NoteKind,
}

/// What is remarked.
#[derive(Clone, Debug, PartialEq, Eq, Hash, thiserror::Error)]
#[allow(missing_docs)] // each message says what its variant means
pub enum NoteKind {
    #[error("read as `{read}`; the other reading is written `{other}`")]
    ImplicitDivision { read: String, other: String },
    #[error("read as `{read}`; the root is written `{root}`")]
    DividedPower { read: String, root: String },
    #[error(
        "`{name}^-1` is read as the inverse function `{inverse}`; the reciprocal is written `1/{name}(…)`"
    )]
    InverseFunction { name: String, inverse: String },
    #[error("`{name}` is read as the product `{product}`")]
    ProductOfNames { name: String, product: String },
    #[error("`{name}` is {meaning}")]
    ConstantUsed { name: &'static str, meaning: &'static str },
    #[error(
        "a power with the exponent {exponent} is for values >= 0; `{other}` takes negative ones as well"
    )]
    OddRoot { exponent: String, other: String },
    #[error("`{radical}` covers only the factor after it; brackets make it cover more")]
    RadicalScope { radical: char },
    #[error("`{name}` is defined again further down; that definition counts everywhere")]
    Redefined { name: String },
    #[error("`{name}` is defined and never used{}", did_you_mean(.meant.as_deref()))]
    Unused { name: String, meant: Option<String> },
    #[error("`{name}` is set to a value outside its range")]
    OutsideRange { name: String },
    #[error("only definitions here: drawing `{drawn}`")]
    DrawsFunction { drawn: String },
    #[error("`{name}` is built in, so this is drawn as an equation and defines nothing")]
    BuiltInOnTheLeft { name: String },
    #[error(
        "`root(a, n)` is the n-th root of a; here n is `{index}`, which is not a fixed whole number"
    )]
    RootIndex { index: String },
    #[error(
        "the exponent `{exponent}` may be a whole number but is not known to be one: the power is for values >= 0; \
         written in digits it takes negative ones as well"
    )]
    NearInteger { exponent: String },
    #[error("there is more to remark from here on, which is left out")]
    More,
}

fn did_you_mean(meant: Option<&str>) -> String {
    meant.map_or_else(String::new, |meant| format!("; did you mean `{meant}`?"))
}

impl Note {
    /// One line that says what is remarked.
    pub fn message(&self) -> String {
        self.kind.to_string()
    }
}
