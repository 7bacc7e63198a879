//! Planes and points with whole-number coordinates of any size.

use glam::DVec3;
use num_bigint::{BigInt, Sign};
use num_integer::Integer;
use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};
use rustc_hash::FxHashMap;

/// A bound of the relative error of a linear function in `f64`.
const ERROR: f64 = 1e-14;

/// A linear function, up to a factor above 0: coefficients of x, y and z, and the constant.
#[derive(Clone, Debug)]
pub struct Plane {
    exact: [BigInt; 4],
    rounded: [f64; 4],
}

impl Plane {
    pub fn of(function: &[BigRational; 4]) -> Self {
        let common = function.iter().fold(BigInt::one(), |all, one| all.lcm(one.denom()));
        let whole = function.each_ref().map(|one| one.numer() * (&common / one.denom()));
        let exact = primitive(whole);
        let rounded = exact.each_ref().map(|one| one.to_f64().unwrap_or(f64::NAN));
        Self { exact, rounded }
    }
}

/// The same numbers, divided by their greatest common divisor.
fn primitive<const N: usize>(whole: [BigInt; N]) -> [BigInt; N] {
    let common = whole.iter().fold(BigInt::zero(), |all, one| all.gcd(one));
    if common.is_zero() { whole } else { whole.map(|one| one / &common) }
}

/// A line: its direction, and its moment. Both do not depend on the points that give the line.
pub type Line = ([BigInt; 3], [BigRational; 3]);

/// A point: multiples of its coordinates, and the factor, which is above 0.
struct Point {
    exact: [BigInt; 4],
    /// Rounded coordinates.
    place: DVec3,
}

/// Planes, and points in which three of them meet.
pub struct Points {
    pub planes: Vec<Plane>,
    all: Vec<Point>,
    numbers: FxHashMap<[BigInt; 4], u32>,
}

impl Points {
    pub fn new(planes: Vec<Plane>) -> Self {
        Self { planes, all: Vec::new(), numbers: FxHashMap::default() }
    }

    /// The point in which three planes meet.
    ///
    /// # Panics
    /// If the planes have more points in common, or none.
    pub fn common(&mut self, planes: [usize; 3]) -> u32 {
        let [a, b, c] = planes.map(|plane| &self.planes[plane].exact);
        // By Cramer's rule: each coordinate is a determinant without that coordinate's column.
        let minor = |[i, j, k]: [usize; 3]| {
            &a[i] * (&b[j] * &c[k] - &b[k] * &c[j]) - &a[j] * (&b[i] * &c[k] - &b[k] * &c[i])
                + &a[k] * (&b[i] * &c[j] - &b[j] * &c[i])
        };
        let weight = minor([0, 1, 2]);
        assert!(!weight.is_zero(), "planes without a common point");
        let turn = |number: BigInt| if weight.is_negative() { -number } else { number };
        let whole = [-minor([3, 1, 2]), -minor([0, 3, 2]), -minor([0, 1, 3]), weight.clone()];
        let exact = primitive(whole.map(turn));
        if let Some(number) = self.numbers.get(&exact) {
            return *number;
        }
        let number = self.all.len() as u32;
        let along = |axis: usize| {
            BigRational::new_raw(exact[axis].clone(), exact[3].clone()).to_f64().unwrap_or(f64::NAN)
        };
        let place = DVec3::from_array([0, 1, 2].map(along));
        self.numbers.insert(exact.clone(), number);
        self.all.push(Point { exact, place });
        number
    }

    /// The sign of a plane's function at a point.
    pub fn side(&self, plane: usize, point: u32) -> i8 {
        let (plane, point) = (&self.planes[plane], &self.all[point as usize]);
        let terms: [f64; 3] = [0, 1, 2].map(|axis| plane.rounded[axis] * point.place[axis]);
        let value = terms.iter().sum::<f64>() + plane.rounded[3];
        let size = terms.iter().map(|term| term.abs()).sum::<f64>() + plane.rounded[3].abs();
        // False for NaN.
        if value.abs() > ERROR * size {
            return if value > 0.0 { 1 } else { -1 };
        }
        sign(&dot(&plane.exact, &point.exact))
    }

