//! A queue of edges that are to be removed.

/// Number of buckets: two for each power of two.
const BUCKETS: usize = 512;
/// Number of low bits of a float that do not matter for its bucket: all but the first one of the
/// significand.
const BITS: u32 = 51;
/// The bucket of costs around 2⁻²⁰⁰ and below.
const FIRST: u64 = (1023 - 200) << 1;

/// An edge, with the numbers of changes at its ends when its cost was found.
#[derive(Clone, Copy)]
pub struct Entry {
    pub ends: [u32; 2],
    pub stamps: [u32; 2],
}

/// Edges, roughly in the order of costs: those in a bucket differ by less than half.
pub struct Queue {
    buckets: Vec<Vec<Entry>>,
    /// No bucket before this one has an entry.
    first: usize,
}

impl Queue {
    pub fn new() -> Self {
        Self { buckets: (0..BUCKETS).map(|_| Vec::new()).collect(), first: BUCKETS }
    }

    /// Adds an edge whose cost is at least 0.
    pub fn push(&mut self, cost: f64, entry: Entry) {
        let bucket =
            (cost.to_bits() >> BITS).saturating_sub(FIRST).min(BUCKETS as u64 - 1) as usize;
        self.first = self.first.min(bucket);
        self.buckets[bucket].push(entry);
    }

    /// Takes an edge with nearly the least cost: the one that was added last.
    pub fn pop(&mut self) -> Option<Entry> {
        while self.first < BUCKETS {
            if let Some(entry) = self.buckets[self.first].pop() {
                return Some(entry);
            }
            self.first += 1;
        }
        None
    }
}
