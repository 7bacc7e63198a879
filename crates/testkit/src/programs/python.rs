//! Random functions of Python: `f(x, y, z)`, helper functions, and global variables.

use super::{once_in, pick};
use crate::random::Rng;

/// A helper function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Helper {
    /// `def near(a, b=0.5, c=2)`
    Near,
    /// `def fold(a)`, with an early `return`
    Fold,
    /// `mixed = lambda a, t=0.25: …`
    Mixed,
    /// `def pair(a, b)`, which returns two numbers
    Pair,
}

struct Writer<'r> {
    rng: &'r mut Rng,
    text: String,
    depth: usize,
    /// Variables that hold floats, and variables that hold integers.
    floats: Vec<String>,
    integers: Vec<String>,
    /// Loops' counters, which no statement assigns.
    fixed: Vec<String>,
    helpers: Vec<Helper>,
    names: usize,
    in_loop: bool,
    /// Variables that are true or false.
    flags: Vec<String>,
}

const NAMES: [&str; 12] = ["d", "e", "s", "g", "k", "w", "q", "v", "c", "h", "m", "n"];

/// Returns a random function of Python.
pub(super) fn program(rng: &mut Rng) -> String {
    let coordinates = ["x", "y", "z"].map(str::to_owned).to_vec();
    let mut writer = Writer {
        rng,
        text: String::new(),
        depth: 0,
        floats: coordinates,
        integers: Vec::new(),
        fixed: Vec::new(),
        helpers: Vec::new(),
        names: 0,
        in_loop: false,
        flags: Vec::new(),
    };
    writer.line("import math");
    writer.line("from math import sin, cos, floor, sqrt");
    if once_in(writer.rng, 3) {
        writer.line("SIZE = 0.75");
        writer.floats.push("SIZE".to_owned());
        writer.fixed.push("SIZE".to_owned());
    }
    writer.write_helpers();
    writer.line("def f(x, y, z):");
    writer.depth = 1;
    let count = writer.rng.u32(4..10);
    writer.declaration();
    for _ in 0..count {
        writer.statement(2);
    }
    let value = writer.float(3);
    writer.line(&format!("return {value}"));
    writer.text
}

