//! The parser must read back random graphs as the reproduction prints them.

use zeroset_ops::{Notation, Op, TABLE};
use zeroset_syntax::{Options, read};
use zeroset_testkit::{
    Defined, Ends, GraphOptions, Place, Rng, enclose_at, point_in_box, random_box, random_graph,
    reproduce,
};

const SEED: u64 = 0x5eed_0060;

/// Returns the text between `{"f":"` and the next quotation mark.
fn formula(line: &str) -> String {
    let text = line.strip_prefix("{\"f\":\"").expect("a formula");
    let end = text.find('"').expect("its end");
    text[..end].replace("\\n", "\n")
}

#[test]
fn printed_formulas_read_back_with_the_same_values() {
    let mut rng = Rng::with_seed(SEED);
    let ops: Vec<Op> =
        TABLE.iter().filter(|row| row.notation != Notation::Internal).map(|row| row.op).collect();
    let mut compared = 0;
    for round in 0..3000 {
        let options = GraphOptions {
            size: rng.u32(1..12),
            ops: ops.clone(),
            parameters: 0,
            adversarial: false,
        };
        let (graph, root) = random_graph(&mut rng, &options);
        let region = random_box::<f32>(&mut rng, Ends::Finite);
        let point = point_in_box(&mut rng, &region);
        let line = reproduce(&graph, root, &[], &Place::At(point));
        let case = format!("{line}\nseed {SEED:#x}, round {round}");
        let text = formula(&line);
        let document = match read(&text, &Options::default()) {
            Ok(document) => document,
            Err(errors) => panic!("{}\n{case}", errors.render(None, &text, false)),
        };
        let surface = &document.surfaces[0];
        let typed = enclose_at(&graph, &[root], point, &[])[0];
        let again = enclose_at(&document.graph, &[surface.root], point, &[])[0];
        let definite = [typed.defined, again.defined].map(|d| d != Defined::Unknown);
        if definite == [true, true] {
            assert_eq!(typed.defined, again.defined, "{case}");
        }
        if [typed.defined, again.defined] == [Defined::Yes; 2] {
            compared += 1;
            assert!(
                typed.lo <= again.hi && again.lo <= typed.hi,
                "{typed:?} and {again:?}\n{case}"
            );
        }
    }
    assert!(compared > 1000, "{compared}");
}
