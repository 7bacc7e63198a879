//! The Pareto front: the points for which no other point is better in one coordinate and no worse
//! in the other.

/// Indices of the points on the front, from left to right. If points are equal, the first is kept.
pub fn front(points: &[[f64; 2]]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| {
        let ([ax, ay], [bx, by]) = (points[a], points[b]);
        ax.total_cmp(&bx).then(ay.total_cmp(&by)).then(a.cmp(&b))
    });
    let mut least = f64::INFINITY;
    order.retain(|&index| {
        let is_better = points[index][1] < least;
        least = least.min(points[index][1]);
        is_better
    });
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_is_what_nothing_is_better_than() {
        assert!(front(&[]).is_empty());
        let points = [[3.0, 1.0], [1.0, 4.0], [2.0, 2.0], [2.0, 3.0], [3.0, 2.0], [4.0, 1.0]];
        assert_eq!(front(&points), [1, 2, 0]);
        // An error of 0 is a value like any other, and equal points count once.
        assert_eq!(front(&[[0.0, 5.0], [0.0, 4.0], [0.0, 4.0], [1.0, 4.5]]), [1]);
    }
}
