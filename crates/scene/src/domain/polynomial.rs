//! Polynomials in x, y and z, and their centers, which move with the surface.
//!
//! Everything is computed in floats rounded to nearest; nothing is a proof. This module depends
//! neither on kernels nor on boxes.

use glam::DVec3;
use std::collections::BTreeMap;

/// A symmetric matrix.
pub type Symmetric = [DVec3; 3];

const IDENTITY: Symmetric = [DVec3::X, DVec3::Y, DVec3::Z];

/// A polynomial: coefficients by the powers of x, y and z.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polynomial(BTreeMap<[u32; 3], f64>);

/// Limits of a product: with more terms, or a higher degree, it is not expanded.
const MOST_TERMS: usize = 400;
const HIGHEST: u32 = 24;

/// A sum a + b counts as 0 if it is at most this share of |a| + |b|: then it is taken for a
/// rounding error.
const ROUNDING: f64 = 1e-14;

/// A direction counts if the square of the polynomial's change along it is more than this share of
/// the sum of such squares over the three axes.
const LEAST_CHANGE: f64 = 1e-20;

impl Polynomial {
    pub fn number(value: f64) -> Self {
        Self::default().with([0; 3], value)
    }

    pub fn axis(axis: usize) -> Self {
        let mut powers = [0; 3];
        powers[axis] = 1;
        Self::default().with(powers, 1.0)
    }

    /// Adds a term: `factor` times the product of the coordinates' powers. A sum that may be 0 up
    /// to rounding is removed.
    fn with(mut self, powers: [u32; 3], factor: f64) -> Self {
        let sum = self.0.entry(powers).or_default();
        let size = sum.abs() + factor.abs();
        *sum += factor;
        if sum.abs() <= ROUNDING * size {
            self.0.remove(&powers);
        }
        self
    }

    /// The sum of this polynomial and `factor` times `other`.
    pub fn plus(&self, factor: f64, other: &Self) -> Self {
        let terms = other.0.iter();
        terms.fold(self.clone(), |sum, (powers, other)| sum.with(*powers, factor * other))
    }

    /// The product; `None` if it exceeds a limit. `work` is the number of pairs of terms that may
    /// still be multiplied, and is updated.
    pub fn times(&self, other: &Self, work: &mut usize) -> Option<Self> {
        *work = work.checked_sub(self.0.len() * other.0.len())?;
        let mut product = Self::default();
        for (a, one) in &self.0 {
            for (b, two) in &other.0 {
                product = product.with([0, 1, 2].map(|axis| a[axis] + b[axis]), one * two);
            }
            if product.0.len() > MOST_TERMS {
                return None;
            }
        }
        (product.degree() <= HIGHEST).then_some(product)
    }

    /// A power; `None` if it exceeds a limit. `work` is as for [`Polynomial::times`].
    pub fn power(&self, exponent: u32, work: &mut usize) -> Option<Self> {
        if exponent.saturating_mul(self.degree()) > HIGHEST {
            return None;
        }
        (0..exponent).try_fold(Self::number(1.0), |power, _| power.times(self, work))
    }

    /// The polynomial's value, if it is a constant.
    pub fn value(&self) -> Option<f64> {
        (self.degree() == 0).then(|| self.0.get(&[0; 3]).copied().unwrap_or(0.0))
    }

    pub fn degree(&self) -> u32 {
        self.0.keys().map(|powers| powers.iter().sum()).max().unwrap_or(0)
    }

    /// The terms of one degree.
    fn form(&self, degree: u32) -> Self {
        let terms = self.0.iter().filter(|(powers, _)| powers.iter().sum::<u32>() == degree);
        Self(terms.map(|(powers, factor)| (*powers, *factor)).collect())
    }

    fn derivative(&self, axis: usize) -> Self {
        let terms = self.0.iter().filter(|(powers, _)| powers[axis] > 0);
        let lowered = terms.map(|(powers, factor)| {
            let mut lower = *powers;
            lower[axis] -= 1;
            (lower, factor * f64::from(powers[axis]))
        });
        Self(lowered.collect())
    }

