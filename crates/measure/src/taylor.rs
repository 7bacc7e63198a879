//! Polynomials near a function in boxes, from bounds of its derivatives.

use crate::clip::{Moments, Strip};
use crate::wall::{approximated, sides, strip};
use glam::DVec3;
use zeroset_eval::{Boxes, EncloseGradient, GradientEnclosures, Kernel, Planes};
use zeroset_interval::Interval;
use zeroset_scene::program::Program;
use zeroset_space::Cell;

/// Bound of rounding errors of a function, relative to its values.
const ROUNDING: f64 = 1e-13;

fn gradients(
    kernel: &dyn Kernel<EncloseGradient, f64>,
    boxes: &[[Interval; 3]],
) -> GradientEnclosures<f64> {
    let mut found = GradientEnclosures::default();
    kernel.eval(&Boxes::around(boxes)[0], &mut found);
    found
}

/// Bounds of a function's derivatives in up to sixteen boxes.
pub struct Derivatives {
    /// The function and its gradient at the center.
    centre: GradientEnclosures<f64>,
    /// The gradient.
    first: GradientEnclosures<f64>,
    /// The gradient of each partial derivative, if it is known.
    second: Option<[GradientEnclosures<f64>; 3]>,
    /// Affine forms of the function, if they are of use.
    planes: Option<Planes<f64>>,
}

impl Derivatives {
    /// The derivatives of a program's function, whose partial derivatives may be the functions of
    /// another program. `None` if a kernel is not available.
    pub fn of(
        (program, number): (&Program, usize),
        slopes: Option<&Program>,
        cells: &[Cell],
    ) -> Option<Self> {
        let boxes: Vec<[Interval; 3]> = cells.iter().map(sides).collect();
        let centre = |cell: &Cell| cell.centre().map(|at| Interval { lo: at, hi: at });
        let centres: Vec<[Interval; 3]> = cells.iter().map(centre).collect();
        let kernel = program.kernels::<f64>(number).gradient_bounds().ok()?;
        let second = |slopes: &Program| {
            let of = |axis: usize| {
                Some(gradients(slopes.kernels::<f64>(axis).gradient_bounds().ok()?, &boxes))
            };
            Some([of(0)?, of(1)?, of(2)?])
        };
        Some(Self {
            centre: gradients(kernel, &centres),
            first: gradients(kernel, &boxes),
            second: slopes.and_then(second),
            planes: None,
        })
    }

    /// The first derivatives of a program's function, and its affine forms. `None` if a kernel is
    /// not available.
    pub fn with_planes((program, number): (&Program, usize), cells: &[Cell]) -> Option<Self> {
        let planes = || {
            // For an equation, the kernel approximates the numerator of a rational form.
            let is_own = program.is_solid(number) || program.cleared(number).ok()?.is_none();
            let kernel = is_own.then(|| program.kernels::<f64>(number).tiles().ok()).flatten()?;
            Some(approximated(kernel, cells))
        };
        Some(Self { planes: planes(), ..Self::of((program, number), None, cells)? })
    }

    /// A linear function near the function in a box, with rounding. `None` if the function is not
    /// proven to be Lipschitz continuous.
    pub fn linear(&self, cell: &Cell, lane: usize) -> Option<Strip> {
        let form = self.form(cell, lane)?;
        let (mut best, mut size) = (form.linear(), form.size());
        let is_solid = (0..3).all(|axis| cell.extent(axis) > 0.0);
        if let Some(plane) = self.planes.as_ref().filter(|_| is_solid).map(|all| strip(all, lane))
            && plane.error < best.error
        {
            size = plane.value.abs() + plane.slope.abs().element_sum();
            best = plane;
        }
        let places: f64 = (0..3).map(|axis| best.slope[axis].abs() * rounding(cell, axis)).sum();
        best.error += places + ROUNDING * size + f64::MIN_POSITIVE;
        Some(best)
    }

    /// Bounds of the gradient in a box. `None` if the function is not proven to be Lipschitz
    /// continuous.
    pub fn gradient(&self, lane: usize) -> Option<[Interval; 3]> {
        let bounds = |axis: usize| Interval {
            lo: -self.first.gradient_neg_lo[axis][lane],
            hi: self.first.gradient_hi[axis][lane],
        };
        (self.first.lipschitz >> lane & 1 == 1).then(|| [0, 1, 2].map(bounds))
    }

