//! Functions that are formulas over other functions, written in the language itself.

/// A function defined by a formula. Functions of the same name differ in their number of
/// parameters.
#[derive(Debug)]
pub struct Composed {
    /// The name by which formulas call the function.
    pub name: &'static str,
    /// Other names that formulas may use for the function.
    pub aliases: &'static [&'static str],
    /// Parameter names, as used in `body`. `n` and `m` stand for constant whole numbers, with m ≤
    /// n.
    pub parameters: &'static [&'static str],
    /// The formula. A name in it always means the built-in function or constant, even if the user
    /// redefines that name. The formula may call internal operations of the table.
    pub body: &'static str,
    /// For a sequence of functions: the formulas for the functions after number 0, which is `body`.
    /// The first argument of a call, a constant, is the function's number.
    pub sequence: Option<Sequence<&'static str>>,
    /// One line of help about the function.
    pub doc: &'static str,
}

/// Formulas for the further functions of a sequence. In them, `p` stands for function number n, and
/// `q` for number n − 1.
#[derive(Clone, Copy, Debug)]
pub enum Sequence<T> {
    /// Formulas for function number 1, and for number n + 1.
    Recurrence([T; 2]),
    /// Formulas for function number 1, for number 2n and for number 2n − 1.
    Doubling([T; 3]),
    /// Formulas for the functions number 1 to 3. There are no others.
    Listed([T; 3]),
}

impl<T> Sequence<T> {
    /// Applies `change` to every formula.
    pub fn map<U>(self, change: impl FnMut(T) -> U) -> Sequence<U> {
        match self {
            Self::Recurrence(all) => Sequence::Recurrence(all.map(change)),
            Self::Doubling(all) => Sequence::Doubling(all.map(change)),
            Self::Listed(all) => Sequence::Listed(all.map(change)),
        }
    }
}

const fn row(
    name: &'static str,
    aliases: &'static [&'static str],
    parameters: &'static [&'static str],
    body: &'static str,
    doc: &'static str,
) -> Composed {
    Composed { name, aliases, parameters, body, sequence: None, doc }
}

const fn sequence(
    name: &'static str,
    aliases: &'static [&'static str],
    parameters: &'static [&'static str],
    body: &'static str,
    sequence: Sequence<&'static str>,
    doc: &'static str,
) -> Composed {
    Composed { name, aliases, parameters, body, sequence: Some(sequence), doc }
}

use Sequence::{Doubling, Listed, Recurrence};

