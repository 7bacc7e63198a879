//! Models of many parts, as texts. All sides draw the graph of the text, so all have the same
//! numbers and the same operations.

use crate::surfaces::{Surface, View};
use anyhow::{Context, Result, anyhow, ensure};
use fastrand::Rng;
use glam::DVec3;
use std::borrow::Cow;
use std::fmt::Write as _;
use std::path::Path;
use zeroset_scene::view::{self, DomainChoice};
use zeroset_syntax::{Options, read};

/// A model of many parts.
pub struct PartsModel {
    /// Name of the models that differ from this one in their number of parts only.
    pub family: String,
    /// Number of parts. `None` for the model of a file.
    pub parts: Option<usize>,
    /// The model with its domain and view.
    pub surface: Surface,
}

/// Family of plain unions of spheres.
pub const SPHERES: &str = "spheres";
/// Family of spheres that are joined by quadratic blends.
pub const BLENDED: &str = "blended spheres";

/// Half the edge of the domain of all generated models.
const HALF: f64 = 1.2;

/// Seed of everything random. The number of parts is added to it.
const SEED: u64 = 43;

/// A text with a definition per line.
#[derive(Default)]
struct Text {
    lines: String,
    count: usize,
}

impl Text {
    /// Adds a definition, and returns its name.
    fn define(&mut self, expression: &str) -> String {
        self.count += 1;
        let name = format!("v_{}", self.count);
        writeln!(self.lines, "{name} = {expression}").expect("text");
        name
    }

    /// Joins terms by a balanced tree.
    fn join(
        &mut self,
        mut terms: Vec<String>,
        join: impl Fn(&mut Self, &str, &str) -> String,
    ) -> String {
        while terms.len() > 1 {
            let pairs = terms.chunks(2).map(|pair| match pair {
                [a, b] => join(self, a, b),
                rest => rest[0].clone(),
            });
            terms = pairs.collect();
        }
        terms.pop().unwrap_or_default()
    }

    fn union(&mut self, terms: Vec<String>) -> String {
        self.join(terms, |text, a, b| text.define(&format!("min({a}, {b})")))
    }

    fn blend(&mut self, terms: Vec<String>, k: f64) -> String {
        let scale = 1.0 / (4.0 * k);
        self.join(terms, |text, a, b| {
            text.define(&format!("min({a}, {b}) - sqr(max({k:.9} - abs({a} - {b}), 0))*{scale:.9}"))
        })
    }

    fn sphere(&mut self, at: DVec3, radius: f64) -> String {
        let [x, y, z] = moved(at);
        self.define(&format!("sqrt(({x})^2 + ({y})^2 + ({z})^2) - {radius:.6}"))
    }

    fn cuboid(&mut self, at: DVec3, half: DVec3) -> String {
        let [x, y, z] = moved(at);
        self.cuboid_of([&x, &y, &z], half)
    }

    fn cuboid_of(&mut self, [x, y, z]: [&str; 3], half: DVec3) -> String {
        self.define(&format!(
            "max(max(abs({x}) - {:.6}, abs({y}) - {:.6}), abs({z}) - {:.6})",
            half.x, half.y, half.z
        ))
    }

    fn model(self, family: &str, parts: usize, zeros: &str) -> PartsModel {
        let text = format!("{}domain {HALF}\n{zeros}\n", self.lines);
        let surface = Surface {
            name: Cow::Owned(family.to_owned()),
            half: HALF,
            is_cut: false,
            view: View::Front,
            text: Cow::Owned(text),
        };
        PartsModel { family: family.to_owned(), parts: Some(parts), surface }
    }
}

/// The coordinates from a point on, as text.
fn moved(at: DVec3) -> [String; 3] {
    [("x", at.x), ("y", at.y), ("z", at.z)].map(|(axis, c)| format!("{axis} - ({c:.6})"))
}

fn point(random: &mut Rng, reach: f64) -> DVec3 {
    DVec3::from_array([0; 3].map(|_| (2.0 * random.f64() - 1.0) * reach))
}

