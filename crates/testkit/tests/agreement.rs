//! Native code gives the bits of the reference evaluator: random graphs, as typed and simplified,
//! over all of space and over boxes, with parameters; −0 equals +0 and NaN equals NaN.
//!
//! A long run: `ZEROSET_CASES=100000000 cargo test --release -p zeroset-testkit --test agreement`.

use std::fmt::Debug;
use zeroset_eval::{
    Assumptions, Binding, BoxPacket, EnclosurePacket, GradientKernel, GradientPacket,
    IntervalKernel, LANES, PointKernel, PointPacket, Reference, Tape, ValuePacket,
};
use zeroset_interval::Facts;
use zeroset_ir::{Graph, NodeId, gradient, rewrite, simplify};
use zeroset_jit::{NativeGradient, NativeInterval, NativePoint};
use zeroset_testkit::{
    Case, Effort, Ends, GraphOptions, Place, Rng, adversarial_f32, minimise, pack_boxes,
};

/// Inputs per kernel: enough that compiling is a small part of the work.
const INPUTS: usize = 256;

/// The steps of a case's function, or of it and its derivatives.
fn tape(case: &Case, simple: bool, derivatives: bool) -> Option<Tape> {
    let Assumptions { domain, parameters } = &case.assumptions;
    let (mut graph, mut root) = (case.graph.clone(), case.root);
    if simple {
        let (simpler, roots) = rewrite(&graph, &[root], domain, parameters).ok()?;
        (graph, root) = (simpler, roots[0]);
    }
    let mut roots = vec![root];
    if derivatives {
        roots.extend(gradient(&mut graph, root));
    }
    if simple {
        (graph, roots) = simplify(&graph, &roots, domain, parameters).ok()?;
    }
    let is_short = |graph: &Graph, roots: &[NodeId]| {
        graph.reachable(roots).iter().filter(|needed| **needed).count() < 400
    };
    is_short(&graph, &roots).then(|| Tape::new(&graph, &roots, &case.assumptions))
}

/// Bindings are rarely undefined; enclosures inherit it.
fn binding(case: &Case) -> Binding {
    let facts = match case.graph.len() % 16 {
        0 => Facts::NONE,
        1 => Facts::NOWHERE,
        _ => Facts::TOTAL,
    };
    let values: Vec<_> = case.parameters.iter().map(|value| (*value, facts)).collect();
    Binding::new(&values)
}

/// A kernel's four lanes of answers, as words to compare and whether they are floats.
trait Lanes: Default + Clone + Debug {
    fn words(&self, lane: usize) -> ([f32; 4], u32);
}

impl Lanes for EnclosurePacket {
    fn words(&self, lane: usize) -> ([f32; 4], u32) {
        ([self.neg_lo[lane], self.hi[lane], 0.0, 0.0], self.facts[lane])
    }
}

impl Lanes for ValuePacket {
    fn words(&self, lane: usize) -> ([f32; 4], u32) {
        ([self.value[lane], 0.0, 0.0, 0.0], 0)
    }
}

impl Lanes for GradientPacket {
    fn words(&self, lane: usize) -> ([f32; 4], u32) {
        let [x, y, z] = self.gradient.map(|lanes| lanes[lane]);
        ([self.value[lane], x, y, z], 0)
    }
}

fn same<O: Lanes>(a: &O, b: &O) -> bool {
    (0..LANES).all(|lane| {
        let ((a, a_facts), (b, b_facts)) = (a.words(lane), b.words(lane));
        let floats = a.iter().zip(b).all(|(a, b)| *a == b || (a.is_nan() && b.is_nan()));
        floats && a_facts == b_facts
    })
}

/// Runs a case's native code and its reference over inputs.
type Both<I, O> = dyn Fn(&Case, &[I]) -> Option<[Vec<O>; 2]>;

fn intervals(simple: bool) -> Box<Both<BoxPacket, EnclosurePacket>> {
    Box::new(move |case, inputs| {
        let (tape, binding) = (tape(case, simple, false)?, binding(case));
        let mut out = [(); 2].map(|()| vec![EnclosurePacket::default(); inputs.len()]);
        NativeInterval::compile(&tape, &binding).expect("compiles").enclose(inputs, &mut out[0]);
        Reference::new(tape, binding).enclose(inputs, &mut out[1]);
        Some(out)
    })
}

