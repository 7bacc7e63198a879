//! Steps that are dropped in a part of space must not matter there.

use crate::suite::{Failure, Tally};
use crate::{Adversarial, Rng};
use std::fmt::Write as _;
use std::sync::Arc;
use zeroset_eval::{
    Assumptions, Binding, Boxes, Enclose, Enclosures, Kernel, LANES, LaneSet, Shortener,
    StepBounds, Tape,
};
use zeroset_interval::{Facts, Interval};
use zeroset_ir::simplify;
use zeroset_jit::{StencilTape, Threaded};
use zeroset_syntax::{Options, read};

/// Half the extent of the domain.
const HALF: f64 = 2.0;

/// A formula with many choices, as text: solids joined by unions, intersections and blends, moved
/// and scaled, and parts that are undefined somewhere.
pub fn random_choices(rng: &mut Rng, depth: u32) -> String {
    let number = |rng: &mut Rng| format!("{:.3}", f64::from(rng.i32(-1500..=1500)) / 1000.0);
    if depth == 0 {
        let [a, b, c, d] = [(); 4].map(|()| number(rng));
        return match rng.u32(0..11) {
            0 | 1 => format!("(sqrt((x-{a})^2+(y-{b})^2+(z-{c})^2)-0.4)"),
            2 => format!("((x-{a})^2+(y-{b})^2+(z-{c})^2-0.3)"),
            3 => format!("({a}*x+{b}*y+{c}*z-{d})"),
            4 => format!("(abs(x-{a})-0.5)"),
            5 => format!("(ln(x-{a})+y)"),
            6 => format!("(sqrt(y-{b})-0.4)"),
            7 => format!("(x/(y-{c})-{d})"),
            8 => format!("(y-{b}){{x < {a}}}"),
            9 => format!("(min(max(x-{a},y-{b}),0)+sqrt(max(x-{a},0)^2+max(y-{b},0)^2))"),
            _ => format!("(sin(3*z)+x*y-{d})"),
        };
    }
    let part = |rng: &mut Rng| {
        let depth = rng.u32(0..depth);
        random_choices(rng, depth)
    };
    let (a, b) = (random_choices(rng, depth - 1), part(rng));
    let n = number(rng);
    let k = f64::from(rng.u32(1..=800)) / 1000.0;
    // 2·c·k from 0 to 3: a blend with more than 1 does not grow with its operands.
    let c = f64::from(rng.u32(0..=15)) / 10.0 / k;
    match rng.u32(0..19) {
        0..=2 => format!("min({a},{b})"),
        3 | 4 => format!("max({a},{b})"),
        5 => format!("(-{a})"),
        6 => format!("({a}+{n})"),
        7 => format!("({n}-{a})"),
        8 => format!("({n}*{a})"),
        9 => format!("({a}/2.5)"),
        10 => format!("abs({a})"),
        11 => format!("({a}+{b})"),
        12 => format!("(min({a},{b})-{c}*max({k}-abs({a}-{b}),0)^2)"),
        13 => format!("(max({a},{b})+{c}*max({k}-abs({a}-{b}),0)^2)"),
        14 => format!("(sqrt(max({a},{b}))-1.1)"),
        // A real exponent that is a whole number in places.
        15 => format!("(({a})^max({b},2)-0.4)"),
        16 => format!("(({a}){{({b}) > {n}}})"),
        // A solid that is displaced. The sum counts only if one side has many choices.
        17 => format!("(({a})-0.2*sin(5*x+{n}))"),
        _ => format!("if({n}*x<y,{a},{b})"),
    }
}

