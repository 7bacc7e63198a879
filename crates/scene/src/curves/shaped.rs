//! Cuts polylines at the border of a region.

use glam::DVec3;
use zeroset_space::Region;

/// Returns whether a point is in the region.
pub fn holds(region: &Region, at: DVec3) -> bool {
    let is_inside = at.cmpge(region.low()).all() && at.cmple(region.high()).all();
    let is_kept = region.clip().is_none_or(|clip| clip.normal.dot(at) <= clip.offset);
    is_inside && is_kept && region.ball().is_none_or(|ball| at.distance(ball.centre) <= ball.radius)
}

/// The parts of a polyline that lie in the region.
pub fn clipped(region: &Region, line: &[DVec3]) -> Vec<Vec<DVec3>> {
    let mut parts: Vec<Vec<DVec3>> = Vec::new();
    let mut is_open = false;
    for pair in line.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        let Some([first, last]) = inside(region, from, to) else {
            is_open = false;
            continue;
        };
        if !is_open || first > 0.0 {
            parts.push(vec![from.lerp(to, first)]);
        }
        let part = parts.last_mut().expect("just pushed, or open");
        part.push(if last < 1.0 { from.lerp(to, last) } else { to });
        is_open = last >= 1.0;
    }
    parts
}

/// The first and last share of a segment that lies in the region.
fn inside(region: &Region, from: DVec3, to: DVec3) -> Option<[f64; 2]> {
    let way = to - from;
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    // Keeps the shares at which `at + share·slope ≤ 0`.
    let mut keep = |at: f64, slope: f64| {
        let share = -at / slope;
        if slope > 0.0 {
            last = last.min(share);
        } else if slope < 0.0 {
            first = first.max(share);
        } else if at > 0.0 {
            last = -1.0;
        }
    };
    for axis in 0..3 {
        keep(from[axis] - region.high()[axis], way[axis]);
        keep(region.low()[axis] - from[axis], -way[axis]);
    }
    if let Some(clip) = region.clip() {
        keep(clip.normal.dot(from) - clip.offset, clip.normal.dot(way));
    }
    if let Some(ball) = region.ball() {
        let off = from - ball.centre;
        let (square, half) = (way.length_squared(), off.dot(way));
        let rest = half * half - square * (off.length_squared() - ball.radius * ball.radius);
        if rest < 0.0 {
            return None;
        }
        if square > 0.0 {
            first = first.max((-half - rest.sqrt()) / square);
            last = last.min((-half + rest.sqrt()) / square);
        } else if !holds(region, from) {
            return None;
        }
    }
    (first <= last).then_some([first, last])
}
