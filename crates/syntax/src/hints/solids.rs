//! Hints on solids of other systems: `OpenSCAD`, `JSCAD`, `CadQuery`, three.js and libfive. The
//! most common functions are rewritten as calls.

use super::pattern::pieces;
use super::{Mistake, Proposal};

/// Deepest nesting of solids that is rewritten.
const DEEPEST: usize = 20;

pub(super) fn proposals(mistake: &Mistake<'_>) -> Vec<Proposal> {
    let text = mistake.text;
    let mut all = Vec::new();
    let why = "solids are joined and moved by functions, and a box has half sizes";
    let listed = scheme(text.trim());
    all.extend(listed.map(|solid| Proposal::text(why, format!("{solid} <= 0"))));
    let is_program = text.contains('{') || text.contains("new ") || text.contains("_extrude");
    let words = ["for (", "Workplane", "translate([", "rotate([", "scale([", "cube(", "square("];
    let is_program = is_program || words.iter().any(|word| text.contains(word));
    if !is_program {
        return all;
    }
    let mut reader = Reader::new(text);
    let modules = reader.modules();
    if let Some(solids) = reader.children(0)
        && reader.at == reader.pieces.len()
        && !solids.is_empty()
    {
        all.push(Proposal::text(why, format!("{modules}{} <= 0", union(&solids))));
    }
    all
}

/// `(move (sphere 1) [0 0 1])` of libfive as `move(sphere(1), (0, 0, 1))`.
fn scheme(line: &str) -> Option<String> {
    let spaced =
        line.replace('(', " ( ").replace(')', " ) ").replace('[', " [ ").replace(']', " ] ");
    let mut words = spaced.split_whitespace();
    let first = words.next().filter(|first| *first == "(")?;
    let value = list(first, &mut words, 0)?;
    words.next().is_none().then_some(value)
}

/// A value of libfive whose first word is `first`, in the notation of this language.
fn list<'a>(
    first: &'a str,
    words: &mut impl Iterator<Item = &'a str>,
    depth: usize,
) -> Option<String> {
    let close = match first {
        "(" => ")",
        "[" | "#[" => "]",
        word => return Some(word.to_owned()),
    };
    if depth > DEEPEST {
        return None;
    }
    let mut values = Vec::new();
    loop {
        match words.next()? {
            word if word == close => break,
            word => values.push(list(word, words, depth + 1)?),
        }
    }
    if close == "]" {
        return Some(format!("({})", values.join(", ")));
    }
    let (name, values) = values.split_first()?;
    if matches!(name.as_str(), "+" | "-" | "*" | "/") {
        return Some(format!("({})", values.join(&format!(" {name} "))));
    }
    let starts = name.starts_with(char::is_alphabetic) && !values.is_empty();
    let name = match name.as_str() {
        "difference" => "subtract",
        "intersection" => "intersect",
        "move" => "translate",
        "box" | "box-exact" => return box_of_corners(values),
        other => other,
    };
    starts.then(|| format!("{name}({})", values.join(", ")))
}

/// libfive's box between two corners.
fn box_of_corners(corners: &[String]) -> Option<String> {
    let numbers = |corner: &String| -> Option<Vec<f64>> {
        let list = corner.strip_prefix('(')?.strip_suffix(')')?;
        list.split(", ").map(|number| number.parse().ok()).collect()
    };
    let [low, high] = corners else { return None };
    let ends: Vec<(f64, f64)> = numbers(low)?.into_iter().zip(numbers(high)?).collect();
    let list = |of: fn(&(f64, f64)) -> f64| {
        ends.iter().map(|pair| of(pair).to_string()).collect::<Vec<_>>().join(", ")
    };
    let (half, center) =
        (list(|(low, high)| (high - low) / 2.0), list(|(low, high)| f64::midpoint(*low, *high)));
    (ends.len() == 3).then(|| format!("translate(box({half}), {center})"))
}

/// The union of some solids.
fn union(solids: &[String]) -> String {
    match solids {
        [only] => only.clone(),
        all => format!("union({})", all.join(", ")),
    }
}

/// The arguments of a call: their names, which may be empty, and values.
type Arguments = Vec<(String, String)>;

/// Reads a program of solids.
struct Reader<'a> {
    text: &'a str,
    pieces: Vec<&'a str>,
    at: usize,
}

impl<'a> Reader<'a> {
    fn new(text: &'a str) -> Self {
        Self { text, pieces: pieces(text).into_iter().map(|piece| &text[piece]).collect(), at: 0 }
    }