/// A union of `count` random spheres, whose total volume does not depend on the count.
pub fn spheres(count: usize, family: &str) -> PartsModel {
    let (mut text, mut random) = (Text::default(), Rng::with_seed(SEED + count as u64));
    let radius = 0.5 / (count as f64).cbrt();
    let all = (0..count).map(|_| text.sphere(point(&mut random, 1.0), radius)).collect();
    let root = if family == BLENDED { text.blend(all, radius / 2.0) } else { text.union(all) };
    text.model(family, count, &format!("{root} - 0 = 0"))
}

/// Models of at least 500 operations with choices, which are drawn as solids.
pub fn solids() -> Vec<PartsModel> {
    vec![colonnade(), boxes(), sponge(), drilled(), chain()]
}

/// Two rows of columns with square capitals, on steps and under beams.
fn colonnade() -> PartsModel {
    let (mut text, mut parts) = (Text::default(), Vec::new());
    for column in 0..22 {
        let side = if column % 2 == 0 { 0.55 } else { -0.55 };
        let (x, z) = (-1.0 + 0.2 * f64::from(column / 2), side);
        let shaft = text.define(&format!(
            "max(sqrt((x - ({x:.6}))^2 + (z - ({z:.6}))^2) - (0.06 - 0.01*y), abs(y) - 0.6)"
        ));
        parts.push(shaft);
        for y in [-0.62, 0.62] {
            parts.push(text.cuboid(DVec3::new(x, y, z), DVec3::new(0.08, 0.03, 0.08)));
        }
    }
    for step in 0..3 {
        let wide = 0.05 * f64::from(step);
        let half = DVec3::new(1.06 + wide, 0.04, 0.64 + wide);
        parts.push(text.cuboid(DVec3::new(0.0, -0.69 - 0.08 * f64::from(step), 0.0), half));
    }
    for side in [-0.55, 0.55] {
        parts.push(text.cuboid(DVec3::new(0.0, 0.7, side), DVec3::new(1.09, 0.05, 0.09)));
    }
    let count = parts.len();
    let root = text.union(parts);
    text.model("colonnade", count, &format!("{root} <= 0"))
}

/// A grid of boxes, each turned about z and then about x.
fn boxes() -> PartsModel {
    let (mut text, mut random) = (Text::default(), Rng::with_seed(SEED));
    let mut parts = Vec::new();
    for place in 0..125 {
        let at = [place % 5, place / 5 % 5, place / 25].map(|n| f64::from(n - 2) * 0.44);
        let [x, y, z] = moved(DVec3::from_array(at));
        let mut turn = |a: &str, b: &str| {
            let (sine, cosine) = (random.f64() * std::f64::consts::TAU).sin_cos();
            let first = format!("{cosine:.6}*({a}) + ({sine:.6})*({b})");
            let second = format!("{cosine:.6}*({b}) - ({sine:.6})*({a})");
            [first, second].map(|turned| text.define(&turned))
        };
        let [u, v] = turn(&x, &y);
        let [v, w] = turn(&v, &z);
        parts.push(text.cuboid_of([&u, &v, &w], DVec3::new(0.16, 0.12, 0.08)));
    }
    let root = text.union(parts);
    text.model("turned boxes", 125, &format!("{root} <= 0"))
}

/// Menger's sponge after three steps, turned so that no face is parallel to a ray.
fn sponge() -> PartsModel {
    let (mut text, mut bars) = (Text::default(), Vec::new());
    let u = text.define("0.8*x + 0.6*z");
    let w = text.define("0.8*z - 0.6*x");
    let v = text.define(&format!("0.8*y + 0.6*{w}"));
    let w = text.define(&format!("0.8*{w} - 0.6*y"));
    for step in 1..=3 {
        let cells = 3_i32.pow(step - 1);
        let cell = 1.38 / f64::from(cells);
        let middle = |n: i32| (f64::from(n) + 0.5) * cell - 0.69;
        let mut slabs = |axis: &str| -> Vec<String> {
            let slab = |n| format!("abs({axis} - ({:.9})) - {:.9}", middle(n), cell / 6.0);
            (0..cells).map(|n| text.define(&slab(n))).collect()
        };
        let axes = [slabs(&u), slabs(&v), slabs(&w)];
        for [a, b] in [[0, 1], [1, 2], [2, 0]] {
            for first in &axes[a] {
                for second in &axes[b] {
                    bars.push(text.define(&format!("max({first}, {second})")));
                }
            }
        }
    }
    let count = bars.len();
    let holes = text.union(bars);
    let cube = text.cuboid_of([&u, &v, &w], DVec3::splat(0.69));
    text.model("sponge", count, &format!("max({cube}, -{holes}) <= 0"))
}

