//! Functions that are formulas over other functions, written in the language itself.

/// A function given by a formula. Several may share a name and differ in the number of parameters.
#[derive(Debug)]
pub struct Composed {
    /// The name it is called by.
    pub name: &'static str,
    /// Other accepted names.
    pub aliases: &'static [&'static str],
    /// Parameter names, as used in `body`.
    pub parameters: &'static [&'static str],
    /// The formula. Names in it mean the built-in functions and constants, whatever the user
    /// redefines; internal operations of the table may be called here.
    pub body: &'static str,
    /// One line for help.
    pub doc: &'static str,
}

const fn row(
    name: &'static str,
    aliases: &'static [&'static str],
    parameters: &'static [&'static str],
    body: &'static str,
    doc: &'static str,
) -> Composed {
    Composed { name, aliases, parameters, body, doc }
}

/// Every composed function.
#[rustfmt::skip] // one row a line
pub static COMPOSED: &[Composed] = &[
    row("recip", &[], &["a"], "1/a", "reciprocal; undefined at 0"),
    row("clamp", &[], &["a", "low", "high"], "min(max(a, low), high)", "a, no smaller than low and no larger than high"),
    row("hypot", &["length"], &["a"], "abs(a)", "distance from the origin"),
    row("hypot", &["length"], &["a", "b"], "sqrt(a^2+b^2)", "distance from the origin"),
    row("hypot", &["length"], &["a", "b", "c"], "sqrt(a^2+b^2+c^2)", "distance from the origin"),
    row("step", &[], &["edge", "a"], "select_negative(a-edge, 0, 1)", "0 where a < edge, else 1"),
    row("smoothstep", &[], &["low", "high", "a"], "clamp((a-low)/(high-low), 0, 1)^2*(3-2*clamp((a-low)/(high-low), 0, 1))", "0 below low, 1 above high, a smooth cubic between"),
    row("mix", &[], &["a", "b", "k"], "a*(1-k)+b*k", "from a at k = 0 to b at k = 1, linearly"),
    row("subtract", &["difference"], &["a", "b"], "max(a, -b)", "solid a without solid b"),
    row("blend", &["smooth_union"], &["a", "b", "k"], "min(a, b)-max(k-abs(a-b), 0)^2/(4*k)", "union of solids a and b, rounded over a width k"),
];
