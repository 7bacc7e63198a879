//! Towers of definitions: each storey uses the one before several times. Each pass over formulas
//! takes time in proportion to their operations. A walk along all paths would never end.

use glam::DVec3;
use std::fmt::Write as _;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};
use zeroset_eval::{Boxes, Enclosures, LANES, Lanes, Tiles};
use zeroset_interval::Interval;
use zeroset_mesh::mesh;
use zeroset_ops::{Notation, TABLE};
use zeroset_render::model::Model;
use zeroset_render::picture::Settings;
use zeroset_scene::curves;
use zeroset_scene::kernels::Evaluator;
use zeroset_scene::program::{KernelSource, Program};
use zeroset_scene::view::{DomainChoice, bounds, region};
use zeroset_space::{Camera, Projection, Region};
use zeroset_syntax::{Document, Format, Options, emit, read};

/// Number of storeys. A tower has at least 2⁶⁰ paths, and fewer than a thousand operations.
const STOREYS: usize = 60;
/// Far above the time that any pass takes, even on a slow and busy machine. It ends only the test:
/// nothing is measured.
const LIMIT: Duration = Duration::from_mins(2);
/// Number of times that a pass is told to go on. Thereafter its evaluations are unwanted: their
/// number depends on the surface, not on how a graph is walked.
const WANTED: usize = 40;

/// Storeys joined in ways that passes treat differently. `A` is the storey before.
const STEPS: [&str; 12] = [
    "A*(A + 1)",
    "min(A, A + x - 0.3)",
    "max(A, z - A)",
    "max(min(A, A - x), min(A + y, A*A))",
    "if(A < x, A + 1, A - y)",
    "A/(A + 2)",
    "abs(A)^x - A",
    "A - 0.1*abs(A)*sqrt(A + 1)",
    "min(A, A - x) - 0.5*max(0.4 - abs(A - (A - x)), 0)^2",
    "x*A - y*A + z*(A - 0.5)",
    "exp(A)*exp(-A) + ln(A^2 + 1)",
    "cos(atan2(A, x) + A) + A",
];

