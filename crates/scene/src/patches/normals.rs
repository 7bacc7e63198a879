//! Normals of a parametric surface, and its points, at given u and v.
//!
//! Everything is computed in floats rounded to nearest. No proof depends on it.

use crate::program::Program;
use glam::DVec3;
use zeroset_eval::{Gradients, Kernel, KernelError, LANES, Points, SampleGradient};
use zeroset_space::PatchCell;

/// A surface's coordinates and their derivatives. As a kernel, it gives the unit normal as gradient
/// at the points (u, v, 0), and 0 as value. The normal is the cross product of the derivatives with
/// respect to u and v. It is NaN where there is none.
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

/// A point of the surface, with its derivatives.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Spot {
    pub uv: [f64; 2],
    pub at: DVec3,
    pub along_u: DVec3,
    pub along_v: DVec3,
}

impl Spot {
    /// The cross product of the derivatives.
    pub fn normal(&self) -> DVec3 {
        self.along_u.cross(self.along_v)
    }

    fn has_normal(&self) -> bool {
        let sizes = self.along_u.length_squared() + self.along_v.length_squared();
        self.normal().length_squared() > SHORT * sizes * sizes
    }
}

impl Normals {
    /// # Errors
    /// If a kernel fails to compile.
    pub fn new(coordinates: &Program, ranges: PatchCell) -> Result<Self, KernelError> {
        let [x, y, z] = [0, 1, 2].map(|axis| coordinates.gradient_kernel(axis));
        Ok(Self { coordinates: [x?, y?, z?], ranges })
    }

    /// The points of the surface at u and v.
    pub fn spots(&self, places: &[[f64; 2]]) -> Vec<Spot> {
        let mut all = Vec::with_capacity(places.len());
        let mut inputs = Points::default();
        let mut outputs: [Gradients<f64>; 3] = Default::default();
        for places in places.chunks(LANES) {
            for (lane, [u, v]) in places.iter().enumerate() {
                (inputs.at[0][lane], inputs.at[1][lane]) = (*u, *v);
            }
            inputs.count = places.len() as u32;
            self.eval_coordinates(&inputs, &mut outputs);
            all.extend((0..places.len()).map(|lane| spot(&inputs, &outputs, lane)));
        }
        all
    }

    fn eval_coordinates(&self, inputs: &Points<f64>, outputs: &mut [Gradients<f64>; 3]) {
        for (kernel, output) in self.coordinates.iter().zip(outputs) {
            kernel.eval(inputs, output);
        }
    }

    /// At a pole of the parameters, such as those of a sphere, takes the derivatives beside it.
    pub fn fill_poles(&self, spots: &mut [Spot]) {
        let poles: Vec<usize> = (0..spots.len()).filter(|k| !spots[*k].has_normal()).collect();
        if poles.is_empty() {
            return;
        }
        let towards_middle = |k: &usize| {
            [0, 1].map(|axis| {
                let ([low, high], at) = (self.ranges[axis], spots[*k].uv[axis]);
                at + NUDGE * (0.5 * (low + high) - at)
            })
        };
        let moved: Vec<[f64; 2]> = poles.iter().map(towards_middle).collect();
        for (k, spot) in poles.iter().zip(self.spots(&moved)) {
            spots[*k] = Spot { at: spots[*k].at, ..spot };
        }
    }
}

/// The point of the surface in a lane.
fn spot(inputs: &Points<f64>, [x, y, z]: &[Gradients<f64>; 3], lane: usize) -> Spot {
    let along = |symbol: usize| {
        let [x, y, z] = [&x.gradient, &y.gradient, &z.gradient];
        DVec3::new(x[symbol][lane], y[symbol][lane], z[symbol][lane])
    };
    Spot {
        uv: [inputs.at[0][lane], inputs.at[1][lane]],
        at: DVec3::new(x.value[lane], y.value[lane], z.value[lane]),
        along_u: along(0),
        along_v: along(1),
    }
}

impl Kernel<SampleGradient, f64> for Normals {
    fn eval(&self, input: &Points<f64>, output: &mut Gradients<f64>) {
        let mut coordinates: [Gradients<f64>; 3] = Default::default();
        self.eval_coordinates(input, &mut coordinates);
        for lane in 0..input.count as usize {
            let mut spot = spot(input, &coordinates, lane);
            if !spot.has_normal() {
                self.fill_poles(std::slice::from_mut(&mut spot));
            }
            let normal = spot.normal().normalize_or(DVec3::NAN);
            output.value[lane] = 0.0;
            for axis in 0..3 {
                output.gradient[axis][lane] = normal[axis];
            }
        }
    }
}
