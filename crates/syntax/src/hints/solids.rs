//! Hints on solids of other systems: `OpenSCAD`, JSCAD, `CadQuery`, three.js and libfive. The most
//! common functions are rewritten as calls. The calls give the same solid: a program with a word or
//! an argument that is not known here gets no line.

use super::pattern::pieces;
use super::{Mistake, Proposal};
use zeroset_parser::tree::scope::{NameMeaning, built_in, canonical};

/// Deepest nesting of solids that is rewritten.
const DEEPEST: usize = 20;
/// Largest number of copies that a loop may make.
const MOST_COPIES: usize = 24;
/// Least number of sides with which a circle of a program counts as round.
const ROUND: f64 = 24.0;

/// Signs and words of programs of solids.
#[rustfmt::skip] // in rows
const SIGNS: [&str; 11] = [
    "{", ";", "new ", "_extrude", "for (", "Workplane", "translate([", "rotate([", "scale([",
    "cube(", "square(",
];

/// Functions whose values differ in `OpenSCAD`: those of angles, since they take degrees, and
/// `log`. Signs that a value must not contain stand before them.
#[rustfmt::skip] // in rows
const UNLIKE: [&str; 16] = [
    "?", ":", "<", ">", "!", "&", "|", "%", "\"", "sin", "cos", "tan", "asin", "acos", "atan", "log",
];

/// Advice on a program of solids that has no line.
pub(super) fn unread(mistake: &Mistake<'_>) -> Option<String> {
    #[rustfmt::skip] // in rows
    const WORDS: [&str; 12] = [
        "module ", "linear_extrude", "rotate_extrude", "polyhedron(", "difference()", "union()",
        "intersection()", "minkowski()", "hull()", "$fn", "cube(", "translate([",
    ];
    WORDS.iter().any(|word| mistake.text.contains(word)).then(|| {
        "programs of solids are not run here; a solid is one formula, and calls join and move \
         solids, as in `subtract(box(2, 1, 1), translate(extrude(circle(0.5), 2), 1, 0, 0)) <= 0`"
            .to_owned()
    })
}

