//! Checks of graph rewriting: values and domains of definition must not change.

use super::{Failure, Tally};
use crate::{
    Claim, Defined, Ends, GraphOptions, Oracle, Place, Rng, point_in_box, random_box, random_graph,
    reproduce,
};
use zeroset_ir::{Graph, NodeId};

/// Rewrites the function `root` over a box (two ends per axis), or returns `None` to skip it.
pub type Rewrite<'a> = &'a dyn Fn(&Graph, NodeId, &[[f32; 2]; 3]) -> Option<(Graph, NodeId)>;

/// Points checked on each graph.
const POINTS: u32 = 8;

/// Checks `graphs` random graphs drawn by `options`, without parameters. Each graph is rewritten
/// for a random box, and compared with the original at points of the box. Both must be defined at
/// the same points, and the enclosures of their values must overlap.
///
/// # Errors
/// The first contradiction, with a line that reproduces it.
pub fn check_rewrite(
    rewrite: Rewrite,
    seed: u64,
    options: &GraphOptions,
    graphs: u32,
) -> Result<Tally, Failure> {
    let mut rng = Rng::with_seed(seed);
    let mut tally = Tally::default();
    let options = GraphOptions { parameters: 0, ..options.clone() };
    for _ in 0..graphs {
        let (graph, root) = random_graph(&mut rng, &options);
        let region = random_box::<f32>(&mut rng, Ends::Infinite);
        let Some((after, new_root)) = rewrite(&graph, root, &region) else {
            continue;
        };
        let (old, new) = (Oracle::new(&graph, &[root]), Oracle::new(&after, &[new_root]));
        for _ in 0..POINTS {
            let point = point_in_box(&mut rng, &region);
            let (was, is) = (old.at(point, &[])[0], new.at(point, &[])[0]);
            tally.compared += 1;
            tally.defined += u64::from([was.defined, is.defined] == [Defined::Yes; 2]);
            let Some(what) = contradiction(was, is) else { continue };
            let line = reproduce(&graph, root, &[], &Place::At(point));
            let rewritten = zeroset_ir::display(&after, new_root, &[]);
            return Err(Failure(format!(
                "{what}: {was:?} became {is:?}\n{line}\nover {region:?} rewritten to {rewritten}\n\
                 seed {seed:#x}"
            )));
        }
    }
    Ok(tally)
}

/// Returns the contradiction if the two claims cannot describe the same value.
pub(crate) fn contradiction(was: Claim, is: Claim) -> Option<&'static str> {
    match (was.defined, is.defined) {
        (Defined::Yes, Defined::No) => Some("no longer defined"),
        (Defined::No, Defined::Yes) => Some("defined where it was not"),
        (Defined::Yes, Defined::Yes) => {
            let meet = was.lo <= is.hi && is.lo <= was.hi;
            (!meet).then_some("another value")
        }
        (Defined::No, Defined::No) | (Defined::Unknown, _) | (_, Defined::Unknown) => None,
    }
}
