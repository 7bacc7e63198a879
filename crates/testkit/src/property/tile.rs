//! Random tiles of rays, and exact points close to them.

use super::dot::dot;
use crate::{Adversarial, Case, Claim, Ends, Rng};
use zeroset_eval::{LANES, Segments, Tiles};

/// A tile of rays over a range of t, as in [`Tiles`]. All numbers are of the kernel's float type.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tile {
    centre: [f64; 2],
    half: [f64; 2],
    /// The least and the greatest t.
    pub span: [f64; 2],
    /// The vectors `o`, `oₐ` and `o_b` of [`Tiles`].
    origin: [[f64; 3]; 3],
    /// The vectors `d`, `dₐ` and `d_b` of [`Tiles`].
    direction: [[f64; 3]; 3],
    error: [f64; 3],
}

/// A point whose distance from a ray of a tile is at most the tile's error.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Probe {
    /// Index of the probe's ray among the rays that have probes.
    pub ray: usize,
    screen: [f64; 2],
    /// The point's t on the ray.
    pub t: f64,
    pub at: [f64; 3],
}

/// Returns a random number of a range, often an end or the middle.
fn within(rng: &mut Rng, [lo, hi]: [f64; 2]) -> f64 {
    let share = f64::uniform(rng);
    let value = match rng.u32(0..5) {
        0 => lo,
        1 => hi,
        2 => lo / 2.0 + hi / 2.0,
        _ => lo * (1.0 - share) + hi * share,
    };
    value.clamp(lo, hi)
}

/// Returns a random vector. Its components are at most `length` in magnitude.
fn vector(rng: &mut Rng, length: f64) -> [f64; 3] {
    [(); 3]
        .map(|()| if rng.u32(0..5) == 0 { 0.0 } else { (f64::uniform(rng) * 2.0 - 1.0) * length })
}

/// Returns (x − middle)/half as a sum of two numbers, with a relative error of about 2⁻¹⁰⁰.
fn symbol(x: f64, middle: f64, half: f64) -> [f64; 2] {
    if half == 0.0 {
        return [0.0; 2];
    }
    let head = x - middle;
    let part = head - x;
    let tail = (x - (head - part)) - (middle + part);
    let quotient = head / half;
    let rest = quotient.mul_add(-half, head) + tail;
    [quotient, rest / half]
}

impl Tile {
    pub(super) fn random<T: Adversarial>(case: &Case, rng: &mut Rng) -> Self {
        let region = case.random_box::<T>(rng);
        let finite = region.map(|[lo, hi]| {
            let (lo, hi): (f64, f64) = (lo.into(), hi.into());
            let lo = if lo.is_finite() { lo } else { (hi - 8.0).min(-4.0) };
            let hi = if hi.is_finite() { hi } else { lo.max(0.0) + 8.0 };
            [lo, hi.max(lo)]
        });
        let tile = match rng.u32(0..8) {
            0..=2 => Self::over(rng, finite),
            3..=6 => {
                let point = case.random_point(rng, &region);
                Self::around_point(rng, point)
            }
            _ => {
                let mut any = || T::adversarial(rng, Ends::Finite).into();
                let mut vectors = || [(); 3].map(|()| [(); 3].map(|()| any()));
                let (origin, direction) = (vectors(), vectors());
                let ([n, f], [a, b, c, d]) = ([any(), any()], [any(), any(), any(), any()]);
                let span = [f64::min(n, f), f64::max(n, f)];
                let half = [f64::abs(c), f64::abs(d)];
                Self { centre: [a, b], half, span, origin, direction, error: [0.0; 3] }
            }
        };
        tile.rounded::<T>()
    }

    /// Returns a tile that fills a box, with one symbol along each side.
    fn over(rng: &mut Rng, region: [[f64; 2]; 3]) -> Self {
        let first = rng.u32(0..3) as usize;
        let axes = [first, (first + 1) % 3, (first + 2) % 3];
        let unit = |axis: usize| [0, 1, 2].map(|k| f64::from(u8::from(k == axis)));
        let sides = axes.map(|axis| region[axis]);
        let middle = |[lo, hi]: [f64; 2]| lo / 2.0 + hi / 2.0;
        let half = |[lo, hi]: [f64; 2]| hi / 2.0 - lo / 2.0;
        let zero = [0.0; 3];
        Self {
            centre: [middle(sides[0]), middle(sides[1])],
            half: [half(sides[0]), half(sides[1])],
            span: sides[2],
            origin: [zero, unit(axes[0]), unit(axes[1])],
            direction: [unit(axes[2]), zero, zero],
            error: zero,
        }
    }

