//! Which lanes of a batch are whose.

use zeroset_eval::LANES;

/// What is still to be looked at of something: segments, the nearest last.
pub(super) type Stack<T = f64> = Vec<[T; 2]>;

/// The things that a batch's lanes are about, by lane.
pub(super) struct Slots {
    things: [usize; LANES],
    used: usize,
}

impl Slots {
    /// All things of which something is left.
    pub fn new(stacks: &[Stack; LANES]) -> Self {
        let mut slots = Self { things: std::array::from_fn(|thing| thing), used: LANES };
        slots.retain(stacks);
        slots
    }

    fn retain(&mut self, stacks: &[Stack; LANES]) {
        let mut kept = 0;
        for slot in 0..self.used {
            let thing = self.things[slot];
            self.things[kept] = thing;
            kept += usize::from(!stacks[thing].is_empty());
        }
        self.used = kept;
    }

    /// Takes out those of which nothing is left, where that saves a vector; returns whether lanes were moved.
    pub fn pack(&mut self, stacks: &[Stack; LANES]) -> bool {
        let live = self.all().filter(|&(_, thing)| !stacks[thing].is_empty()).count();
        let saves = live.div_ceil(4) < self.used.div_ceil(4);
        if saves {
            self.retain(stacks);
        }
        saves
    }

    pub fn len(&self) -> usize {
        self.used
    }

    pub fn is_empty(&self) -> bool {
        self.used == 0
    }

    /// Lanes and what they are about.
    pub fn all(&self) -> impl Iterator<Item = (usize, usize)> {
        self.things.into_iter().take(self.used).enumerate()
    }
}
