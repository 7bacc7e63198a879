//! Named color maps. The maps themselves come from the crate `colorous`.

use colorous::Gradient;

/// A map from numbers to colors: a row of [`COLOR_MAPS`].
#[derive(Clone, Copy, Debug)]
pub struct ColorMap {
    /// The name that selects the map.
    pub name: &'static str,
    gradient: Gradient,
}

/// All color maps.
pub const COLOR_MAPS: [ColorMap; 12] = [
    ColorMap { name: "viridis", gradient: colorous::VIRIDIS },
    ColorMap { name: "magma", gradient: colorous::MAGMA },
    ColorMap { name: "inferno", gradient: colorous::INFERNO },
    ColorMap { name: "plasma", gradient: colorous::PLASMA },
    ColorMap { name: "cividis", gradient: colorous::CIVIDIS },
    ColorMap { name: "turbo", gradient: colorous::TURBO },
    ColorMap { name: "spectral", gradient: colorous::SPECTRAL },
    ColorMap { name: "sinebow", gradient: colorous::SINEBOW },
    ColorMap { name: "rainbow", gradient: colorous::RAINBOW },
    ColorMap { name: "blues", gradient: colorous::BLUES },
    ColorMap { name: "greys", gradient: colorous::GREYS },
    ColorMap { name: "redblue", gradient: colorous::RED_BLUE },
];

impl PartialEq for ColorMap {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl ColorMap {
    /// The color map with this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        const { &COLOR_MAPS }.iter().find(|map| map.name == name)
    }

    /// The color at `share` as sRGB bytes: 0 is the map's first color, 1 its last. A `share`
    /// outside [0, 1] is clamped; NaN counts as 0.
    pub fn bytes(&self, share: f64) -> [u8; 3] {
        let share = if share > 0.0 { share.min(1.0) } else { 0.0 };
        self.gradient.eval_continuous(share).as_array()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_the_first_and_the_last_color() {
        let map = ColorMap::named("viridis").expect("listed");
        assert_eq!(map.bytes(0.0), [68, 1, 84]);
        assert_eq!(map.bytes(1.0), [253, 231, 37]);
        assert_eq!((map.bytes(-3.0), map.bytes(f64::NAN)), (map.bytes(0.0), map.bytes(0.0)));
        assert_eq!(map.bytes(7.0), map.bytes(1.0));
        assert!(ColorMap::named("Viridis").is_none());
    }
}