    /// The polynomial in a box. `None` if the function is not proven to be Lipschitz continuous.
    pub fn form(&self, cell: &Cell, lane: usize) -> Option<Quadratic> {
        let half = [0, 1, 2].map(|axis| 0.5 * cell.extent(axis));
        let is = |of: &GradientEnclosures<f64>| of.lipschitz >> lane & 1 == 1;
        let gradient = |of: &GradientEnclosures<f64>, axis: usize| Interval {
            lo: half[axis] * -of.gradient_neg_lo[axis][lane],
            hi: half[axis] * of.gradient_hi[axis][lane],
        };
        if !is(&self.first) {
            return None;
        }
        let own = Interval { lo: -self.centre.neg_lo[lane], hi: self.centre.hi[lane] };
        let mut form = Quadratic { value: middle(own), error: radius(own), ..Quadratic::default() };
        // Taylor's polynomial with the second derivatives' middles, or else the mean value theorem.
        let second = self.second.as_ref().filter(|all| is(&self.centre) && all.iter().all(is));
        let slopes = if second.is_some() { &self.centre } else { &self.first };
        for axis in 0..3 {
            let slope = gradient(slopes, axis);
            form.slope[axis] = middle(slope);
            form.error += radius(slope);
            let (one, other) = ((axis + 1) % 3, (axis + 2) % 3);
            if let Some(second) = second {
                let square = scaled(gradient(&second[axis], axis), half[axis]);
                let product = scaled(gradient(&second[one], other), half[one]);
                (form.squares[axis], form.products[axis]) = (middle(square), middle(product));
                form.error += 0.5 * radius(square) + radius(product);
            }
        }
        form.error += 64.0 * f64::EPSILON * form.size();
        form.size().is_finite().then_some(form).filter(|form| form.error.is_finite())
    }
}

/// Rounding of a coordinate, as a share of half the extent of a box.
pub fn rounding(cell: &Cell, axis: usize) -> f64 {
    let half = 0.5 * cell.extent(axis);
    if half > 0.0 { 8.0 * f64::EPSILON * cell.reach() / half } else { 0.0 }
}

fn middle(of: Interval) -> f64 {
    of.lo.midpoint(of.hi)
}

fn radius(of: Interval) -> f64 {
    (0.5 * (of.hi - of.lo)).next_up()
}

fn scaled(of: Interval, by: f64) -> Interval {
    Interval { lo: by * of.lo, hi: by * of.hi }
}

/// A polynomial of degree 2 in the coordinates of a cube, and an error.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quadratic {
    /// Value at the middle.
    pub value: f64,
    /// Slope along each axis.
    pub slope: DVec3,
    /// Second derivatives by x, y and z.
    pub squares: DVec3,
    /// Second derivatives by y and z, z and x, x and y.
    pub products: DVec3,
    /// Bound of the distance of a function from the polynomial.
    pub error: f64,
}

impl Quadratic {
    /// A bound of the polynomial's values, and of its derivative along any way in the cube.
    pub fn size(&self) -> f64 {
        let second = self.squares.abs().element_sum() + 2.0 * self.products.abs().element_sum();
        self.value.abs() + self.slope.abs().element_sum() + second
    }

    /// A linear function nearby.
    pub fn linear(&self) -> Strip {
        let squares = 0.25 * self.squares.abs().element_sum();
        Strip {
            value: self.value + 0.25 * self.squares.element_sum(),
            slope: self.slope,
            error: self.error + squares + self.products.abs().element_sum(),
        }
    }

    /// The integrals over the cube.
    pub fn moments(&self) -> Moments {
        let [value, squares] = [8.0 * self.value, 0.5 * self.squares.element_sum()];
        // The integrals of ε², ε⁴ and ε²δ² over the cube are 8/3, 8/5 and 8/9.
        let [second, fourth, mixed] = [8.0 / 3.0, 8.0 / 5.0, 8.0 / 9.0];
        let own = 0.5 * self.squares;
        Moments {
            volume: value + second * squares,
            first: second * self.slope,
            squares: DVec3::splat(value / 3.0) + fourth * own + mixed * (squares - own),
            products: mixed * self.products,
        }
    }
}
