//! The Pareto front: what nothing else is better than in both ways at once.

/// The points that no other one is below in one coordinate without being above in the other, from
/// left to right, by their index. Of equal points there is the first.
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
        // No error at all is a place like any other; equal points are one.
        assert_eq!(front(&[[0.0, 5.0], [0.0, 4.0], [0.0, 4.0], [1.0, 4.5]]), [1]);
    }
}
