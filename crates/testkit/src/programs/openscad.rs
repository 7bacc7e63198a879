//! Random functions of `OpenSCAD`: `f(x, y, z)`, helper functions and variables. Angles are in
//! degrees. The last of several assignments to a variable counts.

use super::{once_in, pick};
use crate::random::Rng;

/// A helper function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Helper {
    /// `function near(a, b = 0.5, c = 2)`
    Near,
    /// `fold = function(a) …`
    Fold,
    /// `function wave(a) = let(…) …`
    Wave,
    /// `function special(a) = a*$k`
    Special,
    /// `function mirror(v, n)`, of vectors
    Mirror,
}

struct Writer<'r> {
    rng: &'r mut Rng,
    text: String,
    names: Vec<String>,
    helpers: Vec<Helper>,
    count: usize,
}

/// Returns a random function of `OpenSCAD`.
pub(super) fn program(rng: &mut Rng) -> String {
    let names = ["x", "y", "z"].map(str::to_owned).to_vec();
    let mut writer = Writer { rng, text: String::new(), names, helpers: Vec::new(), count: 0 };
    let coordinates = std::mem::take(&mut writer.names);
    for name in ["r", "s", "h"] {
        if once_in(writer.rng, 2) {
            let value = writer.constant(2);
            writer.line(&format!("{name} = {value};"));
            writer.names.push(name.to_owned());
        }
    }
    writer.write_helpers();
    writer.names.splice(0..0, coordinates);
    let value = writer.value(4);
    if writer.rng.bool() {
        writer.line(&format!("function f(x, y, z) = {value};"));
    } else {
        writer.line(&format!("f = function(x, y, z) {value};"));
    }
    // The last assignment counts, above it too.
    if writer.names.len() > 3 && once_in(writer.rng, 2) {
        let name = writer.names[3].clone();
        let value = pick(writer.rng, &["2", "0.25", "sin(30)", "cos(60) + 1"]);
        writer.line(&format!("{name} = {value};"));
    }
    writer.text
}