impl Writer<'_> {
    fn line(&mut self, line: &str) {
        self.text.push_str(&"    ".repeat(self.depth));
        self.text.push_str(line);
        self.text.push('\n');
    }

    fn write_helpers(&mut self) {
        if once_in(self.rng, 3) {
            self.helpers.push(Helper::Near);
            self.line("def near(a, b=0.5, c=2):");
            self.line("    a -= b");
            self.line("    return a**c - b");
        }
        if once_in(self.rng, 3) {
            self.helpers.push(Helper::Fold);
            self.line("def fold(a):");
            self.line("    if a < 0.07:");
            self.line("        return -a");
            self.line("    elif 1.618 < a <= 4.1:");
            self.line("        a = a % 1.75");
            self.line("    return a + 1");
        }
        if once_in(self.rng, 3) {
            self.helpers.push(Helper::Mixed);
            self.line("mixed = lambda a, t=0.25: a*(1 - t) + t");
        }
        if once_in(self.rng, 3) {
            self.helpers.push(Helper::Pair);
            self.line("def pair(a, b):");
            self.line("    return a - b, a*0.5");
        }
    }

    fn new_name(&mut self) -> String {
        let name = NAMES[self.names % NAMES.len()];
        let round = self.names / NAMES.len();
        self.names += 1;
        if round == 0 { name.to_owned() } else { format!("{name}{round}") }
    }

    fn target(&mut self) -> Option<String> {
        let mut free = self.floats.clone();
        free.retain(|name| !self.fixed.contains(name));
        (!free.is_empty()).then(|| pick(self.rng, &free))
    }

    fn leaf(&mut self) -> String {
        let literals = ["0.25", "0.5", "1", "1.5", "2.0", ".75", "3", "1e-1", "-2"];
        match self.rng.u32(0..5) {
            0..=2 => pick(self.rng, &self.floats),
            3 if !self.integers.is_empty() => pick(self.rng, &self.integers),
            _ => pick(self.rng, &literals).to_owned(),
        }
    }

    fn int(&mut self, depth: u32) -> String {
        let literal = self.rng.u32(1..6);
        if depth == 0 || self.integers.is_empty() {
            return literal.to_string();
        }
        let name = pick(self.rng, &self.integers);
        match self.rng.u32(0..6) {
            0 => format!("({name} - {literal})"),
            1 => format!("{name}*{literal}"),
            2 => format!("({name} - 3)//{literal}"),
            3 => format!("(({name} - 4) % {literal})"),
            4 => format!("{name}**2"),
            _ => name,
        }
    }

    fn float(&mut self, depth: u32) -> String {
        if depth == 0 {
            return self.leaf();
        }
        let inner = depth - 1;
        match self.rng.u32(0..21) {
            0 | 1 => {
                let sign = pick(self.rng, &["+", "-"]);
                format!("({} {sign} {})", self.float(inner), self.float(inner))
            }
            2 => format!("sin({})*{}", self.float(inner), self.float(inner)),
            3 => format!("{}/(abs({}) + 1.5)", self.float(inner), self.float(inner)),
            4 => {
                let name = pick(self.rng, &["sin", "math.cos", "abs", "-", "floor", "math.floor"]);
                format!("{name}({})", self.float(inner))
            }
            5 => {
                let name = pick(self.rng, &["min", "max"]);
                format!("{name}({}, {})", self.float(inner), self.float(inner))
            }
            6 => format!(
                "({} if {} else {})",
                self.float(inner),
                self.condition(inner),
                self.float(inner)
            ),
            7 => format!("({}) % {}", self.float(inner), pick(self.rng, &["1.75", "-1.75", "3"])),
            8 => format!("({}) // {}", self.float(inner), pick(self.rng, &["1.75", "-1.25", "3"])),
            9 => format!("{}**{}", self.atom(), pick(self.rng, &["2", "3", "2"])),
            10 => format!("-{}**2", self.atom()),
            11 => self.comprehension(inner),
            12 => self.call(inner),
            13 => self.int(inner),
            14 => format!("{}/{}", self.int(inner), pick(self.rng, &["2", "4", "8"])),
            15 => format!("math.sqrt(abs({}))", self.float(inner)),
            16 => format!("2**-{}", pick(self.rng, &["1", "2"])),
            17 => format!("int({})", self.float(inner)),
            18 => format!("pow({}, 2)", self.atom()),
            _ => self.leaf(),
        }
    }

    fn atom(&mut self) -> String {
        let name = pick(self.rng, &self.floats);
        // Powers of powers in loops would leave nothing of a number but rounding errors.
        if self.in_loop { format!("sin({name})") } else { name }
    }

    fn comprehension(&mut self, depth: u32) -> String {
        let index = format!("i{}", self.names);
        self.names += 1;
        self.integers.push(index.clone());
        let body = self.float(depth);
        let range =
            pick(self.rng, &["range(3)", "range(1, 4)", "range(4, 0, -2)", "(1, 2, 5)", "[0, 3]"]);
        let filter = if once_in(self.rng, 3) { format!(" if {index} != 1") } else { String::new() };
        self.integers.pop();
        let name = pick(self.rng, &["sum", "min", "max"]);
        if self.rng.bool() {
            format!("{name}({body} for {index} in {range}{filter})")
        } else {
            format!("{name}([{body} for {index} in {range}{filter}])")
        }
    }

    fn call(&mut self, depth: u32) -> String {
        if self.helpers.is_empty() {
            return self.leaf();
        }
        let value = self.float(depth);
        let value = if self.in_loop { format!("sin({value})") } else { value };
        match pick(self.rng, &self.helpers) {
            Helper::Near => match self.rng.u32(0..5) {
                0 => format!("near({value})"),
                1 => format!("near({value}, {})", self.float(depth)),
                2 => format!("near({value}, c=3)"),
                3 => format!("near({value}, 0.25, 3)"),
                _ => format!("near(b={}, a={value})", self.float(depth)),
            },
            Helper::Fold => format!("fold({value})"),
            Helper::Mixed => {
                pick(self.rng, &[format!("mixed({value})"), format!("mixed({value}, t=0.5)")])
            }
            Helper::Pair => format!("pair({value}, 0.5)[{}]", self.rng.u32(0..2)),
        }
    }

    fn condition(&mut self, depth: u32) -> String {
        let bounds = ["0.3183", "-0.577", "1.618", "0.07"];
        let compared = |writer: &mut Self| {
            let sign = pick(writer.rng, &["<", ">", "<=", ">="]);
            let left = writer.float(depth.min(1));
            format!("{left} {sign} {}", pick(writer.rng, &bounds))
        };
        match self.rng.u32(0..7) {
            0 => format!("{} and {}", compared(self), compared(self)),
            1 => format!("{} or {}", compared(self), compared(self)),
            2 => format!("not {}", compared(self)),
            3 => format!("-0.577 < {} <= 1.618", self.float(depth.min(1))),
            4 => format!("({})", compared(self)),
            5 if !self.flags.is_empty() => pick(self.rng, &self.flags),
            _ => compared(self),
        }
    }

    fn declaration(&mut self) {
        let value = self.float(2);
        if once_in(self.rng, 3) {
            let value = self.int(1);
            let name = self.new_name();
            self.line(&format!("{name} = {value}"));
            self.integers.push(name);
        } else {
            let name = self.new_name();
            self.line(&format!("{name} = {value}"));
            self.floats.push(name);
        }
    }

    fn simple(&mut self) {
        let Some(name) = self.target() else { return self.declaration() };
        match self.rng.u32(0..11) {
            0..=2 => {
                let sign = pick(self.rng, &["+=", "-=", "*=", "/=", "//=", "%=", "**="]);
                let sign = if self.in_loop && sign == "**=" { "+=" } else { sign };
                let value = match sign {
                    "*=" => format!("sin({})", self.float(1)),
                    "/=" | "//=" | "%=" => pick(self.rng, &["2", "1.75", "-1.5"]).to_owned(),
                    "**=" => "2".to_owned(),
                    _ => self.float(2),
                };
                self.line(&format!("{name} {sign} {value}"));
            }
            3 => {
                let Some(other) = self.target() else { return };
                let value = self.float(2);
                self.line(&format!("{name} = {other} = {value}"));
            }
            4 => {
                let Some(other) = self.target() else { return };
                if other != name {
                    self.line(&format!("{name}, {other} = {other}, {name}"));
                }
            }
            5 => {
                let Some(other) = self.target() else { return };
                if other != name {
                    let (one, two) = (self.float(1), self.float(1));
                    self.line(&format!("{name}, {other} = {one}, {two}"));
                }
            }
            6 if self.helpers.contains(&Helper::Pair) => {
                let Some(other) = self.target() else { return };
                if other != name {
                    let value = self.float(1);
                    self.line(&format!("{name}, {other} = pair({value}, {name})"));
                }
            }
            7 if !self.integers.is_empty() => {
                let integer = pick(self.rng, &self.integers);
                if !self.fixed.contains(&integer) {
                    let sign = pick(self.rng, &["+=", "-=", "*=", "//=", "%="]);
                    let value = self.rng.u32(1..4);
                    self.line(&format!("{integer} {sign} {value}"));
                }
            }
            9 => {
                let value = self.condition(2);
                let name = format!("b{}", self.names);
                self.names += 1;
                self.line(&format!("{name} = {value}"));
                self.line(&format!("{name} = not {name}"));
                self.flags.push(name);
            }
            8 => {
                let (one, two) = (self.float(1), self.float(1));
                self.line(&format!("{name} = {one}; {name} += {two}"));
            }
            _ => {
                let value = self.float(2);
                self.line(&format!("{name} = {value}"));
            }
        }
    }

    fn block(&mut self, depth: u32) {
        let known = (self.floats.len(), self.integers.len(), self.flags.len());
        self.depth += 1;
        self.simple();
        let name = pick(self.rng, &["d0", "d0", "pass"]);
        if name == "pass" {
            self.line("pass");
        } else {
            // A block has a statement in any case.
            let value = self.float(1);
            self.line(&format!("{name} = {value}"));
        }
        for _ in 0..self.rng.u32(0..3) {
            self.statement(depth);
        }
        if self.in_loop && once_in(self.rng, 3) {
            let condition = self.condition(1);
            let word = pick(self.rng, &["break", "continue"]);
            self.line(&format!("if {condition}:"));
            self.line(&format!("    {word}"));
            self.simple();
        }
        self.depth -= 1;
        // Variables that only this block assigns may have no value after it.
        self.floats.truncate(known.0);
        self.integers.truncate(known.1);
        self.flags.truncate(known.2);
    }

    fn statement(&mut self, depth: u32) {
        if depth == 0 {
            return self.simple();
        }
        let inner = depth - 1;
        match self.rng.u32(0..12) {
            0 | 1 => self.declaration(),
            2 | 3 => {
                let condition = self.condition(1);
                self.line(&format!("if {condition}:"));
                self.block(inner);
                if once_in(self.rng, 3) {
                    let condition = self.condition(1);
                    self.line(&format!("elif {condition}:"));
                    self.block(inner);
                }
                if self.rng.bool() {
                    self.line("else:");
                    self.block(inner);
                }
            }
            4 | 5 => {
                let index = format!("i{}", self.names);
                self.names += 1;
                let range = pick(
                    self.rng,
                    &["range(3)", "range(1, 4)", "range(3, 0, -1)", "(2, 1)", "[1, 3, 2]"],
                );
                self.line(&format!("for {index} in {range}:"));
                self.loop_body(index, inner);
            }
            6 => {
                let index = format!("i{}", self.names);
                self.names += 1;
                let value = self.rng.u32(1..4);
                self.line(&format!("{index} = {value}"));
                self.line(&format!("while {index} > 0:"));
                self.line(&format!("    {index} -= 1"));
                self.loop_body(index, inner);
            }
            7 => {
                let condition = self.condition(1);
                let value = self.float(2);
                self.line(&format!("if {condition}:"));
                self.line(&format!("    return {value}"));
            }
            8 => {
                let Some(name) = self.target() else { return };
                let (condition, value) = (self.condition(1), self.float(1));
                self.line(&format!("if {condition}: {name} = {value}"));
            }
            _ => self.simple(),
        }
    }

    fn loop_body(&mut self, index: String, depth: u32) {
        self.fixed.push(index.clone());
        self.integers.push(index);
        let before = std::mem::replace(&mut self.in_loop, true);
        self.block(depth);
        self.in_loop = before;
        self.integers.pop();
        if once_in(self.rng, 3) {
            self.line("else:");
            let before = std::mem::replace(&mut self.in_loop, false);
            self.block(0);
            self.in_loop = before;
        }
    }
}