/// A formula of a few planes across the axes. Bounds of planes are tight, so that a part often ends
/// just where an operand may be dropped.
fn random_planes(rng: &mut Rng, depth: u32) -> String {
    let share = |rng: &mut Rng| f64::from(rng.i32(-400..=400)) / 1000.0;
    if depth == 0 {
        let axis = ["x", "y", "z", "-x", "2*y"][rng.u32(0..5) as usize];
        return format!("({axis}-{})", share(rng));
    }
    let (a, b) = (random_planes(rng, depth - 1), random_planes(rng, depth / 2));
    let (n, k) = (share(rng), f64::from(rng.u32(100..=600)) / 1000.0);
    // Blends with c·k near 1 need the widest thresholds.
    let c = if rng.bool() { 0.9999 / k } else { f64::from(rng.u32(1..=13)) / 10.0 / k };
    match rng.u32(0..16) {
        12..=14 => format!("({a}){{max({b},{n}-z) > 0}}"),
        15 => format!("(sin({a})-{n})"),
        0..=2 => format!("(min({a},{b})-{c}*max({k}-abs({a}-{b}),0)^2)"),
        3 | 4 => format!("(max({a},{b})+{c}*max({k}-abs({a}-{b}),0)^2)"),
        5 => format!("min({a},{b})"),
        6 => format!("max({a},{b})"),
        7 => format!("abs({a})"),
        8 => format!("({n}-{a})"),
        9 => format!("if({b}<0,{a},{n}-{a})"),
        10 => format!("({a}){{{b} > 0}}"),
        _ => {
            // A sum counts if one side has many choices.
            let sum = format!("{}({b})", if rng.bool() { "+" } else { "-" });
            let far = (0..16).fold(a, |all, n| format!("min({all},{}+x)", 9 + n));
            if rng.bool() { format!("({far}{sum})") } else { format!("(({b})-{far})") }
        }
    }
}

/// The tapes of a formula, in the precision of the bounds and in `f64`.
type Tapes<T> = (Arc<Tape<T>>, Arc<Tape<f64>>);

/// Returns the tapes of a formula; `None` if it is too large.
fn tapes<T: Adversarial>(text: &str, simple: bool) -> Option<Tapes<T>> {
    let document = read(text, &Options::default()).ok()?;
    let domain = [Interval { lo: -HALF, hi: HALF }; 3];
    let mut graph = (document.graph, vec![document.surfaces.first()?.root]);
    if simple {
        graph = simplify(&graph.0, &graph.1, &domain, &[]).ok()?;
    }
    let assumptions = Assumptions { domain, parameters: Vec::new() };
    let (graph, roots) = (&graph.0, &graph.1[..1]);
    let single = Tape::<T>::new(graph, roots, &assumptions);
    let double = Tape::<f64>::new(graph, roots, &assumptions);
    Some((Arc::new(single), Arc::new(double)))
}

/// Encloses a function at points.
fn enclosed(kernel: &Threaded<Enclose, f64>, points: &[[Interval; 3]]) -> Enclosures<f64> {
    let mut found = Enclosures::default();
    kernel.eval(&Boxes::<f64>::around(points)[0], &mut found);
    found
}

