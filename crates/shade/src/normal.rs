//! Normals of painted points. They are computed after the traversal, and only for painted pixels.
//!
//! For a hit, the gradient is taken at the painted point. If it may have another direction at the
//! zero, it is taken again after one step of Newton's method. If that step turned the gradient, the
//! zero is found in `f64`, if the picture's precision allows it, and the gradient is taken there.
//! If the zero is a multiple one, normals beside it are averaged.
//!
//! For an undecided pixel, the gradient is taken half a pixel before the painted point: where f
//! only touches 0, the gradient at the point is 0. A gradient may not exist (NaN, infinite or zero)
//! at a crease, a cusp or the edge of the domain of definition. Then several substitutes are tried,
//! in this order: the gradient in `f64`, if the picture's precision allows it; gradients a little
//! farther along the ray; central differences over growing steps; the direction to the eye. So a
//! normal is never NaN.

mod at_roots;
mod gradients;

use crate::shade::{ColoredRows, ShadingInput};
use at_roots::{Start, gradients_at_roots, mean_normal};
use glam::DVec3;
use zeroset_eval::{Kernel, Kernels, LANES, Points, Real, Sample, SampleGradient};
use zeroset_space::Ray;
use zeroset_trace::painted::{PixelWindow, SHADED_ROWS};
use zeroset_trace::{GBuffer, KernelStats, RayGrid, Rows, Status};

/// The kernel that normals are computed with.
#[derive(Clone, Copy)]
pub enum NormalSource<'a, T: Real = f32> {
    /// The exact derivative, rounded.
    Gradient(&'a (dyn Kernel<SampleGradient, T> + 'a)),
    /// The exact derivative, computed in `f64` for points at which `T` gives none.
    Refined {
        /// The kernel that is evaluated first.
        kernel: &'a (dyn Kernel<SampleGradient, T> + 'a),
        /// The kernels for points at which the gradient is out of range in `T`.
        double: &'a (dyn Kernels<f64> + 'a),
        /// Whether `double` is used for all points, since floats of `T` are too coarse for them.
        everywhere: bool,
    },
    /// The exact derivative at u and v: [`GBuffer::parameters`], which must be kept. The kernel's
    /// points have u and v as their first two coordinates.
    Parametric(&'a (dyn Kernel<SampleGradient, f64> + 'a)),
    /// Central differences of values one step to either side on each axis, as in Knoll et al. 2007.
    Central(&'a (dyn Kernel<Sample, T> + 'a)),
}

/// Number of points for which substitutes are computed together.
const BATCH: usize = 256;

/// If differences over a step fail, the next step is this many times as long.
const STEP_GROWTH: f64 = 8.0;

/// Number of step lengths that are tried.
const STEPS: u32 = 3;

/// Places along the ray at which gradients are taken, in steps from the painted point. Tracers
/// paint the near end of the segment that holds a root, where the function may not be defined yet.
const AHEAD: [f64; 4] = [0.0, 0.5, 1.0, 2.0];

/// Computes the normal, toward f > 0, of each painted pixel that is not on a cap. `step` is the
/// reach of central differences in world units, such as a thousandth of the region's extent.
/// Returns the number of evaluations.
pub fn normals<T: Real>(
    buffer: &mut GBuffer,
    rays: &RayGrid,
    source: NormalSource<'_, T>,
    step: f64,
) -> KernelStats {
    buffer.each_rows(SHADED_ROWS, |mut rows| source.compute_normals(&mut rows, rays, step, None))
}

/// The part of a ray behind its painted point, and the step along it, in units of the ray's t.
struct Rest {
    ray: Ray,
    step: f64,
    /// The pixel's index in the picture, if it is a hit.
    hit: Option<usize>,
    /// The pixel's width at the painted point, in units of the ray's t.
    width: f64,
}

/// The normals of some rows.
struct BandNormals<'a> {
    /// The picture's normals; empty if it does not keep them.
    kept: &'a mut [[f32; 3]],
    /// If the picture keeps no normals: the normals of windows for which some normals are still
    /// missing.
    waiting: Vec<[[f32; 3]; LANES]>,
}

/// A painted pixel without a normal.
#[derive(Clone, Copy)]
struct OpenPixel {
    /// Its index in the rows.
    pixel: usize,
    /// The index of its normal in [`BandNormals::all`].
    place: usize,
}

