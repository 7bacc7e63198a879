//! The camera of a picture in a region. The caller's choice comes first, then the document's, then
//! a default.

use crate::number::nearest;
use glam::DVec3;
use zeroset_ir::Constant;
use zeroset_space::{Camera, CameraError, Projection, Region};
use zeroset_style::{FOV, StandardView};
use zeroset_syntax::Document;

/// The caller's choice of a camera. A field that is `None` is taken from the document. If the
/// document does not set it either, the camera shows the whole domain from
/// [`VIEWS[0]`](zeroset_style::VIEWS). The module `framing` of the render crate then moves the
/// camera as near as the visible part allows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CameraChoice {
    /// A standard view. It replaces the document's eye and upward direction.
    pub view: Option<&'static StandardView>,
    /// The eye.
    pub eye: Option<DVec3>,
    /// The point looked at.
    pub target: Option<DVec3>,
    /// The direction shown upright.
    pub up: Option<DVec3>,
    /// Perspective or parallel projection, and its field of view.
    pub projection: Option<Projection>,
    /// Whether y points up in the default view, as in programs of shaders.
    pub is_y_up: bool,
    /// Per axis, whether all that is drawn lies in one plane across it. Seen along that axis, such
    /// a drawing is shown by parallel rays, so that ticks are where they are in the plane.
    pub flat: [bool; 3],
}

impl CameraChoice {
    /// The choice that `document` makes itself.
    pub fn typed(document: &Document) -> Self {
        let typed = document.view.clone().unwrap_or_default();
        let point = |numbers: &Option<[Constant; 3]>| {
            numbers.as_ref().map(|numbers| DVec3::from_array(numbers.each_ref().map(nearest)))
        };
        let projection = match (&typed.ortho, &typed.fov) {
            (Some(height), _) => Some(Projection::Orthographic { height: nearest(height) }),
            (None, Some(fov)) => Some(Projection::Perspective { fov: nearest(fov) }),
            (None, None) => None,
        };
        Self {
            view: typed.preset,
            eye: point(&typed.eye),
            target: point(&typed.target),
            up: point(&typed.up),
            projection,
            is_y_up: document.is_y_up,
            flat: [false; 3],
        }
    }

    /// This choice, completed by the document's `own`. A view replaces the document's eye and
    /// upward direction.
    #[must_use]
    pub fn or(self, own: Self) -> Self {
        let is_kept = self.view.is_none();
        Self {
            view: self.view.or(own.view),
            eye: self.eye.or(own.eye.filter(|_| is_kept)),
            target: self.target.or(own.target),
            up: self.up.or(own.up.filter(|_| is_kept)),
            projection: self.projection.or(own.projection),
            is_y_up: self.is_y_up || own.is_y_up,
            flat: [0, 1, 2].map(|axis| self.flat[axis] || own.flat[axis]),
        }
    }

    /// Returns whether the choice fixes the view: a side other than the usual one, an eye, a target
    /// or a projection.
    pub fn is_fixed(&self) -> bool {
        let Self { view, eye, target, up: _, projection, is_y_up: _, flat: _ } = self;
        let is_other = view.is_some_and(|view| view != <&StandardView>::default());
        is_other || eye.is_some() || target.is_some() || projection.is_some()
    }
}

/// The camera in `region`. A standard view alone has a distance from the center that is a fixed
/// multiple of half the largest extent. With the default [`FOV`], the views from the six sides show
/// all of a cube. The default view shows all but the tips of some corners.
///
/// # Errors
/// If eye and target coincide, the upward direction is parallel to the view, or a number is out of
/// range.
pub fn camera(choice: &CameraChoice, region: &Region) -> Result<Camera, CameraError> {
    // In programs of shaders, y points up. A named view, such as the top, ignores this.
    let is_y_up = choice.view.is_none() && choice.is_y_up;
    let view = choice.view.unwrap_or_default();
    let turned =
        |[x, y, z]: [f64; 3]| if is_y_up { DVec3::new(x, z, -y) } else { [x, y, z].into() };
    let (offset, view_up) = (turned(view.offset), turned(view.up));
    // The camera is set up in the displayed space.
    let (stretch, shown) = (region.stretch(), region.displayed());
    let displayed = |point: DVec3| point * stretch;
    let given_eye = choice.eye.map(displayed);
    // An eye in the center keeps the view's direction: its target lies opposite to the offset.
    let usual = match given_eye {
        Some(eye) if eye == shown.centre() => eye - offset * shown.half_extent(),
        _ => shown.centre(),
    };
    let target = choice.target.map_or(usual, displayed);
    let eye = given_eye.unwrap_or(target + offset * shown.half_extent());
    let usual_up = || {
        // An eye set by the caller or the document may look straight down. Then y is the upward
        // direction, as in the view from the top.
        let vertical = given_eye.is_some() && (target - eye).cross(view_up) == DVec3::ZERO;
        if vertical { turned([0.0, 1.0, 0.0]) } else { view_up }
    };
    let up = choice.up.map_or_else(usual_up, displayed);
    let projection = choice.projection.unwrap_or_else(|| {
        let way = eye - target;
        let is_along = |axis: usize| choice.flat[axis] && way.length() == way[axis].abs();
        if choice.eye.is_none() && (0..3).any(is_along) {
            // The same part of the plane is shown as in perspective.
            let half = (FOV.to_radians() / 2.0).tan() * way.length();
            Projection::Orthographic { height: 2.0 * half }
        } else {
            Projection::Perspective { fov: FOV }
        }
    });
    Ok(Camera::new(eye, target, up, projection)?.in_stretched(stretch))
}

/// The corners of a region's box. Bit k of a corner's index is set if it lies at the upper end of
/// axis k.
pub fn corners(region: &Region) -> [DVec3; 8] {
    let (low, high) = (region.low(), region.high());
    std::array::from_fn(|n| {
        DVec3::from_array([0, 1, 2].map(|k| if n >> k & 1 == 1 { high[k] } else { low[k] }))
    })
}

#[cfg(test)]
mod tests;
