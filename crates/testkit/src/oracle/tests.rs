//! Compares the oracle with exact rational arithmetic, published digits, and series with
//! remainders.

use super::{Claim, Defined, enclose_at};
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use zeroset_ir::{Axis, Constant, Graph, NodeId};
use zeroset_ops::Op;

const SEED: u64 = 0x5eed_0001;

fn exact(value: f64) -> BigRational {
    BigRational::from_float(value).expect("a finite number")
}

fn digits(text: &str) -> BigRational {
    let (negative, text) = text.strip_prefix('-').map_or((false, text), |t| (true, t));
    let constant = Constant::decimal(text).expect("a decimal");
    let value = constant.exact().expect("few digits").clone();
    if negative { -value } else { value }
}

/// Returns the claim about `op` applied to up to three variables with these values.
fn claim(op: Op, operands: &[f64]) -> Claim {
    let mut graph = Graph::new();
    let ids: Vec<NodeId> =
        Axis::ALL[..operands.len()].iter().map(|&axis| graph.variable(axis)).collect();
    let root = graph.apply(op, &ids);
    let mut point = [0.0; 3];
    point[..operands.len()].copy_from_slice(operands);
    enclose_at(&graph, &[root], point, &[])[0]
}

/// Returns the claim about `op` applied to parameters with these ranges.
fn claim_over(op: Op, ranges: &[(f64, f64)]) -> Claim {
    let mut graph = Graph::new();
    let ids: Vec<NodeId> = (0..ranges.len() as u32).map(|number| graph.parameter(number)).collect();
    let root = graph.apply(op, &ids);
    enclose_at(&graph, &[root], [0.0; 3], ranges)[0]
}

fn power_claim(base: f64, exponent: Constant) -> Claim {
    let mut graph = Graph::new();
    let x = graph.variable(Axis::X);
    let n = graph.constant(exponent);
    let root = graph.apply(Op::Pow, &[x, n]);
    enclose_at(&graph, &[root], [base, 0.0, 0.0], &[])[0]
}

/// Fails unless `claim` is certain, contains `truth` and is at most `ulps` steps of `f64` wide.
#[track_caller]
fn assert_tight(claim: Claim, truth: &BigRational, ulps: u32, case: &str) {
    assert_eq!(claim.defined, Defined::Yes, "{case}: {claim:?}");
    let above = claim.hi == f64::INFINITY || exact(claim.hi) >= *truth;
    let below = claim.lo == f64::NEG_INFINITY || exact(claim.lo) <= *truth;
    assert!(above && below, "{case}: {claim:?} misses {truth}");
    let mut end = claim.lo;
    for _ in 0..ulps {
        end = end.next_up();
    }
    assert!(claim.hi <= end, "{case}: {claim:?} is wide");
}

fn is_exactly(claim: Claim, value: f64) -> bool {
    claim.defined == Defined::Yes && claim.lo == value && claim.hi == value
}

/// Returns a number of any magnitude. Some numbers have exact sums, products and quotients.
fn number(rng: &mut fastrand::Rng) -> f64 {
    let bits = rng.u64(..);
    let value = match rng.u32(0..6) {
        0 => 0.0,
        1 => f64::from(rng.i32(-100..=100)),
        2 => f64::from(rng.i32(-100..=100)) / 64.0,
        3 => f64::from_bits(bits >> 12),
        4 => f64::from_bits(bits),
        _ => f64::from(f32::from_bits(bits as u32)),
    };
    if value.is_finite() { value } else { f64::MAX }
}

