//! Named sets of lights and tones.

/// The lights and the background of a picture: a row of [`LOOKS`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// The name that selects the look.
    pub name: &'static str,
    /// One line that describes the look.
    pub help: &'static str,
    /// Color of pixels in which nothing is painted, as sRGB bytes.
    pub background: [u8; 3],
    /// Share of the light that is ambient, within [0, 1]. The key and fill lights share the rest.
    pub ambient: f32,
    /// Strength of ambient light from below. Ambient light from above has strength 1.
    pub ground: f32,
    /// Strength of the key light, which casts shadows.
    pub key: f32,
    /// Strength of the fill light, which comes from the viewer's right and brightens shadows.
    pub fill: f32,
    /// Strength of the rim light, which comes from behind and brightens the edges of a surface.
    pub rim: f32,
    /// Strength of the key light's white highlight.
    pub highlight: f32,
    /// Strength of the reflected surroundings on materials that reflect.
    pub surroundings: f32,
    /// Strength, from 0 to 1, of outlines: dark edges where a surface turns from the viewer.
    pub outline: f32,
    /// Whether nearby points of a surface reduce the ambient light.
    pub occlusion: bool,
}

/// All looks; the first is the default.
pub const LOOKS: [Look; 4] = [
    Look {
        name: "studio",
        help: "a key light above on the left, a fill light, a rim light, soft corners",
        background: [244, 244, 246],
        ambient: 0.42,
        ground: 0.55,
        key: 1.25,
        fill: 0.35,
        rim: 0.22,
        highlight: 0.16,
        surroundings: 1.0,
        outline: 0.0,
        occlusion: true,
    },
    Look {
        name: "flat",
        help: "hardly any light and shade: colors as they were typed",
        background: [255, 255, 255],
        ambient: 0.8,
        ground: 0.9,
        key: 1.0,
        fill: 0.4,
        rim: 0.0,
        highlight: 0.0,
        surroundings: 0.5,
        outline: 0.0,
        occlusion: false,
    },
    Look {
        name: "paper",
        help: "white, soft and with dark outlines: for print",
        background: [255, 255, 255],
        ambient: 0.65,
        ground: 0.75,
        key: 1.2,
        fill: 0.3,
        rim: 0.0,
        highlight: 0.0,
        surroundings: 1.0,
        outline: 0.75,
        occlusion: true,
    },
    Look {
        name: "night",
        help: "a dark room with a strong light from behind",
        background: [13, 15, 21],
        ambient: 0.25,
        ground: 0.35,
        key: 1.05,
        fill: 0.22,
        rim: 0.75,
        highlight: 0.25,
        surroundings: 0.55,
        outline: 0.0,
        occlusion: true,
    },
];

impl Look {
    /// The look with this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        LOOKS.iter().find(|look| look.name == name)
    }
}

impl Default for &'static Look {
    fn default() -> Self {
        &LOOKS[0]
    }
}
