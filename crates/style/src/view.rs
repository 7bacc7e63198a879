//! Named views, as directions. Nothing here knows regions or cameras.

/// A view that needs no coordinates: a row of [`VIEWS`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StandardView {
    /// The name that selects the view.
    pub name: &'static str,
    /// The eye's offset from the target. The unit is half the region's extent.
    pub offset: [f64; 3],
    /// The direction that appears upright in the picture, of length 1.
    pub up: [f64; 3],
}

/// Length of every offset: the length of (2, −3, 2.25).
const DISTANCE: f64 = 4.25;

/// All views. The first is the default: the eye is to the right, in front and 32° above the
/// horizon. The z axis points up, and the view `front` looks along +y.
pub const VIEWS: [StandardView; 7] = [
    StandardView { name: "iso", offset: [2.0, -3.0, 2.25], up: UPRIGHT },
    StandardView { name: "front", offset: [0.0, -DISTANCE, 0.0], up: UPRIGHT },
    StandardView { name: "back", offset: [0.0, DISTANCE, 0.0], up: UPRIGHT },
    StandardView { name: "left", offset: [-DISTANCE, 0.0, 0.0], up: UPRIGHT },
    StandardView { name: "right", offset: [DISTANCE, 0.0, 0.0], up: UPRIGHT },
    StandardView { name: "top", offset: [0.0, 0.0, DISTANCE], up: [0.0, 1.0, 0.0] },
    StandardView { name: "bottom", offset: [0.0, 0.0, -DISTANCE], up: [0.0, -1.0, 0.0] },
];

const UPRIGHT: [f64; 3] = [0.0, 0.0, 1.0];

/// The default vertical field of view, in degrees.
pub const FOV: f64 = 40.0;

impl StandardView {
    /// The view with this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        VIEWS.iter().find(|view| view.name == name)
    }
}

impl Default for &'static StandardView {
    fn default() -> Self {
        &VIEWS[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_are_equally_long() {
        for StandardView { name, offset, up } in &VIEWS {
            let length = |v: &[f64; 3]| v.iter().map(|part| part * part).sum::<f64>().sqrt();
            assert_eq!((length(offset), length(up)), (DISTANCE, 1.0), "{name}");
        }
    }

    #[test]
    fn names_are_found() {
        assert_eq!(StandardView::named("top"), Some(&VIEWS[5]));
        assert_eq!(StandardView::named("Top"), None);
    }
}
