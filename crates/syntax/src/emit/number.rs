//! Names constants in messages.

use zeroset_ir::Constant;

/// The name of a constant for messages.
pub(super) fn described(constant: &Constant) -> String {
    match constant {
        Constant::Exact(value) => format!("the number {value}, which is no decimal"),
        Constant::Named(name) => format!("the number {}", name.name()),
        Constant::Enclosed(_) => "a number that is known by its bounds only".to_owned(),
    }
}