#[test]
fn rational_operations_agree_with_exact_arithmetic() {
    let mut rng = fastrand::Rng::with_seed(SEED);
    for round in 0..20_000 {
        let (a, b) = (number(&mut rng), number(&mut rng));
        let (p, q) = (exact(a), exact(b));
        let case = |name: &str| format!("{name}({a:e}, {b:e}), seed {SEED:#x}, round {round}");
        assert_tight(claim(Op::Add, &[a, b]), &(&p + &q), 2, &case("add"));
        assert_tight(claim(Op::Sub, &[a, b]), &(&p - &q), 2, &case("sub"));
        assert_tight(claim(Op::Mul, &[a, b]), &(&p * &q), 2, &case("mul"));
        assert_tight(claim(Op::Sqr, &[a]), &(&p * &p), 2, &case("sqr"));
        assert_tight(claim(Op::Neg, &[a]), &-&p, 0, &case("neg"));
        assert_tight(claim(Op::Abs, &[a]), &p.abs(), 0, &case("abs"));
        assert_tight(claim(Op::Floor, &[a]), &p.floor(), 0, &case("floor"));
        assert_tight(claim(Op::Ceil, &[a]), &p.ceil(), 0, &case("ceil"));
        assert_tight(claim(Op::Trunc, &[a]), &p.trunc(), 0, &case("trunc"));
        assert_tight(claim(Op::Fract, &[a]), &(&p - p.floor()), 2, &case("fract"));
        let root = claim(Op::Sqrt, &[a.abs()]);
        let (below, above) = (exact(root.lo), exact(root.hi));
        let holds = &below * &below <= p.abs() && p.abs() <= &above * &above;
        assert!(holds && root.hi <= root.lo.next_up().next_up(), "{}", case("sqrt"));
        assert!(is_exactly(claim(Op::Min, &[a, b]), a.min(b)), "{}", case("min"));
        assert!(is_exactly(claim(Op::Max, &[a, b]), a.max(b)), "{}", case("max"));
        assert!(is_exactly(claim(Op::WhereDefined, &[a, b]), a), "{}", case("where"));
        if !q.is_zero() {
            assert_tight(claim(Op::Div, &[a, b]), &(&p / &q), 2, &case("div"));
        }
    }
}

#[test]
fn exact_results_are_recognised() {
    assert!(is_exactly(claim(Op::Add, &[0.1, -0.1]), 0.0));
    assert!(is_exactly(claim(Op::Mul, &[0.5, 3.0]), 1.5));
    assert!(is_exactly(claim(Op::Div, &[3.0, -4.0]), -0.75));
    assert!(is_exactly(claim(Op::Sqrt, &[2.25]), 1.5));
    assert!(is_exactly(claim(Op::Cbrt, &[-8.0]), -2.0));
    assert!(is_exactly(claim(Op::Log2, &[f64::from_bits(1)]), -1074.0));
    assert!(is_exactly(claim(Op::Log2, &[0.125]), -3.0));
    assert!(is_exactly(claim(Op::Log10, &[1e22]), 22.0));
    for (op, at, value) in [
        (Op::Exp, 0.0, 1.0),
        (Op::Ln, 1.0, 0.0),
        (Op::Sin, -0.0, 0.0),
        (Op::Cos, 0.0, 1.0),
        (Op::Tan, 0.0, 0.0),
        (Op::Atan, 0.0, 0.0),
    ] {
        assert!(is_exactly(claim(op, &[at]), value), "{op:?}");
    }
    let three = f64::from_bits(3);
    assert!(claim(Op::Log2, &[three]).lo < claim(Op::Log2, &[three]).hi);
    // The float after 10²² is not a power of ten, though its logarithm rounds to 22.
    let claim = claim(Op::Log10, &[1e22_f64.next_up()]);
    assert!(claim.lo < 22.0 && claim.hi > 22.0);
}

#[test]
fn remainders_agree_with_exact_arithmetic() {
    let mut rng = fastrand::Rng::with_seed(SEED);
    for round in 0..20_000 {
        let (a, b) = (number(&mut rng), number(&mut rng));
        if b == 0.0 {
            continue;
        }
        let (p, q) = (exact(a), exact(b));
        let truth = &p - &q * (&p / &q).floor();
        let got = claim(Op::Mod, &[a, b]);
        let case = format!("mod({a:e}, {b:e}), seed {SEED:#x}, round {round}: {got:?}");
        assert!(exact(got.lo) <= truth && truth <= exact(got.hi), "{case}");
        assert_eq!(got.defined, Defined::Yes, "{case}");
        let (least, most) = (b.min(0.0), b.max(0.0));
        assert!(least <= got.lo && got.hi <= most, "{case}");
    }
    assert!(is_exactly(claim(Op::Mod, &[7.5, 2.0]), 1.5));
    assert!(is_exactly(claim(Op::Mod, &[-7.5, 2.0]), 0.5));
    assert!(is_exactly(claim(Op::Mod, &[7.5, -2.0]), -0.5));
    assert!(is_exactly(claim(Op::Mod, &[6.0, 2.0]), 0.0));
}