type Pass = (&'static str, fn(&str, &Document, &Region));

/// Passes over formulas that compile no code. Those of crate `ir` have a test there.
const WALKS: &[Pass] = &[
    ("texts of other programs", |text, document, _| {
        for format in Format::ALL {
            // A format may lack an operation.
            _ = emit(document, text, format);
        }
    }),
    ("program and tapes", |_, document, region| {
        use KernelSource::{Branches, Denominator, Function, Gradient, Numerator};
        let Ok(program) = Program::drawn(document, bounds(region)) else { return };
        _ = program.cleared(0);
        for form in [Function, Numerator, Denominator, Branches, Gradient] {
            _ = program.tape::<f32>(0, form);
            _ = program.tape::<f64>(0, form);
        }
    }),
    ("reference", |_, document, region| {
        let Ok(program) = Program::drawn(document, bounds(region)) else { return };
        let program = program.on(Evaluator::Reference);
        if let Ok(kernel) = program.kernels::<f64>(0).bounds() {
            let boxes = Boxes::around(&[[Interval { lo: 0.0, hi: 0.5 }; 3]]);
            kernel.eval(&boxes[0], &mut Enclosures::default());
        }
    }),
];

/// Passes that also compile code, which takes the most time.
const WITH_CODE: &[Pass] = &[
    ("domain", |_, document, _| _ = region(document, DomainChoice::Auto, None)),
    ("kernels", |_, document, region| {
        let Ok(program) = Program::drawn(document, bounds(region)) else { return };
        program.hurry();
        let kernels = program.kernels::<f32>(0);
        _ = (kernels.zeros().is_ok(), kernels.gradients().is_ok(), kernels.cleared().is_ok());
    }),
    ("steps that matter in parts", |_, document, region| {
        let Ok(program) = Program::drawn(document, bounds(region)) else { return };
        let kernels = program.kernels::<f32>(0);
        if kernels.has_parts() {
            let mut tiles = Tiles::<f32> { count: LANES as u32, ..Tiles::default() };
            tiles.far = Lanes::splat(1.0);
            _ = kernels.in_tiles(&tiles);
        }
    }),
    ("choices and mesh", |_, document, region| {
        let Ok(program) = Program::drawn(document, zeroset_mesh::domain(region)) else { return };
        program.hurry();
        let options = zeroset_mesh::Options {
            region: *region,
            larger: None,
            tolerance: 1.0,
            is_solid: program.is_solid(0),
            is_estimated: false,
            has_large_faces: false,
            most_cells: 64,
        };
        let asked = AtomicUsize::new(0);
        _ = mesh(&program, 0, &options, &|| asked.fetch_add(1, Ordering::Relaxed) < WANTED);
    }),
    ("measures", |_, document, region| {
        let Ok(program) = Program::drawn(document, zeroset_mesh::domain(region)) else { return };
        program.hurry();
        let asked = AtomicUsize::new(0);
        let wanted = || asked.fetch_add(1, Ordering::Relaxed) < WANTED;
        let request = zeroset_measure::Request { relative: 1.0, ..zeroset_measure::Request::ALL };
        _ = zeroset_measure::measure(&program, 0, region, None, &request, &wanted);
    }),
    ("curves", |text, _, region| {
        let (definitions, last) = text.rsplit_once('\n').expect("lines");
        let equation = last.replace("<=", "=");
        let text = format!("{definitions}\ncurve {equation}, z = 0.1");
        curves::trace(&document(&text), region);
    }),
    ("model", |_, document, region| {
        let settings = Settings { width: 4, height: 4, is_preview: true, ..Settings::default() };
        let Ok(model) = Model::new(document, region, &settings) else { return };
        let (eye, target) = (DVec3::new(9.0, 7.0, 5.0), DVec3::ZERO);
        let camera = Camera::new(eye, target, DVec3::Z, Projection::Perspective { fov: 40.0 })
            .expect("a camera");
        let asked = AtomicUsize::new(0);
        let go_on = |_| asked.fetch_add(1, Ordering::Relaxed) < WANTED;
        _ = model.trace(&camera, &settings, &go_on);
        _ = model.sample_typed(document, 0, DVec3::splat(0.3));
    }),
];

fn document(text: &str) -> Document {
    read(text, &Options::default()).unwrap_or_else(|e| panic!("{}", e.render(None, text, false)))
}

/// A text of definitions, each of the one before by `step`, and of a solid.
fn tower(step: &str) -> String {
    let mut text = String::from("a0 = x^2 + y^2 + z\n");
    for storey in 1..=STOREYS {
        let step = step.replace('A', &format!("a{}", storey - 1));
        let _ = writeln!(text, "a{storey} = {step}");
    }
    let _ = write!(text, "a{STOREYS} <= 1");
    text
}

/// A step for each operation that a formula can name, joined to its storey in turn by several
/// others.
fn steps_of_all_operations() -> Vec<String> {
    let written = TABLE.iter().filter_map(|row| {
        let operands = ["A", "(A + 1)", "(A - x)"];
        match (row.notation, row.op.arity()) {
            (Notation::Function, arity) => {
                Some(format!("{}({})", row.name, operands[..arity].join(", ")))
            }
            (Notation::Infix { symbol, .. }, 2) => Some(format!("A {symbol} (A + 1)")),
            (Notation::Infix { symbol, .. }, _) => Some(format!("({symbol}A)")),
            (Notation::Internal, _) => None,
        }
    });
    let joined = ["A + (I)", "A*(I)", "min(A, I)", "x - (I)*A", "max(A, I)", "A/(I)"];
    written.zip(joined.iter().cycle()).map(|(inner, outer)| outer.replace('I', &inner)).collect()
}

#[test]
fn no_walk_takes_all_paths() {
    let region = Region::new(DVec3::splat(-2.0), DVec3::splat(2.0)).expect("a cube");
    let steps = steps_of_all_operations();
    assert!(steps.len() > TABLE.len() / 2, "{}", steps.len());
    let mut slowest = (Duration::ZERO, String::new());
    let all = steps
        .iter()
        .map(|step| (step.as_str(), WALKS))
        .chain([WALKS, WITH_CODE].into_iter().flat_map(|passes| STEPS.map(|step| (step, passes))));
    for (step, passes) in all {
        for (name, pass) in passes {
            let case = format!("{name}: {step}");
            let (text, clock) = (tower(step), Instant::now());
            let (done, ended) = channel();
            // A walk that does not end is left to its thread.
            std::thread::spawn(move || {
                pass(&text, &document(&text), &region);
                done.send(()).expect("the test waits");
            });
            let ended = ended.recv_timeout(LIMIT);
            assert_ne!(ended, Err(RecvTimeoutError::Timeout), "{case}");
            assert_eq!(ended, Ok(()), "{case}");
            slowest = slowest.max((clock.elapsed(), case));
        }
    }
    println!("the slowest: {slowest:?}");
}
