//! Convex polygons in a square that runs from −1 to 1, cut by lines.

use glam::DVec2;

/// A function that lies between `linear − error` and `linear + error` in the square.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// Value at the middle of the square.
    pub value: f64,
    /// Slope along each axis.
    pub slope: DVec2,
    /// Bound of the distance.
    pub error: f64,
}

impl Line {
    /// The function with the opposite sign.
    pub fn negated(&self) -> Self {
        Self { value: -self.value, slope: -self.slope, error: self.error }
    }
}

/// A convex polygon, as its corners in their order around it. It may be empty.
#[derive(Clone, Debug)]
pub struct Polygon(Vec<DVec2>);

impl Polygon {
    /// The square.
    pub fn square() -> Self {
        Self([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(DVec2::from).to_vec())
    }

    /// Returns whether there is no corner.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The part where the linear function plus `offset` is at most 0.
    #[must_use]
    pub fn cut(&self, line: &Line, offset: f64) -> Self {
        let value = |corner: &DVec2| line.value + line.slope.dot(*corner) + offset;
        let mut cut = Vec::with_capacity(self.0.len() + 1);
        for (at, from) in self.0.iter().enumerate() {
            let to = &self.0[(at + 1) % self.0.len()];
            let (below, above) = (value(from), value(to));
            if below <= 0.0 {
                cut.push(*from);
            }
            if (below < 0.0 && above > 0.0) || (below > 0.0 && above < 0.0) {
                cut.push(from.lerp(*to, below / (below - above)));
            }
        }
        Self(cut)
    }

    /// The area, and the integrals of both coordinates.
    pub fn moments(&self) -> (f64, DVec2) {
        let Some(first) = self.0.first() else { return (0.0, DVec2::ZERO) };
        let (mut area, mut moments) = (0.0, DVec2::ZERO);
        for pair in self.0.windows(2).skip(1) {
            let part = 0.5 * (pair[0] - first).perp_dot(pair[1] - first).max(0.0);
            area += part;
            moments += (first + pair[0] + pair[1]) * (part / 3.0);
        }
        (area, moments)
    }
}