#[test]
fn integer_powers_agree_with_exact_arithmetic() {
    let mut rng = fastrand::Rng::with_seed(SEED);
    for round in 0..5_000 {
        let base = if rng.bool() { f64::from(rng.i32(-40..=40)) / 16.0 } else { number(&mut rng) };
        let n = rng.i32(-20..=20);
        if base == 0.0 && n < 0 {
            continue;
        }
        let truth = num_traits::Pow::pow(exact(base), n);
        let case = format!("{base:e}^{n}, seed {SEED:#x}, round {round}");
        assert_tight(power_claim(base, Constant::integer(n.into())), &truth, 2, &case);
    }
}

#[test]
fn powers_too_large_for_floats_keep_their_sign() {
    let huge = Constant::integer(9_007_199_254_740_993); // 2^53 + 1, odd
    let got = power_claim(-1.000_000_1, huge.clone());
    assert_eq!((got.lo, got.hi), (f64::NEG_INFINITY, f64::MIN));
    let got = power_claim(-0.5, huge.clone());
    assert!(got.lo < 0.0 && got.lo >= -f64::MIN_POSITIVE && got.hi == 0.0);
    let got = power_claim(-1.0, huge);
    assert!(is_exactly(got, -1.0), "{got:?}");
}

/// The digits are from the OEIS, those of sin 10²² from the literature on argument reduction.
#[test]
fn published_values_are_enclosed() {
    for (op, at, text) in [
        (Op::Exp, 1.0, "2.71828182845904523536028747135266249775724709369995"),
        (Op::Exp, -1.0, "0.36787944117144232159552377016146086744581113103177"),
        (Op::Ln, 2.0, "0.69314718055994530941723212145817656807550013436025"),
        (Op::Ln, 10.0, "2.30258509299404568401799145468436420760110148862877"),
        (Op::Log2, 3.0, "1.58496250072115618145373894394781650875981440769248"),
        (Op::Log10, 2.0, "0.30102999566398119521373889472449302676818988146211"),
        (Op::Sin, 1.0, "0.84147098480789650665250232163029899962256306079837"),
        (Op::Cos, 1.0, "0.54030230586813971740093660744297660373231042061792"),
        (Op::Tan, 1.0, "1.55740772465490223050697480745836017308725077238152"),
        (Op::Sin, 1e22, "-0.85220084976718880177270589375302"),
        (Op::Cos, 1e22, "0.52321478539513894549759442588437"),
        (Op::Atan, 1.0, "0.78539816339744830961566084581987572104929234984378"),
        (Op::Cbrt, 2.0, "1.25992104989487316476721060727822835057025146470151"),
        (Op::Sqrt, 2.0, "1.41421356237309504880168872420969807856967187537694"),
    ] {
        assert_tight(claim(op, &[at]), &digits(text), 2, &format!("{op:?} {at}"));
    }
    let third = Constant::ratio(1, 3).expect("a ratio");
    let root = digits("1.25992104989487316476721060727822835057025146470151");
    // The constant one third is enclosed by a range, so the result is wider than usual.
    assert_tight(power_claim(2.0, third), &root, 4, "2^(1/3)");
    let root = digits("1.41421356237309504880168872420969807856967187537694");
    let half = Constant::ratio(1, 2).expect("a ratio");
    assert_tight(power_claim(2.0, half), &root, 2, "2^(1/2)");
}

/// Returns a partial sum of a series, and a bound of its remainder. Term k is term k − 1 times
/// `ratio(k)`, which must be at most one half.
fn series(first: BigRational, ratio: impl Fn(i64) -> BigRational) -> (BigRational, BigRational) {
    let enough = exact(2f64.powi(-120));
    let (mut sum, mut term) = (first.clone(), first);
    for k in 1.. {
        term *= ratio(k);
        sum += &term;
        if term.abs() < enough {
            break;
        }
    }
    (sum, term.abs())
}

