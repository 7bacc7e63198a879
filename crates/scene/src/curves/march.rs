//! Follows a curve of two equations step by step along its tangent. Each step is corrected by
//! Newton's method.

use glam::DVec3;
use rustc_hash::FxHashMap;
use zeroset_eval::{Gradients, Kernel, LANES, Points, SampleGradient};
use zeroset_space::Region;

/// Most steps of Newton's method, for a point near the curve and for a cell's center.
const STEPS: usize = 6;
const SEED_STEPS: usize = 16;

/// Least sine of the angle between two gradients. At a smaller angle they give no direction.
const LEAST_SINE: f64 = 1e-7;

/// Least cosine of the angle between the directions of two neighboring steps.
const LEAST_COSINE: f64 = 0.98;

/// A step of Newton's method is the last one if it is this share of a cell.
const CONVERGED: f64 = 1e-9;

/// A point is on a known piece if its distance is this share of a cell.
const NEAR: f64 = 0.05;

/// Shortest step, as a share of the longest.
const SHORTEST: f64 = 1.0 / 4096.0;

/// Largest number of vertices of a curve.
const MOST: usize = 1 << 17;

/// Number of a curve's last vertices that do not count as an earlier part of it.
const RECENT: usize = 8;

/// Two functions with their gradients.
pub struct Pair([Box<dyn Kernel<SampleGradient, f64>>; 2]);

/// The two functions' values and gradients at a point.
struct Local {
    values: [f64; 2],
    gradients: [DVec3; 2],
}

impl Local {
    /// Values and gradients in a lane. `None` if one of the numbers is not finite.
    fn of(outputs: &[Gradients<f64>; 2], lane: usize) -> Option<Self> {
        let values = outputs.each_ref().map(|output| output.value[lane]);
        let gradients = outputs
            .each_ref()
            .map(|output| DVec3::from_array(output.gradient.each_ref().map(|part| part[lane])));
        let is_known = values.iter().all(|value| value.is_finite())
            && gradients.iter().all(|gradient| gradient.is_finite());
        is_known.then_some(Self { values, gradients })
    }

    /// The shortest step to where both linear approximations are 0. `None` if the gradients are
    /// parallel or 0.
    fn step(&self) -> Option<DVec3> {
        let [a, b] = self.gradients;
        let cross = a.cross(b);
        let square = cross.length_squared();
        if square <= LEAST_SINE * LEAST_SINE * a.length_squared() * b.length_squared() {
            return None;
        }
        // The step s is perpendicular to the cross product, with a·s = −f and b·s = −g.
        let step = (self.values[0] * cross.cross(b) - self.values[1] * cross.cross(a)) / square;
        step.is_finite().then_some(step)
    }

    /// The direction of the curve. `None` if the gradients are parallel or 0.
    fn tangent(&self) -> Option<DVec3> {
        let [a, b] = self.gradients.map(|gradient| gradient.normalize_or_zero());
        let cross = a.cross(b);
        (cross.length() > LEAST_SINE).then(|| cross.normalize())
    }
}

impl Pair {
    /// Two functions, given by kernels for values and gradients.
    pub fn new(
        one: Box<dyn Kernel<SampleGradient, f64>>,
        other: Box<dyn Kernel<SampleGradient, f64>>,
    ) -> Self {
        Self([one, other])
    }

    fn outputs(&self, input: &Points<f64>) -> [Gradients<f64>; 2] {
        self.0.each_ref().map(|kernel| {
            let mut output = Gradients::default();
            kernel.eval(input, &mut output);
            output
        })
    }

