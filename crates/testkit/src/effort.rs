//! Length and seed of a random test.

use std::env;
use std::fmt;

/// A seed and a number of inputs. The environment variables `ZEROSET_SEED` and `ZEROSET_CASES`
/// override them. Each variable is decimal, or hexadecimal after `0x`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Seed of the random numbers. The n-th case starts from `seed + n`.
    pub seed: u64,
    /// Least number of inputs to check.
    pub cases: u64,
}

impl Effort {
    /// Returns the given values, unless the environment sets others. Prints the result.
    ///
    /// # Panics
    /// If a variable of the environment is set but is not a number.
    pub fn from_environment(seed: u64, cases: u64) -> Self {
        let or = |name: &str, default| env::var(name).map_or(default, |text| number(name, &text));
        let effort = Self { seed: or("ZEROSET_SEED", seed), cases: or("ZEROSET_CASES", cases) };
        println!("{effort}");
        effort
    }
}

impl fmt::Display for Effort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "ZEROSET_SEED={:#x} ZEROSET_CASES={}", self.seed, self.cases)
    }
}

/// Prints how many claims a random test has attacked. `fuzz/attack` adds these lines up.
pub fn count_claims(count: u64) {
    println!("claims: {count}");
}

fn number(name: &str, text: &str) -> u64 {
    let parsed = match text.strip_prefix("0x") {
        Some(digits) => u64::from_str_radix(digits, 16),
        None => text.parse(),
    };
    parsed.unwrap_or_else(|error| panic!("{name}={text}: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_decimal_or_hexadecimal() {
        assert_eq!(number("N", "100000000"), 100_000_000);
        assert_eq!(number("N", "0x5eed"), 0x5eed);
    }
}
