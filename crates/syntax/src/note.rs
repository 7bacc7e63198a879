//! Notes on how a text was read, where its writer might have meant something else.

use crate::span::Span;

/// The most notes on a document.
pub(crate) const MOST_NOTES: usize = 40;

/// A note, and the place it is about.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// The place to point at.
    pub span: Span,
    /// What it says.
    pub kind: NoteKind,
}

/// What a note says.
#[derive(Clone, Debug, PartialEq, Eq, Hash, thiserror::Error)]
#[allow(missing_docs)] // each message says what its variant means
pub enum NoteKind {
    #[error("read as `{read}`; for the other reading, write `{other}`")]
    ImplicitDivision { read: String, other: String },
    #[error("read as `{read}`; for the root, write `{root}`")]
    DividedPower { read: String, root: String },
    #[error(
        "`{name}^-1` is read as the inverse function `{inverse}`; \
         for the reciprocal, write `1/{name}(…)`"
    )]
    InverseFunction { name: String, inverse: String },
    #[error("`{name}` is read as the product `{product}`")]
    ProductOfNames { name: String, product: String },
    #[error("`{name}` is {meaning}")]
    ConstantUsed { name: &'static str, meaning: &'static str },
    #[error(
        "a power with exponent {exponent} is defined only for values >= 0; \
         `{other}` accepts negative values too"
    )]
    OddRoot { exponent: String, other: String },
    #[error("`{radical}` applies only to the factor after it; use brackets to cover more")]
    RadicalScope { radical: char },
    #[error("`{name}` is defined again below; the last definition applies everywhere")]
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
        "the exponent `{exponent}` may be a whole number but is not known to be one, \
         so the power is defined only for values >= 0; write it in digits to allow negative values"
    )]
    NearInteger { exponent: String },
    #[error("further notes omitted")]
    More,
}

fn did_you_mean(meant: Option<&str>) -> String {
    meant.map_or_else(String::new, |meant| format!("; did you mean `{meant}`?"))
}

impl Note {
    /// What it says, in one line.
    pub fn message(&self) -> String {
        self.kind.to_string()
    }
}
