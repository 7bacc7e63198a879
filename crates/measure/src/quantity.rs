//! The measures, each with the name by which it is asked for.

/// A measure that can be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// The volume of a solid.
    Volume,
    /// The mass of a solid with a density.
    Mass,
    /// The centroid of a solid.
    Centroid,
    /// The moments of inertia of a solid.
    Inertia,
    /// The least and the greatest coordinates.
    Ends,
    /// The area.
    Area,
    /// Pieces, hollows and genus.
    Shape,
}

impl Quantity {
    /// All measures, in the order in which they are printed.
    pub const ALL: [Self; 7] = [
        Self::Volume,
        Self::Mass,
        Self::Centroid,
        Self::Inertia,
        Self::Ends,
        Self::Area,
        Self::Shape,
    ];

    /// The name, a word in lowercase.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Volume => "volume",
            Self::Mass => "mass",
            Self::Centroid => "centroid",
            Self::Inertia => "inertia",
            Self::Ends => "ends",
            Self::Area => "area",
            Self::Shape => "shape",
        }
    }

    /// The measure with a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|one| one.name() == name)
    }

    /// Returns whether boxes of a solid are enough.
    pub(crate) const fn is_of_solid(self) -> bool {
        matches!(self, Self::Volume | Self::Mass | Self::Centroid | Self::Inertia)
    }

    /// Returns whether a density weights the measure.
    pub(crate) const fn is_weighted(self) -> bool {
        matches!(self, Self::Mass | Self::Centroid | Self::Inertia)
    }
}