    /// Moves at most [`LANES`] points to the curve. A point is lost if it moves more than two
    /// cells.
    pub fn nearest_zeros(&self, seeds: &[DVec3], cell: DVec3) -> Vec<Option<DVec3>> {
        let reach = 2.0 * cell.length();
        let mut at = seeds.to_vec();
        let mut is_done = vec![false; seeds.len()];
        let mut is_lost = vec![false; seeds.len()];
        for _ in 0..SEED_STEPS {
            let points: Vec<[f64; 3]> = at.iter().map(DVec3::to_array).collect();
            let outputs = self.outputs(&Points::near(&points)[0]);
            for lane in 0..seeds.len().min(LANES) {
                if is_done[lane] || is_lost[lane] {
                    continue;
                }
                let step = Local::of(&outputs, lane).and_then(|local| local.step());
                let next = step.map(|step| at[lane] + step);
                match next.filter(|next| (*next - seeds[lane]).length() <= reach) {
                    Some(next) => {
                        is_done[lane] = (next - at[lane]).length() < CONVERGED * cell.length();
                        at[lane] = next;
                    }
                    None => is_lost[lane] = true,
                }
            }
            if is_done.iter().zip(&is_lost).all(|(done, lost)| *done || *lost) {
                break;
            }
        }
        at.into_iter().zip(is_done).map(|(at, is_done)| is_done.then_some(at)).collect()
    }

    fn local(&self, at: DVec3) -> Option<Local> {
        Local::of(&self.outputs(&Points::near(&[at.to_array()])[0]), 0)
    }

    /// The curve's point near `at`, and the curve's direction there. `None` if no point of the
    /// curve is found within `reach`.
    fn corrected(&self, at: DVec3, reach: f64) -> Option<(DVec3, DVec3)> {
        let mut now = at;
        for _ in 0..STEPS {
            let local = self.local(now)?;
            let step = local.step()?;
            now += step;
            if (now - at).length() > reach {
                return None;
            }
            if step.length() < 1e-7 * reach + 8.0 * f64::EPSILON * now.abs().max_element() {
                let tangent = self.local(now)?.tangent()?;
                return Some((now, tangent));
            }
        }
        None
    }
}

/// A vertex of a piece, as the grid of vertices finds it.
#[derive(Clone, Copy)]
struct Vertex {
    piece: usize,
    index: usize,
}

/// Follows curves, and knows which parts were followed.
pub struct Marcher<'a> {
    pair: &'a Pair,
    low: DVec3,
    high: DVec3,
    /// Side of the cubes in which vertices are looked up.
    side: f64,
    /// Longest step.
    longest: f64,
    /// The pieces found so far.
    pub pieces: Vec<Vec<DVec3>>,
    /// The vertices in each cube.
    vertices: FxHashMap<[i64; 3], Vec<Vertex>>,
    count: usize,
}

impl<'a> Marcher<'a> {
    /// A marcher in a region, over a grid of cells.
    pub fn new(pair: &'a Pair, region: &Region, cell: DVec3) -> Self {
        Self {
            pair,
            low: region.low(),
            high: region.high(),
            side: cell.max_element(),
            longest: 0.5 * cell.max_element(),
            pieces: Vec::new(),
            vertices: FxHashMap::default(),
            count: 0,
        }
    }

    /// Returns whether no piece was cut off because there are too many vertices.
    pub fn is_complete(&self) -> bool {
        self.count < MOST
    }

    fn key(&self, at: DVec3) -> [i64; 3] {
        ((at - self.low) / self.side).floor().to_array().map(|n| n as i64)
    }

    /// Returns whether a point with this direction is on a piece. The vertices of `own` from number
    /// `recent` on do not count.
    fn is_known(&self, at: DVec3, tangent: DVec3, own: usize, recent: usize) -> bool {
        let [x, y, z] = self.key(at);
        let near = NEAR * self.side;
        (0..27_i64).any(|n| {
            let key = [x + n % 3 - 1, y + n / 3 % 3 - 1, z + n / 9 - 1];
            self.vertices.get(&key).into_iter().flatten().any(|vertex| {
                if vertex.piece == own && vertex.index >= recent {
                    return false;
                }
                let line = &self.pieces[vertex.piece];
                let before = vertex.index.saturating_sub(1);
                let after = (vertex.index + 1).min(line.len() - 1);
                line[before..=after].windows(2).any(|pair| {
                    let way = pair[1] - pair[0];
                    let share = (at - pair[0]).dot(way) / way.length_squared();
                    let foot = pair[0].lerp(pair[1], share.clamp(0.0, 1.0));
                    (at - foot).length() < near && tangent.dot(way.normalize_or_zero()).abs() > 0.9
                })
            })
        })
    }