/// Every composed function.
#[rustfmt::skip] // one row a line
pub static COMPOSED: &[Composed] = &[
    row("recip", &[], &["a"], "1/a", "reciprocal; undefined at 0"),
    row("clamp", &["clip"], &["a", "low", "high"], "min(max(a, low), high)", "a, no smaller than low and no larger than high"),
    row("hypot", &["length", "norm"], &["a"], "abs(a)", "distance from the origin"),
    row("hypot", &["length", "norm"], &["a", "b"], "sqrt(a^2+b^2)", "distance from the origin"),
    row("hypot", &["length", "norm"], &["a", "b", "c"], "sqrt(a^2+b^2+c^2)", "distance from the origin"),
    row("step", &[], &["edge", "a"], "select_negative(a-edge, 0, 1)", "0 where a < edge, else 1"),
    row("smoothstep", &[], &["low", "high", "a"], "clamp((a-low)/(high-low), 0, 1)^2*(3-2*clamp((a-low)/(high-low), 0, 1))", "0 below low, 1 above high, a smooth cubic between"),
    row("mix", &["lerp"], &["a", "b", "k"], "a*(1-k)+b*k", "from a at k = 0 to b at k = 1, linearly"),
    row("sec", &[], &["a"], "1/cos(a)", "secant, 1/cos(a); undefined at odd multiples of pi/2"),
    row("csc", &["cosec"], &["a"], "1/sin(a)", "cosecant, 1/sin(a); undefined at multiples of pi"),
    row("cot", &["cotan"], &["a"], "cos(a)/sin(a)", "cotangent, cos(a)/sin(a); undefined at multiples of pi"),
    row("asec", &["arcsec"], &["a"], "acos(1/a)", "angle in [0, pi] whose secant is a; defined for |a| >= 1"),
    row("acsc", &["arccsc"], &["a"], "asin(1/a)", "angle in [-pi/2, pi/2] whose cosecant is a; defined for |a| >= 1"),
    row("acot", &["arccot"], &["a"], "pi/2-atan(a)", "angle in (0, pi) whose cotangent is a: pi/2 - atan(a)"),
    row("sech", &[], &["a"], "1/cosh(a)", "hyperbolic secant, 1/cosh(a)"),
    row("csch", &["cosech"], &["a"], "1/sinh(a)", "hyperbolic cosecant, 1/sinh(a); undefined at 0"),
    row("coth", &[], &["a"], "1/tanh(a)", "hyperbolic cotangent, 1/tanh(a); undefined at 0"),
    row("asech", &["arsech", "arcsech"], &["a"], "acosh(1/a)", "inverse hyperbolic secant; defined for 0 < a <= 1"),
    row("acsch", &["arcsch", "arccsch"], &["a"], "asinh(1/a)", "inverse hyperbolic cosecant; undefined at 0"),
    row("acoth", &["arcoth", "arccoth"], &["a"], "atanh(1/a)", "inverse hyperbolic cotangent; defined for |a| > 1"),
    // For all a, sin(a)/a lies between the two Taylor polynomials, so min and max change no value.
    // Near 0 the enclosure of sin(a)/a is infinite. The polynomials keep the result narrow.
    row("sinc", &[], &["a"], "otherwise(min(max(sin(a)/a, 1-a^2/6), 1-a^2/6+a^4/120), where_defined(1, a))", "sin(a)/a, and 1 at 0"),
    row("exp2", &[], &["a"], "2^a", "2 to the power a"),
    row("expm1", &[], &["a"], "exp(a)-1", "exp(a) - 1"),
    row("log1p", &[], &["a"], "ln(1+a)", "ln(1 + a); defined for a > -1"),
    row("inversesqrt", &["rsqrt"], &["a"], "1/sqrt(a)", "1/sqrt(a); defined for a > 0"),
    row("radians", &["deg2rad"], &["a"], "a*pi/180", "an angle of a degrees, in radians"),
    row("degrees", &["rad2deg"], &["a"], "a*180/pi", "an angle of a radians, in degrees"),
    row("saturate", &[], &["a"], "min(max(a, 0), 1)", "a, no smaller than 0 and no larger than 1"),
    row("heaviside", &["unitstep", "heavisidetheta"], &["a"], "select_negative(a, 0, 1)", "0 where a < 0, else 1"),
    row("heaviside", &[], &["a", "b"], "select_negative(a, 0, select_negative(-a, 1, b))", "0 where a < 0, 1 where a > 0, b at 0"),
    row("subtract", &["difference"], &["a", "b"], "max(a, -b)", "solid a without solid b"),
    row("blend", &["smooth_union"], &["a", "b", "k"], "min(a, b)-max(k-abs(a-b), 0)^2/(4*k)", "union of solids a and b, rounded over a width k"),
    // Doubling keeps bounds narrow.
    sequence("chebyshev_t", &["chebyshevt", "chebyshevT", "eval_chebyt"], &["n", "a"], "1", Doubling(["a", "2*p^2-1", "2*p*q-a"]), "Chebyshev polynomial of the first kind and degree n, also T_4(a)"),
    sequence("chebyshev_u", &["chebyshevu", "chebyshevU", "eval_chebyu"], &["n", "a"], "1", Recurrence(["2*a", "2*a*p-q"]), "Chebyshev polynomial of the second kind and degree n, also U_4(a)"),
    sequence("legendre", &["legendrep", "legendreP", "legendre_P", "eval_legendre"], &["n", "a"], "1", Recurrence(["a", "((2*n+1)*a*p-n*q)/(n+1)"]), "Legendre polynomial of degree n, also P_4(a)"),
    row("legendre", &["legendrep", "legendreP", "assoc_legendre"], &["n", "m", "a"], "(-1)^m*product(k = 1..m, 2*k-1)*(1-a^2)^(m/2)*gegenbauer(n-m, m+1/2, a)", "associated Legendre function of degree n and order m >= 0, with the sign (-1)^m"),
    sequence("gegenbauer", &["gegenbauerc", "gegenbauerC", "eval_gegenbauer"], &["n", "k", "a"], "1", Recurrence(["2*k*a", "(2*(n+k)*a*p-(n+2*k-1)*q)/(n+1)"]), "Gegenbauer polynomial of degree n and index k"),
    sequence("hermite", &["hermiteh", "hermiteH", "eval_hermite"], &["n", "a"], "1", Recurrence(["2*a", "2*a*p-2*n*q"]), "Hermite polynomial of degree n, of physics, also H_4(a)"),
    sequence("hermite_e", &["hermite_prob", "eval_hermitenorm"], &["n", "a"], "1", Recurrence(["a", "a*p-n*q"]), "Hermite polynomial of degree n, of probability theory"),
    sequence("laguerre", &["laguerrel", "laguerreL", "eval_laguerre"], &["n", "a"], "1", Recurrence(["1-a", "((2*n+1-a)*p-n*q)/(n+1)"]), "Laguerre polynomial of degree n, also L_4(a)"),
    sequence("laguerre", &["laguerrel", "laguerreL", "assoc_laguerre"], &["n", "k", "a"], "1", Recurrence(["1+k-a", "((2*n+1+k-a)*p-(n+k)*q)/(n+1)"]), "associated Laguerre polynomial of degree n and index k"),
    sequence("besselj", &["besselJ", "bessel_j", "bessel_J", "jn", "jv"], &["n", "a"], "besselj0(a)", Listed(["besselj1(a)", "besselj2(a)", "besselj3(a)"]), "Bessel function of the first kind and order n, from 0 to 3, also J_2(a)"),
    row("erfc", &[], &["a"], "1-erf(a)", "complementary error function, 1 - erf(a)"),
    row("bernstein", &[], &["n", "m", "a"], "product(k = 1..m, (n-m+k)/k)*a^m*(1-a)^(n-m)", "Bernstein polynomial number m of degree n"),
    row("spherical_harmonic", &["sphericalharmonicy", "Ynm"], &["n", "m", "a", "b"], "sqrt((2*n+1)/(4*pi)*product(k = n-m+1..n+m, 1/k))*(-1)^m*product(k = 1..m, 2*k-1)*sin(a)^m*gegenbauer(n-m, m+1/2, cos(a))*exp(i*m*b)", "complex spherical harmonic of degree n and order m >= 0, at the angle a from z and b around z"),
];
