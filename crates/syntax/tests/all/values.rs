//! Compares values with a table that another program computed: of complex numbers, of derivatives,
//! and of polynomials that are given by their degree.

use crate::words::value;
use std::fmt::Write as _;
use zeroset_ir::Constant;
use zeroset_syntax::{Options, read};

/// Largest difference, relative to the value or to 1. Where numbers cancel, half of the digits of
/// `f64` are lost.
const TOLERANCE: f64 = 1e-6;

#[test]
fn values_are_those_of_the_table() {
    let path = format!("{}/../../tests/data/values.txt", env!("CARGO_MANIFEST_DIR"));
    let table = std::fs::read_to_string(path).expect("the table is there");
    let mut wrong = String::new();
    let mut count = 0;
    for row in table.lines().filter(|row| !row.starts_with('#')) {
        let [text, point, expected] = row.split("; ").collect::<Vec<_>>()[..] else {
            panic!("{row}");
        };
        let coordinates: Vec<Constant> =
            point.split(' ').map(|c| zeroset_syntax::constant(c).expect(c)).collect();
        let point = <[Constant; 3]>::try_from(coordinates).expect("three coordinates");
        let expected: f64 = expected.parse().expect(expected);
        let document = read(text, &Options::default()).unwrap_or_else(|e| {
            panic!("{}", e.render(None, text, false));
        });
        let found = value(&document, document.surfaces[0].root, &point);
        let bounds = found.map(|found| found.bounds());
        let reach = TOLERANCE * expected.abs().max(1.0);
        let is_near = bounds.is_some_and(|bounds| {
            bounds.lo - reach <= expected
                && expected <= bounds.hi + reach
                && bounds.hi - bounds.lo <= reach
        });
        if !is_near {
            writeln!(wrong, "{row}: {bounds:?}").unwrap();
        }
        count += 1;
    }
    assert!(count > 300, "{count} rows");
    assert!(wrong.is_empty(), "{wrong}");
}