impl BandNormals<'_> {
    fn is_kept(&self) -> bool {
        !self.kept.is_empty()
    }

    /// Adds a window whose wanted lanes still need normals. `known` returns the normals of its
    /// other lanes. If the picture keeps normals, these are stored already, and `known` is not
    /// called.
    #[inline(always)]
    fn wait(
        &mut self,
        window: PixelWindow,
        known: impl FnOnce() -> [[f32; 3]; LANES],
        open: &mut Vec<OpenPixel>,
    ) {
        let first = if self.is_kept() {
            window.index
        } else {
            self.waiting.push(known());
            LANES * (self.waiting.len() - 1)
        };
        let pixel = |lane| OpenPixel { pixel: window.index + lane, place: first + lane };
        open.extend(window.lanes().map(pixel));
    }

    fn all(&mut self) -> &mut [[f32; 3]] {
        if self.is_kept() { self.kept } else { self.waiting.as_flattened_mut() }
    }
}

impl<T: Real> NormalSource<'_, T> {
    /// As [`normals`], for some rows. With a canvas, colors are also computed. Normals that are not
    /// kept are computed only for the colors.
    pub fn compute_normals(
        &self,
        rows: &mut Rows<'_>,
        rays: &RayGrid,
        step: f64,
        mut canvas: Option<ColoredRows<'_>>,
    ) -> KernelStats {
        let mut work = KernelStats::default();
        let start_of_rows = rows.pixels().start;
        let windows = rows.windows();
        let (kept, columns) = rows.columns();
        let seen = ShadingInput { columns, paint: &[] };
        let mut normals = BandNormals { kept, waiting: Vec::new() };
        let open = self.of_band(&seen, &mut normals, rays, &windows, canvas.as_mut(), &mut work);
        let rest = |pixel: usize| {
            let ray = rays.ray_of(start_of_rows + pixel);
            let t = ray.parameter(seen.columns.drawn[pixel]);
            let is_hit = seen.columns.status[pixel] == Status::Hit;
            Rest {
                ray: Ray { origin: ray.at(t), ..ray },
                step: ray.parameter(step),
                hit: is_hit.then_some(start_of_rows + pixel),
                width: rays.footprint(t),
            }
        };
        for open in open.chunks(BATCH) {
            let rests: Vec<Rest> = open.iter().map(|open| rest(open.pixel)).collect();
            let found = self.of_batch(&rests, rays, step, &mut work);
            for (open, found) in open.iter().zip(found) {
                normals.all()[open.place] = found;
            }
        }
        match canvas {
            Some(canvas) if normals.is_kept() => canvas.finish(&seen, normals.kept),
            Some(canvas) => canvas.finish_waiting(&seen, &normals.waiting),
            None => {}
        }
        work
    }

    /// The normals at a batch of points. Each is found in the first way that works: from gradients,
    /// from differences of values, or from the ray's direction alone.
    fn of_batch(
        &self,
        rests: &[Rest],
        rays: &RayGrid,
        step: f64,
        work: &mut KernelStats,
    ) -> Vec<[f32; 3]> {
        let points: Vec<DVec3> = rests.iter().map(|rest| rest.ray.origin).collect();
        let mut normals = vec![None; points.len()];
        if let Self::Refined { double, .. } = self
            && let Ok(kernel) = double.gradients()
        {
            at_roots(kernel, rests, rays, &mut normals, work);
            fill(&mut normals, |open| gradients(kernel, open.iter().map(|&k| points[k]), work));
        }
        if let Self::Gradient(kernel) | Self::Refined { kernel, .. } = self {
            for ahead in AHEAD {
                let point = |k: usize| rests[k].ray.at(ahead * rests[k].step);
                fill(&mut normals, |open| gradients(*kernel, open.iter().map(|&k| point(k)), work));
            }
        }
        let mut reach = step;
        for _ in 0..STEPS {
            fill(&mut normals, |open| {
                self.differences(open.iter().map(|&k| points[k]), reach, work)
            });
            reach *= STEP_GROWTH;
        }
        let values = if normals.iter().all(Option::is_some) {
            Vec::new()
        } else {
            let before: Vec<DVec3> = rests.iter().map(|rest| rest.ray.at(-rest.step)).collect();
            self.sample(&before, work)
        };
        normals
            .into_iter()
            .enumerate()
            .map(|(k, normal)| {
                normal.unwrap_or_else(|| {
                    let towards_eye = -rests[k].ray.direction.normalize().as_vec3();
                    (if values[k] < T::default() { -towards_eye } else { towards_eye }).to_array()
                })
            })
            .collect()
    }

    /// Differences of values along each axis: the gradient times twice the step. A difference is
    /// one-sided if the function is undefined on one side, and 0 if too few values exist.
    fn differences(
        &self,
        points: impl Iterator<Item = DVec3>,
        step: f64,
        work: &mut KernelStats,
    ) -> Vec<DVec3> {
        // Seven samples per point: the point, then a pair for each axis.
        let stencil: Vec<DVec3> = points
            .flat_map(|p| {
                let pair = move |axis: DVec3| [p + axis * step, p - axis * step];
                std::iter::once(p).chain(DVec3::AXES.into_iter().flat_map(pair))
            })
            .collect();
        let slope = |here: T, ahead: T, behind: T| {
            let (here, ahead, behind) = (here.into(), ahead.into(), behind.into());
            match (ahead.is_finite(), behind.is_finite()) {
                (true, true) => ahead - behind,
                (true, false) if here.is_finite() => 2.0 * (ahead - here),
                (false, true) if here.is_finite() => 2.0 * (here - behind),
                _ => 0.0,
            }
        };
        self.sample(&stencil, work)
            .chunks_exact(7)
            .map(|v| {
                DVec3::new(
                    slope(v[0], v[1], v[2]),
                    slope(v[0], v[3], v[4]),
                    slope(v[0], v[5], v[6]),
                )
            })
            .collect()
    }

    /// The function's values at points. The values of unused lanes follow.
    fn sample(&self, points: &[DVec3], work: &mut KernelStats) -> Vec<T> {
        let batches = Points::near(points);
        let (values, count): (Vec<_>, _) = match self {
            Self::Gradient(kernel) | Self::Refined { kernel, .. } => (
                kernel.eval_all(&batches).iter().flat_map(|out| *out.value).collect(),
                &mut work.gradient,
            ),
            Self::Central(kernel) => (
                kernel.eval_all(&batches).iter().flat_map(|out| *out.value).collect(),
                &mut work.point,
            ),
            // No function of x, y and z.
            Self::Parametric(_) => return vec![T::nearest(f64::NAN); LANES * batches.len()],
        };
        for batch in &batches {
            count.called(batch.count);
        }
        values
    }
}

