//! Boxes around triangles, and all pairs of them that meet.
//!
//! A tree holds the boxes, so triangles of very different sizes cost what triangles of one size do.

/// A box with faces across the axes.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    low: [f64; 3],
    high: [f64; 3],
}

impl Bounds {
    /// The smallest box that holds all points.
    pub fn of(points: impl IntoIterator<Item = [f64; 3]>) -> Self {
        let nothing = Self { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };
        points.into_iter().fold(nothing, |all, point| all.join(Self { low: point, high: point }))
    }

    /// The smallest box that holds both.
    fn join(self, other: Self) -> Self {
        Self {
            low: [0, 1, 2].map(|axis| self.low[axis].min(other.low[axis])),
            high: [0, 1, 2].map(|axis| self.high[axis].max(other.high[axis])),
        }
    }

    /// Returns whether the closed boxes have a point in common.
    fn meets(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.low[axis] <= other.high[axis] && other.low[axis] <= self.high[axis])
    }

    /// Twice the coordinate of the center.
    fn middle(&self, axis: usize) -> f64 {
        self.low[axis] + self.high[axis]
    }

    fn extent(&self, axis: usize) -> f64 {
        self.high[axis] - self.low[axis]
    }
}

/// A leaf has up to this many boxes, which are compared one by one.
const LEAF: usize = 8;

/// A part of the boxes, by their numbers, and the box around all of them.
enum Node {
    Leaf(Bounds, Vec<usize>),
    Fork(Bounds, Box<[Node; 2]>),
}

impl Node {
    fn new(boxes: &[Bounds], numbers: &mut [usize]) -> Self {
        let mut all = Bounds::of([]);
        for number in &*numbers {
            all = all.join(boxes[*number]);
        }
        if numbers.len() <= LEAF {
            return Self::Leaf(all, numbers.to_vec());
        }
        let longest = |one: &usize, other: &usize| all.extent(*one).total_cmp(&all.extent(*other));
        let axis = (0..3).max_by(longest).expect("three axes");
        let half = numbers.len() / 2;
        let along = |number: &usize| boxes[*number].middle(axis);
        numbers.select_nth_unstable_by(half, |one, other| along(one).total_cmp(&along(other)));
        let (left, right) = numbers.split_at_mut(half);
        Self::Fork(all, Box::new([Self::new(boxes, left), Self::new(boxes, right)]))
    }

    fn bounds(&self) -> &Bounds {
        match self {
            Self::Leaf(bounds, _) | Self::Fork(bounds, _) => bounds,
        }
    }

    /// Visits the pairs within one node.
    fn visit(&self, boxes: &[Bounds], pair: &mut impl FnMut(usize, usize)) {
        match self {
            Self::Leaf(_, numbers) => {
                for (k, one) in numbers.iter().enumerate() {
                    for other in numbers[..k].iter().filter(|o| boxes[*one].meets(&boxes[**o])) {
                        pair(*one, *other);
                    }
                }
            }
            Self::Fork(_, children) => {
                let [left, right] = &**children;
                left.visit(boxes, pair);
                right.visit(boxes, pair);
                left.visit_both(right, boxes, pair);
            }
        }
    }

    /// Visits the pairs of a box of one node and a box of another.
    fn visit_both(&self, other: &Self, boxes: &[Bounds], pair: &mut impl FnMut(usize, usize)) {
        if !self.bounds().meets(other.bounds()) {
            return;
        }
        match (self, other) {
            (Self::Leaf(_, left), Self::Leaf(_, right)) => {
                for one in left {
                    for other in right.iter().filter(|other| boxes[*one].meets(&boxes[**other])) {
                        pair(*one, *other);
                    }
                }
            }
            (Self::Fork(_, children), Self::Leaf(..)) => {
                children.iter().for_each(|child| child.visit_both(other, boxes, pair));
            }
            (_, Self::Fork(_, children)) => {
                children.iter().for_each(|child| self.visit_both(child, boxes, pair));
            }
        }
    }
}

/// Visits every two boxes that meet once, by their numbers.
pub fn for_each_pair(boxes: &[Bounds], pair: &mut impl FnMut(usize, usize)) {
    let mut numbers: Vec<usize> = (0..boxes.len()).collect();
    Node::new(boxes, &mut numbers).visit(boxes, pair);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Small boxes beside large ones, compared with all pairs.
    #[test]
    fn each_pair_that_meets_is_visited_once() {
        let mut random = fastrand::Rng::with_seed(64);
        let mut boxes = Vec::new();
        for number in 0..300 {
            let size = if number % 7 == 0 { 8.0 } else { 0.5 };
            let mut point = |spread: f64| [0; 3].map(|_| spread * random.f64());
            let (from, by) = (point(10.0), point(size));
            boxes.push(Bounds::of([from, [0, 1, 2].map(|axis| from[axis] + by[axis])]));
        }
        let mut found = Vec::new();
        for_each_pair(&boxes, &mut |one, other| found.push([one.min(other), one.max(other)]));
        found.sort_unstable();
        let mut expected = Vec::new();
        for one in 0..boxes.len() {
            let meeting = (one + 1..boxes.len()).filter(|other| boxes[one].meets(&boxes[*other]));
            expected.extend(meeting.map(|other| [one, other]));
        }
        assert!(expected.len() > 500, "{}", expected.len());
        assert_eq!(found, expected);
    }
}
