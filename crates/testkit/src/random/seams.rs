//! Random formulas as text with folds, jumps, quotients or waves of angles, for which there are
//! special rules. Random operations hardly ever produce them.

use super::Rng;
use super::values::below;

/// Returns a random expression for a number: some seams, joined.
pub fn random_seam(rng: &mut Rng) -> String {
    Seams(rng).joined()
}

/// Returns a condition on a point, with a random seam or without.
pub fn random_limit(rng: &mut Rng) -> String {
    let mut seams = Seams(rng);
    let limited = if seams.0.bool() { seams.fold(1) } else { seams.small() };
    let sign = seams.one_of(&["<", "<=", ">", ">="]);
    let level = seams.one_of(&["0", "0.3", "-0.5", "1"]);
    format!("{limited} {sign} {level}")
}

struct Seams<'r>(&'r mut Rng);

impl Seams<'_> {
    fn one_of(&mut self, all: &[&'static str]) -> &'static str {
        all[below(self.0, all.len())]
    }

    fn axis(&mut self) -> &'static str {
        self.one_of(&["x", "y", "z"])
    }

    fn number(&mut self) -> &'static str {
        self.one_of(&["0.5", "1", "2", "-1", "0.7", "3/7", "-2", "3"])
    }

    /// Returns a polynomial that is often 0 at points with simple coordinates.
    fn small(&mut self) -> String {
        let (a, b, n) = (self.axis(), self.axis(), self.number());
        match self.0.u32(0..8) {
            0 | 1 => a.to_owned(),
            2 => format!("({a}*{b})"),
            3 => format!("({a} - {b})"),
            4 => format!("({a} + ({n}))"),
            5 => format!("({a} - ({n})*{b})"),
            6 => format!("({a}^2 - {b}^2)"),
            _ => format!("(({n})*{a})"),
        }
    }

    fn joined(&mut self) -> String {
        let (seam, more) = (self.seam(), if self.0.bool() { self.seam() } else { self.small() });
        match self.0.u32(0..8) {
            0 => format!("{seam} + {more}"),
            1 => format!("{seam}*{more}"),
            2 => format!("max({seam}, {more})"),
            3 => format!("min({seam}, {more})"),
            4 => format!("hypot({seam}, {more})"),
            5 => format!("abs({seam}) + abs({more})"),
            6 => format!("if({}, {seam}, {more})", random_limit(self.0)),
            _ => seam,
        }
    }

    fn seam(&mut self) -> String {
        match self.0.u32(0..3) {
            0 => self.fold(2),
            1 => self.quotient(),
            _ => self.wave(),
        }
    }

    /// Returns a function with a jump, nested up to `depth` times.
    fn fold(&mut self, depth: u32) -> String {
        let u =
            if depth > 1 && self.0.u32(0..3) == 0 { self.fold(depth - 1) } else { self.small() };
        let (v, n) = (self.small(), self.one_of(&["0.5", "1", "2", "0.7"]));
        match self.0.u32(0..12) {
            0 => format!("(mod({u}, {n}) - {n}/2)"),
            1 => format!("({u} - {n}*round({u}/{n}))"),
            2 => format!("(fract({u}) - 0.5)"),
            3 => format!("(abs(mod({u}, 2*{n}) - {n}) - 0.2)"),
            4 => format!("(sign({u})*{v})"),
            5 => format!("({n}*floor({u}))"),
            6 => format!("atan2({u}, {v})"),
            7 => format!("(mod(atan2({u}, {v}), {n}) - {n}/2)"),
            8 => format!("if({u} < 0, {v}, {n} - {v})"),
            9 => format!("trunc({u})"),
            10 => format!("({n} + {v}/abs({u}))"),
            _ => format!("mod({v}, {u})"),
        }
    }

    /// Returns a quotient whose numerator mostly vanishes where its denominator does.
    fn quotient(&mut self) -> String {
        let (h, p) = (self.small(), self.small());
        let above = self.vanishing(&h);
        let below = if self.0.bool() { h.clone() } else { self.vanishing(&h) };
        match self.0.u32(0..6) {
            0 => format!("(({above})^2/({below}))"),
            1 => format!("(({above})/(({below})*{p}))"),
            2 => format!("(({above})/({below}) + {p}/{h})"),
            3 => format!("({h}/({above}/({below})))"),
            _ => format!("(({above})/({below}))"),
        }
    }

    /// Returns an expression that is mostly 0 where `h` is.
    fn vanishing(&mut self, h: &str) -> String {
        let (q, n) = (self.small(), self.one_of(&["0", "1", "4"]));
        match self.0.u32(0..11) {
            0 => h.to_owned(),
            1 => format!("{h}*{q}"),
            2 => format!("{h}*{q} - {h}"),
            3 | 4 => {
                let f = self.one_of(&[
                    "exp", "sin", "cos", "sinh", "cosh", "sqrt", "cbrt", "ln", "tanh", "asin",
                    "acos", "atan", "asinh", "atanh",
                ]);
                let u = if self.0.bool() { q } else { n.to_owned() };
                format!("{f}({u} + {h}) - {f}({u})")
            }
            5 => format!("1 - cos({h})"),
            6 => format!("ln(1 + {h})"),
            7 => format!("{h}*ln({h})"),
            8 => {
                let [f, g] = [0; 2].map(|_| self.one_of(&["exp", "sin", "cos", "tanh", "atan"]));
                format!("{f}({g}({q} + {h})) - {f}({g}({q}))")
            }
            9 => {
                // This is 0 where u is v, and mostly where u is -v.
                let (u, v) = (self.axis(), self.axis());
                let f = self.one_of(&["sin", "cos", "sinh", "cosh", "exp"]);
                format!("{h}/({u}^2 - {v}^2)*({u}^2*{f}({v}) - {v}^2*{f}({u}))")
            }
            _ => {
                let f =
                    self.one_of(&["sin", "tan", "asin", "atan", "sinh", "tanh", "asinh", "abs"]);
                format!("{f}({h})")
            }
        }
    }

    /// Returns a sine or cosine of a sum with multiples of angles.
    fn wave(&mut self) -> String {
        let mut sum = self.multiple();
        if self.0.u32(0..3) == 0 {
            sum = format!("{sum} + {}", self.multiple());
        }
        if self.0.u32(0..3) == 0 {
            sum = format!("{sum} - {}", self.small());
        }
        let f = self.one_of(&["sin", "cos"]);
        format!("{f}({sum})")
    }

    fn multiple(&mut self) -> String {
        let (u, v) = (self.small(), self.small());
        let angle = match self.0.u32(0..6) {
            0 | 1 => format!("acos({u})"),
            2 => format!("asin({u})"),
            3 => format!("atan({u})"),
            _ => format!("atan2({u}, {v})"),
        };
        let n = self.0.i32(-9..=9);
        match self.0.u32(0..4) {
            0 => format!("{angle}/2"),
            1 => format!("({n})*{angle}/2"),
            _ => format!("({n})*{angle}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_syntax::{Options, read};

    /// Checks that texts are accepted, since refused texts would test nothing.
    #[test]
    fn seams_read() {
        let mut rng = Rng::with_seed(0x5eed_0032);
        for _ in 0..1000 {
            let text = format!("{} = 0 {{{}}}", random_seam(&mut rng), random_limit(&mut rng));
            let read = read(&text, &Options::default());
            assert!(read.is_ok(), "{}", read.unwrap_err().render(None, &text, false));
        }
    }
}
