//! Normals of a parametric surface at given u and v.
//!
//! Everything is computed in floats rounded to nearest. No proof depends on it.

use crate::program::Program;
use glam::DVec3;
use zeroset_eval::{Gradients, Kernel, KernelError, Points, SampleGradient};
use zeroset_space::PatchCell;

/// A surface's coordinates and their derivatives. As a kernel, it gives the unit normal as gradient
/// at the points (u, v, 0), and 0 as value. The normal is the cross product of the derivatives with
/// respect to u and v, or NaN if that is 0.
pub(super) struct Normals {
    /// Each coordinate and its derivatives, as functions of u and v.
    coordinates: [Box<dyn Kernel<SampleGradient, f64>>; 3],
    /// The ranges of u and v.
    ranges: PatchCell,
}

/// How far a normal is taken beside a point without one, as a share of the ranges of u and v.
const NUDGE: f64 = 1e-4;
/// A normal is too short if its square is below this share of that of the derivatives' lengths.
const SHORT: f64 = 1e-14;

impl Normals {
    /// # Errors
    /// If a kernel fails to compile.
    pub fn new(coordinates: &Program, ranges: PatchCell) -> Result<Self, KernelError> {
        let [x, y, z] = [0, 1, 2].map(|axis| coordinates.gradient_kernel(axis));
        Ok(Self { coordinates: [x?, y?, z?], ranges })
    }

    /// The coordinates and their derivatives at points (u, v, 0).
    fn derivatives(&self, input: &Points<f64>) -> [Gradients<f64>; 3] {
        let mut all: [Gradients<f64>; 3] = Default::default();
        for (kernel, output) in self.coordinates.iter().zip(&mut all) {
            kernel.eval(input, output);
        }
        all
    }

    /// The derivatives beside a pole of the parameters, such as those of a sphere.
    fn beside(&self, pole: [f64; 2]) -> [DVec3; 2] {
        let mut input = Points { count: 1, ..Points::default() };
        for (axis, at) in pole.into_iter().enumerate() {
            let [low, high] = self.ranges[axis];
            input.at[axis][0] = at + NUDGE * (0.5 * (low + high) - at);
        }
        tangents(&self.derivatives(&input), 0)
    }
}

/// The derivatives of the surface's point with respect to u and v, in a lane.
fn tangents(coordinates: &[Gradients<f64>; 3], lane: usize) -> [DVec3; 2] {
    let [x, y, z] = coordinates.each_ref().map(|coordinate| &coordinate.gradient);
    [0, 1].map(|symbol| DVec3::new(x[symbol][lane], y[symbol][lane], z[symbol][lane]))
}

/// Returns whether the cross product of two derivatives is long enough to have a direction.
fn have_normal([along_u, along_v]: [DVec3; 2]) -> bool {
    let sizes = along_u.length_squared() + along_v.length_squared();
    along_u.cross(along_v).length_squared() > SHORT * sizes * sizes
}

impl Kernel<SampleGradient, f64> for Normals {
    fn eval(&self, input: &Points<f64>, output: &mut Gradients<f64>) {
        let coordinates = self.derivatives(input);
        for lane in 0..input.count as usize {
            let mut both = tangents(&coordinates, lane);
            if !have_normal(both) {
                both = self.beside([input.at[0][lane], input.at[1][lane]]);
            }
            let normal = both[0].cross(both[1]).normalize_or(DVec3::NAN);
            output.value[lane] = 0.0;
            for axis in 0..3 {
                output.gradient[axis][lane] = normal[axis];
            }
        }
    }
}
