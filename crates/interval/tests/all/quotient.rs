//! The affine form of a quotient whose divisor depends on no symbol.

use zeroset_interval::{
    Enclosure, Exponent, Form, FormOperand, Format, Interval, Software, Vector128, linearise,
};
use zeroset_ops::Op;

/// Tests that a form counts the rounding of the reciprocal. All roundings here go in one direction,
/// and together they exceed the error that is counted for the product alone.
#[test]
fn the_rounding_of_the_reciprocal_is_counted() {
    let (centre, slope, divisor) = (1.951_794_4_f32, 0.25_f32, 1.742_237_3_f32);
    let lanes = |number: f32| Vector128::from_f32([number; 4]);
    let operand = |value| FormOperand { value, range: Interval::ENTIRE, exponent: Exponent::Real };
    let number = |lanes: Vector128| f64::from(lanes.f32()[0]);
    for mut machine in Software::BOTH {
        let m = &mut machine;
        let bounds = Enclosure::total(lanes(-divisor), lanes(divisor));
        let divided = Form::<_, 1>::coordinate(lanes(centre), [lanes(slope)], lanes(0.0));
        let by = Form::between(m, Format::F32, &bounds);
        let form = linearise(m, Format::F32, Op::Div, &[operand(divided), operand(by)]);
        let error = number(form.error(m, Format::F32).expect("it rounds"));
        let [rise] = form.slopes.expect("it varies").map(number);
        for end in [-1.0, 1.0] {
            let exact = (f64::from(centre) + f64::from(slope) * end) / f64::from(divisor);
            let off = (exact - (number(form.centre) + rise * end)).abs();
            assert!(off <= error, "{off} > {error} at {end}");
        }
    }
}
