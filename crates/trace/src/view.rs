//! Named points of view.

use crate::camera::{Camera, CameraError, Projection};
use crate::region::Region;
use glam::DVec3;

/// A point of view that needs no coordinates: z is up, and `Front` looks along +y.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StandardView {
    /// From the right, the front and above: the default.
    #[default]
    Iso,
    /// Along +y.
    Front,
    /// Along −y.
    Back,
    /// Along +x.
    Left,
    /// Along −x.
    Right,
    /// Along −z, with +y upward.
    Top,
    /// Along +z, with −y upward.
    Bottom,
}

/// The eye of the default view, relative to the box's centre, in half extents.
const ISO_EYE: DVec3 = DVec3::new(2.0, -3.0, 1.5);

impl StandardView {
    /// Every view with its name.
    pub const ALL: [(&'static str, Self); 7] = [
        ("iso", Self::Iso),
        ("front", Self::Front),
        ("back", Self::Back),
        ("left", Self::Left),
        ("right", Self::Right),
        ("top", Self::Top),
        ("bottom", Self::Bottom),
    ];

    /// The default field of view, in degrees.
    pub const FOV: f64 = 40.0;

    /// The view called `name`.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|view| view.0 == name).map(|view| view.1)
    }

    /// The offset of the eye from the target, in half extents, and the upward direction.
    pub fn offset_and_up(self) -> (DVec3, DVec3) {
        let distance = ISO_EYE.length();
        match self {
            Self::Iso => (ISO_EYE, DVec3::Z),
            Self::Front => (DVec3::NEG_Y * distance, DVec3::Z),
            Self::Back => (DVec3::Y * distance, DVec3::Z),
            Self::Left => (DVec3::NEG_X * distance, DVec3::Z),
            Self::Right => (DVec3::X * distance, DVec3::Z),
            Self::Top => (DVec3::Z * distance, DVec3::Y),
            Self::Bottom => (DVec3::NEG_Z * distance, DVec3::NEG_Y),
        }
    }

    /// The camera that shows the box of `region` from this side, at a fixed multiple of half its
    /// largest extent. With [`StandardView::FOV`] the six sides show all of a cube; the default
    /// view shows all but the tips of some corners.
    ///
    /// # Errors
    /// If `projection` is out of range.
    pub fn camera(self, region: &Region, projection: Projection) -> Result<Camera, CameraError> {
        let (offset, up) = self.offset_and_up();
        let centre = region.centre();
        Camera::new(centre + offset * region.half_extent(), centre, up, projection)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn looks_along(view: StandardView) -> DVec3 {
        let region = Region::new(DVec3::splat(-1.0), DVec3::new(3.0, 1.0, 1.0)).expect("valid");
        let camera = view
            .camera(&region, Projection::Perspective { fov: StandardView::FOV })
            .expect("valid");
        assert_eq!(camera.target(), DVec3::X);
        camera.rays(2, 2).forward()
    }

    #[test]
    fn views_look_where_their_names_say() {
        assert_eq!(looks_along(StandardView::Front), DVec3::Y);
        assert_eq!(looks_along(StandardView::Back), DVec3::NEG_Y);
        assert_eq!(looks_along(StandardView::Left), DVec3::X);
        assert_eq!(looks_along(StandardView::Right), DVec3::NEG_X);
        assert_eq!(looks_along(StandardView::Top), DVec3::NEG_Z);
        assert_eq!(looks_along(StandardView::Bottom), DVec3::Z);
        let iso = looks_along(StandardView::Iso);
        assert!(iso.x < 0.0 && iso.y > 0.0 && iso.z < 0.0);
    }

    #[test]
    fn the_six_sides_show_the_whole_cube() {
        let region = Region::new(DVec3::splat(-1.0), DVec3::splat(1.0)).expect("valid");
        for (name, view) in StandardView::ALL.into_iter().filter(|view| view.1 != StandardView::Iso)
        {
            let camera = view
                .camera(&region, Projection::Perspective { fov: StandardView::FOV })
                .expect("valid");
            let rays = camera.rays(32, 32);
            for corner in 0..8 {
                let sign = |bit: usize| if corner >> bit & 1 == 1 { 1.0 } else { -1.0 };
                let to = DVec3::new(sign(0), sign(1), sign(2)) - camera.eye();
                let depth = to.dot(rays.forward());
                let reach = depth * (StandardView::FOV / 2.0).to_radians().tan();
                let inside = to.dot(rays.up()).abs() < reach && to.dot(rays.right()).abs() < reach;
                assert!(inside, "{name} loses corner {corner}");
            }
        }
    }

    #[test]
    fn names_are_found() {
        assert_eq!(StandardView::named("top"), Some(StandardView::Top));
        assert_eq!(StandardView::named("Top"), None);
    }
}
