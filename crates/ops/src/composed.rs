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
    /// The formula. Names in it mean the built-in functions and constants, whatever the user redefines; internal
    /// operations of the table may be called here.
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
    // The half-angle form keeps the denominator at or above 1, so the ends of [-1, 1] stay in the domain.
    row("asin", &["arcsin"], &["a"], "2*atan(a/(1+sqrt(1-a^2)))", "angle in [-pi/2, pi/2] whose sine is a; defined for |a| <= 1"),
    row("acos", &["arccos"], &["a"], "pi/2-2*atan(a/(1+sqrt(1-a^2)))", "angle in [0, pi] whose cosine is a; defined for |a| <= 1"),
    row("atan2", &["atan", "arctan"], &["b", "a"], "select_negative(a, select_negative(b, atan(b/a)-pi, atan(b/a)+pi), 2*atan(b/(a+sqrt(a^2+b^2))))", "angle in (-pi, pi] of the point (a, b) given as atan2(b, a); undefined at the origin"),
    row("sinh", &[], &["a"], "(exp(a)-exp(-a))/2", "hyperbolic sine"),
    row("cosh", &[], &["a"], "(exp(abs(a))+exp(-abs(a)))/2", "hyperbolic cosine"),
    row("tanh", &[], &["a"], "1-2/(exp(2*a)+1)", "hyperbolic tangent"),
    // Odd by its sign: a + sqrt(a^2+1) cancels for a below 0.
    row("asinh", &["arsinh"], &["a"], "sign(a)*ln(abs(a)+sqrt(a^2+1))", "inverse hyperbolic sine"),
    row("acosh", &["arcosh"], &["a"], "ln(a+sqrt(a^2-1))", "inverse hyperbolic cosine; defined for a >= 1"),
    row("atanh", &["artanh"], &["a"], "ln((1+a)/(1-a))/2", "inverse hyperbolic tangent; defined for |a| < 1"),
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
