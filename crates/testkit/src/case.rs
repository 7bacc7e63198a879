//! A function with its domain and parameters, from which kernels are compiled.
//!
//! The caller chooses the kind of kernel and how it is compiled.

use crate::random::{
    Adversarial, Ends, GraphOptions, Rng, point_in_box, random_box, random_domain, random_graph,
    random_parameters, range_within,
};
use crate::{Place, reproduce_in};
use std::fmt;
use zeroset_eval::{Assumptions, Boxes, Real};
use zeroset_interval::Interval;
use zeroset_ir::{Graph, NodeId};

/// A function, the assumptions its code may make, and the values of its parameters.
#[derive(Clone, Debug)]
pub struct Case {
    /// The graph as typed.
    pub graph: Graph,
    /// The node of the function.
    pub root: NodeId,
    /// The domain and the parameters' ranges that compiled code may assume.
    pub assumptions: Assumptions,
    /// Bounds of each parameter's value when the code runs, within the assumed range.
    pub parameters: Vec<Interval>,
}

impl Case {
    /// Returns a function drawn by `options`. Its domain is all of space, or a box whose ends need
    /// not be `f32`. The code may assume a parameter's bounds, a wider range, or nothing.
    pub fn random(rng: &mut Rng, options: &GraphOptions) -> Self {
        let (graph, root) = random_graph(rng, options);
        let domain = random_domain(rng);
        let values = random_parameters(rng, options.parameters);
        let parameters: Vec<Interval> =
            values.into_iter().map(|(lo, hi)| Interval { lo, hi }).collect();
        let assumed = parameters.iter().map(|value| match rng.u32(0..3) {
            0 => *value,
            1 => value.hull(Interval { lo: -4.0, hi: 4.0 }),
            _ => Interval::ENTIRE,
        });
        let assumptions = Assumptions { parameters: assumed.collect(), domain };
        Self { graph, root, assumptions, parameters }
    }

    /// Returns a random box in the domain. Its ends are rounded outward to `T`, so it exceeds the
    /// domain by one rounding at most.
    pub fn random_box<T: Adversarial>(&self, rng: &mut Rng) -> [[T; 2]; 3] {
        let anywhere: [[T; 2]; 3] = random_box(rng, Ends::Infinite);
        let mut region = anywhere;
        for (range, bounds) in region.iter_mut().zip(self.assumptions.domain) {
            *range = range_within(rng, bounds, *range);
        }
        region
    }

    /// Returns a random point that lies in the domain and in `region`.
    pub fn random_point<T: Adversarial>(&self, rng: &mut Rng, region: &[[T; 2]; 3]) -> [f64; 3] {
        let mut point = point_in_box(rng, region);
        for (value, bounds) in point.iter_mut().zip(self.assumptions.domain) {
            *value = value.clamp(bounds.lo, bounds.hi);
        }
        point
    }

    /// Returns a value of each parameter as two equal bounds, mostly an end of its range.
    pub fn random_values(&self, rng: &mut Rng) -> Vec<(f64, f64)> {
        let drawn = self.parameters.iter().map(|bounds| {
            let value = match rng.u32(0..3) {
                0 => bounds.lo,
                1 => bounds.hi,
                _ => (bounds.lo / 2.0 + bounds.hi / 2.0).clamp(bounds.lo, bounds.hi),
            };
            (value, value)
        });
        drawn.collect()
    }

    /// Number of nodes on which the function depends.
    pub fn size(&self) -> usize {
        self.graph.reachable(&[self.root]).into_iter().filter(|needed| *needed).count()
    }

    /// Returns a line for `zeroset eval` in the precision `T` with this case, and the assumptions.
    pub fn describe<T: Real>(&self, place: &Place) -> String {
        let values: Vec<(f64, f64)> = self.parameters.iter().map(|v| (v.lo, v.hi)).collect();
        let line = reproduce_in::<T>(&self.graph, self.root, &values, place);
        format!("{line}\nunder {}", Assumed(&self.assumptions))
    }
}

struct Assumed<'a>(&'a Assumptions);

impl fmt::Display for Assumed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("domain")?;
        for range in self.0.domain {
            write!(f, " [{:?}, {:?}]", range.lo, range.hi)?;
        }
        f.write_str(", parameters")?;
        for range in &self.0.parameters {
            write!(f, " [{:?}, {:?}]", range.lo, range.hi)?;
        }
        Ok(())
    }
}

/// Packs boxes into batches for kernels.
pub fn pack_boxes<T: Real>(regions: &[[[T; 2]; 3]]) -> Vec<Boxes<T>> {
    let exact = |[lo, hi]: [T; 2]| Interval { lo: lo.into(), hi: hi.into() };
    let regions: Vec<_> = regions.iter().map(|region| region.map(exact)).collect();
    Boxes::around(&regions)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_lie_in_the_domain_and_points_in_both() {
        let seed = 0x5eed_0080;
        println!("seed {seed:#x}");
        let mut rng = Rng::with_seed(seed);
        let options = GraphOptions { parameters: 2, ..GraphOptions::default() };
        let (mut whole, mut inside, mut entire) = (0, 0, 0);
        for _ in 0..5000 {
            let case = Case::random(&mut rng, &options);
            let region = case.random_box::<f32>(&mut rng);
            let point = case.random_point(&mut rng, &region);
            for axis in 0..3 {
                let (bounds, [lo, hi]) = (case.assumptions.domain[axis], region[axis]);
                let p = point[axis];
                assert!(lo <= hi && lo < f32::INFINITY && hi > f32::NEG_INFINITY, "{region:?}");
                assert!(f64::from(lo) <= p && p <= f64::from(hi) && bounds.contains(p), "{p}");
                // The box exceeds the domain by one rounding at most.
                assert!(f64::from(lo.next_up()) > bounds.lo || lo.next_up() == hi.next_up());
                assert!(f64::from(hi.next_down()) < bounds.hi || hi == lo, "{region:?} {bounds:?}");
                let reaches = f64::from(lo) <= bounds.lo && f64::from(hi) >= bounds.hi;
                whole += u32::from(reaches && bounds.is_bounded() && bounds.width() > 0.0);
                inside += u32::from(f64::from(lo) > bounds.lo && f64::from(hi) < bounds.hi);
                entire += u32::from(bounds == Interval::ENTIRE);
            }
            for (value, assumed) in case.parameters.iter().zip(&case.assumptions.parameters) {
                assert!(assumed.encloses(*value));
            }
        }
        assert!(whole > 500 && inside > 5000 && entire > 3000, "{whole} {inside} {entire}");
    }
}
