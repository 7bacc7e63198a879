//! The simplifier must keep values and domains of definition.

use zeroset_interval::Interval;
use zeroset_ir::{Graph, NodeId, simplify};
use zeroset_testkit::GraphOptions;
use zeroset_testkit::suite::check_rewrite;

fn simplified(graph: &Graph, root: NodeId, region: &[[f32; 2]; 3]) -> Option<(Graph, NodeId)> {
    let domain = region.map(|[lo, hi]| Interval { lo: f64::from(lo), hi: f64::from(hi) });
    let (graph, roots) = simplify(graph, &[root], &domain, &[]).ok()?;
    Some((graph, roots[0]))
}

#[test]
fn values_and_domains_stay() {
    for (seed, size) in [(0x5eed_0070, 3), (0x5eed_0071, 8), (0x5eed_0072, 16)] {
        let options = GraphOptions { size, ..GraphOptions::default() };
        let tally = check_rewrite(&simplified, seed, &options, 10_000);
        let tally = tally.unwrap_or_else(|failure| panic!("{failure}"));
        assert!(tally.defined > 10_000, "{tally:?}");
    }
}
