//! Random shaders: a function `map` of a point, helper functions, and global variables.
//!
//! GLSL leaves open whether `a + a++` reads the old or the new `a`. So no expression writes a
//! variable that it read before, unless an operator such as `&&` or a comma is between.

use super::{once_in, pick};
use crate::random::Rng;
use std::collections::BTreeSet;

/// Type of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Float,
    Int,
    Bool,
    Vec2,
    Vec3,
}

impl Kind {
    fn name(self) -> &'static str {
        match self {
            Self::Float => "float",
            Self::Int => "int",
            Self::Bool => "bool",
            Self::Vec2 => "vec2",
            Self::Vec3 => "vec3",
        }
    }
}

#[derive(Clone, Debug)]
struct Variable {
    name: String,
    kind: Kind,
    /// True if no statement may assign it: a loop's counter, or a parameter of another function.
    is_fixed: bool,
}

/// A helper function.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Helper {
    /// `float grow(float a, inout float b)`
    Grow,
    /// `void turn(inout vec3 q, float s)`
    Turn,
    /// `float split(float a, out float b)`
    Split,
    /// `float fold(vec2 q)`, without effects
    Fold,
    /// `float count(float a)`, which changes a global variable
    Count,
    /// `float lit(float a)`, which reads that variable
    Lit,
    /// `void dim(float a)`, which changes that variable
    Dim,
    /// `int half(int a)`
    Half,
}

struct Writer<'r> {
    rng: &'r mut Rng,
    text: String,
    depth: usize,
    scopes: Vec<Vec<Variable>>,
    helpers: Vec<Helper>,
    /// Variables that the current expression read since its last sequence point.
    read: BTreeSet<String>,
    /// Number of variables so far, for their names.
    names: usize,
    loops: usize,
    /// True if an expression may have no effects.
    is_pure: bool,
}

const NAMES: [&str; 12] = ["d", "e", "s", "g", "k", "w", "q", "v", "c", "h", "m", "n"];