    fn peek(&self) -> &'a str {
        self.pieces.get(self.at).copied().unwrap_or("")
    }

    fn take(&mut self, piece: &str) -> bool {
        let is_next = self.peek() == piece;
        self.at += usize::from(is_next);
        is_next
    }

    /// Reads the modules at the start of the text, as definitions.
    fn modules(&mut self) -> String {
        let mut all = String::new();
        while self.peek() == "module" {
            let start = self.at;
            self.at += 1;
            let module = self.module();
            let Some(module) = module else {
                self.at = start;
                break;
            };
            all += &module;
        }
        all
    }

    fn module(&mut self) -> Option<String> {
        let name = self.peek();
        self.at += 1;
        let parameters: Vec<String> = self
            .arguments()?
            .into_iter()
            .map(|(name, value)| if name.is_empty() { value } else { name })
            .collect();
        let body = if self.take("{") { self.block(1)? } else { vec![self.solid(1)?] };
        let parameters = parameters.join(", ");
        Some(format!("{name}({parameters}) = {}\n", union(&body)))
    }

    /// The solids up to the end of the text or a closing brace.
    fn children(&mut self, depth: usize) -> Option<Vec<String>> {
        let mut all = Vec::new();
        while self.at < self.pieces.len() && self.peek() != "}" {
            if self.take(";") || self.take(",") {
                continue;
            }
            all.push(self.solid(depth)?);
        }
        Some(all)
    }

    fn block(&mut self, depth: usize) -> Option<Vec<String>> {
        let all = self.children(depth + 1)?;
        self.take("}").then_some(all)
    }

    /// The solids that a call applies to: those in braces, or the next one.
    fn operands(&mut self, depth: usize) -> Option<Vec<String>> {
        if self.take("{") { self.block(depth) } else { Some(vec![self.solid(depth + 1)?]) }
    }

    /// The arguments in brackets. Those in braces have names, too.
    fn arguments(&mut self) -> Option<Arguments> {
        if !self.take("(") {
            return None;
        }
        let is_object = self.take("{");
        let mut all = Arguments::new();
        let (mut name, mut value, mut depth) = (String::new(), String::new(), 0_usize);
        loop {
            let piece = self.pieces.get(self.at)?;
            self.at += 1;
            match *piece {
                ")" | "}" | "," if depth == 0 => {
                    if !value.is_empty() {
                        all.push((std::mem::take(&mut name), std::mem::take(&mut value)));
                    }
                    match *piece {
                        "," => {}
                        "}" => {
                            all.push(("center".to_owned(), "true".to_owned()));
                            return self.take(")").then_some(all);
                        }
                        _ if is_object => return None,
                        _ => return Some(all),
                    }
                }
                "=" | ":" if depth == 0 => name = std::mem::take(&mut value),
                piece => {
                    depth += usize::from(matches!(piece, "(" | "[" | "{"));
                    depth = depth.checked_sub(usize::from(matches!(piece, ")" | "]" | "}")))?;
                    value += piece;
                }
            }
        }
    }

    /// One solid as a formula.
    fn solid(&mut self, depth: usize) -> Option<String> {
        if depth > DEEPEST {
            return None;
        }
        for word in ["new", "const", "return", "#", "%"] {
            self.take(word);
        }
        // `THREE.SphereGeometry` and `cq.Workplane("XY").box(…)`.
        while matches!(self.pieces.get(self.at + 1), Some(&".")) {
            self.at += 2;
        }
        let name = self.peek();
        self.at += 1;
        if name == "for" {
            return self.copies(depth);
        }
        if name == "Workplane" {
            self.arguments()?;
            return self.workplane();
        }
        let start = self.at;
        if let Some(solids) = self.functional(name, depth) {
            return Some(solids);
        }
        self.at = start;
        let arguments = self.arguments()?;
        if let Some(primitive) = primitive(name, &arguments) {
            return Some(primitive);
        }
        if self.text.contains(&format!("module {name}")) {
            let values: Vec<&str> = arguments.iter().map(|(_, value)| value.as_str()).collect();
            return Some(format!("{name}({})", values.join(", ")));
        }
        let solids = self.operands(depth)?;
        applied(name, &arguments, &solids)
    }

    /// A call whose arguments are solids, as in JSCAD: `subtract(cube({size: 3}), sphere(1))`.
    fn functional(&mut self, name: &str, depth: usize) -> Option<String> {
        let is_joint =
            matches!(name, "subtract" | "union" | "intersect" | "difference" | "intersection");
        if !is_joint || !self.take("(") || self.peek() == ")" {
            return None;
        }
        let mut solids = Vec::new();
        while !self.take(")") {
            solids.push(self.solid(depth + 1)?);
            self.take(",");
        }
        applied(name, &Arguments::new(), &solids)
    }

    /// `for (i = [0:5]) translate([i*3, 0, 0]) sphere(1);` as copies in a row.
    fn copies(&mut self, depth: usize) -> Option<String> {
        let arguments = self.arguments()?;
        let [(name, range)] = arguments.as_slice() else { return None };
        let ends: Vec<f64> = range
            .trim_matches(['[', ']'])
            .split(':')
            .map(str::parse)
            .collect::<Result<_, _>>()
            .ok()?;
        let (count, step) = match ends.as_slice() {
            [low, high] => (high - low + 1.0, 1.0),
            [low, step, high] => (((high - low) / step).floor() + 1.0, *step),
            _ => return None,
        };
        let in_braces = self.take("{");
        if !self.take("translate") {
            return None;
        }
        let moved = self.arguments()?;
        let solid = union(&self.operands(depth)?);
        if in_braces && !(self.take(";") | true && self.take("}")) {
            return None;
        }
        let parts: Vec<String> = moved
            .first()?
            .1
            .trim_matches(['[', ']'])
            .split(',')
            .map(|part| {
                let factor: String = part.split('*').filter(|factor| factor != name).collect();
                match (part.contains(name.as_str()), factor.parse::<f64>()) {
                    (false, _) => "0".to_owned(),
                    (true, Ok(factor)) => (factor * step).to_string(),
                    (true, Err(_)) if part == name => step.to_string(),
                    (true, Err(_)) => factor,
                }
            })
            .collect();
        Some(format!("repeat({solid}, ({}), {count})", parts.join(", ")))
    }

    /// The chain of calls after `CadQuery`'s `Workplane("XY")`.
    fn workplane(&mut self) -> Option<String> {
        let mut solid: Option<String> = None;
        let mut height = "1".to_owned();
        while self.take(".") {
            let name = self.peek();
            self.at += 1;
            let arguments = self.arguments()?;
            let value = |at: usize| arguments.get(at).map(|(_, value)| value.as_str());
            solid = match (name, solid) {
                ("box", None) => {
                    value(2)?.clone_into(&mut height);
                    let [a, b, c] = [half(value(0)?), half(value(1)?), half(value(2)?)];
                    Some(format!("box({a}, {b}, {c})"))
                }
                ("sphere", None) => Some(format!("sphere({})", value(0)?)),
                ("cylinder", None) => Some(format!("cylinder({}, {})", value(1)?, half(value(0)?))),
                ("circle", None) => Some(format!("circle({})", value(0)?)),
                ("rect", None) => {
                    Some(format!("rectangle({}, {})", half(value(0)?), half(value(1)?)))
                }
                ("extrude", Some(solid)) => Some(format!("extrude({solid}, {})", half(value(0)?))),
                ("hole", Some(solid)) => {
                    Some(format!("subtract({solid}, cylinder({}, {height}))", half(value(0)?)))
                }
                ("faces" | "workplane" | "edges" | "vertices", solid) => solid,
                _ => return None,
            };
        }
        solid
    }
}