pub(super) fn proposals(mistake: &Mistake<'_>) -> Vec<Proposal> {
    let text = mistake.text;
    let mut all = Vec::new();
    let why = "solids are joined and moved by functions, and a box has half sizes";
    let listed = scheme(text.trim());
    all.extend(listed.map(|solid| Proposal::text(why, format!("{solid} <= 0"))));
    if !SIGNS.iter().any(|sign| text.contains(sign)) && !text.contains('=') {
        return all;
    }
    let mut reader = Reader::new(text);
    let solids = reader.program().filter(|(_, solids)| !solids.is_empty());
    all.extend(solids.map(|(definitions, solids)| {
        Proposal::text(why, format!("{definitions}{} <= 0", union(&solids)))
    }));
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

/// A solid moved by a vector, whose components are given.
fn translated(solid: &str, by: [&str; 3]) -> String {
    if by == ["0"; 3] { solid.to_owned() } else { format!("translate({solid}, {})", by.join(", ")) }
}

/// A solid that is centered if `center` is true, and is moved up by half its height otherwise.
fn raised(solid: String, half: &str, center: bool) -> String {
    if center { solid } else { translated(&solid, ["0", "0", half]) }
}

/// The half of a value, as a number if the value is one.
fn half(value: &str) -> String {
    value
        .parse::<f64>()
        .map_or_else(|_| format!("({value})/2"), |number| (number / 2.0).to_string())
}

/// The components of a list such as `[1, 2, 0]`.
fn components(list: &str) -> Option<Vec<&str>> {
    let inner = list.strip_prefix('[')?.strip_suffix(']')?;
    let is_flat = !inner.contains(['[', ']']) && inner.matches('(').count() < 2;
    is_flat.then(|| inner.split(',').collect())
}

/// The three components of a vector. Those that are missing are 0.
fn vector(list: &str) -> Option<[&str; 3]> {
    let mut parts = components(list)?;
    parts.resize(3, "0");
    parts.try_into().ok()
}

/// The arguments of a call, by name. Those without a name have an empty one.
#[derive(Clone, Default)]
struct Arguments(Vec<(String, String)>);

impl Arguments {
    /// Gives the names in `order` to the arguments without a name.
    fn in_order(mut self, order: &str) -> Option<Self> {
        let mut order = order.split_whitespace();
        for (name, _) in self.0.iter_mut().filter(|(name, _)| name.is_empty()) {
            order.next()?.clone_into(name);
        }
        Some(self)
    }

    /// Takes the value of the first of these names that is given.
    fn take(&mut self, names: &[&str]) -> Option<String> {
        let at = self.0.iter().position(|(name, _)| names.contains(&name.as_str()))?;
        Some(self.0.remove(at).1)
    }

    /// Takes a radius, or half of a diameter.
    fn radius(&mut self, radius: &[&str], diameter: &[&str]) -> Option<String> {
        self.take(radius).or_else(|| self.take(diameter).map(|value| half(&value)))
    }

    /// Takes whether the solid is centered.
    fn center(&mut self) -> Option<bool> {
        match self.take(&["center"]).as_deref() {
            None | Some("false") => Some(false),
            Some("true") => Some(true),
            Some(_) => None,
        }
    }

    /// Succeeds if all arguments that are left only say how fine a mesh is.
    fn end(self) -> Option<()> {
        let is_fine = |value: &str| value.parse().is_ok_and(|sides: f64| sides >= ROUND);
        let is_no_matter = |(name, value): &(String, String)| match name.as_str() {
            "convexity" | "$fa" | "$fs" | "rings" => true,
            "$fn" | "segments" => is_fine(value),
            _ => false,
        };
        self.0.iter().all(is_no_matter).then_some(())
    }
}

/// Reads a program of solids.
struct Reader<'a> {
    pieces: Vec<&'a str>,
    at: usize,
    /// Names of the modules.
    modules: Vec<&'a str>,
    /// The variables of the loops around the present place, with their values.
    loops: Vec<(&'a str, String)>,
}

impl<'a> Reader<'a> {
    fn new(text: &'a str) -> Self {
        let pieces = pieces(text).into_iter().map(|piece| &text[piece]).collect();
        Self { pieces, at: 0, modules: Vec::new(), loops: Vec::new() }
    }

    fn peek(&self) -> &'a str {
        self.pieces.get(self.at).copied().unwrap_or("")
    }

    fn take(&mut self, piece: &str) -> bool {
        let is_next = self.peek() == piece;
        self.at += usize::from(is_next);
        is_next
    }

    /// Reads the whole program: its definitions, as lines, and its solids.
    fn program(&mut self) -> Option<(String, Vec<String>)> {
        let (mut definitions, mut solids) = (String::new(), Vec::new());
        while self.at < self.pieces.len() {
            if self.take("module") {
                definitions += &self.module()?;
            } else if self.pieces.get(self.at + 1) == Some(&"=") || self.peek() == "$" {
                definitions += &self.assignment()?;
            } else {
                self.statement(0, &mut solids)?;
            }
        }
        Some((definitions, solids))
    }

    /// Reads an assignment, as a definition. The text is empty if it only says how fine a mesh is.
    fn assignment(&mut self) -> Option<String> {
        let is_special = self.take("$");
        let name = self.peek();
        self.at += 1;
        if !self.take("=") {
            return None;
        }
        let mut value = String::new();
        while !self.take(";") {
            value += self.pieces.get(self.at)?;
            self.at += 1;
        }
        if is_special {
            Arguments(vec![(format!("${name}"), value)]).end()?;
            return Some(String::new());
        }
        (is_free(name) && is_alike(&value)).then(|| format!("{name} = {value}\n"))
    }

    fn module(&mut self) -> Option<String> {
        let name = self.peek();
        self.at += 1;
        self.modules.push(name);
        let parameters = self.arguments()?.0;
        // The functions of this language have no default values.
        let parameters = parameters
            .into_iter()
            .map(|(name, value)| (name.is_empty() && is_free(&value)).then_some(value));
        let parameters: Vec<String> = parameters.collect::<Option<_>>()?;
        let body = union(&self.operands(1)?);
        Some(format!("{name}({}) = {body}\n", parameters.join(", ")))
    }

    /// Reads a statement, and adds its solid.
    fn statement(&mut self, depth: usize, solids: &mut Vec<String>) -> Option<()> {
        if self.take(";") || self.take(",") {
            return Some(());
        }
        // These are seen in a preview at most.
        let is_left_out = self.take("%") || self.take("*");
        self.take("#");
        let solid = self.solid(depth)?;
        solids.extend(Some(solid).filter(|_| !is_left_out));
        Some(())
    }

    /// The solids that a call applies to: those in braces, or the next one.
    fn operands(&mut self, depth: usize) -> Option<Vec<String>> {
        if !self.take("{") {
            return Some(vec![self.solid(depth + 1)?]);
        }
        let mut all = Vec::new();
        while !self.take("}") {
            self.pieces.get(self.at)?;
            self.statement(depth + 1, &mut all)?;
        }
        (!all.is_empty()).then_some(all)
    }

    /// The arguments in brackets. Those in braces have names, too, and their solids are centered.
    fn arguments(&mut self) -> Option<Arguments> {
        if !self.take("(") {
            return None;
        }
        let is_object = self.take("{");
        let mut all = Vec::new();
        let (mut name, mut value, mut depth) = (String::new(), String::new(), 0_usize);
        loop {
            let piece = *self.pieces.get(self.at)?;
            self.at += 1;
            match piece {
                ")" | "}" | "," if depth == 0 => {
                    if !value.is_empty() {
                        let is_text = name.is_empty() && value.starts_with('"');
                        (is_text || is_alike(&value)).then_some(())?;
                        all.push((std::mem::take(&mut name), std::mem::take(&mut value)));
                    }
                    match piece {
                        "," => {}
                        "}" => {
                            all.push(("center".to_owned(), "true".to_owned()));
                            return self.take(")").then_some(Arguments(all));
                        }
                        _ if is_object => return None,
                        _ => return Some(Arguments(all)),
                    }
                }
                "=" | ":" if depth == 0 => name = std::mem::take(&mut value),
                piece => {
                    depth += usize::from(matches!(piece, "(" | "[" | "{"));
                    depth = depth.checked_sub(usize::from(matches!(piece, ")" | "]" | "}")))?;
                    let bound = self.loops.iter().rev().find(|(name, _)| *name == piece);
                    value += bound.map_or(piece, |(_, value)| value);
                }
            }
        }
    }

    /// One solid as a formula.
    fn solid(&mut self, depth: usize) -> Option<String> {
        if depth > DEEPEST {
            return None;
        }
        self.take("new");
        self.take("return");
        // `THREE.SphereGeometry` and `cq.Workplane("XY").box(…)`.
        while matches!(self.pieces.get(self.at + 1), Some(&".")) {
            self.at += 2;
        }
        let name = self.peek();
        self.at += 1;
        match name {
            "for" => return self.copies(depth),
            "Workplane" => return self.workplane(),
            _ => {}
        }
        let start = self.at;
        if let Some(solids) = self.functional(name, depth) {
            return Some(solids);
        }
        self.at = start;
        let arguments = self.arguments()?;
        if self.modules.contains(&name) {
            let is_plain = arguments.0.iter().all(|(name, _)| name.is_empty());
            let values: Vec<&str> = arguments.0.iter().map(|(_, value)| value.as_str()).collect();
            return is_plain.then(|| format!("{name}({})", values.join(", ")));
        }
        if let Some(order) = order_of(PRIMITIVES, name) {
            return primitive(name, arguments.in_order(order)?);
        }
        let solids = self.operands(depth)?;
        applied(name, arguments.in_order(order_of(MOVES, name).unwrap_or_default())?, &solids)
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
        applied(name, Arguments::default(), &solids)
    }

    /// `for (i = [0:5]) translate([i*3, 0, 0]) sphere(1);` as copies in a row, other loops as a
    /// union.
    fn copies(&mut self, depth: usize) -> Option<String> {
        if !self.take("(") {
            return None;
        }
        let name = self.peek();
        self.at += 1;
        let values = self.loop_values()?;
        let start = self.at;
        if let Some(row) = self.row(name, &values, depth) {
            return Some(row);
        }
        let mut solids = Vec::new();
        for value in values {
            self.at = start;
            self.loops.push((name, format!("({value})")));
            let round = self.operands(depth);
            self.loops.pop();
            solids.extend(round?);
        }
        Some(union(&solids))
    }

    /// Reads `= [0:5])` or `= [1, 2, 4])`, the values of a loop's variable.
    fn loop_values(&mut self) -> Option<Vec<f64>> {
        let end = self.at + self.pieces[self.at..].iter().position(|piece| *piece == ")")?;
        let list = self.pieces[self.at..end].concat();
        self.at = end + 1;
        let list = list.strip_prefix("=[")?.strip_suffix(']')?;
        let numbers =
            |sign: char| list.split(sign).map(str::parse).collect::<Result<Vec<f64>, _>>().ok();
        let values = match numbers(':').as_deref() {
            Some([_]) | None => numbers(',')?,
            Some([low, high]) => steps(*low, 1.0, *high)?,
            Some([low, step, high]) => steps(*low, *step, *high)?,
            Some(_) => return None,
        };
        (1..=MOST_COPIES).contains(&values.len()).then_some(values)
    }

    /// Copies at equal distances, as a call of `repeat`.
    fn row(&mut self, name: &str, values: &[f64], depth: usize) -> Option<String> {
        let [first, second, ..] = values else { return None };
        let step = second - first;
        let is_even = values.windows(2).all(|pair| pair[1] - pair[0] == step);
        let in_braces = self.take("{");
        if !is_even || !self.take("translate") {
            return None;
        }
        let mut arguments = self.arguments()?.in_order("v")?;
        let moved = arguments.take(&["v"])?;
        arguments.end()?;
        let from = self.at;
        let solid = union(&self.operands(depth)?);
        let is_fixed = !self.pieces[from..self.at].contains(&name);
        while in_braces && self.take(";") {}
        if !is_fixed || in_braces && !self.take("}") {
            return None;
        }
        let factor = |part: &str| {
            let rest = || part.strip_suffix(name)?.strip_suffix('*');
            let rest = rest().or_else(|| part.strip_prefix(name)?.strip_prefix('*'));
            if part == name { Some(1.0) } else { rest?.parse::<f64>().ok() }
        };
        let mut starts = Vec::new();
        let mut moves = Vec::new();
        for part in vector(&moved)? {
            let is_constant = !pieces(part).into_iter().any(|piece| &part[piece] == name);
            let by = if is_constant { 0.0 } else { factor(part)? };
            moves.push((by * step).to_string());
            starts.push(if is_constant { part.to_owned() } else { (by * first).to_string() });
        }
        let row = format!("repeat({solid}, ({}), {})", moves.join(", "), values.len());
        Some(translated(&row, [&starts[0], &starts[1], &starts[2]]))
    }

    /// `CadQuery`'s `Workplane("XY")` and the chain of calls after it.
    fn workplane(&mut self) -> Option<String> {
        let planes = self.arguments()?.0;
        if !matches!(planes.as_slice(), [(_, plane)] if plane == "\"XY\"") {
            return None;
        }
        let mut solid: Option<String> = None;
        let mut height = "1".to_owned();
        while self.take(".") {
            let name = self.peek();
            self.at += 1;
            let arguments = self.arguments()?.0;
            let values: Vec<&str> = arguments.iter().map(|(_, value)| value.as_str()).collect();
            let is_plain = arguments.iter().all(|(name, _)| name.is_empty());
            solid = match (name, solid, values.as_slice()) {
                _ if !is_plain => return None,
                ("box", None, [a, b, c]) => {
                    (*c).clone_into(&mut height);
                    Some(format!("box({}, {}, {})", half(a), half(b), half(c)))
                }
                ("sphere", None, [radius]) => Some(format!("sphere({radius})")),
                ("cylinder", None, [high, radius]) => {
                    (*high).clone_into(&mut height);
                    Some(format!("cylinder({radius}, {})", half(high)))
                }
                ("circle", None, [radius]) => Some(format!("circle({radius})")),
                ("rect", None, [a, b]) => Some(format!("rectangle({}, {})", half(a), half(b))),
                ("extrude", Some(shape), [high]) => {
                    (*high).clone_into(&mut height);
                    let half = half(high);
                    Some(raised(format!("extrude({shape}, {half})"), &half, false))
                }
                ("hole", Some(solid), [diameter]) => {
                    Some(format!("subtract({solid}, cylinder({}, {height}))", half(diameter)))
                }
                ("faces", Some(solid), ["\">Z\"" | "\"<Z\""]) | ("workplane", Some(solid), []) => {
                    Some(solid)
                }
                _ => return None,
            };
        }
        solid
    }
}

