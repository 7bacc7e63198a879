//! Values, enclosures and rays, compared with the oracle, the certified tracer and pictures.

use std::ops::RangeInclusive;
use zeroset::{Function, Precision, Ray, RayResult, Scene, Settings, Status, TraceSettings};
use zeroset_ir::{Constant, Graph, NodeId, fix_exponents};
use zeroset_syntax::{Document, Options, SurfaceKind, read};
use zeroset_testkit::certified::{self, Line};
use zeroset_testkit::{Defined, Ends, Oracle, Rng, point_in_box, random_box, random_ray};

/// Texts with poles, jumps, gaps and parameters.
const DIFFICULT: [&str; 9] = [
    "1/x + y",
    "atan(1/x) - z",
    "sqrt(x) - y*z",
    "ln(x^2+y^2) - z",
    "floor(x) + y - z/3",
    "tan(x) - y",
    "x^y - z",
    "r = 1.5 in [1, 2]\nn = 3\nx^n + y^2 - r*z",
    "max(abs(x)-1, abs(y)-1, abs(z)-1) {x*y < 1}",
];

/// The oracle of a document's first surface, and bounds of the parameters' values. Parameters in
/// exponents are replaced by their values.
fn oracle<'a>(
    document: &Document,
    fixed: &'a mut Option<(Graph, Vec<NodeId>)>,
) -> (Oracle<'a>, Vec<(f64, f64)>) {
    let values: Vec<Constant> = document.parameters.iter().map(|p| p.value.clone()).collect();
    let (graph, roots) =
        fixed.insert(fix_exponents(&document.graph, &[document.surfaces[0].root], &values));
    let bounds = |value: &Constant| (value.bounds().lo, value.bounds().hi);
    (Oracle::new(graph, roots), values.iter().map(bounds).collect())
}

/// The gallery's texts that are a single function, and the difficult texts.
fn texts() -> impl Iterator<Item = (String, Document)> {
    let gallery = zeroset::gallery().map(|example| example.text);
    gallery.chain(DIFFICULT).filter_map(|text| {
        let document = read(text, &Options::default()).expect("reads");
        let is_function =
            matches!(&document.surfaces[..], [one] if one.kind == SurfaceKind::Equation);
        is_function.then(|| (text.to_owned(), document))
    })
}

fn range([low, high]: [f64; 2]) -> RangeInclusive<f64> {
    low..=high
}

#[test]
fn functions_are_shared_between_threads() {
    fn shared<T: Send + Sync>() {}
    shared::<Function>();
    shared::<Scene>();
    shared::<zeroset::Picture>();
    shared::<zeroset::Error>();
}

#[test]
fn what_is_no_single_function_is_refused() {
    for (text, why) in [
        ("x^2+y^2 < 1", "an inequality is a solid and not a function: write `x^2 + y^2 - 1`"),
        ("4 >= x^2+y^2", "write `x^2 + y^2 - 4`"),
        ("z <= x + y", "write `z - (x + y)`"),
        ("x > 0 and y > 0", "an inequality is a solid and not a function: render a scene"),
        ("x = 1\ny = 1", "these are 2 formulas and not a function"),
        (
            "(u, v, u v) for u in [0, 1], v in [0, 1]",
            "this is a parametric surface and not a function: render a scene",
        ),
        ("x = 1; (u, v, u v) for u in [0, 1], v in [0, 1]", "these are 2 formulas"),
    ] {
        let error = Function::parse(text).expect_err("no function");
        assert!(error.to_string().contains(why), "{text}: {error}");
    }
}

/// Enclosures over random boxes contain the oracle's values at points of the boxes.
#[test]
fn enclosures_hold_for_random_boxes() {
    let mut rng = Rng::with_seed(1);
    let (mut proven, mut apart) = (0, 0);
    for (text, document) in texts() {
        let function = Function::parse(&text).expect("a function");
        let mut fixed = None;
        let (oracle, parameters) = oracle(&document, &mut fixed);
        // The boxes fill several batches, so results in a wrong order would show.
        let boxes = [(); 200].map(|()| random_box::<f64>(&mut rng, Ends::Infinite));
        let found = function.enclose(&boxes.map(|ends| ends.map(range))).expect("boxes");
        assert_eq!(found.len(), boxes.len());
        for (ends, found) in boxes.iter().zip(&found) {
            let point = point_in_box(&mut rng, ends);
            let claim = oracle.at(point, &parameters)[0];
            let (low, high) = (*found.bounds.start(), *found.bounds.end());
            let case = || format!("{text}\nover {ends:?}: {found:?}, at {point:?}: {claim:?}");
            if claim.defined == Defined::Yes {
                assert!(!found.undefined && low <= claim.hi && claim.lo <= high, "{}", case());
                assert!(found.may_vanish() || claim.lo != 0.0 || claim.hi != 0.0, "{}", case());
            }
            assert!(claim.defined != Defined::No || !found.defined, "{}", case());
            assert!(found.defined || !found.continuous, "{}", case());
            assert!(!found.undefined || low > high, "{}", case());
            proven += usize::from(found.defined);
            apart += usize::from(!found.may_vanish());
        }
    }
    // Many boxes are proven to have values everywhere, and many to have no zero.
    assert!(proven > 3000 && apart > 3000, "{proven} defined, {apart} without a zero");
}

