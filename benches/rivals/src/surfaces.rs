//! The surfaces and their view.
//!
//! The C++ has its own formulas. All other renderers use the function files of `crates/chart/data`.

use anyhow::{Context, Result, ensure};
use glam::DVec3;
use std::borrow::Cow;
use zeroset_scene::view::{self, DomainChoice};
use zeroset_space::{Camera, Projection, Region};
use zeroset_syntax::{Document, Options, read};
use zeroset_testkit::certified::Line;
use zeroset_trace::RayGrid;

/// A surface with its domain.
pub struct Surface {
    /// Name in the tables, and in the C++ code.
    pub name: Cow<'static, str>,
    /// Half the edge of the domain, which is a cube around the origin.
    pub half: f64,
    /// True if the domain cuts the surface open.
    pub is_cut: bool,
    /// The view in which it is drawn.
    pub view: View,
    /// Text of the surface's document, which states the same domain.
    pub text: Cow<'static, str>,
}

/// A view of the domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum View {
    /// From [`EYE`], in perspective.
    Oblique,
    /// Along −z, in parallel. The picture is as wide as the domain.
    Front,
}

/// Defines a surface by a function file of `crates/chart/data`.
macro_rules! surface {
    ($name:literal, $file:literal, $half:expr, $is_cut:expr) => {
        Surface {
            name: Cow::Borrowed($name),
            half: $half,
            is_cut: $is_cut,
            view: View::Oblique,
            text: Cow::Borrowed(include_str!(concat!(
                "../../../crates/chart/data/",
                $file,
                ".zset"
            ))),
        }
    };
}

/// All surfaces: those of the C++, and a gyroid.
pub static SURFACES: [Surface; 10] = [
    surface!("sphere", "sphere", 1.2, false),
    surface!("torus", "torus", 1.3, false),
    surface!("steiner", "steiner", 1.0, false),
    surface!("mitchell", "mitchell", 2.0, false),
    surface!("tangle", "tangle", 3.0, false),
    surface!("teardrop", "teardrop", 1.2, true),
    surface!("klein", "klein", 4.2, false),
    surface!("barth", "barth", 2.0, true),
    surface!("linked_tori", "linked-tori", 1.0, false),
    surface!("gyroid", "gyroid", std::f64::consts::TAU, true),
];

/// Position of the eye, in multiples of `half`. The eye looks at the origin.
pub const EYE: DVec3 = DVec3::new(2.0, 1.5, 3.0);
/// Field of view, in degrees.
pub const FOV: f64 = 40.0;

impl Surface {
    /// Reads the text.
    ///
    /// # Errors
    /// If it is not valid.
    pub fn document(&self) -> Result<Document> {
        let document = read(&self.text, &Options::default());
        document.map_err(|errors| anyhow::anyhow!("{}: {errors}", self.name))
    }

    /// Returns the domain.
    ///
    /// # Errors
    /// If the cube is invalid, or the document states another domain.
    pub fn region(&self) -> Result<Region> {
        let half = DVec3::splat(self.half);
        let region = Region::new(-half, half).with_context(|| self.name.to_string())?;
        let (own, _) = view::region(&self.document()?, DomainChoice::Document, None)?;
        ensure!(own == region, "{}: it is measured in another domain than {own:?}", self.name);
        Ok(region)
    }

    /// Ends of the domain, per axis.
    pub fn bounds(&self) -> [[f64; 2]; 3] {
        [[-self.half, self.half]; 3]
    }

    /// The camera of the view.
    ///
    /// # Errors
    /// If it is invalid.
    pub fn camera(&self) -> Result<Camera> {
        let (eye, projection) = match self.view {
            View::Oblique => (EYE, Projection::Perspective { fov: FOV }),
            View::Front => (2.0 * DVec3::Z, Projection::Orthographic { height: 2.0 * self.half }),
        };
        Camera::new(eye * self.half, DVec3::ZERO, DVec3::Y, projection)
            .with_context(|| self.name.to_string())
    }
}

/// Converts the ray of a pixel for the certified tracer.
pub fn line(rays: &RayGrid, pixel: usize) -> Line {
    let ray = rays.ray_of(pixel);
    Line { eye: ray.origin.to_array(), direction: ray.direction.to_array() }
}