/// The numbers from `low` to `high` in steps.
fn steps(low: f64, step: f64, high: f64) -> Option<Vec<f64>> {
    let count = ((high - low) / step + 1e-9).floor();
    (0.0..MOST_COPIES as f64)
        .contains(&count)
        .then(|| (0..=count as usize).map(|index| low + index as f64 * step).collect())
}

/// Returns whether a name has no meaning of its own in this language.
fn is_free(name: &str) -> bool {
    built_in(name) == NameMeaning::Unknown && canonical(name).is_none()
}

/// Returns whether a value means the same in this language.
fn is_alike(value: &str) -> bool {
    let is_unlike = |piece: &str| UNLIKE.contains(&piece);
    !pieces(value).into_iter().any(|piece| is_unlike(&value[piece]))
}

/// Names of solids without operands, and the order of their arguments.
const PRIMITIVES: &[(&str, &str)] = &[
    ("sphere Sphere ball circle", "r"),
    ("SphereGeometry", "r segments rings"),
    ("cube cuboid square", "size center"),
    ("BoxGeometry Box", "a b c"),
    ("cylinder", "h r1 r2 center"),
    ("CylinderGeometry", "r2 r1 h segments"),
    ("ConeGeometry", "r h segments"),
    ("TorusGeometry torus", "r s segments segments"),
];