#[test]
fn values_are_near_the_real_ones_and_nan_where_there_are_none() {
    let mut rng = Rng::with_seed(2);
    let (mut values, mut gaps) = (0, 0);
    for (text, document) in texts() {
        let function = Function::parse(&text).expect("a function");
        let mut fixed = None;
        let (oracle, parameters) = oracle(&document, &mut fixed);
        let coordinate = |rng: &mut Rng| f64::from(rng.i32(-300..=300)) / 100.0;
        let points: Vec<[f64; 3]> =
            (0..100).map(|_| [(); 3].map(|()| coordinate(&mut rng))).collect();
        for (point, value) in points.iter().zip(function.eval(&points)) {
            let claim = oracle.at(*point, &parameters)[0];
            match claim.defined {
                Defined::Yes => {
                    let size = claim.lo.abs().max(claim.hi.abs()).max(1.0);
                    let slack = 1e-9 * size;
                    let is_near = claim.lo - slack <= value && value <= claim.hi + slack;
                    assert!(is_near, "{text} at {point:?}: {value}, {claim:?}");
                    values += 1;
                }
                Defined::No => {
                    assert!(value.is_nan(), "{text} at {point:?}: {value}");
                    gaps += 1;
                }
                Defined::Unknown => {}
            }
        }
    }
    assert!(values > 3000 && gaps > 200, "{values} values, {gaps} gaps");
    // At 0 this function is undefined, although rounding alone could give a number.
    let step = Function::parse("atan(1/x)").expect("a function");
    assert!(step.eval(&[[0.0; 3]])[0].is_nan());
    // A coordinate that is no number gives no value, even in a function that does not depend on it.
    let plane = Function::parse("0*x + y").expect("a function");
    for bad in [f64::NAN, f64::INFINITY] {
        assert!(plane.eval(&[[bad, 1.0, 0.0]])[0].is_nan() && plane.eval(&[[1.0; 3]]) == [1.0]);
        assert!(plane.gradient(&[[bad, 1.0, 0.0]]).expect("small")[0][1].is_nan());
    }
    assert_eq!(plane.gradient(&[[1.0; 3]]).expect("small"), [[0.0, 1.0, 0.0]]);
}

/// Kernels refuse what lies outside of their domain. A function's domain is all of space, so only
/// what is no box is refused, and by an error.
#[test]
fn boxes_may_have_any_size_and_what_is_no_box_is_an_error() {
    let text = "r = 1 in [0, 2]\nx^2+y^2+z^2-r^2 + 0*sqrt(x)";
    let mut function = Function::parse(text).expect("a function");
    let unit = 0.0..=1.0;
    let (most, infinite) = (f64::MAX, f64::INFINITY);
    for r in [1.0, 2.5, -1e100] {
        function.set("r", r).expect("a parameter");
        for range in [0.0..=0.0, -most..=most, most..=infinite, -infinite..=infinite] {
            for axis in 0..3 {
                let mut place = [unit.clone(), unit.clone(), unit.clone()];
                place[axis] = range.clone();
                let found = &function.enclose(&[place]).expect("a box")[0];
                assert!(found.bounds.start() <= found.bounds.end(), "{range:?}: {found:?}");
            }
        }
        for bad in [1.0..=0.0, f64::NAN..=1.0, 0.0..=f64::NAN, infinite..=infinite] {
            for axis in 0..3 {
                let mut place = [unit.clone(), unit.clone(), unit.clone()];
                place[axis] = bad.clone();
                let error = function.enclose(&[place]).expect_err("no box").to_string();
                assert!(error.contains("holds no number"), "{error}");
            }
        }
        let value = |c| function.eval(&[[c; 3]])[0];
        assert!(!value(most).is_finite() && value(infinite).is_nan() && value(-1.0).is_nan());
        assert_eq!(value(0.0), -r * r);
    }
}

