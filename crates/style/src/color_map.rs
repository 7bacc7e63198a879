//! Colors for numbers, by name. The maps themselves are those of the crate `colorous`.

use colorous::Gradient;

/// Colors from the first to the last: a row of [`COLOR_MAPS`].
#[derive(Clone, Copy, Debug)]
pub struct ColorMap {
    /// What it is called.
    pub name: &'static str,
    gradient: Gradient,
}

/// Every color map.
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

impl ColorMap {
    /// The map of this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        const { &COLOR_MAPS }.iter().find(|map| map.name == name)
    }

    /// The sRGB bytes of the color at a share of the way from the first to the last; beyond the
    /// ends, theirs. NaN is as 0.
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
