//! Parameter values as kernels read them.

use crate::packet::Lanes;
use crate::tape::{middle, outward};
use zeroset_interval::{Facts, Interval};

/// Values of all parameters for one picture: what turns code into a function of x, y and z.
///
/// A parameter is a real number known by bounds, because what was typed need not be a float. It may also be an
/// expression of other parameters, computed beforehand, and as such be undefined; every enclosure inherits that.
#[derive(Clone, Debug, PartialEq)]
pub struct Binding {
    enclosures: Vec<[Lanes; 2]>,
    values: Vec<Lanes>,
    bounds: Vec<Interval>,
    facts: Facts,
}

impl Binding {
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
        let bounds: Vec<Interval> = parameters.iter().map(|(bounds, _)| outward(*bounds)).collect();
        Self {
            enclosures: bounds.iter().map(|b| [[-b.lo as f32; 4], [b.hi as f32; 4]]).collect(),
            values: bounds.iter().map(|b| [middle(*b) as f32; 4]).collect(),
            bounds,
            facts,
        }
    }

    /// For functions without parameters.
    pub fn empty() -> Self {
        Self::new(&[])
    }

    /// Per parameter, −lo and hi in all lanes.
    pub fn enclosures(&self) -> &[[Lanes; 2]] {
        &self.enclosures
    }

    /// Per parameter, a value near the middle of its bounds, in all lanes.
    pub fn values(&self) -> &[Lanes] {
        &self.values
    }

    /// Per parameter, its bounds with `f32` ends.
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
