//! Coordinates as text that reads back as the same float, with π where it fits.

use crate::number::number;
use std::f64::consts::FRAC_PI_4;

/// A coordinate as text that reads back as the same float: a multiple of π/4, or a decimal.
pub fn coordinate(value: f64) -> String {
    let times = value / FRAC_PI_4;
    let is_near = times.abs() < 1e6 && (times - times.round()).abs() < 1e-9;
    let text = multiple_of_pi(times / 4.0);
    // Only the float nearest to a multiple of π/4 is shown as that multiple.
    if is_near && number(&text) == Some(value) { text } else { value.to_string() }
}

/// The multiple of a power of ten that is nearest to a number: the float of this decimal.
pub fn decimal(value: f64, exponent: i32) -> f64 {
    let unit = 10.0_f64.powi(exponent.abs());
    let near =
        if exponent < 0 { (value * unit).round() / unit } else { (value / unit).round() * unit };
    // Adding 0 takes the sign from -0.
    near + 0.0
}

/// The text of `times` π, where `times` is a multiple of 1/4.
pub fn multiple_of_pi(times: f64) -> String {
    let quarters = (4.0 * times).round() as i64;
    let (sign, quarters) = (if quarters < 0 { "-" } else { "" }, quarters.unsigned_abs());
    let divisor = [1, 2].into_iter().find(|d| quarters % (4 / d) == 0).unwrap_or(4);
    let factor = match quarters / (4 / divisor) {
        0 => return "0".to_owned(),
        1 => String::new(),
        more => more.to_string(),
    };
    if divisor == 1 { format!("{sign}{factor}π") } else { format!("{sign}{factor}π/{divisor}") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::DomainChoice;
    use std::f64::consts::PI;

    #[test]
    fn decimals_have_no_digits_but_their_own() {
        for (value, exponent, text) in [
            (0.1234, -3, "0.123"),
            (-0.3, -1, "-0.3"),
            (-0.0004, -3, "0"),
            (999_951.0, 2, "1000000"),
            (-123_456.7, 2, "-123500"),
        ] {
            assert_eq!(coordinate(decimal(value, exponent)), text);
        }
    }

    #[test]
    fn coordinates_read_back_as_they_were() {
        for (value, text) in [
            (2.0 * PI, "2π"),
            (-PI, "-π"),
            (-1.5 * PI, "-3π/2"),
            (FRAC_PI_4, "π/4"),
            (0.0, "0"),
            (-0.0, "0"),
            (2.5, "2.5"),
            (1e300, &1e300.to_string()),
            (PI.next_up(), &PI.next_up().to_string()),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(coordinate(value), text);
        }
        for quarters in -200..200 {
            let value = f64::from(quarters) * FRAC_PI_4;
            for value in [value, value.next_up(), value.next_down()] {
                let text = coordinate(value);
                let read: DomainChoice = [text.as_str(); 6].join(",").parse().expect("bounds");
                assert_eq!(read, DomainChoice::Bounds([value; 6]), "{text}");
            }
        }
    }
}
