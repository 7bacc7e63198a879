//! Steps that are dropped in a part of space must not matter there.

use crate::suite::{Failure, Tally};
use crate::{Adversarial, Rng};
use std::fmt::Write as _;
use zeroset_eval::{
    Assumptions, Binding, Boxes, Enclose, Enclosures, Kernel, LANES, Shortener, Tape,
};
use zeroset_interval::{Facts, Interval};
use zeroset_ir::simplify;
use zeroset_jit::Threaded;
use zeroset_syntax::{Options, read};

/// Batches of points per formula; each has its own box.
const BATCHES: usize = 4;
/// Half the extent of the domain.
const HALF: f64 = 2.0;

/// A formula with many choices, as text: solids joined by unions, intersections and blends, moved
/// and scaled, and parts that are undefined somewhere.
pub fn random_choices(rng: &mut Rng, depth: u32) -> String {
    let number = |rng: &mut Rng| format!("{:.3}", f64::from(rng.i32(-1500..=1500)) / 1000.0);
    if depth == 0 {
        let [a, b, c, d] = [(); 4].map(|()| number(rng));
        return match rng.u32(0..9) {
            0 | 1 => format!("(sqrt((x-{a})^2+(y-{b})^2+(z-{c})^2)-0.4)"),
            2 => format!("((x-{a})^2+(y-{b})^2+(z-{c})^2-0.3)"),
            3 => format!("({a}*x+{b}*y+{c}*z-{d})"),
            4 => format!("(abs(x-{a})-0.5)"),
            5 => format!("(ln(x-{a})+y)"),
            6 => format!("(sqrt(y-{b})-0.4)"),
            7 => format!("(x/(y-{c})-{d})"),
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
    // 2·c·k from 0 to 1.2: a blend with more than 1 does not grow with its operands.
    let c = f64::from(rng.u32(0..=12)) / 20.0 / k;
    match rng.u32(0..16) {
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
        _ => format!("if({n}*x<y,{a},{b})"),
    }
}

/// Checks that the steps selected for random boxes of a random formula give the same signs, and
/// values at the same points, as all steps do. Each claim is a proof by intervals at single points.
///
/// # Errors
/// The first contradiction, with the formula, the box and the point.
pub fn check_shortening<T: Adversarial>(rng: &mut Rng) -> Result<Tally, Failure> {
    let depth = rng.u32(2..=6);
    let text = random_choices(rng, depth);
    let Ok(document) = read(&text, &Options::default()) else { return Ok(Tally::default()) };
    let domain = [Interval { lo: -HALF, hi: HALF }; 3];
    let roots = [document.surfaces[0].root];
    let Ok((graph, roots)) = simplify(&document.graph, &roots, &domain, &[]) else {
        return Ok(Tally::default());
    };
    let assumptions = Assumptions { domain, parameters: Vec::new() };
    let whole = Tape::<T>::new(&graph, &roots, &assumptions).coarse();
    let exact = Tape::<f64>::new(&graph, &roots, &assumptions).coarse();
    let shortener = Shortener::new(&whole);
    let none = Binding::empty();
    let traced = Threaded::<Enclose, T>::traced(whole.clone(), &none, shortener.deciding());
    let traced = traced.expect("stencils");
    let all = Threaded::<Enclose, f64>::new(exact.clone(), &Binding::empty());
    let mut tally = Tally::default();
    for _ in 0..BATCHES {
        let region = [(); 3].map(|()| {
            let size = HALF / f64::from(1_u32 << rng.u32(0..6));
            let lo = f64::from(rng.u32(0..=1000)) / 1000.0 * (2.0 * HALF - size) - HALF;
            let ends = [lo, lo + size].map(|end| T::nearest(end.clamp(-HALF, HALF)).into());
            Interval { lo: ends[0], hi: ends[1] }
        });
        let select = |_: &Enclosures<T>, trace: &zeroset_jit::Trace<'_, T>| {
            shortener.select(&whole, &trace.lane(0))
        };
        let boxes = &Boxes::around(&[region])[0];
        let Some(selection) = traced.eval_traced(boxes, &mut Enclosures::default(), select) else {
            continue;
        };
        let short = Threaded::<Enclose, f64>::new(exact.select(&selection), &Binding::empty());
        let points: Vec<[Interval; 3]> = (0..LANES)
            .map(|_| {
                region.map(|Interval { lo, hi }| {
                    let at = lo + (hi - lo) * f64::from(rng.u32(0..=1024)) / 1024.0;
                    Interval { lo: at, hi: at }
                })
            })
            .collect();
        let batch = &Boxes::<f64>::around(&points)[0];
        let claims = |kernel: &dyn Kernel<Enclose, f64>| {
            let mut found = Enclosures::default();
            kernel.eval(batch, &mut found);
            found
        };
        let (before, after) =
            (claims(all.as_ref().expect("stencils")), claims(&short.expect("stencils")));
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
                let _ = write!(what, "\n{} of {} steps", selection.len(), whole.steps().len());
                return Err(Failure::new(what));
            }
        }
    }
    Ok(tally)
}
