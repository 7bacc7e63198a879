//! Named materials of surfaces.

/// How a surface reflects light: a row of [`MATERIALS`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// The name that selects the material.
    pub name: &'static str,
    /// One line that describes the material.
    pub help: &'static str,
    /// Share of the light that the surface scatters in its own color.
    pub diffuse: f32,
    /// Strength of the key light's highlight, as a multiple of the look's.
    pub highlight: f32,
    /// Whether the highlight is small and sharp.
    pub is_sharp: bool,
    /// Share of the surroundings that is reflected where the surface faces the eye. It grows to 1
    /// toward grazing angles (Schlick, "An Inexpensive BRDF Model for Physically-based Rendering",
    /// 1994). Without a reflection, the share is 0 everywhere.
    pub reflection: f32,
    /// Whether reflections have the surface's color.
    pub is_metal: bool,
    /// Opacity of a surface for which no line sets one, from 0 to 1.
    pub opacity: f64,
}

/// All materials; the first is the default.
pub const MATERIALS: [Material; 5] = [
    Material {
        name: "satin",
        help: "a soft highlight",
        diffuse: 1.0,
        highlight: 1.0,
        is_sharp: false,
        reflection: 0.0,
        is_metal: false,
        opacity: 1.0,
    },
    Material {
        name: "matte",
        help: "no highlight, as paper or clay",
        diffuse: 1.0,
        highlight: 0.0,
        is_sharp: false,
        reflection: 0.0,
        is_metal: false,
        opacity: 1.0,
    },
    Material {
        name: "gloss",
        help: "a small highlight, and reflections that grow toward the edges, as lacquer",
        diffuse: 0.95,
        highlight: 2.6,
        is_sharp: true,
        reflection: 0.05,
        is_metal: false,
        opacity: 1.0,
    },
    Material {
        name: "metal",
        help: "reflections of a bright room in the surface's color",
        diffuse: 0.2,
        highlight: 1.6,
        is_sharp: true,
        reflection: 0.8,
        is_metal: true,
        opacity: 1.0,
    },
    Material {
        name: "glass",
        help: "a clear film, with reflections that grow toward the edges; bends no light",
        diffuse: 0.9,
        highlight: 4.0,
        is_sharp: true,
        reflection: 0.08,
        is_metal: false,
        opacity: 0.24,
    },
];

impl Default for &'static Material {
    fn default() -> Self {
        &MATERIALS[0]
    }
}