fn points(simple: bool) -> Box<Both<PointPacket, ValuePacket>> {
    Box::new(move |case, inputs| {
        let (tape, binding) = (tape(case, simple, false)?, binding(case));
        let mut out = [(); 2].map(|()| vec![ValuePacket::default(); inputs.len()]);
        NativePoint::compile(&tape, &binding).expect("compiles").sample(inputs, &mut out[0]);
        Reference::new(tape, binding).sample(inputs, &mut out[1]);
        Some(out)
    })
}

fn gradients(simple: bool) -> Box<Both<PointPacket, GradientPacket>> {
    Box::new(move |case, inputs| {
        let (tape, binding) = (tape(case, simple, true)?, binding(case));
        let mut out = [(); 2].map(|()| vec![GradientPacket::default(); inputs.len()]);
        NativeGradient::compile(&tape, &binding).expect("compiles").gradient(inputs, &mut out[0]);
        Reference::new(tape, binding).gradient(inputs, &mut out[1]);
        Some(out)
    })
}

fn random_boxes(case: &Case, rng: &mut Rng) -> Vec<BoxPacket> {
    let regions: Vec<_> = (0..INPUTS).map(|_| case.random_box(rng)).collect();
    pack_boxes(&regions)
}

/// Samples assume nothing of the domain, so any point will do, infinite ones too.
fn random_points(_: &Case, rng: &mut Rng) -> Vec<PointPacket> {
    let mut draw = || adversarial_f32(rng, Ends::Infinite);
    let packets = (0..INPUTS / LANES)
        .map(|_| PointPacket { at: [[0.0; LANES]; 3].map(|lanes| lanes.map(|_: f32| draw())) });
    packets.collect()
}

/// Compares until `effort.cases` inputs agreed, and tells the first that does not, made smaller.
fn check<I: Clone + Debug, O: Lanes>(
    seed: u64,
    options: &GraphOptions,
    inputs: fn(&Case, &mut Rng) -> Vec<I>,
    both: &Both<I, O>,
) {
    let effort = Effort::from_environment(seed, 250_000);
    let mut compared = 0;
    for seed in effort.seed.. {
        if compared >= effort.cases {
            break;
        }
        let mut rng = Rng::with_seed(seed);
        let case = Case::random(&mut rng, options);
        let packets = inputs(&case, &mut rng);
        let Some([native, reference]) = both(&case, &packets) else { continue };
        compared += (packets.len() * LANES) as u64;
        let mut pairs = native.iter().zip(&reference);
        if let Some(at) = pairs.position(|(a, b)| !same(a, b)) {
            let packet = &packets[at..=at];
            let mut differs = |case: &Case| {
                both(case, packet)
                    .is_some_and(|[native, reference]| !same(&native[0], &reference[0]))
            };
            let least = minimise(&case, &mut differs);
            let answers = both(&least, packet);
            panic!(
                "{}\n{packet:?}\n{answers:#?}\nZEROSET_SEED={seed:#x} ZEROSET_CASES=1",
                least.describe(&Place::At([0.0; 3])),
            );
        }
    }
    println!("{compared} inputs agree");
}

fn options() -> GraphOptions {
    GraphOptions { size: 8, parameters: 2, ..GraphOptions::default() }
}

/// Derivatives grow, so they are taken of shorter formulas.
fn short() -> GraphOptions {
    GraphOptions { size: 4, ..options() }
}

#[test]
fn intervals_agree() {
    check(0x5eed_0400_0000, &options(), random_boxes, &*intervals(false));
    check(0x5eed_0410_0000, &options(), random_boxes, &*intervals(true));
    let plain = GraphOptions { adversarial: false, size: 16, ..options() };
    check(0x5eed_0420_0000, &plain, random_boxes, &*intervals(false));
    check(0x5eed_0430_0000, &plain, random_boxes, &*intervals(true));
}

#[test]
fn points_agree() {
    check(0x5eed_0500_0000, &options(), random_points, &*points(false));
    check(0x5eed_0510_0000, &options(), random_points, &*points(true));
    let plain = GraphOptions { adversarial: false, size: 16, ..options() };
    check(0x5eed_0520_0000, &plain, random_points, &*points(false));
    check(0x5eed_0530_0000, &plain, random_points, &*points(true));
}

#[test]
fn gradients_agree() {
    check(0x5eed_0600_0000, &short(), random_points, &*gradients(false));
    check(0x5eed_0610_0000, &short(), random_points, &*gradients(true));
    let plain = GraphOptions { adversarial: false, ..options() };
    check(0x5eed_0620_0000, &plain, random_points, &*gradients(false));
    check(0x5eed_0630_0000, &plain, random_points, &*gradients(true));
}
