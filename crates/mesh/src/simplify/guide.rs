//! Estimates of the distance between points and a surface. They prove nothing.

use glam::DVec3;
use rayon::prelude::*;
use smallvec::SmallVec;
use zeroset_eval::{Gradients, Kernel, KernelError, LANES, Points};
use zeroset_scene::program::Program;
use zeroset_space::Region;

/// A unit normal, and a distance along it from a plane.
type Plane = (DVec3, f64);

/// A rim that is farther from all faces of the region than so many allowed distances is not on a
/// face.
const AWAY: f64 = 8.0;

/// A surface in a region.
pub struct Guide<'a> {
    gradients: &'a dyn Kernel<zeroset_eval::SampleGradient, f64>,
    region: &'a Region,
    is_solid: bool,
}

impl<'a> Guide<'a> {
    pub fn new(
        program: &'a Program,
        surface: usize,
        region: &'a Region,
    ) -> Result<Self, KernelError> {
        let gradients = program.kernels::<f64>(surface).gradients()?;
        Ok(Self { gradients, region, is_solid: program.is_solid(surface) })
    }

    /// The unit normals of the surface near points, and the distances along them. `None` where
    /// there is no gradient. For a solid, faces where the region cuts it count, too.
    pub fn planes(&self, points: &[DVec3]) -> Vec<Option<Plane>> {
        let planes = |some: &[DVec3]| -> SmallVec<[Option<Plane>; LANES]> {
            self.some_planes(some).map(|(_, plane)| plane).collect()
        };
        points.par_chunks(LANES).flat_map_iter(planes).collect()
    }

    /// Returns whether all points seem to be within a distance of the surface. For a solid, faces
    /// where the region cuts it count, too.
    pub fn are_near(&self, points: &[DVec3], distance: f64) -> bool {
        let is_near = |plane: Option<Plane>| plane.is_some_and(|(_, off)| off.abs() <= distance);
        points.chunks(LANES).all(|some| self.some_planes(some).all(|(_, plane)| is_near(plane)))
    }

    /// Returns whether all points seem to be within a distance of the surface's rim, where that is
    /// on a face of the region.
    pub fn are_near_rim(&self, points: &[DVec3], distance: f64) -> bool {
        let is_near = |(point, plane): (&DVec3, Option<Plane>)| {
            let Some((normal, off)) = plane else { return false };
            let (across, beyond) = self.cut(*point);
            if beyond.abs() > AWAY * distance {
                return true;
            }
            // The shortest vector to both planes.
            let cosine = normal.dot(across);
            let sum = off * off - 2.0 * cosine * off * beyond + beyond * beyond;
            sum <= (1.0 - cosine * cosine) * distance * distance
        };
        points.chunks(LANES).all(|some| self.some_planes(some).all(is_near))
    }

    /// The plane for each of some points, which fit one batch.
    fn some_planes<'p>(
        &self,
        points: &'p [DVec3],
    ) -> impl Iterator<Item = (&'p DVec3, Option<Plane>)> {
        let mut found = Gradients::<f64>::default();
        self.gradients.eval(&Points::near(points)[0], &mut found);
        points.iter().enumerate().map(move |(lane, point)| {
            let slope = DVec3::from_array(found.gradient.each_ref().map(|axis| axis[lane]));
            let plane = slope.try_normalize().and_then(|normal| {
                let off = found.value[lane] / slope.length();
                let cut = self.is_solid.then(|| self.cut(*point)).filter(|cut| cut.1 > off);
                if cut.is_some() {
                    return cut;
                }
                off.is_finite().then_some((normal, off))
            });
            (point, plane)
        })
    }

    /// The unit normal of the plane that cuts the region, if one does, and a point's distance from
    /// it.
    pub fn clip(&self, point: DVec3) -> Option<Plane> {
        self.region.clip().map(|clip| {
            let length = clip.normal.length();
            (clip.normal / length, (clip.normal.dot(point) - clip.offset) / length)
        })
    }

    /// The unit normal of the face of the region that is nearest to a point inside, or farthest
    /// from a point outside, and the distance from it: below 0 inside.
    fn cut(&self, point: DVec3) -> Plane {
        let region = self.region;
        let faces = DVec3::AXES.into_iter().enumerate().flat_map(|(axis, normal)| {
            let (low, high) = (region.low()[axis], region.high()[axis]);
            [(-normal, low - point[axis]), (normal, point[axis] - high)]
        });
        let ball = region.ball().map(|ball| {
            let from = point - ball.centre;
            (from.normalize_or_zero(), from.length() - ball.radius)
        });
        let all = faces.chain(ball).chain(self.clip(point));
        all.max_by(|a, b| a.1.total_cmp(&b.1)).expect("a box has faces")
    }
}