/// Fills in missing normals. `vectors` gets the indices of points without a normal, and returns
/// vectors in the direction of their normals.
fn fill(normals: &mut [Option<[f32; 3]>], vectors: impl FnOnce(&[usize]) -> Vec<DVec3>) {
    let open: Vec<usize> = (0..normals.len()).filter(|&k| normals[k].is_none()).collect();
    if !open.is_empty() {
        for (&k, vector) in open.iter().zip(vectors(&open)) {
            normals[k] = unit(vector);
        }
    }
}

/// Fills in the normals of hits at their zeros.
fn at_roots(
    kernel: &dyn Kernel<SampleGradient, f64>,
    rests: &[Rest],
    rays: &RayGrid,
    normals: &mut [Option<[f32; 3]>],
    work: &mut KernelStats,
) {
    let hit = |(k, rest): (usize, &Rest)| Some((k, rest.hit?));
    let hits: Vec<(usize, usize)> = rests.iter().enumerate().filter_map(hit).collect();
    let start = |ray: Ray, rest: &Rest| Start { ray, pixel: rest.width };
    let starts: Vec<Start> = hits.iter().map(|&(k, _)| start(rests[k].ray, &rests[k])).collect();
    for (&(k, pixel), found) in hits.iter().zip(gradients_at_roots(kernel, &starts, work)) {
        normals[k] = found.and_then(unit).or_else(|| {
            // The painted point moves with the ray.
            let moved = rests[k].ray.origin - rays.ray_of(pixel).origin;
            let t = moved.dot(rests[k].ray.direction) / rests[k].ray.direction.length_squared();
            let beside = rays.rays_within(pixel);
            let beside = beside.map(|ray| start(Ray { origin: ray.at(t), ..ray }, &rests[k]));
            mean_normal(kernel, &beside, work)
        });
    }
}

/// The function's gradients at points.
fn gradients<T: Real>(
    kernel: &dyn Kernel<SampleGradient, T>,
    points: impl Iterator<Item = DVec3>,
    work: &mut KernelStats,
) -> Vec<DVec3> {
    let points: Vec<DVec3> = points.collect();
    let batches = Points::near(&points);
    for batch in &batches {
        work.gradient.called(batch.count);
    }
    let out = kernel.eval_all(&batches);
    (0..points.len())
        .map(|k| {
            let gradient = out[k / LANES].gradient.each_ref();
            DVec3::from_array(gradient.map(|axis| axis[k % LANES].into()))
        })
        .collect()
}