    /// The rounded place of a point.
    pub fn place(&self, point: u32) -> DVec3 {
        self.all[point as usize].place
    }

    /// The line through two planes, which has this point. The direction is that of the product of
    /// their normals, or the opposite.
    pub fn line(&self, planes: [usize; 2], point: u32) -> Line {
        let [a, b] = planes.map(|plane| &self.planes[plane].exact);
        let direction = primitive(cross([&a[0], &a[1], &a[2]], [&b[0], &b[1], &b[2]]));
        let first = direction.iter().find(|along| !along.is_zero());
        let is_turned = first.is_some_and(Signed::is_negative);
        let direction = direction.map(|along| if is_turned { -along } else { along });
        let [x, y, z, weight] = &self.all[point as usize].exact;
        let moment = cross([x, y, z], direction.each_ref());
        (direction, moment.map(|along| BigRational::new(along, weight.clone())))
    }

    /// The scalar product of a point and a direction.
    pub fn along(&self, direction: &[BigInt; 3], point: u32) -> BigRational {
        let [x, y, z, weight] = &self.all[point as usize].exact;
        let [u, v, w] = direction;
        BigRational::new(x * u + y * v + z * w, weight.clone())
    }

    /// The signs of all planes' functions between some points, at their mean.
    pub fn signs_between(&self, points: &[u32]) -> Vec<i8> {
        let exact = |point: &u32| &self.all[*point as usize].exact;
        let common = points.iter().fold(BigInt::one(), |all, one| all.lcm(&exact(one)[3]));
        let mut sum = [(); 4].map(|()| BigInt::zero());
        for point in points.iter().map(exact) {
            let factor = &common / &point[3];
            for (sum, along) in sum.iter_mut().zip(point) {
                *sum += along * &factor;
            }
        }
        self.planes.iter().map(|plane| sign(&dot(&plane.exact, &sum))).collect()
    }

    /// The least distance between two parallel planes among these. `None` without parallel planes.
    pub fn thinnest(&self, planes: impl Iterator<Item = usize>) -> Option<f64> {
        let mut parallel: FxHashMap<[BigInt; 3], Vec<f64>> = FxHashMap::default();
        for plane in planes {
            let [x, y, z, _] = &self.planes[plane].exact;
            let common = x.gcd(y).gcd(z);
            let first = [x, y, z].into_iter().find(|along| !along.is_zero());
            let common = if first.is_some_and(Signed::is_negative) { -common } else { common };
            let normal = [x / &common, y / &common, z / &common];
            let length = DVec3::from_array(normal.each_ref().map(to_f64)).length();
            let number = self.planes[plane].rounded[3] / to_f64(&common) / length;
            parallel.entry(normal).or_default().push(number);
        }
        let gap = |mut numbers: Vec<f64>| {
            numbers.sort_by(f64::total_cmp);
            let gaps = numbers.windows(2).map(|pair| pair[1] - pair[0]);
            gaps.filter(|gap| *gap > 0.0).min_by(f64::total_cmp)
        };
        parallel.into_values().filter_map(gap).min_by(f64::total_cmp)
    }
}

fn sign(number: &BigInt) -> i8 {
    match number.sign() {
        Sign::Minus => -1,
        Sign::NoSign => 0,
        Sign::Plus => 1,
    }
}

fn to_f64(number: &BigInt) -> f64 {
    number.to_f64().unwrap_or(f64::NAN)
}

fn dot(plane: &[BigInt; 4], point: &[BigInt; 4]) -> BigInt {
    plane.iter().zip(point).map(|(a, b)| a * b).sum()
}

fn cross([a, b, c]: [&BigInt; 3], [u, v, w]: [&BigInt; 3]) -> [BigInt; 3] {
    [b * w - c * v, c * u - a * w, a * v - b * u]
}
