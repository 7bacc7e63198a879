//! Errors of a picture against the certified reference.

use crate::quantile::quantile;
use crate::reference::RootReference;
use crate::truth::{Root, Truth};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use zeroset_trace::{GBuffer, RayGrid, Status};

/// Counts and sizes of errors at some pixels. Pixels that the reference leaves open count only in
/// `samples` and `open`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PixelErrors {
    /// Number of pixels compared.
    pub samples: usize,
    /// Pixels that the reference leaves open.
    pub open: usize,
    /// Pixels with a root.
    pub roots: usize,
    /// Pixels that have a root, but show nothing.
    pub missed: usize,
    /// Pixels that have no root, but show something.
    pub phantom: usize,
    /// Pixels drawn nearer to the next root than to the first.
    pub wrong_root: usize,
    /// Pixels with the status undecided.
    pub undecided: usize,
    /// Pixels with a false status: a miss on a ray with a root, or a hit whose bracket does not
    /// hold the first root. Without brackets: a hit that is painted wrongly.
    pub false_claims: usize,
    /// Pixels drawn at their first root. Distances and normals are measured at these.
    pub painted: usize,
    /// Distance from the root, as a multiple of the pixel's footprint at the root: median, 99.9 %
    /// quantile and maximum.
    pub off_pixels: Option<[f64; 3]>,
    /// Distance from the root in world units: median, 99.9 % quantile and maximum.
    pub off: Option<[f64; 3]>,
    /// Angle between the drawn normal and the root's normal, in degrees: median, 99.9 % quantile
    /// and maximum.
    pub normal_degrees: Option<[f64; 3]>,
}

/// A mistake at a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mistake {
    /// A root is not painted.
    Missed,
    /// Something is painted where there is no root.
    Phantom,
    /// A root other than the first is painted.
    WrongRoot,
}

/// Distance from `drawn` to the nearest interval; 0 if an interval contains it.
fn outside(pieces: &[[f64; 2]], drawn: f64) -> f64 {
    let outside = |[near, far]: &[f64; 2]| (near - drawn).max(drawn - far).max(0.0);
    pieces.iter().map(outside).fold(f64::INFINITY, f64::min)
}

fn is_next(root: &Root, drawn: f64) -> bool {
    root.next.is_some_and(|next| outside(&[next], drawn) < outside(&root.pieces, drawn))
}

/// Returns whether a bracket may hold the root. Its ends were rounded when they became distances.
fn may_hold([near, far]: &[f64; 2], root: &Root) -> bool {
    let slack = 8.0 * f64::EPSILON * far.abs();
    root.pieces.iter().any(|[first, last]| near - slack <= *last && *first <= far + slack)
}

/// The mistake of a pixel that is drawn at the distance `drawn`, or infinity if nothing is painted.
/// `None` if the pixel is right or the reference leaves it open.
pub fn mistake(truth: &Truth, drawn: f64) -> Option<Mistake> {
    match truth {
        Truth::Open => None,
        Truth::Miss => drawn.is_finite().then_some(Mistake::Phantom),
        Truth::Root(_) if !drawn.is_finite() => Some(Mistake::Missed),
        Truth::Root(root) => is_next(root, drawn).then_some(Mistake::WrongRoot),
    }
}