/// Fails unless `claim` overlaps `sum ± rest` and is at most two ulps wide.
#[track_caller]
fn assert_meets(claim: Claim, (sum, rest): &(BigRational, BigRational), case: &str) {
    let (lo, hi) = (exact(claim.lo), exact(claim.hi));
    assert!(lo <= sum + rest && sum - rest <= hi, "{case}: {claim:?}");
    assert!(claim.hi <= claim.lo.next_up().next_up(), "{case}: {claim:?}");
}

#[test]
fn elementary_functions_agree_with_their_series() {
    let mut rng = fastrand::Rng::with_seed(SEED);
    let ratio = |a: i64, b: i64| BigRational::new(a.into(), b.into());
    for round in 0..300 {
        // A number of few bits keeps the exact terms short.
        let x = f64::from(rng.i32(-4096..=4096)) / 8192.0;
        let x = if rng.bool() { x } else { x / 1024.0 };
        let p = exact(x);
        let square = &p * &p;
        let case = |name: &str| format!("{name}({x:e}), seed {SEED:#x}, round {round}");
        let truth = series(BigRational::one(), |k| &p * ratio(1, k));
        assert_meets(claim(Op::Exp, &[x]), &truth, &case("exp"));
        let truth = series(p.clone(), |k| -&square * ratio(1, 2 * k * (2 * k + 1)));
        assert_meets(claim(Op::Sin, &[x]), &truth, &case("sin"));
        let truth = series(BigRational::one(), |k| -&square * ratio(1, (2 * k - 1) * (2 * k)));
        assert_meets(claim(Op::Cos, &[x]), &truth, &case("cos"));
        let truth = series(p.clone(), |k| -&square * ratio(2 * k - 1, 2 * k + 1));
        assert_meets(claim(Op::Atan, &[x]), &truth, &case("atan"));
        // ln a = 2·artanh((a − 1)/(a + 1)), here for a between 1/2 and 3/2.
        let u = &p / (&p + ratio(2, 1));
        let square = &u * &u;
        let (sum, rest) = series(u, |k| &square * ratio(2 * k - 1, 2 * k + 1));
        let truth = (sum * ratio(2, 1), rest * ratio(2, 1));
        assert_meets(claim(Op::Ln, &[1.0 + x]), &truth, &case("ln"));
    }
}

#[test]
fn inverse_functions_and_identities_hold_at_all_magnitudes() {
    let mut rng = fastrand::Rng::with_seed(SEED);
    let mut graph = Graph::new();
    let x = graph.variable(Axis::X);
    let one = |graph: &mut Graph, op, id| graph.apply(op, &[id]);
    let (sin, cos) = (one(&mut graph, Op::Sin, x), one(&mut graph, Op::Cos, x));
    let (sin2, cos2) = (one(&mut graph, Op::Sqr, sin), one(&mut graph, Op::Sqr, cos));
    let pythagoras = graph.apply(Op::Add, &[sin2, cos2]);
    let tan = one(&mut graph, Op::Tan, x);
    let quotient = graph.apply(Op::Div, &[sin, cos]);
    let tangents = graph.apply(Op::Sub, &[tan, quotient]);
    let magnitude = one(&mut graph, Op::Abs, x);
    let ln = one(&mut graph, Op::Ln, magnitude);
    let exp = one(&mut graph, Op::Exp, ln);
    let there_and_back = graph.apply(Op::Div, &[exp, magnitude]);
    let two = graph.integer(2);
    let log2 = one(&mut graph, Op::Log2, magnitude);
    let ln2 = one(&mut graph, Op::Ln, two);
    let changed_base = graph.apply(Op::Mul, &[log2, ln2]);
    let logarithms = graph.apply(Op::Sub, &[changed_base, ln]);
    let atan = one(&mut graph, Op::Atan, x);
    let tan_atan = one(&mut graph, Op::Tan, atan);
    let arcs = graph.apply(Op::Div, &[tan_atan, x]);
    let cbrt = one(&mut graph, Op::Cbrt, x);
    let three = graph.integer(3);
    let cube = graph.apply(Op::Pow, &[cbrt, three]);
    let roots = graph.apply(Op::Div, &[cube, x]);
    let checks = [
        (pythagoras, 1.0, 1e-14),
        (tangents, 0.0, f64::INFINITY),
        (there_and_back, 1.0, 1e-12),
        (logarithms, 0.0, 1e-12),
        (arcs, 1.0, f64::INFINITY),
        (roots, 1.0, 1e-14),
    ];
    let ids = checks.map(|check| check.0);
    for round in 0..20_000 {
        let at = number(&mut rng);
        if !(f64::MIN_POSITIVE..1e300).contains(&at.abs()) {
            continue;
        }
        let claims = enclose_at(&graph, &ids, [at, 0.0, 0.0], &[]);
        for (index, (got, (_, value, width))) in claims.iter().zip(checks).enumerate() {
            let case = format!("identity {index} at {at:e}, seed {SEED:#x}, round {round}");
            assert!(got.lo <= value && value <= got.hi, "{case}: {got:?}");
            assert!(got.hi - got.lo <= width, "{case}: {got:?}");
        }
    }
}