    /// The polynomial in coordinates whose origin is at `place`.
    fn translated_to(&self, place: DVec3) -> Self {
        let mut seen = self.clone();
        for (axis, along) in
            place.to_array().into_iter().enumerate().filter(|(_, along)| *along != 0.0)
        {
            let mut moved = Self::default();
            for (powers, factor) in &seen.0 {
                // The binomial terms, from the highest power down.
                let (mut lower, mut factor) = (*powers, *factor);
                for k in 0..=powers[axis] {
                    moved = moved.with(lower, factor);
                    factor *= along * f64::from(powers[axis] - k) / f64::from(k + 1);
                    lower[axis] = lower[axis].saturating_sub(1);
                }
            }
            seen = moved;
        }
        seen
    }

    /// The scalar product of the coefficients of two polynomials.
    fn coefficient_product(&self, other: &Self) -> f64 {
        let both = self.0.iter().filter_map(|(powers, one)| Some(one * other.0.get(powers)?));
        both.sum()
    }

    /// The center of the polynomial: the place about which it looks simplest, along the directions
    /// in which there is such a place.
    ///
    /// Moving the origin does not change the terms of the highest degree. At the center, the terms
    /// of one degree less are smallest. For a quadric, this place is the quadric's center. Some
    /// directions do not change the highest terms; along these, terms of lower degrees are treated
    /// in the same way. For x = y², this gives the parabola's tip.
    pub fn middle(&self) -> DirectionalSum {
        let mut free = IDENTITY;
        let (mut pull, mut place) = (DirectionalSum::default(), DVec3::ZERO);
        let (mut seen, mut from) = (self.clone(), place);
        for degree in (1..=self.degree()).rev() {
            if place != from {
                (seen, from) = (self.translated_to(place), place);
            }
            let (highest, lower) = (seen.form(degree), seen.form(degree - 1));
            let changes = [0, 1, 2].map(|axis| highest.derivative(axis));
            let products = |other: &Self| -> DVec3 {
                changes.each_ref().map(|change| change.coefficient_product(other)).into()
            };
            let (gram, wanted) = (changes.each_ref().map(products), -products(&lower));
            let least = LEAST_CHANGE * (gram[0][0] + gram[1][1] + gram[2][2]);
            for (size, along) in principal(within(free, gram)) {
                // Because of rounding, a direction that was already used may be found again.
                if size > least && times(free, along).dot(along) > 0.5 {
                    place += along.dot(wanted) / size * along;
                    pull.add(along, place.dot(along));
                    free = without_direction(free, along);
                }
            }
        }
        pull
    }
}

/// Coordinates of several polynomials' centers along some directions, added up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DirectionalSum {
    directions: Symmetric,
    places: DVec3,
}

impl DirectionalSum {
    /// Adds the coordinate `place` along a direction of length 1.
    fn add(&mut self, along: DVec3, place: f64) {
        self.join(&Self { directions: onto(along), places: along * place });
    }

    pub fn join(&mut self, other: &Self) {
        self.places += other.places;
        for (row, other) in self.directions.iter_mut().zip(other.directions) {
            *row += other;
        }
    }

    /// The mean of the places that were added. Along directions without coordinates it is the mean
    /// of `rest`, or else 0.
    pub fn mean(&self, rest: Option<&Self>) -> DVec3 {
        let (mut free, mut place) = (IDENTITY, DVec3::ZERO);
        for pull in [Some(self), rest].into_iter().flatten() {
            let missing = pull.places - times(pull.directions, place);
            for (size, along) in principal(within(free, pull.directions)) {
                if size > LEAST_WEIGHT {
                    place += along.dot(missing) / size * along;
                    free = without_direction(free, along);
                }
            }
        }
        place
    }
}

/// A direction with a smaller weight than this counts as having no coordinate.
const LEAST_WEIGHT: f64 = 1e-6;

fn times(matrix: Symmetric, vector: DVec3) -> DVec3 {
    matrix.map(|row| row.dot(vector)).into()
}

/// The matrix restricted to the directions onto which `free` projects.
fn within(free: Symmetric, matrix: Symmetric) -> Symmetric {
    let half = free.map(|row| times(matrix, row));
    half.map(|row| times(free, row))
}

/// Removes the direction `along` from the projection `free`.
fn without_direction(free: Symmetric, along: DVec3) -> Symmetric {
    let gone = onto(along);
    [0, 1, 2].map(|axis| free[axis] - gone[axis])
}