/// The half of a value, as a number if the value is one.
fn half(value: &str) -> String {
    value
        .parse::<f64>()
        .map_or_else(|_| format!("({value})/2"), |number| (number / 2.0).to_string())
}

/// A solid without operands.
fn primitive(name: &str, arguments: &Arguments) -> Option<String> {
    let named = |names: &[&str]| {
        let found = arguments.iter().find(|(name, _)| names.contains(&name.as_str()));
        found.map(|(_, value)| value.clone())
    };
    let unnamed = |at: usize| {
        let mut all = arguments.iter().filter(|(name, _)| name.is_empty());
        all.nth(at).map(|(_, value)| value.clone())
    };
    let radius = |at: usize| {
        let diameter = || named(&["d", "diameter"]).map(|value| half(&value));
        named(&["r", "radius", "r1"]).or_else(diameter).or_else(|| unnamed(at))
    };
    let sizes = |value: &str| {
        let parts: Vec<String> = value.trim_matches(['[', ']']).split(',').map(half).collect();
        parts.join(", ")
    };
    // OpenSCAD begins at 0 otherwise.
    let is_centered = named(&["center"]).is_some_and(|center| center == "true");
    Some(match name {
        "sphere" | "SphereGeometry" | "Sphere" | "ball" => format!("sphere({})", radius(0)?),
        "circle" => format!("circle({})", radius(0)?),
        "cube" | "cuboid" => {
            let half = sizes(&named(&["size"]).or_else(|| unnamed(0))?);
            let solid = format!("box({half})");
            match half.contains(',') {
                _ if is_centered => solid,
                true => format!("translate({solid}, {half})"),
                false => format!("translate({solid}, {half}, {half}, {half})"),
            }
        }
        "square" => {
            let size = named(&["size"]).or_else(|| unnamed(0))?;
            match sizes(&size) {
                both if both.contains(',') => format!("rectangle({both})"),
                one => format!("rectangle({one}, {one})"),
            }
        }
        "BoxGeometry" | "Box" => {
            let all = [unnamed(0)?, unnamed(1)?, unnamed(2)?].map(|size| half(&size));
            format!("box({})", all.join(", "))
        }
        "cylinder" => {
            let height = named(&["h", "height"]).or_else(|| unnamed(0))?;
            let half = half(&height);
            let solid = format!("cylinder({}, {half})", radius(1)?);
            if is_centered { solid } else { format!("translate({solid}, 0, 0, {half})") }
        }
        "CylinderGeometry" => format!("cylinder({}, {})", unnamed(0)?, half(&unnamed(2)?)),
        "ConeGeometry" => format!("cone({}, {})", unnamed(0)?, half(&unnamed(1)?)),
        "TorusGeometry" | "torus" => format!("torus({}, {})", unnamed(0)?, unnamed(1)?),
        _ => return None,
    })
}