#[test]
fn ranges_hold_what_lies_between_their_ends() {
    let range = |op, lo, hi| {
        let got = claim_over(op, &[(lo, hi)]);
        (got.lo, got.hi, got.defined)
    };
    let (_, most, _) = range(Op::Sin, 1.5, 1.6);
    assert_eq!(most, 1.0);
    let (least, most, _) = range(Op::Sin, -1.6, -1.5);
    assert!(least == -1.0 && most < -0.99);
    let (least, most, _) = range(Op::Cos, -0.1, 0.2);
    assert!(most == 1.0 && least < 0.981 && least > 0.98);
    let (least, _, _) = range(Op::Cos, 3.1, 3.2);
    assert_eq!(least, -1.0);
    assert_eq!(range(Op::Sin, 0.0, 7.0), (-1.0, 1.0, Defined::Yes));
    assert_eq!(range(Op::Fract, 0.9, 1.1), (0.0, 1.0, Defined::Yes));
    assert_eq!(range(Op::Floor, 0.9, 1.1), (0.0, 1.0, Defined::Yes));
    assert_eq!(range(Op::Round, 0.5, 1.5), (0.0, 2.0, Defined::Yes));
    assert_eq!(range(Op::Abs, -1.0, 2.0), (0.0, 2.0, Defined::Yes));
    assert_eq!(range(Op::Sign, -1.0, 0.0), (-1.0, 0.0, Defined::Yes));
    assert_eq!(range(Op::Sqr, -1.0, 2.0), (0.0, 4.0, Defined::Yes));
    let unbounded = (f64::NEG_INFINITY, f64::INFINITY, Defined::Unknown);
    assert_eq!(range(Op::Tan, 1.5, 1.6), unbounded);
    assert_eq!(range(Op::Tan, 1.0, 1.0 + std::f64::consts::TAU), unbounded);
    let got = claim_over(Op::Div, &[(1.0, 1.0), (0.0, 0.5)]);
    assert_eq!((got.lo, got.hi), (2.0, f64::INFINITY));
    let got = claim_over(Op::Div, &[(1.0, 1.0), (-0.0, 0.5)]);
    assert_eq!((got.lo, got.hi), (2.0, f64::INFINITY));
    let got = claim_over(Op::Div, &[(1.0, 1.0), (-0.5, 0.5)]);
    assert_eq!((got.lo, got.hi), (f64::NEG_INFINITY, f64::INFINITY));
    let got = claim_over(Op::Div, &[(1.0, 1.0), (-0.5, 0.0)]);
    assert_eq!((got.lo, got.hi), (f64::NEG_INFINITY, -2.0));
    let got = claim_over(Op::Mul, &[(0.0, 0.0), (f64::NEG_INFINITY, f64::INFINITY)]);
    assert_eq!((got.lo, got.hi), (0.0, 0.0));
    let got = claim_over(Op::Min, &[(1.0, 4.0), (2.0, 3.0)]);
    assert_eq!((got.lo, got.hi), (1.0, 3.0));
    let got = claim_over(Op::Max, &[(1.0, 4.0), (2.0, 3.0)]);
    assert_eq!((got.lo, got.hi), (2.0, 4.0));
    let got = claim_over(Op::Mod, &[(1.5, 2.5), (2.0, 2.0)]);
    assert_eq!((got.lo, got.hi), (0.0, 2.0));
}