/// The projection onto a direction of length 1.
fn onto(along: DVec3) -> Symmetric {
    along.to_array().map(|one| one * along)
}

/// Number of sweeps over the three pairs of axes. Each sweep squares the size of the off-diagonal
/// part, so few sweeps are enough.
const SWEEPS: usize = 5;

/// The eigenvalues and eigenvectors of a symmetric matrix, by Jacobi rotations.
pub fn principal(mut matrix: Symmetric) -> [(f64, DVec3); 3] {
    let mut directions = IDENTITY;
    for (p, q) in [(0, 1), (0, 2), (1, 2)].repeat(SWEEPS) {
        if matrix[p][q] == 0.0 {
            continue;
        }
        let theta = (matrix[q][q] - matrix[p][p]) / (2.0 * matrix[p][q]);
        let tangent = 1.0_f64.copysign(theta) / (theta.abs() + theta.hypot(1.0));
        let cosine = 1.0 / tangent.hypot(1.0);
        let sine = tangent * cosine;
        for row in &mut matrix {
            (row[p], row[q]) = (cosine * row[p] - sine * row[q], sine * row[p] + cosine * row[q]);
        }
        for axis in 0..3 {
            let (a, b) = (matrix[p][axis], matrix[q][axis]);
            (matrix[p][axis], matrix[q][axis]) = (cosine * a - sine * b, sine * a + cosine * b);
            let (a, b) = (directions[p][axis], directions[q][axis]);
            (directions[p][axis], directions[q][axis]) =
                (cosine * a - sine * b, sine * a + cosine * b);
        }
    }
    [0, 1, 2].map(|k| (matrix[k][k], directions[k]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// (x - a)^2 + (y - b)^2 * z, expanded.
    fn umbrella([a, b]: [f64; 2]) -> Polynomial {
        let less =
            |axis: usize, by: f64| Polynomial::axis(axis).plus(-by, &Polynomial::number(1.0));
        let squared = |axis: usize, by: f64| less(axis, by).power(2, &mut 100).expect("short");
        let high = squared(1, b).times(&Polynomial::axis(2), &mut 100).expect("short");
        squared(0, a).plus(1.0, &high)
    }

    #[test]
    fn what_is_written_out_is_the_product() {
        let one = umbrella([0.0; 2]);
        let terms = [([2, 0, 0], 1.0), ([0, 2, 1], 1.0)];
        assert_eq!(one, Polynomial(terms.into_iter().collect()));
        assert_eq!(one.degree(), 3);
        assert_eq!(umbrella([3.0, -2.0]).translated_to(DVec3::new(3.0, -2.0, 0.0)), one);
        assert_eq!(one.plus(-1.0, &one).value(), Some(0.0));
        assert_eq!(one.power(9, &mut 10_000), None);
        assert_eq!(one.power(2, &mut 5), None);
        let sum = [0, 1, 2].map(Polynomial::axis);
        let sum = sum[0].plus(1.0, &sum[1]).plus(1.0, &sum[2]).plus(1.0, &Polynomial::number(1.0));
        assert_eq!(sum.power(6, &mut 1000).expect("short").0.len(), 84);
    }

    #[test]
    fn the_middle_moves_along() {
        let middle = umbrella([3.0, -2.0]).middle().mean(None);
        assert!(middle.distance(DVec3::new(3.0, -2.0, 0.0)) < 1e-12, "{middle:?}");
    }

    #[test]
    fn principal_directions_take_a_matrix_apart() {
        let matrix = [[2.0, 1.0, -0.5], [1.0, -3.0, 4.0], [-0.5, 4.0, 1.0]].map(DVec3::from);
        let parts = principal(matrix);
        for a in 0..3 {
            for b in 0..3 {
                let sum: f64 = parts.iter().map(|(size, along)| size * along[a] * along[b]).sum();
                assert!((sum - matrix[a][b]).abs() < 1e-12, "{parts:?}");
                let dot = parts[a].1.dot(parts[b].1);
                assert!((dot - f64::from(u8::from(a == b))).abs() < 1e-12, "{parts:?}");
            }
        }
    }
}
