//! Source of random choices: a seeded generator, or the bytes of a fuzzer.

use std::ops::{Bound, RangeBounds};

/// A source of choices. The same seed or the same bytes give the same choices on every platform.
#[derive(Clone, Debug)]
pub struct Rng {
    /// Bytes not used yet, in reverse order.
    bytes: Vec<u8>,
    /// Generator used when the bytes have run out.
    tail: fastrand::Rng,
}

/// Number of leading bytes that seed the generator.
const SEED_BYTES: usize = 4;

impl Rng {
    /// Creates a source of pseudo-random choices.
    pub fn with_seed(seed: u64) -> Self {
        Self { bytes: Vec::new(), tail: fastrand::Rng::with_seed(seed) }
    }

    /// Creates a source whose choices are made by `data`. Each choice uses as few bytes as can
    /// distinguish its possibilities, so a changed byte changes one choice. When the bytes have run
    /// out, choices come from a generator. The first four bytes are its seed.
    pub fn from_bytes(data: &[u8]) -> Self {
        let (seed, choices) = data.split_at(data.len().min(SEED_BYTES));
        let seed = seed.iter().fold(0, |seed, byte| seed << 8 | u64::from(*byte));
        Self { bytes: choices.iter().rev().copied().collect(), ..Self::with_seed(seed) }
    }

    /// Returns true or false.
    pub fn bool(&mut self) -> bool {
        self.take(1).map_or_else(|| self.tail.bool(), |byte| byte & 1 != 0)
    }

    /// Returns a number in `range`.
    ///
    /// # Panics
    /// If the range is empty.
    pub fn u32(&mut self, range: impl RangeBounds<u32>) -> u32 {
        let wide =
            (range.start_bound().map(|x| u64::from(*x)), range.end_bound().map(|x| u64::from(*x)));
        match self.chosen(bounds(wide, 0, u64::from(u32::MAX))) {
            Some(value) => value as u32,
            None => self.tail.u32(range),
        }
    }

    /// Returns a number in `range`.
    ///
    /// # Panics
    /// If the range is empty.
    pub fn u64(&mut self, range: impl RangeBounds<u64>) -> u64 {
        let copied = (range.start_bound().cloned(), range.end_bound().cloned());
        match self.chosen(bounds(copied, 0, u64::MAX)) {
            Some(value) => value,
            None => self.tail.u64(range),
        }
    }

    /// Returns a number in `range`.
    ///
    /// # Panics
    /// If the range is empty.
    pub fn i32(&mut self, range: impl RangeBounds<i32>) -> i32 {
        // The shift turns `i32::MIN` into 0.
        let shifted = |x: &i32| (i64::from(*x) - i64::from(i32::MIN)) as u64;
        let wide = (range.start_bound().map(shifted), range.end_bound().map(shifted));
        match self.chosen(bounds(wide, 0, u64::from(u32::MAX))) {
            Some(value) => (value as i64 + i64::from(i32::MIN)) as i32,
            None => self.tail.i32(range),
        }
    }

    /// Returns a number between two limits, chosen by bytes; `None` if the bytes have run out.
    fn chosen(&mut self, (least, most): (u64, u64)) -> Option<u64> {
        assert!(least <= most, "an empty range");
        let others = most - least;
        if others == 0 {
            return Some(least);
        }
        let needed = (u64::BITS - others.leading_zeros()).div_ceil(8);
        let drawn = self.take(needed as usize)?;
        Some(least + others.checked_add(1).map_or(drawn, |count| drawn % count))
    }

    /// Returns the next bytes as a number. If there are too few, drops them and returns `None`.
    fn take(&mut self, count: usize) -> Option<u64> {
        let rest = self.bytes.len().checked_sub(count);
        let Some(rest) = rest else {
            self.bytes.clear();
            return None;
        };
        Some(self.bytes.drain(rest..).fold(0, |value, byte| value << 8 | u64::from(byte)))
    }
}

/// Returns the least and the greatest number of a range. An open side ends at `least` or `most`.
fn bounds(range: (Bound<u64>, Bound<u64>), least: u64, most: u64) -> (u64, u64) {
    let least = match range.0 {
        Bound::Included(x) => x,
        Bound::Excluded(x) => x + 1,
        Bound::Unbounded => least,
    };
    let most = match range.1 {
        Bound::Included(x) => x,
        Bound::Excluded(x) => x.checked_sub(1).expect("a range with members"),
        Bound::Unbounded => most,
    };
    (least, most)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_choose_and_then_their_seed() {
        let mut rng = Rng::from_bytes(&[0, 0, 0, 7, 1, 9, 1, 0, 250, 255]);
        assert!(rng.bool());
        assert_eq!(rng.u32(0..8), 1);
        assert_eq!(rng.u32(5..=5), 5);
        // More than 256 possibilities take two bytes, the low byte first.
        assert_eq!(rng.u64(0..1000), 1);
        assert_eq!(rng.i32(-3..=6), -3); // 250 is a multiple of 10
        assert_eq!(rng.i32(-128..128), 127);
        let mut seeded = Rng::with_seed(7);
        for _ in 0..10 {
            assert_eq!(rng.u32(0..1000), seeded.u32(0..1000));
            assert_eq!(rng.i32(-5..5), seeded.i32(-5..5));
            assert_eq!(rng.bool(), seeded.bool());
            assert_eq!(rng.u64(0..1 << 60), seeded.u64(0..1 << 60));
        }
    }

    #[test]
    fn a_choice_that_lacks_bytes_ends_them() {
        let mut rng = Rng::from_bytes(&[0, 0, 0, 1, 200]);
        let mut seeded = Rng::with_seed(1);
        assert_eq!(rng.u64(0..1 << 53), seeded.u64(0..1 << 53));
        assert_eq!(rng.u32(0..256), seeded.u32(0..256));
        assert_eq!(Rng::from_bytes(&[]).u32(0..99), Rng::with_seed(0).u32(0..99));
    }
}