    /// Returns a tile of rays that pass near `point`. The rays start at one eye or are parallel.
    fn around_point(rng: &mut Rng, point: [f64; 3]) -> Self {
        let distance = 2f64.powi(rng.i32(-2..=3));
        let way = vector(rng, distance);
        let t = 2f64.powi(rng.i32(-2..=4));
        let depth = t * 2f64.powi(-rng.i32(0..=24));
        let width = 2f64.powi(-rng.i32(0..=12));
        let (a, b) = (vector(rng, distance / t), vector(rng, distance / t));
        let parallel = rng.bool();
        let zero = [0.0; 3];
        let [base, screen] = [0, 1].map(|k| if (k == 0) == parallel { [a, b] } else { [zero; 2] });
        let centre = [(); 2].map(|()| f64::uniform(rng) * 2.0 - 1.0);
        let half = [width, if rng.u32(0..4) == 0 { 0.0 } else { width }];
        let mut tile = Self {
            centre,
            half,
            span: [t - depth * f64::uniform(rng), t + depth],
            origin: [zero, base[0], base[1]],
            direction: [way.map(|way| way / t), screen[0], screen[1]],
            error: zero,
        };
        // Makes the middle ray meet the point.
        let at = tile.position(centre, t);
        tile.origin[0] = [0, 1, 2].map(|k| point[k] - at[k]);
        tile
    }

    fn rounded<T: Adversarial>(mut self) -> Self {
        let nearest = |x: f64| T::nearest(x).into();
        self.centre = self.centre.map(nearest);
        self.half = self.half.map(nearest);
        self.span = self.span.map(nearest);
        self.origin = self.origin.map(|v| v.map(nearest));
        self.direction = self.direction.map(|v| v.map(nearest));
        self
    }

    /// Returns products whose sum is the coordinate along `axis` of the ray (a, b) at t.
    fn terms(&self, [a, b]: [f64; 2], t: f64, axis: usize) -> [(f64, f64); 8] {
        let [o, o_a, o_b] = self.origin.map(|v| v[axis]);
        let [d, d_a, d_b] = self.direction.map(|v| v[axis]);
        let [(ta, ta_rest), (tb, tb_rest)] = [a, b].map(|x| (t * x, t.mul_add(x, -(t * x))));
        [(o, 1.0), (a, o_a), (b, o_b), (t, d), (ta, d_a), (ta_rest, d_a), (tb, d_b), (tb_rest, d_b)]
    }

    fn position(&self, screen: [f64; 2], t: f64) -> [f64; 3] {
        [0, 1, 2].map(|axis| dot(self.terms(screen, t, axis)).value)
    }

    /// Returns probes in the domain, on or near rays of the tile, ray by ray. Probes at the ends of
    /// a ray come first. Sets the tile's error to bound the probes' distances from their rays.
    pub(super) fn random_probes<T: Adversarial>(
        &mut self,
        case: &Case,
        rng: &mut Rng,
        count: usize,
    ) -> Vec<Probe> {
        const PROBES_PER_RAY: usize = 4;
        let off = match rng.u32(0..4) {
            0 => 2f64.powi(-rng.i32(4..=40)),
            _ => 0.0,
        };
        let mut probes = Vec::new();
        for ray in 0..count / PROBES_PER_RAY {
            let screen = [0, 1].map(|k| {
                let (centre, half) = (self.centre[k], self.half[k]);
                // The ends centre ± half are rounded inward.
                let lo = centre - half;
                let lo = if dot([(centre, 1.0), (half, -1.0), (lo, -1.0)]).value > 0.0 {
                    lo.next_up()
                } else {
                    lo
                };
                let hi = centre + half;
                let hi = if dot([(centre, -1.0), (half, -1.0), (hi, 1.0)]).value > 0.0 {
                    hi.next_down()
                } else {
                    hi
                };
                within(rng, [lo.min(centre), hi.max(centre)])
            });
            for number in 0..PROBES_PER_RAY {
                let t = match number {
                    0 | 1 => self.span[number],
                    _ => within(rng, self.span),
                };
                let mut at = self.position(screen, t);
                let mut is_inside = true;
                for (x, range) in at.iter_mut().zip(case.assumptions.domain) {
                    *x += [-off, off, 0.0][rng.u32(0..3) as usize];
                    let inside = x.clamp(range.lo, range.hi);
                    // A point that leaves the domain by about one rounding of its numbers is moved
                    // back.
                    is_inside &= (inside - *x).abs() <= 2.0 * f64::from(f32::EPSILON) * x.abs();
                    *x = inside;
                }
                if is_inside && at.iter().all(|x| x.is_finite()) {
                    probes.push(Probe { ray, screen, t, at });
                }
            }
        }
        for probe in &probes {
            for axis in 0..3 {
                let off = self.off::<T>(probe, axis);
                self.error[axis] = self.error[axis].max(off);
            }
        }
        probes
    }

