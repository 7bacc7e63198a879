//! Random formulas as text, with every special form, composed function and builder of the language.
//! They give graphs that random operations hardly ever produce.

use super::Rng;
use super::values::below;
use zeroset_ops::{
    BUILDERS, COMPOSED, Differential, FORMS, FormKind, Role, Sequence, TABLE, VectorFunction,
};

/// Vectors and a function that every text defines.
const HEAD: &str = "p = vec3(x, y, z)\nq = vec3(y, 1 - z, x*y)\nf(a) = a^2 - x/2\n";

/// Returns a text of one formula whose nesting is limited by `depth`.
pub fn random_text(rng: &mut Rng, depth: u32) -> String {
    let mut text = Text { rng, indices: 0 };
    let formula = text.number(depth);
    format!("{HEAD}{formula}")
}

struct Text<'r> {
    rng: &'r mut Rng,
    /// Number of sums and products that enclose the expression being written.
    indices: usize,
}

impl Text<'_> {
    fn leaf(&mut self) -> String {
        if self.indices > 0 && self.rng.bool() {
            return format!("k{}", below(self.rng, self.indices));
        }
        let leaves = [
            "x", "y", "z", "x", "y", "z", "rho", "theta", "phi", "2", "0.5", "pi", "p.x", "q.y",
            "0", "-1", "3/7",
        ];
        leaves[below(self.rng, leaves.len())].to_owned()
    }

    /// Returns a random expression for a number.
    fn number(&mut self, depth: u32) -> String {
        if depth == 0 {
            return self.leaf();
        }
        let inner = depth - 1;
        match self.rng.u32(0..9) {
            0 => self.leaf(),
            1 => {
                let signs = ["+", "-", "*", "/"];
                let sign = signs[below(self.rng, signs.len())];
                format!("({} {sign} {})", self.number(inner), self.number(inner))
            }
            2 => {
                let names = ["sin", "cos", "abs", "sqrt", "exp", "floor", "fract", "atan"];
                let name = names[below(self.rng, names.len())];
                format!("{name}({})", self.number(inner))
            }
            3 | 4 => {
                let row = &COMPOSED[below(self.rng, COMPOSED.len())];
                let degrees = if let Some(Sequence::Listed(_)) = row.sequence { 4 } else { 7 };
                let degree = self.rng.u32(0..degrees);
                let given = row.parameters.iter().map(|parameter| match *parameter {
                    "n" => degree.to_string(),
                    "m" => self.rng.u32(0..=degree).to_string(),
                    _ => self.number(inner),
                });
                let given: Vec<String> = given.collect();
                // Some composed functions are complex. `re` changes no real number.
                format!("re({}({}))", row.name, given.join(", "))
            }
            5 => format!("length({})", self.vector(inner)),
            6 => self.builder(inner),
            _ => self.form(inner),
        }
    }

    /// Returns a call of a builder. Its sizes are above 0, since others are refused.
    fn builder(&mut self, depth: u32) -> String {
        let row = &BUILDERS[below(self.rng, BUILDERS.len())];
        let mut given: Vec<String> = Vec::new();
        for (_, role) in row.parameters {
            let sizes = ["0.5", "1", "2", "3/7", "abs(x) + 1", "sqrt(2)"];
            let size = |rng: &mut Rng| sizes[below(rng, sizes.len())].to_owned();
            let rng = &mut *self.rng;
            given.push(match role {
                // A shape must vary: a constant is refused if only the last argument varies.
                Role::Shape => format!("x + ({})", self.number(depth)),
                Role::Distance | Role::Number => self.number(depth),
                Role::Vector => self.vector(depth),
                Role::Direction => format!("(1, {}, 2)", self.number(depth)),
                Role::Sizes => format!("({}, {}, {})", size(rng), size(rng), size(rng)),
                Role::Cells => format!("({}, 0, {})", size(rng), size(rng)),
                Role::Size => size(rng),
                Role::Count => format!("{}", rng.u32(1..4)),
            });
        }
        if row.has_center() && self.rng.bool() {
            given.push(self.vector(depth));
        }
        format!("{}({})", row.name, given.join(", "))
    }

    fn condition(&mut self, depth: u32) -> String {
        let signs = ["<", "<=", ">", ">="];
        let sign = signs[below(self.rng, signs.len())];
        let compared = format!("{} {sign} {}", self.number(depth), self.number(depth));
        match self.rng.u32(0..6) {
            0 => format!("{compared} and {} < 1", self.number(depth)),
            1 => format!("{compared} or {} > 0", self.number(depth)),
            2 => format!("not ({compared})"),
            3 => format!("-1 < {} < 1", self.number(depth)),
            _ => compared,
        }
    }

    /// Returns a random expression for a vector of three components.
    fn vector(&mut self, depth: u32) -> String {
        if depth == 0 {
            return ["p", "q", "p.zxy", "q.yzx"][below(self.rng, 4)].to_owned();
        }
        let inner = depth - 1;
        match self.rng.u32(0..8) {
            0 => format!(
                "vec3({}, {}, {})",
                self.number(inner),
                self.number(inner),
                self.number(inner)
            ),
            1 => format!("({} + {})", self.vector(inner), self.vector(inner)),
            2 => format!("{}*{}", self.leaf(), self.vector(inner)),
            3 => format!("abs({})", self.vector(inner)),
            4 => format!("mod({}, 2)", self.vector(inner)),
            5 => format!("mix({}, {}, {})", self.vector(inner), self.vector(inner), self.leaf()),
            6 => format!("normalize({})", self.vector(inner)),
            _ => format!("cross({}, {})", self.vector(inner), self.vector(inner)),
        }
    }

    /// Returns a matrix of `size` columns, given by all its elements, or by one number for the
    /// diagonal.
    fn matrix(&mut self, size: u8, depth: u32) -> String {
        let count = usize::from(size) * usize::from(size);
        let count = if self.rng.u32(0..3) == 0 { 1 } else { count };
        let elements: Vec<String> = (0..count).map(|_| self.number(depth)).collect();
        format!("mat{size}({})", elements.join(", "))
    }

    /// Returns a random expression for a complex number.
    fn complex_number(&mut self, depth: u32) -> String {
        if depth == 0 {
            return ["(x + i*y)", "(z - i*x)", "i", "complex(y, z)"][below(self.rng, 4)].to_owned();
        }
        let inner = depth - 1;
        let functions: Vec<&str> =
            TABLE.iter().filter(|row| !row.complex.is_empty()).map(|row| row.name).collect();
        match self.rng.u32(0..7) {
            0 => format!("({} + i*{})", self.number(inner), self.number(inner)),
            1 => format!("({}*{})", self.complex_number(inner), self.complex_number(inner)),
            2 => format!("({} + {})", self.complex_number(inner), self.leaf()),
            3 => format!("({}/{})", self.complex_number(inner), self.complex_number(inner)),
            4 => format!("{}^{}", self.complex_number(0), self.rng.u32(0..5)),
            5 => format!("({}^({}))", self.complex_number(0), self.number(0)),
            _ => format!(
                "{}({})",
                functions[below(self.rng, functions.len())],
                self.complex_number(inner)
            ),
        }
    }

    /// Returns a random expression for a number, with one of the special forms.
    fn form(&mut self, depth: u32) -> String {
        let form = &FORMS[below(self.rng, FORMS.len())];
        let name = form.name;
        match form.meaning {
            FormKind::Choose => {
                let (condition, yes) = (self.condition(depth), self.number(depth));
                match self.rng.u32(0..3) {
                    0 => format!("{name}({condition}, {yes}, {})", self.number(depth)),
                    1 => format!("{{{condition}: {yes}, {}}}", self.number(depth)),
                    _ => format!("({condition} ? {yes} : {})", self.number(depth)),
                }
            }
            FormKind::Pieces => {
                let (first, last) = (self.number(depth), self.number(depth));
                format!("{name}([[{first}, {}], [{last}, x >= 0]])", self.condition(depth))
            }
            FormKind::Sum | FormKind::Product => {
                let index = self.indices;
                self.indices += 1;
                let body = self.number(depth);
                self.indices -= 1;
                format!("{name}(k{index} = {}..3, {body})", self.rng.u32(0..3))
            }
            FormKind::Iterate => {
                format!("{name}(f, {}, {})", self.rng.u32(0..4), self.number(depth))
            }
            FormKind::Vector(size) => {
                let parts: Vec<String> = (0..size).map(|_| self.number(depth)).collect();
                format!("{name}({}).{}", parts.join(", "), ["x", "y"][below(self.rng, 2)])
            }
            FormKind::Matrix(size @ 2..=3) => {
                let vector = if size == 2 { "p.xy" } else { "q" };
                format!("({}*{vector}).x", self.matrix(size, depth.min(1)))
            }
            FormKind::Matrix(_) => format!("(mat4({})*vec4(p, 1)).w", self.number(depth)),
            FormKind::Derivative => {
                format!("{name}({}, {})", self.number(depth), ["x", "y", "z"][below(self.rng, 3)])
            }
            FormKind::OfDerivatives(Differential::Gradient) => {
                format!("{name}({}).y", self.number(depth.min(1)))
            }
            FormKind::OfDerivatives(_) => format!("{name}({})", self.number(depth.min(1))),
            FormKind::Multiply => format!("{name}({}, p.xz).x", self.matrix(2, depth)),
            FormKind::OfVectors(function) => match function {
                VectorFunction::Transpose => format!("({name}({})*p.yz).y", self.matrix(2, depth)),
                VectorFunction::Determinant => format!("{name}({})", self.matrix(2, depth)),
                VectorFunction::Dot | VectorFunction::Distance => {
                    format!("{name}({}, {})", self.vector(depth), self.vector(depth))
                }
                VectorFunction::Cross | VectorFunction::Reflect => {
                    format!("{name}({}, {}).z", self.vector(depth), self.vector(depth))
                }
                VectorFunction::Normalize => format!("{name}({}).y", self.vector(depth)),
                VectorFunction::Complex => {
                    format!("abs({name}({}, {}))", self.number(depth), self.number(depth))
                }
                VectorFunction::Quaternion => {
                    let parts = (self.number(depth), self.number(0), self.number(0), self.leaf());
                    format!("abs({name}({}, {}, {}, {})^2)", parts.0, parts.1, parts.2, parts.3)
                }
                VectorFunction::RealPart
                | VectorFunction::ImaginaryPart
                | VectorFunction::Argument => format!("{name}({})", self.complex_number(depth)),
                VectorFunction::Conjugate => {
                    format!("re({name}({0})*{0})", self.complex_number(depth))
                }
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_syntax::{Options, read};

    /// Checks that texts are accepted, since refused texts would test nothing.
    #[test]
    fn texts_read_and_hold_every_form_composed_function_and_builder() {
        let mut rng = Rng::with_seed(0x5eed_0031);
        let texts: Vec<String> = (0..3000).map(|_| random_text(&mut rng, 3)).collect();
        for text in &texts[..500] {
            let read = read(text, &Options::default());
            assert!(read.is_ok(), "{}", read.unwrap_err().render(None, text, false));
        }
        let count = |word: &str| texts.iter().filter(|text| text.contains(word)).count();
        for form in FORMS {
            assert!(count(&format!("{}(", form.name)) > 20, "{}", form.name);
        }
        for row in BUILDERS {
            assert!(count(&format!("{}(", row.name)) > 20, "{}", row.name);
        }
        for row in COMPOSED {
            assert!(count(&format!("{}(", row.name)) > 20, "{}", row.name);
        }
    }
}