#[test]
fn parameters_are_set_exactly() {
    let mut function = Function::parse("r = 1 in [0, 2]\nn = 2\nx^n*r - y").expect("a function");
    let names: Vec<String> = function.parameters().into_iter().map(|p| p.name).collect();
    assert_eq!(names, ["r", "n"]);
    assert_eq!(function.parameters()[0].range, Some(0.0..=2.0));
    for (r, n) in [(0.1, 2.0), (2.0, 3.0), (7.5, -1.0), (-0.3, 0.5)] {
        function.set("r", r).expect("a parameter");
        function.set("n", n).expect("a parameter");
        assert_eq!(function.parameters()[1].value, n);
        let found = &function.enclose(&[[4.0..=4.0, 0.0..=0.0, 0.0..=0.0]]).expect("a box")[0];
        // `value` is correctly rounded, so it lies within an ulp of the exact value.
        let value = f64::powf(4.0, n) * r;
        let near = value.next_down()..=value.next_up();
        assert!(near.contains(found.bounds.start()) && near.contains(found.bounds.end()));
        assert!(found.bounds.contains(&value), "{r} {n}: {found:?}");
    }
    for (name, value, why) in [
        ("r", f64::NAN, "not a number"),
        ("r", f64::INFINITY, "not a number"),
        ("q", 1.0, "`r`, `n`"),
        ("x", 1.0, "`r`, `n`"),
    ] {
        let error = function.set(name, value).expect_err("no such value");
        assert!(error.to_string().contains(why), "{error}");
    }
    assert_eq!(function.parameters()[0].value, -0.3);
    // Traced rays also use a parameter's new value.
    let ray = Ray { origin: [0.0, 5.0, 0.0], direction: [0.0, -1.0, 0.0] };
    let mut plane = Function::parse("h = 1 in [0, 2]\ny - h + 0*x").expect("a function");
    let settings = TraceSettings::new().domain([-3.0..=3.0, -3.0..=3.0, -3.0..=3.0]);
    for h in [1.0, 0.5, -1.0] {
        plane.set("h", h).expect("a parameter");
        let [RayResult::Hit { bracket: [near, far], .. }] =
            plane.trace_with(&[ray], &settings).expect("a ray")[..]
        else {
            panic!("the ray meets the plane");
        };
        assert!(near <= 5.0 - h && 5.0 - h <= far, "{h}: {near} to {far}");
    }
}

/// Random rays through random domains. No result contradicts the certified tracer, which shares no
/// code with kernels or methods.
#[test]
fn rays_agree_with_the_certified_tracer() {
    const BUDGET: u32 = 5_000;
    let mut rng = Rng::with_seed(3);
    let (mut hits, mut misses, mut undecided) = (0, 0, 0);
    for (text, document) in texts().step_by(3) {
        let function = Function::parse(&text).expect("a function");
        let domain = [(); 3].map(|()| {
            let middle = f64::from(rng.i32(-10..=10)) / 10.0;
            [middle - 2.0, middle + 2.0]
        });
        let rays = (0..60).map(|_| {
            let zeroset_testkit::Ray { direction, .. } = random_ray(&mut rng);
            // The ray passes through a point of the domain, and starts inside or outside of it.
            let (at, back) = (point_in_box(&mut rng, &domain), f64::from(rng.u32(0..8)));
            Ray { origin: [0, 1, 2].map(|axis| at[axis] - back * direction[axis]), direction }
        });
        let rays: Vec<Ray> = rays.collect();
        let values: Vec<_> = document.parameters.iter().map(|p| p.value.clone()).collect();
        let certified =
            certified::Function::new(&document.graph, document.surfaces[0].root, &values);
        let settings = TraceSettings::new().domain(domain.map(range));
        let results = function.trace_with(&rays, &settings).expect("rays");
        assert_eq!(results.len(), rays.len());
        for (ray, result) in rays.iter().zip(&results) {
            let line = Line { eye: ray.origin, direction: ray.direction };
            let truth = certified.trace(&line, &domain, BUDGET);
            let crossed = truth.crossing.map_or(f64::INFINITY, |crossing| crossing.far);
            let case = || format!("{text}\n{ray:?} in {domain:?}: {result:?}, {truth:?}");
            match *result {
                RayResult::Hit { t, bracket: [near, far], .. } => {
                    assert!(near <= t && t <= far, "{}", case());
                    assert!(truth.first() <= far && near <= crossed, "{}", case());
                    hits += 1;
                }
                RayResult::Miss => {
                    assert!(truth.crossing.is_none(), "{}", case());
                    misses += 1;
                }
                RayResult::Undecided { from, .. } => {
                    assert!(from <= crossed, "{}", case());
                    undecided += 1;
                }
                _ => unreachable!("three results"),
            }
        }
    }
    let all = hits + misses + undecided;
    assert!(hits > 200 && misses > 200 && undecided < all / 20, "{hits} {misses} {undecided}");
}

