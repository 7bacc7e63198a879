//! Parameter values as kernels read them.

use crate::real::Real;
use crate::tape::{middle, outward};
use zeroset_interval::{Facts, Interval};

/// Values of all parameters for one picture: what turns code into a function of x, y and z.
///
/// A parameter is a real number known by bounds, because what was typed need not be a float. It may also be an
/// expression of other parameters, computed beforehand, and as such be undefined; every enclosure inherits that.
#[derive(Clone, Debug, PartialEq)]
pub struct Binding<T: Real = f32> {
    enclosures: Vec<[T; 2]>,
    values: Vec<T>,
    bounds: Vec<Interval>,
    facts: Facts,
}

impl<T: Real> Binding<T> {
    /// Binds each parameter to bounds of its value and to what is proven of it.
    pub fn new(parameters: &[(Interval, Facts)]) -> Self {
        let nowhere = parameters.iter().any(|(_, facts)| facts.has(Facts::NOWHERE));
        let facts = if nowhere {
            Facts::NOWHERE
        } else {
            // A parameter does not vary over a box: where it is defined, it is continuous.
            let defined = parameters.iter().all(|(_, facts)| facts.has(Facts::DEFINED));
            if defined { Facts::TOTAL } else { Facts::NONE }
        };
        let bounds: Vec<Interval> =
            parameters.iter().map(|(bounds, _)| outward::<T>(*bounds)).collect();
        Self {
            enclosures: bounds.iter().map(|b| [T::nearest(-b.lo), T::nearest(b.hi)]).collect(),
            values: bounds.iter().map(|b| T::nearest(middle::<T>(*b))).collect(),
            bounds,
            facts,
        }
    }

    /// For functions without parameters.
    pub fn empty() -> Self {
        Self::new(&[])
    }

    /// Per parameter, −lo and hi.
    pub fn enclosures(&self) -> &[[T; 2]] {
        &self.enclosures
    }

    /// Per parameter, a value near the middle of its bounds.
    pub fn values(&self) -> &[T] {
        &self.values
    }

    /// Per parameter, its bounds with ends in `T`.
    pub fn bounds(&self) -> &[Interval] {
        &self.bounds
    }

    /// What is proven of the parameters together.
    pub fn facts(&self) -> Facts {
        self.facts
    }

    /// The facts of an enclosure that also depends on these parameters: `(facts & kept) | added` by bits.
    pub fn limit(&self, facts: Facts) -> Facts {
        let [kept, added] = self.limits();
        (facts & kept) | added
    }

    /// The two operands of [`Binding::limit`], as kernels read them.
    pub fn limits(&self) -> [Facts; 2] {
        [self.facts | Facts::NOWHERE, self.facts & Facts::NOWHERE]
    }
}