    /// Returns an upper bound of the distance along `axis` between a probe and its ray.
    fn off<T: Adversarial>(&self, probe: &Probe, axis: usize) -> f64 {
        let terms = self.terms(probe.screen, probe.t, axis).into_iter();
        let off = dot(terms.chain([(probe.at[axis], -1.0)])).most();
        // Products of t and a screen coordinate may underflow. This bounds what they lose.
        let lost = [1, 2].map(|k| self.direction[k][axis].abs() * f64::from_bits(1));
        T::above((off + lost[0] + lost[1]).next_up().next_up()).into()
    }

    /// Returns a random part of the tile. The part contains `probe`.
    pub(super) fn narrower<T: Adversarial>(&self, rng: &mut Rng, probe: &Probe) -> Self {
        let mut part = *self;
        let share = 2f64.powi(-rng.i32(0..=30));
        let near: f64 = T::nearest(probe.t - (probe.t - self.span[0]) * share).into();
        let far: f64 = T::nearest(probe.t + (self.span[1] - probe.t) * share).into();
        let [near, far] = [near.max(self.span[0]), far.min(self.span[1])];
        if near <= probe.t && probe.t <= far {
            part.span = [near, far];
        }
        for k in 0..2 {
            let share = 2f64.powi(-rng.i32(0..=12));
            let half: f64 = T::nearest(self.half[k] * share).into();
            let centre: f64 = T::nearest(probe.screen[k] + half * (f64::uniform(rng) - 0.5)).into();
            if (probe.screen[k] - centre).abs() * (1.0 + 1e-9) <= half {
                (part.centre[k], part.half[k]) = (centre, half);
            }
        }
        part
    }

    /// Whether a plane certainly misses the claim at a probe by more than the plane's error. The
    /// plane's slopes belong to the tile's two symbols and to (t − middle)/half.
    pub(super) fn misses(
        &self,
        probe: &Probe,
        (value, slopes, error): (f64, [f64; 3], f64),
        [middle, half]: [f64; 2],
        claim: &Claim,
    ) -> bool {
        let symbols = [
            symbol(probe.screen[0], self.centre[0], self.half[0]),
            symbol(probe.screen[1], self.centre[1], self.half[1]),
            symbol(probe.t, middle, half),
        ];
        let line = || {
            let terms = slopes.into_iter().zip(symbols);
            let terms = terms.flat_map(|(slope, [head, tail])| [(slope, head), (slope, tail)]);
            terms.chain([(value, 1.0)])
        };
        if line().any(|(a, b)| !(a * b).is_finite()) {
            return !value.is_finite() || slopes.iter().any(|slope| !slope.is_finite());
        }
        let above = dot(line().map(|(a, b)| (-a, b)).chain([(claim.lo, 1.0), (-error, 1.0)]));
        let below = dot(line().chain([(-claim.hi, 1.0), (-error, 1.0)]));
        above.is_positive() || below.is_positive()
    }
}

/// Packs tiles into a batch for kernels.
pub(super) fn pack_tiles<T: Adversarial>(tiles: &[Tile]) -> Tiles<T> {
    let mut batch = Tiles { count: tiles.len().min(LANES) as u32, ..Tiles::default() };
    for (lane, tile) in tiles.iter().enumerate() {
        for k in 0..2 {
            batch.centre[k][lane] = T::nearest(tile.centre[k]);
            batch.half[k][lane] = T::nearest(tile.half[k]);
        }
        [batch.near[lane], batch.far[lane]] = tile.span.map(T::nearest);
        for k in 0..9 {
            batch.origin[k][lane] = T::nearest(tile.origin[k / 3][k % 3]);
            batch.direction[k][lane] = T::nearest(tile.direction[k / 3][k % 3]);
        }
        for axis in 0..3 {
            batch.error[axis][lane] = T::nearest(tile.error[axis]);
        }
    }
    batch.allow_rounding();
    batch
}

/// Packs one ray per tile into a batch of segments: the ray with the probe's screen coordinates.
pub(super) fn pack_segments<T: Adversarial>(tiles: &[Tile], probe: &Probe) -> Segments<T> {
    let mut batch = Segments { count: tiles.len().min(LANES) as u32, ..Segments::default() };
    for (lane, tile) in tiles.iter().enumerate() {
        let [from, to] = [0.0, 1.0].map(|t| tile.position(probe.screen, t));
        [batch.near[lane], batch.far[lane]] = tile.span.map(T::nearest);
        for axis in 0..3 {
            let origin = T::nearest(from[axis]);
            let direction = T::nearest(to[axis] - from[axis]);
            let terms = [(origin.into(), 1.0), (probe.t, direction.into()), (probe.at[axis], -1.0)];
            batch.origin[axis][lane] = origin;
            batch.direction[axis][lane] = direction;
            batch.error[axis][lane] = T::above(dot(terms).most());
        }
    }
    batch.allow_rounding();
    batch
}
