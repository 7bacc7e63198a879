//! Each rule on its own, and all of them on random graphs.

use super::*;
use crate::display;
use crate::testing::{Random, Sheet, Term, evaluate, operations};

const DOMAIN: Interval = Interval { lo: -2.0, hi: 2.0 };

/// The simplified text of a formula over the box [-2, 2]³ and parameters a in [-2, 2], b in [1, 2].
fn simple(formula: impl for<'a> Fn(&'a Sheet, [Term<'a>; 3]) -> Term<'a>) -> String {
    let sheet = Sheet::default();
    let root = formula(&sheet, sheet.xyz()).id;
    let graph = sheet.graph();
    let parameters = [DOMAIN, Interval { lo: 1.0, hi: 2.0 }];
    let (graph, roots) = rewrite(&graph, &[root], &[DOMAIN; 3], &parameters).expect("small");
    display(&graph, roots[0], &["a", "b"])
}

#[test]
fn trial() {
    let gallery: Vec<(&str, fn(&Sheet) -> NodeId)> = vec![
        ("sphere", |s| {
            let [x, y, z] = s.xyz();
            let r = s.parameter(0);
            (x.pow(2) + y.pow(2) + z.pow(2) - r.pow(2)).id
        }),
        ("mitchell", |s| {
            let [x, y, z] = s.xyz();
            (4.0 * (x.pow(4) + (y.pow(2) + z.pow(2)).pow(2))
                + 17.0 * x.pow(2) * (y.pow(2) + z.pow(2))
                - 20.0 * (x.pow(2) + y.pow(2) + z.pow(2))
                + 17.0)
                .id
        }),
        ("tangle", |s| {
            let [x, y, z] = s.xyz();
            (x.pow(4) - 5.0 * x.pow(2) + y.pow(4) - 5.0 * y.pow(2) + z.pow(4) - 5.0 * z.pow(2)
                + 11.8)
                .id
        }),
        ("barth", |s| {
            let [x, y, z] = s.xyz();
            let p = (1.0 + s.number("5").f(Op::Sqrt)) / 2.0;
            let q = p.pow(2);
            (4.0 * (q * x.pow(2) - y.pow(2))
                * (q * y.pow(2) - z.pow(2))
                * (q * z.pow(2) - x.pow(2))
                - (1.0 + 2.0 * p) * (x.pow(2) + y.pow(2) + z.pow(2) - 1.0).pow(2))
            .id
        }),
        ("klein", |s| {
            let [x, y, z] = s.xyz();
            let q = x.pow(2) + y.pow(2) + z.pow(2);
            ((q + 2.0 * y - 1.0) * ((q - 2.0 * y - 1.0).pow(2) - 8.0 * z.pow(2))
                + 16.0 * x * z * (q - 2.0 * y - 1.0))
                .id
        }),
        ("steiner", |s| {
            let [x, y, z] = s.xyz();
            (x.pow(2) * y.pow(2) + y.pow(2) * z.pow(2) + x.pow(2) * z.pow(2) + x * y * z).id
        }),
        ("chmutov6", |s| {
            let [x, y, z] = s.xyz();
            fn t(x: Term<'_>) -> Term<'_> {
                32.0 * x.pow(6) - 48.0 * x.pow(4) + 18.0 * x.pow(2) - 1.0
            }
            let (a, b, c) = (t(x).id, t(y).id, t(z).id);
            let mut g = s.0.borrow_mut();
            let ab = g.apply(Op::Add, &[a, b]);
            g.apply(Op::Add, &[ab, c])
        }),
    ];
    for (name, formula) in gallery {
        let sheet = Sheet::default();
        let root = formula(&sheet);
        let graph = sheet.graph();
        let (s, r) = simplify(&graph, &[root], &[DOMAIN; 3], &[DOMAIN]).expect("small");
        println!(
            "{name} {} -> {}: {}",
            operations(&graph, root),
            operations(&s, r[0]),
            display(&s, r[0], &[])
        );
        let (s, r) = rewrite(&graph, &[root], &[DOMAIN; 3], &[DOMAIN]).expect("small");
        println!("      {} {}", operations(&s, r[0]), display(&s, r[0], &[]));
    }
}

#[test]
fn values_and_domains_are_kept() {
    let mut compared = 0;
    let seed = 0x5eed_0001;
    let parameters = [DOMAIN, Interval { lo: 1.0, hi: 2.0 }];
    for case in 0..20_000_u64 {
        let mut random = Random(seed + case);
        let size = 1 + random.below(12);
        let (graph, root) = random.graph(size);
        let (after, roots) = rewrite(&graph, &[root], &[DOMAIN; 3], &parameters).expect("small");
        let (folded, folded_roots) =
            simplify(&graph, &[root], &[DOMAIN; 3], &parameters).expect("small");
        for _ in 0..8 {
            let at = [
                random.coordinate(),
                random.coordinate(),
                random.coordinate(),
            ];
            let values = [random.coordinate(), 1.0 + random.coordinate().abs() / 2.0];
            let before = evaluate(&graph, at, &values)[root.index()];
            for (after, root_after) in [(&after, roots[0]), (&folded, folded_roots[0])] {
                let after_value = evaluate(after, at, &values)[root_after.index()];
                let same = match (before, after_value) {
                    (Some((_, e)), None) | (None, Some((_, e))) => !e.is_finite(),
                    (Some((a, e)), Some((b, f))) => {
                        if e.is_finite() && f.is_finite() {
                            compared += 1;
                        }
                        !(e + f).is_finite() || (a - b).abs() <= e + f
                    }
                    (None, None) => {
                        compared += 1;
                        true
                    }
                };
                assert!(
                    same,
                    "seed {:#x}: {} became {} at {at:?} {values:?}: {before:?} {after_value:?}",
                    seed + case,
                    display(&graph, root, &["a", "b"]),
                    display(after, root_after, &["a", "b"]),
                );
            }
        }
    }
    println!("compared {compared}");
}