#[test]
fn overflow_is_an_unbounded_claim() {
    let upward = |got: Claim| (got.lo, got.hi) == (f64::MAX, f64::INFINITY);
    assert!(upward(claim(Op::Add, &[f64::MAX, f64::MAX])));
    assert!(upward(claim(Op::Mul, &[1e200, 1e200])));
    assert!(upward(claim(Op::Exp, &[1e300])));
    assert!(upward(claim(Op::Sqr, &[-1e300])));
    let got = claim(Op::Mul, &[1e-200, 1e-200]);
    assert!(got.hi > 0.0 && got.lo <= 0.0, "{got:?}");
    assert_eq!(claim(Op::Exp, &[-1e300]).lo, 0.0);
}

/// Checks whether an operation is claimed to be defined, for several ranges of one operand.
#[test]
fn definedness_is_claimed_only_when_certain() {
    use Defined::{No, Unknown, Yes};
    let tiny = 1e-20;
    let unary = |lo, hi| vec![(lo, hi)];
    let last = |lo, hi| vec![(1.0, 1.0), (lo, hi)];
    for op in [Op::Sqrt, Op::WhereNonneg] {
        let over = if op == Op::Sqrt { unary } else { last };
        let at = |lo, hi| claim_over(op, &over(lo, hi)).defined;
        let got = [at(0.0, 1.0), at(-tiny, tiny), at(-tiny, 0.0), at(-2.0, -tiny)];
        assert_eq!(got, [Yes, Unknown, Unknown, No], "{op:?}");
    }
    for op in [Op::Ln, Op::Log2, Op::Log10, Op::WherePositive] {
        let over = if op == Op::WherePositive { last } else { unary };
        let at = |lo, hi| claim_over(op, &over(lo, hi)).defined;
        let got = [at(tiny, 1.0), at(0.0, tiny), at(-tiny, tiny), at(-2.0, 0.0)];
        assert_eq!(got, [Yes, Unknown, Unknown, No], "{op:?}");
    }
    for op in [Op::Div, Op::Mod, Op::WhereNonzero] {
        let at = |lo, hi| claim_over(op, &last(lo, hi)).defined;
        let got = [at(tiny, 1.0), at(0.0, tiny), at(-tiny, tiny), at(0.0, -0.0)];
        assert_eq!(got, [Yes, Unknown, Unknown, No], "{op:?}");
    }
    assert_eq!(claim(Op::Tan, &[std::f64::consts::FRAC_PI_2]).defined, Yes);
}

#[test]
fn powers_are_defined_as_the_table_says() {
    use Defined::{No, Unknown, Yes};
    let integer = |base, n| power_claim(base, Constant::integer(n)).defined;
    assert_eq!([integer(-2.0, 3), integer(0.0, 0), integer(0.0, 2)], [Yes; 3]);
    assert_eq!([integer(-2.0, -3), integer(0.0, -1)], [Yes, No]);
    let half = |base| power_claim(base, Constant::ratio(1, 2).expect("a ratio")).defined;
    assert_eq!([half(2.0), half(0.0), half(-2.0)], [Yes, Yes, No]);
    // An exponent that varies is not an integer constant, whatever its value.
    let varying = |base, n| claim(Op::Pow, &[base, n]).defined;
    assert_eq!([varying(-2.0, 2.0), varying(0.0, 0.0)], [No, No]);
    assert_eq!([varying(0.0, 1.0), varying(2.0, -1.5)], [Yes, Yes]);
    let over = |base, n| claim_over(Op::Pow, &[base, n]).defined;
    assert_eq!(over((-1.0, 1.0), (2.0, 2.0)), Unknown);
    assert_eq!(over((0.0, 1.0), (-1.0, 1.0)), Unknown);

    // Evaluators may fold −(−2) and 4·(1/2) to the constant 2, or not. A claim allows for both.
    let mut graph = Graph::new();
    let x = graph.variable(Axis::X);
    let minus_two = graph.integer(-2);
    let two = graph.apply(Op::Neg, &[minus_two]);
    let four = graph.integer(4);
    let half = graph.constant(Constant::ratio(1, 2).expect("a ratio"));
    let also_two = graph.apply(Op::Mul, &[four, half]);
    let also_minus_two = graph.apply(Op::Neg, &[also_two]);
    let roots = [two, also_two, also_minus_two].map(|n| graph.apply(Op::Pow, &[x, n]));
    let at = |x| enclose_at(&graph, &roots, [x, 0.0, 0.0], &[]);
    assert!(is_exactly(at(3.0)[0], 9.0) && is_exactly(at(3.0)[1], 9.0));
    for got in &at(-3.0)[..2] {
        assert_eq!((got.lo, got.hi, got.defined), (-9.0, 9.0, Unknown));
    }
    assert_eq!(at(0.0)[2].defined, No);
}