/// A solid that `name` makes of others.
fn applied(name: &str, arguments: &Arguments, solids: &[String]) -> Option<String> {
    let vector = || {
        let (_, value) = arguments.first()?;
        let list = value.strip_prefix('[')?.strip_suffix(']')?;
        let mut parts: Vec<&str> = list.split(',').collect();
        parts.resize(3, "0");
        Some(parts.join(", "))
    };
    let number = |names: &[&str]| {
        let found = arguments.iter().find(|(name, _)| names.contains(&name.as_str()));
        found.or(arguments.first()).map(|(_, value)| value.as_str())
    };
    let all = union(solids);
    Some(match (name, solids) {
        ("union" | "group" | "color" | "render" | "resize" | "convexity", _) => all,
        ("difference" | "subtract", [first, rest @ ..]) if !rest.is_empty() => {
            format!("subtract({first}, {})", union(rest))
        }
        ("intersection" | "intersect", _) => format!("intersect({})", solids.join(", ")),
        ("translate", _) => format!("translate({all}, {})", vector()?),
        ("scale", _) => match vector() {
            Some(vector) => format!("scale({all}, {vector})"),
            None => format!("scale({all}, {})", number(&["v"])?),
        },
        ("mirror", _) => format!("mirror({all}, {})", vector()?),
        ("rotate", _) => match vector() {
            None => format!("rotate({all}, {}°)", number(&["a"])?),
            Some(angles) => {
                let axes = ["(1, 0, 0)", "(0, 1, 0)", "(0, 0, 1)"];
                let turned = angles.split(", ").zip(axes).filter(|(angle, _)| *angle != "0");
                turned.fold(all, |all, (angle, axis)| format!("rotate({all}, {angle}°, {axis})"))
            }
        },
        ("linear_extrude", _) => format!("extrude({all}, {})", half(number(&["height"])?)),
        ("rotate_extrude", [only]) => {
            match only.strip_prefix("translate(").and_then(|rest| rest.rsplit_once(", ")) {
                Some((rest, "0)")) => {
                    let (rest, _) = rest.rsplit_once(", ")?;
                    let (shape, radius) = rest.rsplit_once(", ")?;
                    format!("revolve({shape}, {radius})")
                }
                _ => format!("revolve({only})"),
            }
        }
        ("minkowski", [first, ball]) => {
            format!("offset({first}, {})", ball.strip_prefix("sphere(")?.strip_suffix(')')?)
        }
        ("hull", [first, second]) => {
            let radius = first.strip_prefix("sphere(")?.strip_suffix(')')?;
            let moved = second.strip_prefix(&format!("translate(sphere({radius}), "))?;
            format!("capsule((0, 0, 0), ({moved}, {radius})")
        }
        _ => return None,
    })
}
