//! The part of a cube where linear functions are negative, as tetrahedra, and its moments.
//!
//! All coordinates are the cube's own, which run from −1 to 1.

use glam::DVec3;
use zeroset_interval::Interval;

/// A function that lies between `linear − error` and `linear + error` in a cube.
#[derive(Clone, Copy, Debug)]
pub struct Strip {
    /// Value at the middle of the cube.
    pub value: f64,
    /// Slope along each axis of the cube.
    pub slope: DVec3,
    /// Bound of the distance, rounding of [`Strip::at`] included.
    pub error: f64,
}

impl Strip {
    /// The linear function at a point of the cube.
    pub fn at(&self, point: DVec3) -> f64 {
        self.value + self.slope.dot(point)
    }

    /// Bounds of the function in the cube.
    pub fn bounds(&self) -> (f64, f64) {
        let reach = self.slope.abs().element_sum() + self.error;
        (self.value - reach, self.value + reach)
    }
}

/// The corners of a tetrahedron.
pub type Tetrahedron = [DVec3; 4];

/// The cube as six tetrahedra around its diagonal.
pub fn cube() -> Vec<Tetrahedron> {
    let corner = |n: usize| {
        DVec3::from_array([0, 1, 2].map(|axis| if n >> axis & 1 == 1 { 1.0 } else { -1.0 }))
    };
    [[1, 3], [1, 5], [2, 3], [2, 6], [4, 5], [4, 6]]
        .map(|[i, k]| [corner(0), corner(i), corner(k), corner(7)])
        .to_vec()
}

/// The part of the tetrahedra where `strip.linear + offset ≤ 0`.
pub fn clip(tetrahedra: &[Tetrahedron], strip: &Strip, offset: f64) -> Vec<Tetrahedron> {
    let mut clipped = Vec::with_capacity(2 * tetrahedra.len());
    for tetrahedron in tetrahedra {
        let mut corners = tetrahedron.map(|corner| (corner, strip.at(corner) + offset));
        corners.sort_by(|a, b| a.1.total_cmp(&b.1));
        let inside = corners.iter().filter(|(_, value)| *value <= 0.0).count();
        let [a, b, c, d] = corners.map(|(corner, _)| corner);
        // The zero on the edge between two corners.
        let on = |i: usize, k: usize| {
            let ((from, below), (to, above)) = (corners[i], corners[k]);
            from.lerp(to, below / (below - above))
        };
        match inside {
            0 => {}
            1 => clipped.push([a, on(0, 1), on(0, 2), on(0, 3)]),
            2 => {
                let (left, right) = ([a, on(0, 2), on(0, 3)], [b, on(1, 2), on(1, 3)]);
                clipped.extend(prism(left, right));
            }
            3 => clipped.extend(prism([a, b, c], [on(0, 3), on(1, 3), on(2, 3)])),
            _ => clipped.push([a, b, c, d]),
        }
    }
    clipped
}

/// The three tetrahedra of a prism between two triangles.
fn prism(from: [DVec3; 3], to: [DVec3; 3]) -> [Tetrahedron; 3] {
    let ([a, b, c], [d, e, f]) = (from, to);
    [[a, b, c, f], [a, b, e, f], [a, d, e, f]]
}

/// The vector (y, z, x).
fn next(p: DVec3) -> DVec3 {
    DVec3::new(p.y, p.z, p.x)
}

/// Integrals over a solid.
#[derive(Clone, Copy, Debug, Default)]
pub struct Moments {
    /// Volume.
    pub volume: f64,
    /// Integral of each coordinate.
    pub first: DVec3,
    /// Integrals of x², y² and z².
    pub squares: DVec3,
    /// Integrals of y·z, z·x and x·y.
    pub products: DVec3,
}

impl Moments {
    /// The integrals over tetrahedra.
    pub fn of(tetrahedra: &[Tetrahedron]) -> Self {
        let mut all = Self::default();
        for [a, b, c, d] in tetrahedra {
            let volume = (b - a).cross(c - a).dot(d - a).abs() / 6.0;
            let sum = a + b + c + d;
            // The integral of x·y is V/20 · (Σ xᵢ yᵢ + Σ xᵢ Σ yᵢ).
            let pairs = |one: fn(DVec3) -> DVec3| {
                let each = [a, b, c, d].into_iter().map(|p| *p * one(*p)).sum::<DVec3>();
                (each + sum * one(sum)) * (volume / 20.0)
            };
            all.volume += volume;
            all.first += sum * (volume / 4.0);
            all.squares += pairs(|p| p);
            // `pairs` are x·y, y·z and z·x. They are rotated into the order of `products`.
            all.products += next(pairs(next));
        }
        all
    }