impl PixelErrors {
    /// The errors of a picture at the reference's pixels. `rays` are the picture's rays.
    pub fn new(reference: &RootReference, rays: &RayGrid, buffer: &GBuffer) -> Self {
        let mut errors = Self { samples: reference.pixels.len(), ..Self::default() };
        let [mut off_pixels, mut off, mut degrees] = [const { Vec::new() }; 3];
        for (pixel, truth) in &reference.pixels {
            let (status, drawn) = (buffer.status[*pixel], buffer.drawn[*pixel]);
            if *truth == Truth::Open {
                errors.open += 1;
                continue;
            }
            let mistake = mistake(truth, drawn);
            match mistake {
                Some(Mistake::Missed) => errors.missed += 1,
                Some(Mistake::Phantom) => errors.phantom += 1,
                Some(Mistake::WrongRoot) => errors.wrong_root += 1,
                None => {}
            }
            errors.undecided += usize::from(status == Status::Undecided);
            let is_false = match (status, truth) {
                (Status::Undecided, _) | (_, Truth::Open) => false,
                (Status::Miss, truth) => matches!(truth, Truth::Root(_)),
                (Status::Hit, Truth::Miss) => true,
                (Status::Hit, Truth::Root(root)) => buffer
                    .bracket
                    .get(*pixel)
                    .map_or(mistake.is_some(), |bracket| !may_hold(bracket, root)),
            };
            errors.false_claims += usize::from(is_false);
            let Truth::Root(root) = truth else { continue };
            errors.roots += 1;
            if mistake.is_some() {
                continue;
            }
            errors.painted += 1;
            let distance = outside(&root.pieces, drawn);
            // The footprint is measured at the root, on this pixel's own ray.
            let along = rays.ray_of(*pixel).parameter(root.pieces[0][0]);
            off.push(distance);
            off_pixels.push(distance / rays.footprint(along).max(f64::MIN_POSITIVE));
            let drawn = DVec3::from_array(buffer.normal[*pixel].map(f64::from));
            if let Some(normal) = root.normal.filter(|_| drawn != DVec3::ZERO) {
                let normal = DVec3::from_array(normal);
                // For small angles the sine is accurate where the cosine is not.
                degrees.push(normal.cross(drawn).length().atan2(normal.dot(drawn)).to_degrees());
            }
        }
        let three = |values: &[f64]| {
            let [median, high, maximum] = [0.5, 0.999, 1.0].map(|share| quantile(values, share));
            Some([median?, high?, maximum?])
        };
        (errors.off_pixels, errors.off) = (three(&off_pixels), three(&off));
        errors.normal_degrees = three(&degrees);
        errors
    }

    /// Number of pixels painted wrongly.
    pub fn wrong(&self) -> usize {
        self.missed + self.phantom + self.wrong_root
    }

    /// Number of pixels that the reference decides.
    pub fn decided(&self) -> usize {
        self.samples - self.open
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn root(next: Option<[f64; 2]>) -> Truth {
        Truth::Root(Root { pieces: vec![[2.0, 2.0]], next, normal: None })
    }

    #[test]
    fn mistakes_are_named() {
        let none = f64::INFINITY;
        assert_eq!(mistake(&Truth::Miss, none), None);
        assert_eq!(mistake(&Truth::Miss, 1.0), Some(Mistake::Phantom));
        assert_eq!(mistake(&Truth::Open, 1.0), None);
        assert_eq!(mistake(&root(None), none), Some(Mistake::Missed));
        assert_eq!(mistake(&root(None), 9.0), None);
        let two = root(Some([4.0, 4.0]));
        assert_eq!([1.0, 2.9].map(|drawn| mistake(&two, drawn)), [None; 2]);
        assert_eq!(mistake(&two, 3.1), Some(Mistake::WrongRoot));
    }

    /// The first root is at 2. The painted point may be nearer to the next, at 4.
    #[test]
    fn a_hit_is_judged_by_its_bracket() {
        let Truth::Root(root) = root(Some([4.0, 4.0])) else { unreachable!("a root") };
        for (bracket, holds) in
            [([1.5, 3.5], true), ([2.0, 2.0], true), ([2.1, 4.1], false), ([1.0, 1.9], false)]
        {
            assert_eq!(may_hold(&bracket, &root), holds, "{bracket:?}");
        }
    }

    #[test]
    fn a_distance_within_a_piece_is_no_error() {
        let pieces = [[1.0, 2.0], [5.0, 5.5]];
        let expected = [(1.5, 0.0), (0.75, 0.25), (4.0, 1.0), (6.0, 0.5)];
        for (drawn, off) in expected {
            assert_eq!(outside(&pieces, drawn), off);
        }
    }
}