/// Names of calls that change solids, and the order of their arguments.
const MOVES: &[(&str, &str)] = &[
    ("translate scale mirror", "v"),
    ("rotate", "a v"),
    ("linear_extrude", "height"),
    ("offset", "r"),
    ("color", "c alpha"),
];

/// The order of the arguments of `name`.
fn order_of(table: &[(&str, &'static str)], name: &str) -> Option<&'static str> {
    let row = table.iter().find(|(names, _)| names.split(' ').any(|one| one == name));
    row.map(|(_, order)| *order)
}

/// A solid without operands.
fn primitive(name: &str, mut given: Arguments) -> Option<String> {
    let solid = match name {
        "sphere" | "Sphere" | "ball" | "SphereGeometry" | "circle" => {
            let radius = given.radius(&["r", "radius"], &["d", "diameter"])?;
            given.take(&["center"]);
            format!("{}({radius})", if name == "circle" { "circle" } else { "sphere" })
        }
        "cube" | "cuboid" | "square" => block(&mut given, name == "square")?,
        "BoxGeometry" | "Box" => {
            let sides = [given.take(&["a"])?, given.take(&["b"])?, given.take(&["c"])?];
            format!("box({})", sides.map(|side| half(&side)).join(", "))
        }
        "TorusGeometry" | "torus" => {
            format!("torus({}, {})", given.take(&["r"])?, given.take(&["s"])?)
        }
        "ConeGeometry" => {
            let (radius, height) = (given.take(&["r"])?, half(&given.take(&["h"])?));
            format!("rotate(cone({radius}, {height}), -90°, (1, 0, 0))")
        }
        "CylinderGeometry" => {
            let height = half(&given.take(&["h"])?);
            let (top, bottom) = (given.take(&["r2"])?, given.take(&["r1"])?);
            // Its axis is y.
            format!("rotate({}, -90°, (1, 0, 0))", frustum(&bottom, &top, &height))
        }
        _ => {
            let height = half(&given.take(&["h", "height"]).unwrap_or_else(|| "1".to_owned()));
            let both = given.radius(&["r", "radius"], &["d", "diameter"]);
            let mut end = |radius, diameter| {
                let own = given.radius(&[radius], &[diameter]).or_else(|| both.clone());
                own.unwrap_or_else(|| "1".to_owned())
            };
            let solid = frustum(&end("r1", "d1"), &end("r2", "d2"), &height);
            raised(solid, &height, given.center()?)
        }
    };
    given.end()?;
    Some(solid)
}

/// A cylinder, or a cone that is cut off, with the radii at its bottom and top.
fn frustum(bottom: &str, top: &str, half: &str) -> String {
    match (bottom, top) {
        _ if bottom == top => format!("cylinder({bottom}, {half})"),
        (_, "0") => format!("cone({bottom}, {half})"),
        ("0", _) => format!("mirror(cone({top}, {half}), 0, 0, 1)"),
        _ => format!("cone({bottom}, {top}, {half})"),
    }
}

/// A box, or a rectangle if `is_flat`. It begins at 0 unless it is centered.
fn block(given: &mut Arguments, is_flat: bool) -> Option<String> {
    let size = given.take(&["size"]).unwrap_or_else(|| "1".to_owned());
    let count = if is_flat { 2 } else { 3 };
    let is_list = size.starts_with('[');
    let sides = if is_list { components(&size)? } else { vec![size.as_str(); count] };
    if sides.len() != count {
        return None;
    }
    let halves: Vec<String> = sides.into_iter().map(half).collect();
    let solid = match (is_flat, is_list) {
        (true, _) => format!("rectangle({})", halves.join(", ")),
        (false, true) => format!("box({})", halves.join(", ")),
        (false, false) => format!("box({})", halves[0]),
    };
    let up = halves.get(2).map_or("0", String::as_str);
    let is_centered = given.center()?;
    Some(if is_centered { solid } else { translated(&solid, [&halves[0], &halves[1], up]) })
}

/// A solid that `name` makes of others.
fn applied(name: &str, mut given: Arguments, solids: &[String]) -> Option<String> {
    let all = union(solids);
    let solid = match (name, solids) {
        ("union" | "group" | "render", _) => all,
        ("color", _) => {
            given.0.clear();
            all
        }
        ("difference" | "subtract", [first, rest @ ..]) if !rest.is_empty() => {
            format!("subtract({first}, {})", union(rest))
        }
        ("intersection" | "intersect", [_, _, ..]) => format!("intersect({})", solids.join(", ")),
        ("translate", _) => translated(&all, vector(&given.take(&["v"])?)?),
        ("mirror", _) => format!("mirror({all}, {})", vector(&given.take(&["v"])?)?.join(", ")),
        ("scale", _) => match given.take(&["v"])? {
            list if list.starts_with('[') => {
                let parts = components(&list).filter(|parts| parts.len() == 3)?;
                format!("scale({all}, {})", parts.join(", "))
            }
            factor => format!("scale({all}, {factor})"),
        },
        ("rotate", _) => rotated(all, &given.take(&["a"])?, given.take(&["v"]).as_deref())?,
        ("linear_extrude", _) => {
            let height = half(&given.take(&["height", "h"])?);
            raised(format!("extrude({all}, {height})"), &height, given.center()?)
        }
        ("rotate_extrude", _) => {
            given.take(&["angle"]).is_none_or(|angle| angle == "360").then_some(())?;
            format!("revolve({all})")
        }
        ("offset", _) => format!("offset({all}, {})", given.take(&["r"])?),
        ("minkowski", [first, ball]) => {
            format!("offset({first}, {})", ball.strip_prefix("sphere(")?.strip_suffix(')')?)
        }
        ("hull", [first, second]) => {
            let radius = first.strip_prefix("sphere(")?.strip_suffix(')')?;
            let moved = second.strip_prefix(&format!("translate(sphere({radius}), "))?;
            format!("capsule((0, 0, 0), ({moved}, {radius})")
        }
        _ => return None,
    };
    given.end()?;
    Some(solid)
}

/// A solid turned by degrees: about an axis, about z, or about x, y and z in this order.
fn rotated(solid: String, angle: &str, axis: Option<&str>) -> Option<String> {
    if let Some(axis) = axis {
        return Some(format!(
            "rotate({solid}, {}, ({}))",
            degrees(angle),
            vector(axis)?.join(", ")
        ));
    }
    if !angle.starts_with('[') {
        return Some(format!("rotate({solid}, {})", degrees(angle)));
    }
    let axes = ["(1, 0, 0)", "(0, 1, 0)", "(0, 0, 1)"];
    let turned = vector(angle)?.into_iter().zip(axes).filter(|(angle, _)| *angle != "0");
    let turn = |all, (angle, axis)| format!("rotate({all}, {}, {axis})", degrees(angle));
    Some(turned.fold(solid, turn))
}

/// An angle in degrees.
fn degrees(value: &str) -> String {
    if value.parse::<f64>().is_ok() { format!("{value}°") } else { format!("({value})°") }
}
