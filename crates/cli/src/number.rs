//! Numbers in JSON lines, read and written exactly.

use serde_json::{Number, Value};

/// Parses a JSON number or a string. The string holds `inf`, `-inf`, `nan`, a decimal, or a
/// hexadecimal float such as `-0x1.8p-3`.
///
/// # Errors
/// A message that says what is wrong.
pub fn read(value: &Value) -> Result<f64, String> {
    match value {
        Value::Number(number) => number.as_f64().ok_or_else(|| format!("{number} is too large")),
        Value::String(text) => {
            let unsigned = text.strip_prefix(['+', '-']).unwrap_or(text);
            match unsigned.strip_prefix("0x").or_else(|| unsigned.strip_prefix("0X")) {
                Some(digits) => hexadecimal(digits)
                    .map(|magnitude| if text.starts_with('-') { -magnitude } else { magnitude })
                    .ok_or_else(|| format!("'{text}' is not a hexadecimal float of 64 bits")),
                None => text.parse().map_err(|_| format!("'{text}' is not a number")),
            }
        }
        other => Err(format!("{other} is not a number")),
    }
}

/// Returns the shortest decimal that reads back as `value`, or a string for infinities and NaN.
pub fn write(value: f64) -> Value {
    match Number::from_f64(value) {
        Some(number) => Value::Number(number),
        None if value.is_nan() => "nan".into(),
        None if value > 0.0 => "inf".into(),
        None => "-inf".into(),
    }
}

/// Parses a float such as `1.8p-3`. Returns `None` unless its value is exactly an `f64`.
fn hexadecimal(text: &str) -> Option<f64> {
    let (mantissa, exponent) = match text.split_once(['p', 'P']) {
        Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
        None => (text, 0),
    };
    // Reject numbers far beyond the range of `f64`, so that no sum below can overflow.
    if exponent.abs() > 10_000 || mantissa.len() > 1000 {
        return None;
    }
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = format!("{whole}{fraction}");
    if digits.is_empty() {
        return None;
    }
    let mut exponent = exponent - 4 * fraction.len() as i32;
    let significant = digits.trim_start_matches('0').trim_end_matches('0');
    if significant.is_empty() {
        return digits.bytes().all(|digit| digit == b'0').then_some(0.0);
    }
    exponent += 4 * (digits.trim_start_matches('0').len() - significant.len()) as i32;
    if !significant.bytes().all(|digit| digit.is_ascii_hexdigit()) {
        return None;
    }
    let odd = u64::from_str_radix(significant, 16).ok()?;
    exponent += odd.trailing_zeros() as i32;
    let odd = odd >> odd.trailing_zeros();
    let bits = 64 - odd.leading_zeros() as i32;
    // The leading bit's exponent determines the lowest bit that the `f64` can hold.
    let top = exponent + bits - 1;
    let lowest = (top - 52).max(-1074);
    if !(-1074..=1023).contains(&top) || exponent < lowest {
        return None;
    }
    // Scale in two steps, so that neither factor leaves the range of `f64`.
    let half = exponent / 2;
    Some(odd as f64 * power_of_two(half) * power_of_two(exponent - half))
}

fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((exponent + 1023) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn text(text: &str) -> Option<f64> {
        read(&json!(text)).ok()
    }

    #[test]
    fn hexadecimal_floats_are_exact() {
        assert_eq!(text("0x1.8p-3"), Some(0.1875));
        assert_eq!(text("-0X1p4"), Some(-16.0));
        assert_eq!(text("0x.8"), Some(0.5));
        assert_eq!(text("0x0p0"), Some(0.0));
        assert_eq!(text("-0x0").map(f64::to_bits), Some((-0.0_f64).to_bits()));
        assert_eq!(text("0x1p-1074"), Some(f64::from_bits(1)));
        assert_eq!(text("0x0.0000000000001p-1022"), Some(f64::from_bits(1)));
        assert_eq!(text("0x1.fffffffffffffp1023"), Some(f64::MAX));
        assert_eq!(text("0x1.fffffep127"), Some(f64::from(f32::MAX)));
        let wrong = [
            "0x",
            "0x.",
            "0xp3",
            "0x1p",
            "0x1.00000000000001p0",
            "0x1p1024",
            "0x1p-1075",
            "0xg",
            "0x1.8p-1074",
            "0x1p99999999999",
            "--0x1",
            "0x+1",
            "0x1.+",
        ];
        for wrong in wrong {
            assert_eq!(text(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn every_number_survives_being_written_and_read() {
        let adversarial = [
            0.1,
            -0.0,
            5e-324,
            f64::MAX,
            f64::MIN_POSITIVE,
            1.0 / 3.0,
            1e23,
            9_007_199_254_740_993.0,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::from(0.1_f32),
        ];
        for value in adversarial {
            let line = serde_json::to_string(&write(value)).expect("serialises");
            let back = read(&serde_json::from_str(&line).expect("parses")).expect("a number");
            assert_eq!(back.to_bits(), value.to_bits(), "{line}");
        }
        assert!(read(&write(f64::NAN)).expect("a number").is_nan());
    }
}