/// If a direction is scaled, the line is the same, and its values of t are divided by the factor.
#[test]
fn directions_may_have_any_length() {
    let function = Function::parse("x^2+y^2+z^2-1").expect("a function");
    let trace = |direction: [f64; 3]| {
        let ray = Ray { origin: [-3.0, 0.25, 0.125], direction };
        let RayResult::Hit { bracket, .. } = function.trace(&[ray]).expect("a ray")[0] else {
            panic!("{direction:?} meets the sphere");
        };
        bracket
    };
    let direction = [1.0, -0.0625, 0.03125];
    let [near, far] = trace(direction);
    assert!(far - near < 1e-5);
    for power in [-330, -100, -1, 0, 1, 100, 330] {
        let scale = 2f64.powi(power);
        assert_eq!(trace(direction.map(|c| c * scale)), [near / scale, far / scale], "{power}");
    }
    let [third, two_thirds] = trace(direction.map(|c| c / 3.0));
    assert!(third / 3.0 < far && near < two_thirds / 3.0);
}

/// A ray through a pixel's center gives the same result as the picture of that pixel.
#[test]
fn rays_agree_with_pictures() {
    const SIDE: usize = 48;
    let domain = || [-2.0..=2.0, -1.5..=2.5, -2.0..=2.0];
    let names = ["clebsch-diagonal-cubic", "gyroid", "steiner-roman", "floor-steps", "tan-sheets"];
    for method in zeroset::Method::all() {
        for example in zeroset::gallery().filter(|example| names.contains(&example.name)) {
            // The text's own domain is removed, since the settings below give one.
            let lines = example.text.lines().filter(|line| !line.starts_with("domain"));
            let text = lines.collect::<Vec<_>>().join("\n");
            let settings = Settings::new(SIDE, SIDE).domain(domain()).method(method);
            let picture = Scene::read(&text).expect("reads").render(&settings).expect("a picture");
            let pixels = (0..SIDE).flat_map(|row| (0..SIDE).map(move |column| (column, row)));
            let rays = pixels.clone().map(|(column, row)| picture.ray(column, row).expect("there"));
            let rays: Vec<Ray> = rays.collect();
            let settings = TraceSettings::new().domain(domain()).method(method);
            let results = Function::parse(&text).expect("a function");
            let results = results.trace_with(&rays, &settings).expect("rays");
            let mut decided = 0;
            for (pixel, (ray, result)) in rays.iter().zip(&results).enumerate() {
                let length = ray.direction.iter().map(|c| c * c).sum::<f64>().sqrt();
                let status = picture.status()[pixel];
                let case =
                    || format!("{} by {method:?}: {ray:?}: {status:?}, {result:?}", example.name);
                match (status, *result) {
                    (Status::Undecided, _) | (_, RayResult::Undecided { .. }) => continue,
                    (Status::Hit, RayResult::Hit { bracket: [near, far], .. }) => {
                        let [low, high] = picture.brackets()[pixel];
                        let [near, far] = [near * length, far * length];
                        let slack = 1e-12 * high;
                        assert!(near <= high + slack && low <= far + slack, "{}", case());
                    }
                    (Status::Miss, RayResult::Miss) => {}
                    _ => panic!("{}", case()),
                }
                decided += 1;
            }
            let least = if method.name() == "affine" { SIDE * SIDE * 97 / 100 } else { 0 };
            assert!(decided >= least, "{} by {method:?}: {decided} decided", example.name);
        }
    }
}

#[test]
fn results_depend_neither_on_threads_nor_on_what_was_asked_before() {
    let text = "sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x)";
    let (shared, fresh) = (Function::parse(text).expect("reads"), || Function::parse(text));
    let rays: Vec<Ray> = (0..500)
        .map(|n| f64::from(n) / 250.0 - 1.0)
        .map(|c| Ray { origin: [c, 4.0, -c], direction: [0.3, -1.0, c] })
        .collect();
    let settings = |half: f64| {
        TraceSettings::new()
            .domain([-half..=half, -half..=half, -half..=half])
            .precision(Precision::F64)
    };
    std::thread::scope(|scope| {
        for half in [1.0, 2.0, 3.0, 1.0] {
            let (shared, rays) = (&shared, &rays);
            scope.spawn(move || {
                let settings = settings(half);
                let expected = fresh().expect("reads").trace_with(rays, &settings);
                for _ in 0..5 {
                    assert_eq!(shared.trace_with(rays, &settings), expected);
                }
            });
        }
    });
}