/// Compares the steps selected for random boxes of a random formula with all steps. Both must have
/// values at the same points, with the same signs. Each claim is a proof by intervals at single
/// points. The boxes are around a point at which the formula is nearly 0.
///
/// # Errors
/// The first contradiction, with the formula, the box and the point.
///
/// # Panics
/// If stencils cannot be compiled.
pub fn check_shortening<T: Adversarial>(rng: &mut Rng) -> Result<Tally, Failure> {
    let (depth, simple, is_flat) = (rng.u32(2..=6), rng.bool(), rng.bool());
    // Planes meet near the origin.
    let (mut text, extent) = if is_flat {
        (random_planes(rng, depth.min(5) - 1), 0.4)
    } else {
        (random_choices(rng, depth), HALF)
    };
    let middle = [(); 3].map(|()| f64::from(rng.i32(-1000..=1000)) / 1000.0 * extent);
    let whole = |tape: &Arc<Tape<f64>>| {
        Threaded::<Enclose, f64>::new((**tape).clone(), &Binding::empty()).expect("calls")
    };
    let Some((_, exact)) = tapes::<T>(&text, simple) else { return Ok(Tally::default()) };
    let at = enclosed(&whole(&exact), &[middle.map(|at| Interval { lo: at, hi: at })]);
    if at.facts(0).has(Facts::DEFINED) && at.hi[0].abs() < 1e3 {
        text = format!("{text}-({:.6})", at.hi[0]);
    }
    if rng.u32(0..3) == 0 {
        // Only zeros and sign of a product matter, unless something is added to it.
        let (factor, third) = (random_choices(rng, depth / 2), random_choices(rng, 0));
        text = match rng.u32(0..3) {
            0 => format!("({text})*{factor}"),
            1 => format!("{third}*(({text})*{factor})"),
            _ => format!("min({third},max({factor}*({text}),{third}-1))*-{factor}"),
        };
    }
    let Some((single, exact)) = tapes::<T>(&text, simple) else { return Ok(Tally::default()) };
    let shortener = Shortener::new(&single, &[], if rng.bool() { 1 } else { 32 });
    let from = shortener.all(&single);
    let deciding = shortener.deciding(&from);
    let (clauses, binding) = (shortener.clauses(), Binding::empty());
    let single = Arc::new(clauses.coarse((*single).clone()));
    let traced = StencilTape::<Enclose, T>::new(&single, &binding, clauses);
    let traced =
        Threaded::traced(&Arc::new(traced.expect("stencils")), &from, &deciding).expect("calls");
    let all = whole(&exact);
    let exact = Arc::new(clauses.coarse((*exact).clone()));
    let exact = StencilTape::<Enclose, f64>::new(&exact, &Binding::empty(), clauses);
    let exact = Arc::new(exact.expect("stencils"));
    let mut tally = Tally::default();
    let regions: Vec<[Interval; 3]> = (0..LANES)
        .map(|_| {
            let scale = f64::from(1_u32 << rng.u32(0..7));
            std::array::from_fn(|axis| {
                let (size, share) = (HALF / scale, f64::from(rng.u32(0..=100)) / 100.0);
                let lo = middle[axis] - share * size;
                let ends = [lo, lo + size].map(|end| T::nearest(end.clamp(-HALF, HALF)).into());
                Interval { lo: ends[0], hi: ends[1] }
            })
        })
        .collect();
    // Other lanes get no selection, nor those in which nearly all steps matter.
    let open = 1 << rng.u32(0..16) | rng.u32(0..1 << 16) as LaneSet;
    let most = from.steps().len().saturating_sub(1);
    let select = |_: &Enclosures<T>, bounds: &[StepBounds<T>]| {
        shortener.select(&single, &from, &deciding, bounds, open, most)
    };
    let boxes = &Boxes::around(&regions)[0];
    let selections = traced.eval_traced(boxes, &mut Enclosures::default(), select);
    for (lane, (region, selection)) in regions.iter().zip(selections).enumerate() {
        let Some(selection) = selection else { continue };
        assert!(open >> lane & 1 == 1, "an open lane");
        let short = Threaded::selected(&exact, &selection).expect("calls");
        let points: Vec<[Interval; 3]> = (0..LANES)
            .map(|_| {
                region.map(|Interval { lo, hi }| {
                    let at = lo + (hi - lo) * f64::from(rng.u32(0..=1024)) / 1024.0;
                    Interval { lo: at, hi: at }
                })
            })
            .collect();
        let (before, after) = (enclosed(&all, &points), enclosed(&short, &points));
        for (lane, point) in points.iter().enumerate() {
            tally.compared += 1;
            let [was, is] = [&before, &after].map(|found| {
                let (lo, hi, facts) = (-found.neg_lo[lane], found.hi[lane], found.facts(lane));
                (lo, hi, facts)
            });
            let certain =
                |one: Facts, other: Facts| one.has(Facts::DEFINED) && other.has(Facts::NOWHERE);
            let is_defined = was.2.has(Facts::DEFINED) && is.2.has(Facts::DEFINED);
            tally.defined += u64::from(is_defined);
            let differs = |a: (f64, f64, Facts), b: (f64, f64, Facts)| {
                // One is above 0, and the other is not.
                a.0 > 0.0 && b.1 <= 0.0 || a.1 < 0.0 && b.0 >= 0.0
            };
            let is_false = certain(was.2, is.2)
                || certain(is.2, was.2)
                || is_defined && (differs(was, is) || differs(is, was));
            if is_false {
                let mut what = format!("{text}\nin {region:?} at {point:?}: {was:?} became {is:?}");
                let _ =
                    write!(what, "\n{} of {} steps", selection.steps().len(), from.steps().len());
                return Err(Failure::new(what));
            }
        }
    }
    Ok(tally)
}