/// The vector scaled to length 1, or `None` if it has no direction.
fn unit(vector: DVec3) -> Option<[f32; 3]> {
    // Gradients of steep functions overflow when squared, even in f64. Scaling first keeps the
    // direction.
    let largest = vector.abs().max_element();
    if !vector.is_finite() || largest == 0.0 {
        return None;
    }
    Some((vector / largest).normalize().as_vec3().to_array())
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset_eval::{Gradients, Lanes, Values};
    use zeroset_space::{Camera, Projection};
    use zeroset_trace::Status;

    /// A function with values and, optionally, gradients.
    struct Plain<F, G>(F, G);

    fn at(points: &Points, lane: usize) -> [f32; 3] {
        [0, 1, 2].map(|axis| points.at[axis][lane])
    }

    impl<F, G> Kernel<Sample> for Plain<F, G>
    where
        F: Fn([f32; 3]) -> f32 + Send + Sync,
        G: Send + Sync,
    {
        fn eval(&self, points: &Points, out: &mut Values) {
            for lane in 0..LANES {
                out.value[lane] = self.0(at(points, lane));
            }
        }
    }

    impl<F, G> Kernel<SampleGradient> for Plain<F, G>
    where
        F: Fn([f32; 3]) -> f32 + Send + Sync,
        G: Fn([f32; 3]) -> [f32; 3] + Send + Sync,
    {
        fn eval(&self, points: &Points, out: &mut Gradients) {
            for lane in 0..LANES {
                out.value[lane] = self.0(at(points, lane));
                for (axis, slope) in self.1(at(points, lane)).into_iter().enumerate() {
                    out.gradient[axis][lane] = slope;
                }
            }
        }
    }

    /// The normal of one pixel. Its ray runs along +y from (0, −5, 0), to a point at distance 4:
    /// (0, −1, 0).
    fn normal_of(source: NormalSource<'_>) -> [f32; 3] {
        let projection = Projection::Perspective { fov: 40.0 };
        let camera = Camera::new(DVec3::NEG_Y * 5.0, DVec3::ZERO, DVec3::Z, projection);
        let mut buffer = GBuffer::new(1, 1, 0);
        (buffer.status[0], buffer.drawn[0]) = (Status::Hit, 4.0);
        normals(&mut buffer, &RayGrid::new(&camera.expect("valid"), 1, 1), source, 1e-3);
        buffer.normal[0]
    }

    fn near(a: [f32; 3], b: [f32; 3]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-3)
    }

    #[test]
    fn gradients_and_differences_agree_on_a_sphere() {
        let value = |[x, y, z]: [f32; 3]| x * x + y * y + z * z - 1.0;
        let sphere = Plain(value, |p: [f32; 3]| p.map(|c| 2.0 * c));
        assert!(near(normal_of(NormalSource::Gradient(&sphere)), [0.0, -1.0, 0.0]));
        assert!(near(normal_of(NormalSource::Central(&sphere)), [0.0, -1.0, 0.0]));
    }

    #[test]
    fn a_missing_gradient_is_replaced_by_differences() {
        for broken in [f32::NAN, 0.0, f32::INFINITY] {
            let kernel = Plain(|[x, y, _]: [f32; 3]| x - y, move |_: [f32; 3]| [broken; 3]);
            let half = std::f32::consts::FRAC_1_SQRT_2;
            assert!(near(normal_of(NormalSource::Gradient(&kernel)), [half, -half, 0.0]));
        }
    }

    #[test]
    fn a_gradient_just_behind_the_painted_point_serves() {
        // The gradient is defined only for y > −0.9996: at half a step behind the point, but not at
        // it.
        let edge = |[_, y, _]: [f32; 3]| {
            if y > -0.9996 { [1.0, 0.0, 0.0] } else { [f32::NAN; 3] }
        };
        let kernel = Plain(|_: [f32; 3]| f32::NAN, edge);
        assert!(near(normal_of(NormalSource::Gradient(&kernel)), [1.0, 0.0, 0.0]));
    }

    #[test]
    fn beyond_the_edge_of_the_domain_one_sided_differences_serve() {
        // The function is undefined for y > −1, just behind the painted point.
        let edge = |[_, y, z]: [f32; 3]| if y > -1.0 { f32::NAN } else { y + z };
        let half = std::f32::consts::FRAC_1_SQRT_2;
        let normal = normal_of(NormalSource::Central(&Plain(edge, ())));
        assert!(near(normal, [0.0, half, half]), "{normal:?}");
    }

    #[test]
    fn with_nothing_to_go_by_the_normal_faces_the_side_that_is_seen() {
        let undefined = Plain(|_: [f32; 3]| f32::NAN, ());
        assert!(near(normal_of(NormalSource::Central(&undefined)), [0.0, -1.0, 0.0]));
        let negative = Plain(|_: [f32; 3]| -1.0, ());
        assert!(near(normal_of(NormalSource::Central(&negative)), [0.0, 1.0, 0.0]));
    }

    #[test]
    fn huge_gradients_keep_their_direction() {
        let steep = Plain(|_: [f32; 3]| 0.0, |_: [f32; 3]| [0.0, f32::MAX, f32::MAX]);
        let half = std::f32::consts::FRAC_1_SQRT_2;
        assert!(near(normal_of(NormalSource::Gradient(&steep)), [0.0, half, half]));
    }

    #[test]
    fn tiny_gradients_keep_their_direction() {
        for size in [1e-20, 1e-40] {
            let flat = Plain(|_: [f32; 3]| 0.0, move |_: [f32; 3]| [0.0, size, size]);
            let half = std::f32::consts::FRAC_1_SQRT_2;
            assert!(near(normal_of(NormalSource::Gradient(&flat)), [0.0, half, half]), "{size}");
        }
    }

    /// A gradient of (1, 2, 3) times a factor, in `f64`.
    struct Steep(f64);

    impl Kernel<SampleGradient, f64> for Steep {
        fn eval(&self, _: &Points<f64>, out: &mut Gradients<f64>) {
            out.gradient = [1.0, 2.0, 3.0].map(|slope| Lanes::splat(slope * self.0));
        }
    }

    /// An orthographic picture along +y, with x from −4 to 4. Two pixels in three are painted.
    fn striped() -> (GBuffer, RayGrid) {
        let projection = Projection::Orthographic { height: 2.0 };
        let camera = Camera::new(DVec3::NEG_Y * 5.0, DVec3::ZERO, DVec3::Z, projection);
        let mut buffer = GBuffer::new(80, 20, 0);
        for pixel in (0..80 * 20).filter(|pixel| pixel % 3 != 0) {
            (buffer.status[pixel], buffer.drawn[pixel]) = (Status::Hit, 5.0);
        }
        (buffer, RayGrid::new(&camera.expect("valid"), 80, 20))
    }

    #[test]
    fn gradients_beyond_f32_have_directions() {
        for size in [1e-300, 1e-40, 1.0, 1e40, 1e300] {
            let (mut buffer, rays) = striped();
            let kernel = Steep(size);
            normals(&mut buffer, &rays, NormalSource::Gradient(&kernel), 1e-3);
            let unit = [1.0, 2.0, 3.0].map(|slope: f32| slope / 14.0_f32.sqrt());
            for pixel in (0..buffer.drawn.len()).filter(|&pixel| buffer.is_drawn(pixel)) {
                assert!(near(buffer.normal[pixel], unit), "{size} {pixel}");
            }
        }
    }

    #[test]
    fn each_pixel_has_its_own_normal_whatever_its_neighbours_have() {
        // There is no gradient right of x = 1. Pixels left of x = −2 are caps, which have normals
        // already.
        let gradient = |[x, _, z]: [f32; 3]| if x > 1.0 { [f32::NAN; 3] } else { [x, 0.0, z] };
        let kernel = Plain(|[x, _, _]: [f32; 3]| x, gradient);
        let (mut buffer, rays) = striped();
        let middle = |pixel: usize| rays.ray_of(pixel).origin.as_vec3();
        buffer.keep_caps();
        for pixel in (0..buffer.drawn.len()).filter(|&pixel| middle(pixel).x < -2.0) {
            (buffer.normal[pixel], buffer.cap[pixel]) = ([0.0, 1.0, 0.0], true);
        }
        let work = normals(&mut buffer, &rays, NormalSource::Gradient(&kernel), 1e-3);
        assert!(work.gradient.lanes > 0);
        for pixel in (0..buffer.drawn.len()).filter(|&pixel| buffer.is_drawn(pixel)) {
            let at = middle(pixel);
            let expected = if at.x < -2.0 {
                [0.0, 1.0, 0.0]
            } else if at.x > 1.0 {
                [1.0, 0.0, 0.0]
            } else {
                (at * glam::Vec3::new(1.0, 0.0, 1.0)).normalize().to_array()
            };
            assert!(near(buffer.normal[pixel], expected), "{at} {:?}", buffer.normal[pixel]);
        }
    }
}