impl Writer<'_> {
    fn line(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    fn write_helpers(&mut self) {
        if once_in(self.rng, 3) {
            self.helpers.push(Helper::Near);
            self.line("function near(a, b = 0.5, c = 2) = pow(a - b, c) - b;");
        }
        if once_in(self.rng, 3) {
            self.helpers.push(Helper::Fold);
            self.line(
                "fold = function(a) a < 0.07 ? -a : a > 1.618 && a <= 4.1 ? a % 1.75 : sin(a*45);",
            );
        }
        if once_in(self.rng, 3) {
            self.helpers.push(Helper::Wave);
            self.line(
                "function wave(a) = let(b = a*90, c = cos(b), e = c + 1) e*c + atan2(b, 2)/45;",
            );
        }
        if once_in(self.rng, 3) {
            self.helpers.push(Helper::Mirror);
            self.line("function mirror(v, n = [0.6, 0, 0.8]) = v - 2*(v*n)*n;");
        }
        if once_in(self.rng, 12) {
            self.helpers.push(Helper::Special);
            self.line("$k = 0.5;");
            self.line("function special(a) = a*$k + 1;");
        }
    }

    fn constant(&mut self, depth: u32) -> String {
        if self.names.is_empty() || depth == 0 {
            return pick(self.rng, &["0.5", "2", "1.25", "3"]).to_owned();
        }
        let name = pick(self.rng, &self.names);
        pick(
            self.rng,
            &[
                format!("{name} + 0.5"),
                format!("sin({name}*20)"),
                "1.5".to_owned(),
                "sqrt(2)".to_owned(),
            ],
        )
    }

    fn leaf(&mut self) -> String {
        let literals = ["0.25", "0.5", "1", "1.5", "2", "0.75", "3", "1e-1"];
        match self.rng.u32(0..4) {
            0..=2 => pick(self.rng, &self.names),
            _ => pick(self.rng, &literals).to_owned(),
        }
    }

    fn value(&mut self, depth: u32) -> String {
        if depth == 0 {
            return self.leaf();
        }
        let inner = depth - 1;
        match self.rng.u32(0..22) {
            0 | 1 => {
                let sign = pick(self.rng, &["+", "-"]);
                format!("({} {sign} {})", self.value(inner), self.value(inner))
            }
            2 => format!("sin(30*{})*{}", self.value(inner), self.value(inner)),
            3 => format!("{}/(abs({}) + 1.5)", self.value(inner), self.value(inner)),
            4 => {
                let name =
                    pick(self.rng, &["sin", "cos", "abs", "-", "floor", "ceil", "sign", "atan"]);
                format!("{name}({})", self.value(inner))
            }
            5 => {
                let name = pick(self.rng, &["min", "max"]);
                format!("{name}({}, {})", self.value(inner), self.value(inner))
            }
            6 => format!(
                "({} ? {} : {})",
                self.condition(inner),
                self.value(inner),
                self.value(inner)
            ),
            7 => format!("({}) % {}", self.value(inner), pick(self.rng, &["1.75", "3"])),
            8 => format!("{}^{}", pick(self.rng, &self.names), pick(self.rng, &["2", "3"])),
            9 => format!("pow({}, 2)", self.value(inner)),
            10 | 11 => self.bindings(inner),
            12 => self.comprehension(inner),
            13 | 14 => self.call(inner),
            15 => format!("norm([{}, {}, {}])", self.value(inner), self.value(inner), self.leaf()),
            16 => format!(
                "[{}, {}]*[{}, {}]",
                self.value(inner),
                self.leaf(),
                self.leaf(),
                self.value(inner)
            ),
            17 => format!("[{}, {}, 2][{}]", self.value(inner), self.leaf(), self.rng.u32(0..3)),
            18 => format!("acos(cos({}*40))/30", self.value(inner)),
            19 => format!("atan2({}, abs({}) + 0.5)/45", self.value(inner), self.value(inner)),
            20 => format!("sqrt(abs({}))", self.value(inner)),
            _ => self.leaf(),
        }
    }

    fn new_name(&mut self) -> String {
        self.count += 1;
        format!("v{}", self.count)
    }

    fn bindings(&mut self, depth: u32) -> String {
        let known = self.names.len();
        let mut parts = Vec::new();
        for _ in 0..self.rng.u32(1..3) {
            let value = self.value(depth);
            // A binding may hide an outer variable.
            let hides = self.names.len() > 3 && once_in(self.rng, 3);
            let name = if hides { pick(self.rng, &self.names[3..]) } else { self.new_name() };
            if parts.iter().any(|part: &String| part.starts_with(&format!("{name} "))) {
                continue;
            }
            parts.push(format!("{name} = {value}"));
            self.names.push(name);
        }
        let value = self.value(depth);
        self.names.truncate(known);
        format!("(let({}) {value})", parts.join(", "))
    }

    fn comprehension(&mut self, depth: u32) -> String {
        let name = self.new_name();
        self.names.push(name.clone());
        let value = self.value(depth);
        self.names.pop();
        let range =
            pick(self.rng, &["[0:2]", "[1:3]", "[0:0.5:1]", "[2:-1:0]", "[1, 3, 2]", "[-1:1]"]);
        let filter =
            if once_in(self.rng, 3) { format!("if ({name} != 1) ") } else { String::new() };
        match self.rng.u32(0..3) {
            0 => format!("min([for ({name} = {range}) {filter}{value}])"),
            1 => format!("max([for ({name} = {range}) {filter}{value}])"),
            _ => format!("[for ({name} = [0:2]) {value}]*[1, 1, 1]"),
        }
    }

    fn call(&mut self, depth: u32) -> String {
        if self.helpers.is_empty() {
            return self.leaf();
        }
        let value = self.value(depth);
        match pick(self.rng, &self.helpers) {
            Helper::Near => match self.rng.u32(0..5) {
                0 => format!("near({value})"),
                1 => format!("near({value}, {})", self.value(depth)),
                2 => format!("near({value}, c = 3)"),
                3 => format!("near({value}, 0.25, 3)"),
                _ => format!("near(b = {}, a = {value})", self.value(depth)),
            },
            Helper::Fold => format!("fold({value})"),
            Helper::Wave => format!("wave({value})"),
            Helper::Mirror => match self.rng.u32(0..3) {
                0 => format!("mirror([{value}, x, 1])[{}]", self.rng.u32(0..3)),
                1 => format!("norm(mirror([y, 0.5, {value}], [0.8, 0.6, 0]))"),
                _ => format!("(let(v = [x, {value}, z], w = mirror(v)) w*v*0.25)"),
            },
            Helper::Special if once_in(self.rng, 3) => format!("special({value}, $k = 2)"),
            Helper::Special => format!("special({value})"),
        }
    }

    fn condition(&mut self, depth: u32) -> String {
        let compared = |writer: &mut Self| {
            let sign = pick(writer.rng, &["<", ">", "<=", ">="]);
            let left = writer.value(depth.min(1));
            format!("{left} {sign} {}", pick(writer.rng, &["0.3183", "-0.577", "1.618", "0.07"]))
        };
        match self.rng.u32(0..6) {
            0 => format!("({} && {})", compared(self), compared(self)),
            1 => format!("({} || {})", compared(self), compared(self)),
            2 => format!("!({})", compared(self)),
            _ => compared(self),
        }
    }
}
