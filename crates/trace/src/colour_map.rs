//! Colours for numbers, by name. The maps themselves are those of the crate `colorous`.

use crate::colour::LinearRgb;
use colorous::Gradient;

/// Colours from the first to the last: a row of [`COLOUR_MAPS`].
#[derive(Clone, Copy, Debug)]
pub struct ColourMap {
    /// What it is called.
    pub name: &'static str,
    gradient: Gradient,
}

/// Every colour map.
pub const COLOUR_MAPS: [ColourMap; 12] = [
    ColourMap { name: "viridis", gradient: colorous::VIRIDIS },
    ColourMap { name: "magma", gradient: colorous::MAGMA },
    ColourMap { name: "inferno", gradient: colorous::INFERNO },
    ColourMap { name: "plasma", gradient: colorous::PLASMA },
    ColourMap { name: "cividis", gradient: colorous::CIVIDIS },
    ColourMap { name: "turbo", gradient: colorous::TURBO },
    ColourMap { name: "spectral", gradient: colorous::SPECTRAL },
    ColourMap { name: "sinebow", gradient: colorous::SINEBOW },
    ColourMap { name: "rainbow", gradient: colorous::RAINBOW },
    ColourMap { name: "blues", gradient: colorous::BLUES },
    ColourMap { name: "greys", gradient: colorous::GREYS },
    ColourMap { name: "redblue", gradient: colorous::RED_BLUE },
];

impl ColourMap {
    /// The map of this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        const { &COLOUR_MAPS }.iter().find(|map| map.name == name)
    }

    /// The sRGB bytes of the colour at a share of the way from the first to the last; beyond the
    /// ends, theirs. NaN is as 0.
    pub fn bytes(&self, share: f64) -> [u8; 3] {
        let share = if share > 0.0 { share.min(1.0) } else { 0.0 };
        self.gradient.eval_continuous(share).as_array()
    }

    /// The same colour in linear light.
    pub fn at(&self, share: f64) -> LinearRgb {
        LinearRgb::from_srgb(self.bytes(share))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_are_the_first_and_the_last_colour() {
        let map = ColourMap::named("viridis").expect("listed");
        assert_eq!(map.bytes(0.0), [68, 1, 84]);
        assert_eq!(map.bytes(1.0), [253, 231, 37]);
        assert_eq!((map.bytes(-3.0), map.bytes(f64::NAN)), (map.bytes(0.0), map.bytes(0.0)));
        assert_eq!(map.bytes(7.0), map.bytes(1.0));
        assert!(ColourMap::named("Viridis").is_none());
    }
}