    /// The integrals over tetrahedra, weighted by a linear function. They take twice as long as
    /// those of [`Moments::of`].
    pub fn weighted(tetrahedra: &[Tetrahedron], weight: &Strip) -> Self {
        let mut all = Self::default();
        for corners in tetrahedra {
            let [a, b, c, d] = corners;
            let volume = (b - a).cross(c - a).dot(d - a).abs() / 6.0;
            let weights = corners.map(|corner| weight.at(corner));
            let (sum, total) = (a + b + c + d, weights.iter().sum::<f64>());
            let each = || corners.iter().zip(weights);
            let weighted = each().map(|(p, weight)| *p * weight).sum::<DVec3>();
            // The integral of w·x·y is V/120 times the sum of wᵢ·xⱼ·yₖ over all i, j and k. A term
            // counts twice if two of the three numbers are equal, and six times if all are.
            let pairs = |one: fn(DVec3) -> DVec3| {
                let equal =
                    each().map(|(p, weight)| *p * one(*p) * (total + 2.0 * weight)).sum::<DVec3>();
                let mixed = weighted * one(sum) + sum * one(weighted);
                (sum * one(sum) * total + mixed + equal) * (volume / 120.0)
            };
            all.volume += total * (volume / 4.0);
            all.first += (weighted + sum * total) * (volume / 20.0);
            all.squares += pairs(|p| p);
            all.products += next(pairs(next));
        }
        all
    }

    /// All integrals, in their order.
    pub fn to_array(self) -> [f64; 10] {
        let [x, y, z] = self.first.to_array();
        let [xx, yy, zz] = self.squares.to_array();
        let [yz, zx, xy] = self.products.to_array();
        [self.volume, x, y, z, xx, yy, zz, yz, zx, xy]
    }

    /// The integrals of which [`Moments::to_array`] is the list.
    pub fn from_array([volume, x, y, z, xx, yy, zz, yz, zx, xy]: [f64; 10]) -> Self {
        Self {
            volume,
            first: DVec3::new(x, y, z),
            squares: DVec3::new(xx, yy, zz),
            products: DVec3::new(yz, zx, xy),
        }
    }

    /// The integrals over the whole cube.
    pub const CUBE: Self = Self {
        volume: 8.0,
        first: DVec3::ZERO,
        squares: DVec3::splat(8.0 / 3.0),
        products: DVec3::ZERO,
    };

    /// Bounds of the integrals over a box with these half extents, in which no coordinate exceeds
    /// `reach`.
    pub fn most(reach: DVec3, half: DVec3) -> Self {
        let volume = 8.0 * half.x * half.y * half.z;
        let products = next(reach) * next(next(reach));
        Self {
            volume,
            first: volume * reach,
            squares: volume * reach * reach,
            products: volume * products,
        }
    }

    /// The integrals times a number.
    #[must_use]
    pub fn times(&self, by: f64) -> Self {
        Self {
            volume: by * self.volume,
            first: by * self.first,
            squares: by * self.squares,
            products: by * self.products,
        }
    }

    /// Adds other integrals.
    pub fn add(&mut self, other: &Self) {
        self.volume += other.volume;
        self.first += other.first;
        self.squares += other.squares;
        self.products += other.products;
    }

    /// The smaller and the larger of each two integrals.
    pub fn ordered([one, other]: [Self; 2]) -> [Self; 2] {
        let of = |volume: fn(f64, f64) -> f64, each: fn(DVec3, DVec3) -> DVec3| Self {
            volume: volume(one.volume, other.volume),
            first: each(one.first, other.first),
            squares: each(one.squares, other.squares),
            products: each(one.products, other.products),
        };
        [of(f64::min, DVec3::min), of(f64::max, DVec3::max)]
    }

    /// Narrower bounds of the integrals over a set with this volume, whose coordinates are in these
    /// ranges.
    pub fn within(bounds: [Self; 2], volume: Interval, ranges: [Interval; 3]) -> [Self; 2] {
        let [mut least, mut most] = bounds;
        (least.volume, most.volume) = (volume.lo, volume.hi);
        for axis in 0..3 {
            let (own, one, other) = (ranges[axis], ranges[(axis + 1) % 3], ranges[(axis + 2) % 3]);
            let narrow = |low: &mut DVec3, high: &mut DVec3, bounds: Interval| {
                low[axis] = low[axis].max(bounds.lo);
                high[axis] = high[axis].min(bounds.hi);
            };
            narrow(&mut least.first, &mut most.first, volume.times(own));
            narrow(&mut least.squares, &mut most.squares, volume.times(own.times(own)));
            narrow(&mut least.products, &mut most.products, volume.times(one.times(other)));
        }
        [least, most]
    }

    /// The integrals in the coordinates `middle + half · p`, where p are the cube's coordinates.
    pub fn moved(&self, middle: DVec3, half: DVec3) -> Self {
        let scale = half.x * half.y * half.z;
        let (first, volume) = (half * self.first, self.volume);
        let squares = half * half * self.squares + 2.0 * middle * first + middle * middle * volume;
        let last = |p: DVec3| next(next(p));
        let products = next(half) * last(half) * self.products
            + next(middle) * last(first)
            + next(first) * last(middle)
            + next(middle) * last(middle) * volume;
        Self {
            volume: scale * volume,
            first: scale * (first + middle * volume),
            squares: scale * squares,
            products: scale * products,
        }
    }
}