    /// Follows the curve through `seed` in both directions, unless it is known.
    pub fn follow(&mut self, seed: DVec3) {
        let is_inside = self.holds(seed);
        let Some(tangent) = self.pair.local(seed).and_then(|local| local.tangent()) else { return };
        if !is_inside || !self.is_complete() || self.is_known(seed, tangent, usize::MAX, 0) {
            return;
        }
        let own = self.pieces.len();
        self.pieces.push(vec![seed]);
        self.mark(own, 0);
        if self.march(own, tangent) {
            return;
        }
        self.turn(own);
        self.march(own, -tangent);
        if self.pieces[own].len() < 2 {
            self.pieces.pop();
            self.vertices.values_mut().for_each(|all| all.retain(|vertex| vertex.piece != own));
        }
    }

    /// Reverses a piece, so that it can be followed from its other end.
    fn turn(&mut self, own: usize) {
        self.pieces[own].reverse();
        let last = self.pieces[own].len() - 1;
        let mut keys: Vec<[i64; 3]> = self.pieces[own].iter().map(|at| self.key(*at)).collect();
        keys.sort_unstable();
        keys.dedup();
        for key in keys {
            let all = self.vertices.entry(key).or_default().iter_mut();
            for vertex in all.filter(|vertex| vertex.piece == own) {
                vertex.index = last - vertex.index;
            }
        }
    }

    fn mark(&mut self, piece: usize, index: usize) {
        let key = self.key(self.pieces[piece][index]);
        self.vertices.entry(key).or_default().push(Vertex { piece, index });
        self.count += 1;
    }

    fn holds(&self, at: DVec3) -> bool {
        let slack = 1e-9 * (self.high - self.low);
        at.cmpge(self.low - slack).all() && at.cmple(self.high + slack).all()
    }

    /// Extends a piece from its last vertex in a direction. Returns whether the piece is closed.
    fn march(&mut self, own: usize, direction: DVec3) -> bool {
        let mut at = self.pieces[own][self.pieces[own].len() - 1];
        let (start, first) = (at, direction);
        let begun = self.pieces[own].len();
        let mut along = direction;
        let mut step = self.longest;
        while self.is_complete() {
            let next =
                self.pair.corrected(at + along * step, 0.3 * step).and_then(|(next, way)| {
                    let way = if way.dot(along) < 0.0 { -way } else { way };
                    let chord = (next - at).normalize_or_zero();
                    let is_smooth =
                        way.dot(along) > LEAST_COSINE && chord.dot(along) > LEAST_COSINE;
                    is_smooth.then_some((next, way))
                });
            let Some((next, way)) = next else {
                step /= 2.0;
                if step < SHORTEST * self.longest {
                    return false;
                }
                continue;
            };
            let length = self.pieces[own].len();
            if begun == 1 && length > 2 {
                let ahead = start - at;
                let chord = next - at;
                let share = ahead.dot(chord) / chord.length_squared();
                let off = (ahead - chord * share.clamp(0.0, 1.0)).length();
                let is_passed = (0.0..=1.0).contains(&share) && off < 0.3 * chord.length();
                let near = (2.0 * NEAR * self.side).min(0.5 * step);
                let is_near = share > 0.0 && next.distance(start) < near;
                if (is_passed || is_near) && way.dot(first) > 0.9 {
                    self.pieces[own].push(start);
                    return true;
                }
            }
            let recent = length.saturating_sub(RECENT);
            let is_known = self.is_known(next, way, own, recent);
            self.pieces[own].push(next);
            self.mark(own, length);
            if is_known || !self.holds(next) {
                return false;
            }
            (at, along) = (next, way);
            step = (1.5 * step).min(self.longest);
        }
        false
    }
}