/// Returns a random shader.
pub(super) fn program(rng: &mut Rng) -> String {
    let mut writer = Writer {
        rng,
        text: String::new(),
        depth: 0,
        scopes: vec![Vec::new()],
        helpers: Vec::new(),
        read: BTreeSet::new(),
        names: 0,
        loops: 0,
        is_pure: false,
    };
    if once_in(writer.rng, 3) {
        writer.line("#define SQ(a) ((a)*(a))");
    }
    if once_in(writer.rng, 3) {
        writer.line("const int N = 7/2;");
        writer.add("N", Kind::Int, true);
    }
    if once_in(writer.rng, 3) {
        writer.line("float glow = 0.5;");
        writer.add("glow", Kind::Float, false);
        writer.line("float count(float a) { glow += 0.25; return a*glow; }");
        writer.helpers.push(Helper::Count);
        writer.line("float lit(float a) { return a - glow; }");
        writer.helpers.push(Helper::Lit);
        writer.line("void dim(float a) { glow *= 0.5; if (a > 0.07) return; glow += a; }");
        writer.helpers.push(Helper::Dim);
    }
    writer.write_helpers();
    writer.line("float map(vec3 p) {");
    writer.scopes.push(Vec::new());
    writer.add("p", Kind::Vec3, false);
    writer.depth = 1;
    writer.declaration();
    let count = writer.rng.u32(3..8);
    for _ in 0..count {
        writer.statement(2);
    }
    let value = writer.full(Kind::Float, 3);
    writer.line(&format!("return {value};"));
    writer.depth = 0;
    writer.line("}");
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
            self.helpers.push(Helper::Grow);
            self.line(
                "float grow(float a, inout float b) { b = b*0.5 + a; a += 1.; return a - b; }",
            );
        }
        if once_in(self.rng, 3) {
            self.helpers.push(Helper::Turn);
            self.line("void turn(inout vec3 q, float s) { if (q.x < s) return; q.xz = vec2(q.z, -q.x); q.y += s; }");
        }
        if once_in(self.rng, 3) {
            self.helpers.push(Helper::Split);
            self.line("float split(float a, out float b) { b = fract(a); return floor(a); }");
        }
        if once_in(self.rng, 3) {
            self.helpers.push(Helper::Half);
            self.line("int half_of(int a) { a -= 3; return a/2; }");
        }
        if once_in(self.rng, 3) {
            self.helpers.push(Helper::Fold);
            self.line(
                "float fold(vec2 q) { q = abs(q); if (q.x > q.y) q = q.yx; return q.y - 0.5*q.x; }",
            );
        }
    }

    fn add(&mut self, name: &str, kind: Kind, is_fixed: bool) {
        let scope = self.scopes.last_mut().expect("a scope");
        scope.push(Variable { name: name.to_owned(), kind, is_fixed });
    }

    /// A name for a new variable. Sometimes it hides a variable of an outer scope.
    fn new_name(&mut self) -> String {
        let own = |scopes: &[Vec<Variable>], name: &str| {
            scopes.last().expect("a scope").iter().any(|variable| variable.name == name)
        };
        if self.scopes.len() > 2 && once_in(self.rng, 2) {
            let index = self.rng.u32(1..self.scopes.len() as u32 - 1) as usize;
            let hidden = self.scopes[index].iter().filter(|variable| !variable.is_fixed);
            let hidden = hidden.map(|variable| variable.name.clone());
            let hidden: Vec<String> = hidden.collect();
            if !hidden.is_empty() {
                let name = pick(self.rng, &hidden);
                if !own(&self.scopes, &name) {
                    return name;
                }
            }
        }
        let name = NAMES[self.names % NAMES.len()];
        let round = self.names / NAMES.len();
        self.names += 1;
        if round == 0 { name.to_owned() } else { format!("{name}{round}") }
    }

    /// Visible variables of a kind.
    fn visible(&self, kind: Kind, is_target: bool) -> Vec<String> {
        let mut seen = BTreeSet::new();
        let mut found = Vec::new();
        for variable in self.scopes.iter().rev().flat_map(|scope| scope.iter().rev()) {
            if seen.insert(&variable.name)
                && variable.kind == kind
                && !(is_target && variable.is_fixed)
            {
                found.push(variable.name.clone());
            }
        }
        found
    }

    /// A variable that may be written without having been read.
    fn target(&mut self, kind: Kind) -> Option<String> {
        let all = self.visible(kind, true);
        let free: Vec<String> = all.into_iter().filter(|name| !self.read.contains(name)).collect();
        (!free.is_empty()).then(|| pick(self.rng, &free))
    }

    fn use_of(&mut self, kind: Kind) -> Option<String> {
        let all = self.visible(kind, false);
        if all.is_empty() {
            return None;
        }
        let name = pick(self.rng, &all);
        self.read.insert(name.clone());
        Some(name)
    }

    /// A full expression, which begins after a sequence point.
    fn full(&mut self, kind: Kind, depth: u32) -> String {
        self.read.clear();
        self.expression(kind, depth)
    }

    fn expression(&mut self, kind: Kind, depth: u32) -> String {
        match kind {
            Kind::Float => self.float(depth),
            Kind::Int => self.int(depth),
            Kind::Bool => self.condition(depth),
            Kind::Vec2 | Kind::Vec3 => self.vector(kind, depth),
        }
    }

    fn leaf(&mut self) -> String {
        let literals = ["0.25", "0.5", "1.", "1.5", "2.0", ".75", "3.", "1e-1", "0.3183"];
        match self.rng.u32(0..6) {
            0 | 1 => self.use_of(Kind::Float).unwrap_or_else(|| "0.5".to_owned()),
            2 | 3 => {
                let kind = pick(self.rng, &[Kind::Vec3, Kind::Vec3, Kind::Vec2]);
                let letters: &[&str] =
                    if kind == Kind::Vec3 { &["x", "y", "z", "r", "g"] } else { &["x", "y"] };
                let letter = pick(self.rng, letters);
                match self.use_of(kind) {
                    Some(name) => format!("{name}.{letter}"),
                    None => "1.25".to_owned(),
                }
            }
            4 => {
                let name = self.use_of(Kind::Int);
                name.map_or_else(|| "0.125".to_owned(), |name| format!("float({name})"))
            }
            _ => pick(self.rng, &literals).to_owned(),
        }
    }

    fn float(&mut self, depth: u32) -> String {
        if depth == 0 {
            return self.leaf();
        }
        let inner = depth - 1;
        match self.rng.u32(0..20) {
            2 | 3 => {
                let sign = pick(self.rng, &["+", "-"]);
                format!("({} {sign} {})", self.float(inner), self.float(inner))
            }
            4 => format!("sin({})*{}", self.float(inner), self.float(inner)),
            5 => format!("{}/(abs({}) + 1.5)", self.float(inner), self.float(inner)),
            6 => {
                let name = pick(self.rng, &["sin", "cos", "abs", "-", "floor", "SQ"]);
                let name = if name == "SQ" && !self.text.contains("SQ") { "abs" } else { name };
                if name == "SQ" {
                    // The macro writes its argument twice.
                    let (pure, before) = (self.is_pure, self.read.clone());
                    self.is_pure = true;
                    let text = format!("SQ({})", self.float(inner.min(1)));
                    self.is_pure = pure;
                    self.read.extend(before);
                    return text;
                }
                format!("{name}({})", self.float(inner))
            }
            7 => {
                let name = pick(self.rng, &["min", "max", "mod", "step"]);
                let (a, b) = (self.float(inner), self.float(inner));
                let b = if name == "mod" { "1.75".to_owned() } else { b };
                format!("{name}({a}, {b})")
            }
            8 => format!("clamp({}, -1., {})", self.float(inner), pick(self.rng, &["1.", "2.5"])),
            9 => {
                let (a, b) = (self.float(inner), self.float(inner));
                format!("mix({a}, {b}, {})", pick(self.rng, &["0.25", "0.5", "0.75"]))
            }
            10 => {
                let kind = pick(self.rng, &[Kind::Vec2, Kind::Vec3]);
                match self.rng.u32(0..2) {
                    0 => format!("length({})", self.vector(kind, inner)),
                    _ => format!(
                        "dot({}, {})*0.25",
                        self.vector(kind, inner),
                        self.vector(kind, inner)
                    ),
                }
            }
            11 => self.ternary(Kind::Float, inner),
            12 => format!("float({})", self.int(inner)),
            13 => self.call(inner).unwrap_or_else(|| self.leaf()),
            14 | 15 => self.effect(inner).unwrap_or_else(|| self.leaf()),
            16 if !self.is_pure => self.comma(inner),
            17 => {
                format!("{}.{}", self.vector(Kind::Vec3, inner), pick(self.rng, &["x", "y", "z"]))
            }
            18 => format!("float({})", self.condition(inner)),
            _ => self.leaf(),
        }
    }

    /// An assignment as an expression.
    fn effect(&mut self, depth: u32) -> Option<String> {
        if self.is_pure {
            return None;
        }
        let name = self.target(Kind::Float)?;
        Some(match self.rng.u32(0..6) {
            0 => format!("{name}++"),
            1 => format!("--{name}"),
            2 | 3 => {
                let sign = pick(self.rng, &["+=", "-=", "*="]);
                self.read.insert(name.clone());
                let value = self.float(depth);
                format!("({name} {sign} {value})")
            }
            4 => {
                let vector = self.target(Kind::Vec3)?;
                let value = self.float(depth);
                format!("({vector}.{} = {value})", pick(self.rng, &["x", "y", "z"]))
            }
            _ => format!("({name} = {})", self.float(depth)),
        })
    }

    fn comma(&mut self, depth: u32) -> String {
        let before = self.read.clone();
        let first = self.effect(depth).unwrap_or_else(|| self.leaf());
        // The comma is a sequence point for variables read after the bracket.
        let between = std::mem::replace(&mut self.read, before);
        let second = self.float(depth);
        self.read.extend(between);
        format!("({first}, {second})")
    }

    fn ternary(&mut self, kind: Kind, depth: u32) -> String {
        let condition = self.condition(depth);
        let yes = self.expression(kind, depth);
        let no = self.expression(kind, depth);
        format!("({condition} ? {yes} : {no})")
    }

    fn condition(&mut self, depth: u32) -> String {
        let compared = |writer: &mut Self| {
            let sign = pick(writer.rng, &["<", ">", "<=", ">="]);
            let effect = if once_in(writer.rng, 4) { writer.effect(1) } else { None };
            let left = effect.unwrap_or_else(|| writer.float(depth.min(2)));
            format!("{left} {sign} {}", pick(writer.rng, &["0.3183", "-0.577", "1.618", "0.07"]))
        };
        match self.rng.u32(0..6) {
            0 => format!("({} && {})", compared(self), compared(self)),
            1 => format!("({} || {})", compared(self), compared(self)),
            2 => format!("(!({}))", compared(self)),
            3 => self.use_of(Kind::Bool).unwrap_or_else(|| "true".to_owned()),
            _ => format!("({})", compared(self)),
        }
    }

    fn int(&mut self, depth: u32) -> String {
        let literal = self.rng.u32(1..6).to_string();
        if depth == 0 {
            return self.use_of(Kind::Int).unwrap_or(literal);
        }
        let inner = depth - 1;
        match self.rng.u32(0..8) {
            0 => format!("({} + {})", self.int(inner), self.int(inner)),
            1 => format!("({} - {literal})", self.int(inner)),
            2 => format!("{}*{literal}", self.int(0)),
            3 => format!("({}/{literal})", self.int(inner)),
            4 => {
                let name = self.use_of(Kind::Int);
                name.map_or(literal.clone(), |name| format!("(({name}*{name}) % {literal})"))
            }
            5 if !self.is_pure => match self.target(Kind::Int) {
                Some(name) => pick(self.rng, &[format!("{name}++"), format!("--{name}")]),
                None => literal,
            },
            _ => self.use_of(Kind::Int).unwrap_or(literal),
        }
    }

    fn vector(&mut self, kind: Kind, depth: u32) -> String {
        let is_three = kind == Kind::Vec3;
        let name = kind.name();
        if depth == 0 {
            return self.use_of(kind).unwrap_or_else(|| format!("{name}(0.5)"));
        }
        let inner = depth - 1;
        match self.rng.u32(0..10) {
            0 => {
                let (x, y) = (self.float(inner), self.float(inner));
                if is_three {
                    format!("vec3({x}, {y}, {})", self.float(inner))
                } else {
                    format!("vec2({x}, {y})")
                }
            }
            1 => format!("({} + {})", self.vector(kind, inner), self.vector(kind, inner)),
            2 => format!("abs({})", self.vector(kind, inner)),
            3 => format!("({}*{})", self.vector(kind, 0), pick(self.rng, &["0.5", "1.5", "-1."])),
            4 if is_three => match self.use_of(Kind::Vec3) {
                Some(name) => format!("{name}.{}", pick(self.rng, &["zxy", "xxy", "yzx"])),
                None => "vec3(1., 2., 3.)".to_owned(),
            },
            4 => match self.use_of(Kind::Vec3) {
                Some(name) => format!("{name}.{}", pick(self.rng, &["xy", "zx", "yy"])),
                None => "vec2(1., 2.)".to_owned(),
            },
            5 => format!("mod({}, 1.75)", self.vector(kind, inner)),
            6 if !self.is_pure => match self.target(kind) {
                Some(target) => format!("({target} = {})", self.vector(kind, inner)),
                None => self.vector(kind, 0),
            },
            7 if !is_three => {
                let turn = pick(self.rng, &["mat2(0.5, 0.25, -0.5, 1.)", "mat2(0., 1., -1., 0.)"]);
                let vector = self.vector(kind, inner);
                let both = [format!("({turn}*{vector})"), format!("({vector}*{turn})")];
                pick(self.rng, &both)
            }
            8 => self.ternary(kind, inner),
            _ => self.vector(kind, 0),
        }
    }

    /// A call of a helper.
    fn call(&mut self, depth: u32) -> Option<String> {
        let helper =
            if self.helpers.is_empty() { None } else { Some(pick(self.rng, &self.helpers)) };
        match helper? {
            Helper::Half => Some(format!("float(half_of({})/3)", self.int(depth))),
            Helper::Lit if !self.is_pure => {
                let value = self.float(depth);
                self.read.insert("glow".to_owned());
                Some(format!("lit({value})"))
            }
            Helper::Fold => Some(format!("fold({})", self.vector(Kind::Vec2, depth))),
            _ if self.is_pure => None,
            Helper::Grow => {
                let value = self.float(depth);
                let target = self.target(Kind::Float)?;
                Some(format!("grow({value}, {target})"))
            }
            Helper::Split => {
                let value = self.float(depth);
                let target = self.target(Kind::Float)?;
                Some(format!("split({value}, {target})"))
            }
            Helper::Count if !self.read.contains("glow") => {
                let value = self.float(depth);
                if self.read.contains("glow") {
                    return Some(value);
                }
                Some(format!("count({value})"))
            }
            Helper::Count | Helper::Turn | Helper::Dim | Helper::Lit => None,
        }
    }

    fn declaration(&mut self) {
        let kind = pick(
            self.rng,
            &[Kind::Float, Kind::Float, Kind::Vec3, Kind::Vec2, Kind::Int, Kind::Bool],
        );
        let count = if once_in(self.rng, 3) { 2 } else { 1 };
        let mut parts = Vec::new();
        for _ in 0..count {
            let value = self.full(kind, 2);
            let name = self.new_name();
            // In `float d = d;` the name already means the new variable.
            let uses = value.split(|c: char| !c.is_alphanumeric()).any(|word| word == name);
            if uses {
                continue;
            }
            self.add(&name, kind, false);
            parts.push(format!("{name} = {value}"));
        }
        if !parts.is_empty() {
            let name = kind.name();
            self.line(&format!("{name} {};", parts.join(", ")));
        }
    }

    /// An assignment or another expression as a statement.
    fn simple(&mut self) -> Option<String> {
        self.read.clear();
        let kind = pick(self.rng, &[Kind::Float, Kind::Float, Kind::Float, Kind::Vec3, Kind::Vec2]);
        Some(match self.rng.u32(0..15) {
            0 => {
                let name = self.target(Kind::Float)?;
                pick(self.rng, &[format!("{name}++"), format!("--{name}")])
            }
            1..=3 => {
                let name = self.target(kind)?;
                self.read.insert(name.clone());
                let sign = pick(self.rng, &["+=", "-=", "*="]);
                let value = if sign == "*=" { Kind::Float } else { kind };
                let value = self.expression(value, 2);
                let value = if sign == "*=" { format!("sin({value})") } else { value };
                format!("{name} {sign} {value}")
            }
            4 => {
                // A chain, as in `s *= e = 2./dot(p, p)`.
                let first = self.target(Kind::Float)?;
                self.read.insert(first.clone());
                let second = self.target(Kind::Float)?;
                let sign = pick(self.rng, &["=", "+=", "*="]);
                format!("{first} {sign} {second} = {}", self.float(2))
            }
            5 => {
                let name = self.target(Kind::Vec3)?;
                let letters = pick(self.rng, &["xy", "zx", "yz"]);
                let value = self.vector(Kind::Vec2, 2);
                format!("{name}.{letters} = {value}")
            }
            6 => {
                let name = self.target(Kind::Vec3)?;
                let letters = pick(self.rng, &["xy", "zx", "yz"]);
                format!("{name}.{letters} *= mat2(0.75, 0.5, -0.5, 0.75)")
            }
            7 => {
                let name = self.target(Kind::Vec3)?;
                self.read.insert(name.clone());
                let letter = pick(self.rng, &["x", "y", "z"]);
                let sign = pick(self.rng, &["+=", "-=", "="]);
                let value = self.float(2);
                format!("{name}.{letter} {sign} {value}")
            }
            8 => {
                let (one, two) = (self.simple()?, self.simple()?);
                format!("{one}, {two}")
            }
            9 if self.helpers.contains(&Helper::Turn) => {
                let value = self.float(1);
                let target = self.target(Kind::Vec3)?;
                format!("turn({target}, {value})")
            }
            12 => {
                let name = self.target(Kind::Bool)?;
                format!("{name} = {}", self.condition(2))
            }
            13 if self.helpers.contains(&Helper::Dim) => {
                let value = self.float(1);
                format!("dim({value})")
            }
            10 => {
                let name = self.target(Kind::Int)?;
                let sign = pick(self.rng, &["+=", "-=", "*="]);
                format!("{name} {sign} 2")
            }
            11 => {
                let condition = self.condition(1);
                self.read.clear();
                let (yes, no) = (self.effect(1)?, self.effect(1)?);
                format!("{condition} ? {yes} : {no}")
            }
            _ => {
                let name = self.target(kind)?;
                format!("{name} = {}", self.expression(kind, 2))
            }
        })
    }

    fn block(&mut self, depth: u32, is_loop: bool) {
        self.scopes.push(Vec::new());
        self.depth += 1;
        let count = self.rng.u32(1..4);
        for _ in 0..count {
            self.statement(depth);
        }
        if is_loop && once_in(self.rng, 3) {
            let condition = self.full_condition();
            let word = pick(self.rng, &["break", "continue"]);
            self.line(&format!("if {condition} {word};"));
            self.statement(0);
        }
        self.depth -= 1;
        self.scopes.pop();
    }

    fn full_condition(&mut self) -> String {
        self.read.clear();
        let condition = self.condition(2);
        if condition.starts_with('(') { condition } else { format!("({condition})") }
    }

    fn statement(&mut self, depth: u32) {
        if depth == 0 {
            if let Some(line) = self.simple() {
                self.line(&format!("{line};"));
            }
            return;
        }
        let inner = depth - 1;
        match self.rng.u32(0..14) {
            0..=2 => self.declaration(),
            3 | 4 => {
                let condition = self.full_condition();
                self.line(&format!("if {condition} {{"));
                self.block(inner, false);
                if self.rng.bool() {
                    self.line("} else {");
                    self.block(inner, false);
                }
                self.line("}");
            }
            5 => {
                let condition = self.full_condition();
                if let (Some(yes), Some(no)) = (self.simple(), self.simple()) {
                    self.line(&format!("if {condition} {yes}; else {no};"));
                }
            }
            6 => {
                self.line("{");
                self.block(inner, false);
                self.line("}");
            }
            7 | 8 => self.counted_loop(inner),
            9 => {
                let name = format!("u{}", self.loops);
                self.loops += 1;
                let header = match self.rng.u32(0..3) {
                    0 => format!("while ({name}-- > 0)"),
                    1 => format!("while (({name} -= 1) >= 0)"),
                    _ => format!("for (; {name}-- > 0;)"),
                };
                let value = self.rng.u32(1..4);
                self.line(&format!("int {name} = {value};"));
                self.add(&name, Kind::Int, true);
                self.line(&format!("{header} {{"));
                self.block(inner, true);
                self.line("}");
            }
            10 if once_in(self.rng, 2) => {
                let condition = self.full_condition();
                let value = self.full(Kind::Float, 2);
                self.line(&format!("if {condition} return {value};"));
            }
            _ => {
                if let Some(line) = self.simple() {
                    self.line(&format!("{line};"));
                }
            }
        }
    }

    fn counted_loop(&mut self, depth: u32) {
        let name = format!("i{}", self.loops);
        let other = format!("j{}", self.loops);
        self.loops += 1;
        let count = self.rng.u32(1..4);
        self.read.clear();
        let effect = self.simple().unwrap_or_else(|| format!("{name} += 0"));
        let header = match self.rng.u32(0..7) {
            0 => format!("int {name} = 0; {name} < {count}; {name}++, {effect}"),
            1 => format!("int {name} = 0, {other} = 3; {name} < {other}; {name}++, {other}--"),
            2 => format!("float {name} = 0.; {name} < {count}.; {name} += 0.75"),
            3 => format!("int {name} = {count}; {name} > 0; {effect}, --{name}"),
            4 => format!("int {name} = 0; {name}++ < {count};"),
            5 if self.text.contains("const int N") => {
                format!("int {name} = N; {name} > 0; {name}--")
            }
            _ => format!("int {name} = 1; {name} <= {count}; {name} += 1"),
        };
        if once_in(self.rng, 5) {
            self.line(&format!("for ({header});"));
            return;
        }
        self.line(&format!("for ({header}) {{"));
        self.scopes.push(Vec::new());
        let kind = if header.starts_with("float") { Kind::Float } else { Kind::Int };
        self.add(&name, kind, true);
        self.block(depth, true);
        self.scopes.pop();
        self.line("}");
    }
}