/// A block with holes along all three axes.
fn drilled() -> PartsModel {
    let (mut text, mut random) = (Text::default(), Rng::with_seed(SEED));
    let mut holes = Vec::new();
    for hole in 0..100 {
        let [a, b] = [["x", "y"], ["y", "z"], ["z", "x"]][hole % 3];
        let at = point(&mut random, 1.0);
        let radius = 0.03 + 0.05 * random.f64();
        let (p, q) = (at.x, at.y);
        holes.push(
            text.define(&format!("sqrt(({a} - ({p:.6}))^2 + ({b} - ({q:.6}))^2) - {radius:.6}")),
        );
    }
    let holes = text.union(holes);
    let block = text.cuboid(DVec3::ZERO, DVec3::splat(1.0));
    text.model("drilled block", 100, &format!("max({block}, -{holes}) <= 0"))
}

/// A tube of blended capsules along a knot.
fn chain() -> PartsModel {
    const LINKS: usize = 60;
    let knot = |n: usize| {
        let t = n as f64 / LINKS as f64 * std::f64::consts::TAU;
        let ring = 0.75 + 0.3 * (3.0 * t).cos();
        DVec3::new(ring * (2.0 * t).cos(), ring * (2.0 * t).sin(), 0.3 * (3.0 * t).sin())
    };
    let (mut text, mut links) = (Text::default(), Vec::new());
    for link in 0..LINKS {
        let (from, way) = (knot(link), knot(link + 1) - knot(link));
        let own = moved(from).map(|c| text.define(&c));
        let along = way / way.length_squared();
        let share = format!(
            "{:.6}*{} + ({:.6})*{} + ({:.6})*{}",
            along.x, own[0], along.y, own[1], along.z, own[2]
        );
        let share = text.define(&format!("max(min({share}, 1), 0)"));
        let off = [0, 1, 2].map(|n| format!("({} - {share}*({:.6}))^2", own[n], way[n]));
        links.push(text.define(&format!("sqrt({}) - 0.07", off.join(" + "))));
    }
    let root = text.blend(links, 0.04);
    text.model("knot", LINKS, &format!("{root} <= 0"))
}

/// The model of a file, whose domain must be a cube around the origin.
///
/// # Errors
/// If the file cannot be read, or has another domain.
pub fn of_file(path: &Path) -> Result<PartsModel> {
    let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
    let document = read(&text, &Options::default());
    let document = document.map_err(|errors| anyhow!("{}: {errors}", path.display()))?;
    let (region, _) = view::region(&document, DomainChoice::Document, None)?;
    let half = region.high().x;
    let is_cube = region.high() == DVec3::splat(half) && region.low() == DVec3::splat(-half);
    ensure!(is_cube, "{}: add a line such as `domain 2`, a cube around 0", path.display());
    let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into());
    let (name, text) = (Cow::Owned(name), Cow::Owned(text));
    let surface = Surface { name, half, is_cut: false, view: View::Front, text };
    Ok(PartsModel { family: surface.name.to_string(), parts: None, surface })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_models_are_valid_and_their_solids_large() {
        for family in [SPHERES, BLENDED] {
            let model = spheres(7, family);
            model.surface.document().expect("valid");
            model.surface.region().expect("its domain");
        }
        for model in solids() {
            let document = model.surface.document().expect("valid");
            assert!(document.graph.len() > 500, "{}: {}", model.family, document.graph.len());
        }
    }
}
