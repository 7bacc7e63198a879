//! Random solids whose parts meet in edges and corners.

use super::Rng;

/// A solid, and how to mesh it.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// Its text.
    pub text: String,
    /// The domain is the cube around the origin with this half edge.
    pub half: f64,
    /// Largest distance between mesh and solid.
    pub tolerance: f64,
}

/// Returns a random solid: planes at any angle, boxes, quadrics and cubics, combined by union,
/// intersection and difference. Many of them go through one point, inside the domain, or on a face,
/// an edge or a corner of it. The numbers of half of them are dyadic, so that parts lie in planes
/// of grids.
pub fn random_solid(rng: &mut Rng) -> Solid {
    let half = [1.0, 2.0, 1.5][rng.u32(0..3) as usize];
    let tolerance = half * [0.3, 0.1, 0.04][rng.u32(0..3) as usize];
    let is_dyadic = rng.bool();
    let mut parts = Parts { rng, half, is_dyadic, common: [0.0; 3] };
    parts.common = [0; 3].map(|_: i32| match parts.rng.u32(0..6) {
        0 => half,
        1 => 0.0,
        _ => parts.number(half),
    });
    let depth = parts.rng.u32(1..4);
    let text = format!("{} <= 0", parts.choice(depth));
    Solid { text, half, tolerance }
}

struct Parts<'r> {
    rng: &'r mut Rng,
    half: f64,
    is_dyadic: bool,
    /// A point that many parts go through.
    common: [f64; 3],
}

impl Parts<'_> {
    /// A number between −`most` and `most`, with a few digits.
    fn number(&mut self, most: f64) -> f64 {
        let steps = if self.is_dyadic { 16.0 } else { 1000.0 };
        let share = f64::from(self.rng.i32(-900..=900)) / 1000.0;
        (share * most * steps).round() / steps
    }

    fn choice(&mut self, depth: u32) -> String {
        if depth == 0 {
            return self.part();
        }
        let [left, right] = [0; 2].map(|_: i32| {
            let depth = if self.rng.u32(0..4) == 0 { 0 } else { depth - 1 };
            self.choice(depth)
        });
        match self.rng.u32(0..3) {
            0 => format!("min({left}, {right})"),
            1 => format!("max({left}, {right})"),
            _ => format!("max({left}, -{right})"),
        }
    }

    /// A point that the next part goes through, or has as its center.
    fn place(&mut self) -> [f64; 3] {
        if self.rng.u32(0..3) > 0 {
            return self.common;
        }
        let most = self.half;
        [0; 3].map(|_: i32| self.number(most))
    }

    fn part(&mut self) -> String {
        let [a, b, c] = self.place();
        let [x, y, z] = [("x", a), ("y", b), ("z", c)].map(|(name, at)| minus(name, at));
        let most = self.half;
        match self.rng.u32(0..8) {
            0 | 1 => {
                let along = [x, y, z][self.rng.u32(0..3) as usize].clone();
                if self.rng.bool() { format!("({along})") } else { format!("(-({along}))") }
            }
            2 | 3 => {
                let [u, v, w] = [0; 3].map(|_: i32| self.number(1.0));
                format!("({u}*({x}) + {v}*({y}) + {w}*({z}) + 0)")
            }
            4 => {
                // Its corner is in the place.
                let [u, v, w] = [0; 3].map(|_: i32| self.number(0.5 * most).abs() + 0.125);
                format!("max(abs({x} + {u}) - {u}, abs({y} + {v}) - {v}, abs({z} + {w}) - {w})")
            }
            5 => {
                let [u, v, w] = [0; 3].map(|_: i32| self.number(0.5 * most));
                let square = (u * u + v * v + w * w).max(0.0625);
                let shifted = [(x, u), (y, v), (z, w)].map(|(along, by)| minus(&along, by));
                let [x, y, z] = shifted;
                format!("(({x})^2 + ({y})^2 + ({z})^2 - {square})")
            }
            6 => {
                let [u, v] = [0; 2].map(|_: i32| self.number(0.5 * most));
                let square = (u * u + v * v).max(0.0625);
                let [x, z] = [minus(&x, u), minus(&z, v)];
                format!("(({x})^2 + ({z})^2 - {square})")
            }
            _ => {
                let [u, v, w] = [0; 3].map(|_: i32| self.number(1.0));
                format!("({u}*({x}) + {v}*({y}) + {w}*({z}) + ({x})*({y})*({z}) + ({y})^2/2)")
            }
        }
    }
}

/// A difference as a text.
fn minus(name: &str, at: f64) -> String {
    if at == 0.0 { name.to_owned() } else { format!("{name} - ({at})") }
}