/// Checks that an operation is undefined where an operand is undefined. Exceptions are a branch
/// that is not chosen, and operands of `otherwise`.
#[test]
fn undefined_operands_spread() {
    for row in zeroset_ops::TABLE {
        for hole in 0..row.arity {
            let mut graph = Graph::new();
            let y = graph.variable(Axis::Y);
            let minus = graph.integer(-1);
            let undefined = graph.apply(Op::Sqrt, &[minus]);
            let mut operands = vec![y; usize::from(row.arity)];
            operands[usize::from(hole)] = undefined;
            let root = graph.apply(row.op, &operands);
            let got = enclose_at(&graph, &[root], [0.0, 1.0, 0.0], &[])[0];
            let spared = [(Op::SelectNegative, 1), (Op::Otherwise, 0), (Op::Otherwise, 1)];
            let chosen = !spared.contains(&(row.op, hole));
            let expected = if chosen { Defined::No } else { Defined::Yes };
            assert_eq!(got.defined, expected, "{} with hole {hole}", row.name);
        }
    }
}

#[test]
fn selection_follows_the_sign() {
    let at = |a| claim(Op::SelectNegative, &[a, 2.0, 3.0]);
    assert!(is_exactly(at(-f64::MIN_POSITIVE), 2.0));
    assert!(is_exactly(at(0.0), 3.0) && is_exactly(at(-0.0), 3.0));
    let got = claim_over(Op::SelectNegative, &[(-1.0, 1.0), (2.0, 2.0), (3.0, 3.0)]);
    assert_eq!((got.lo, got.hi, got.defined), (2.0, 3.0, Defined::Yes));
}

#[test]
fn another_value_stands_in_where_there_is_none() {
    let mut graph = Graph::new();
    let x = graph.variable(Axis::X);
    let seven = graph.integer(7);
    let root = graph.apply(Op::Sqrt, &[x]);
    let otherwise = graph.apply(Op::Otherwise, &[root, seven]);
    let neither = graph.apply(Op::Otherwise, &[root, root]);
    let at = |x: f64| enclose_at(&graph, &[otherwise, neither], [x, 0.0, 0.0], &[]);
    assert!(is_exactly(at(4.0)[0], 2.0) && is_exactly(at(-4.0)[0], 7.0));
    assert_eq!((at(4.0)[1].defined, at(-4.0)[1].defined), (Defined::Yes, Defined::No));
}

#[test]
fn constants_are_enclosed_tightly() {
    let huge = 10_i64.pow(17) + 1; // not a float
    for (constant, exactly) in [
        (Constant::integer(-3), true),
        (Constant::integer(huge), false),
        (Constant::ratio(1, 3).expect("a ratio"), false),
        (Constant::ratio(-3, 8).expect("a ratio"), true),
        (Constant::decimal("1e-130").expect("a decimal"), false),
    ] {
        let truth = constant.exact().expect("rational").clone();
        let mut graph = Graph::new();
        let root = graph.constant(constant);
        let got = enclose_at(&graph, &[root], [0.0; 3], &[])[0];
        let ulps = if exactly { 0 } else { 2 };
        assert_tight(got, &truth, ulps, &truth.to_string());
    }
}
