//! Random graphs are printed as text, and the text is compiled to enclosures as for a picture. The
//! enclosures must hold the oracle's values of the graph. Parameters become sliders of the
//! document.
//!
//! A long run: `ZEROSET_CASES=100000000 cargo test --release --test all soundness`.

use zeroset_eval::{Boxes, Enclose, Enclosures, Kernel};
use zeroset_ops::{Notation, TABLE};
use zeroset_scene::program::Program;
use zeroset_syntax::{Options, read};
use zeroset_testkit::suite::check_interval_cases;
use zeroset_testkit::{Case, Effort, GraphOptions, typed};

/// The first surface of a program, as a kernel.
struct First(Program);

impl Kernel<Enclose> for First {
    fn eval(&self, boxes: &Boxes, enclosures: &mut Enclosures) {
        self.0.kernels(0).bounds().expect("compiles").eval(boxes, enclosures);
    }
}

fn compiled(case: &Case) -> Option<Box<dyn Kernel<Enclose>>> {
    // The bounds of each parameter's value.
    let values: Vec<(f64, f64)> =
        case.parameters.iter().map(|value| (value.lo, value.hi)).collect();
    let text = typed(&case.graph, case.root, &values)?;
    let document = read(&text, &Options::default())
        .unwrap_or_else(|errors| panic!("{}", errors.render(None, &text, false)));
    let program = Program::unchecked(&document, case.assumptions.domain).ok()?;
    program.kernels::<f32>(0).bounds().expect("compiles");
    Some(Box::new(First(program)))
}

#[test]
fn what_is_typed_is_enclosed() {
    let effort = Effort::from_environment(0x5eed_0700_0000, 200_000);
    let ops = TABLE.iter().filter(|row| row.notation != Notation::Internal).map(|row| row.op);
    let options = GraphOptions { ops: ops.collect(), parameters: 2, adversarial: false, size: 8 };
    let tally = check_interval_cases(&compiled, effort, &options);
    let tally = tally.unwrap_or_else(|failure| panic!("{failure}"));
    println!("{tally:?}");
    assert!(tally.defined >= effort.cases, "{tally:?}");
}
