//! The surfaces, and where they are seen from.
//!
//! The C++ has formulas of its own; all else is made of the texts of the charts.

use anyhow::{Context, Result, ensure};
use glam::DVec3;
use zeroset::scene::{self, DomainChoice};
use zeroset_syntax::{Document, Options, read};
use zeroset_testkit::certified::Line;
use zeroset_trace::{Camera, Projection, RayGrid, Region};

/// A row of the table of surfaces.
pub struct Surface {
    /// What the C++ calls it.
    pub name: &'static str,
    /// The domain is a cube of twice this edge around the origin, and distances are counted in it.
    pub half: f64,
    /// Whether the domain cuts it open.
    pub is_cut: bool,
    /// A document; its domain is that cube.
    text: &'static str,
}

/// A row, whose text is that of the charts.
macro_rules! surface {
    ($name:literal, $file:literal, $half:expr, $is_cut:expr) => {
        Surface {
            name: $name,
            half: $half,
            is_cut: $is_cut,
            text: include_str!(concat!("../../../crates/chart/data/", $file, ".zset")),
        }
    };
}

/// All surfaces: those of the C++, and a gyroid.
pub const SURFACES: [Surface; 10] = [
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

/// Of the eye, in half extents; the target is the origin.
pub const EYE: DVec3 = DVec3::new(2.0, 1.5, 3.0);
/// In degrees.
pub const FOV: f64 = 40.0;

impl Surface {
    /// Its formula, read.
    ///
    /// # Errors
    /// If it is none.
    pub fn document(&self) -> Result<Document> {
        let document = read(self.text, &Options::default());
        document.map_err(|errors| anyhow::anyhow!("{}: {errors}", self.name))
    }

    /// Its domain.
    ///
    /// # Errors
    /// If there is no such domain, or the document has another.
    pub fn region(&self) -> Result<Region> {
        let half = DVec3::splat(self.half);
        let region = Region::new(-half, half).context(self.name)?;
        let (own, _) = scene::region(&self.document()?, DomainChoice::Document, None)?;
        ensure!(own == region, "{}: the C++ has another domain than {own:?}", self.name);
        Ok(region)
    }

    /// Its domain, axis by axis.
    pub fn bounds(&self) -> [[f64; 2]; 3] {
        [[-self.half, self.half]; 3]
    }

    /// Where it is seen from.
    ///
    /// # Errors
    /// If there is no such camera.
    pub fn camera(&self) -> Result<Camera> {
        let projection = Projection::Perspective { fov: FOV };
        Camera::new(EYE * self.half, DVec3::ZERO, DVec3::Y, projection).context(self.name)
    }
}

/// The ray of a pixel, as the certified tracer takes it.
pub fn line(rays: &RayGrid, pixel: usize) -> Line {
    let ray = rays.ray_of(pixel);
    Line { eye: ray.origin.to_array(), direction: ray.direction.to_array() }
}
