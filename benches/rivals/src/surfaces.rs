//! The surfaces, and where they are seen from.
//!
//! The C++ has formulas of its own; all else is made of the texts here.

use anyhow::{Context, Result};
use glam::DVec3;
use zeroset_syntax::{Document, Options, read};
use zeroset_testkit::certified::Line;
use zeroset_trace::{Camera, Projection, RayGrid, Region};

/// A row of the table of surfaces.
pub struct Surface {
    /// What the C++ calls it.
    pub name: &'static str,
    /// The domain is a cube of twice this edge around the origin, and distances are counted in it.
    pub half: f64,
    formula: &'static str,
    /// Whether the domain cuts it open.
    pub is_cut: bool,
}

const fn whole(name: &'static str, half: f64, formula: &'static str) -> Surface {
    Surface { name, half, formula, is_cut: false }
}

const fn cut(name: &'static str, half: f64, formula: &'static str) -> Surface {
    Surface { name, half, formula, is_cut: true }
}

/// All surfaces: those of the C++, and a gyroid.
pub const SURFACES: [Surface; 10] = [
    whole("sphere", 1.2, "x^2+y^2+z^2-1"),
    whole("torus", 1.3, "(sqrt(x^2+y^2)-0.8)^2+z^2-0.11111"),
    whole("steiner", 1.0, "x^2*y^2+y^2*z^2+x^2*z^2+x*y*z"),
    whole("mitchell", 2.0, "4*(x^4+(y^2+z^2)^2)+17*x^2*(y^2+z^2)-20*(x^2+y^2+z^2)+17"),
    whole("tangle", 3.0, "x^4-5*x^2+y^4-5*y^2+z^4-5*z^2+11.8"),
    cut("teardrop", 1.2, "0.5*x^5+0.5*x^4-y^2-z^2"),
    whole(
        "klein",
        4.2,
        "(x^2+y^2+z^2+2*y-1)*((x^2+y^2+z^2-2*y-1)^2-8*z^2)+16*x*z*(x^2+y^2+z^2-2*y-1)",
    ),
    cut(
        "barth",
        2.0,
        "4*(phi^2*x^2-y^2)*(phi^2*y^2-z^2)*(phi^2*z^2-x^2)-(1+2*phi)*(x^2+y^2+z^2-1)^2",
    ),
    whole(
        "linked_tori",
        1.0,
        "((100*x^2+(10*y-2)^2+100*z^2+13)^2-53*(100*x^2+(10*y-2)^2))\
         *((100*z^2+(10*y+2)^2+100*x^2+13)^2-53*(100*z^2+(10*y+2)^2))+1000",
    ),
    cut("gyroid", std::f64::consts::TAU, "sin(x)*cos(y)+sin(y)*cos(z)+sin(z)*cos(x)"),
];

/// Of the eye, in half extents; the target is the origin.
const EYE: DVec3 = DVec3::new(2.0, 1.5, 3.0);
/// In degrees.
pub const FOV: f64 = 40.0;

impl Surface {
    /// Its formula, read.
    ///
    /// # Errors
    /// If it is none.
    pub fn document(&self) -> Result<Document> {
        let document = read(self.formula, &Options::default());
        document.map_err(|errors| anyhow::anyhow!("{}: {errors}", self.name))
    }

    /// Its domain.
    ///
    /// # Errors
    /// If there is no such domain.
    pub fn region(&self) -> Result<Region> {
        let half = DVec3::splat(self.half);
        Region::new(-half, half).context(self.name)
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
