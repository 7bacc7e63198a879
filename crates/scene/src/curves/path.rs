//! Curves with a parameter: samples, as dense as the curve bends.

use super::functions::{bound, coordinates, points_at};
use crate::number::nearest;
use glam::DVec3;
use zeroset_eval::{Kernel, SampleGradient};
use zeroset_ir::NodeId;
use zeroset_space::Region;
use zeroset_syntax::Document;

/// Number of intervals into which the range is divided first. A prime number, so that no wave fits
/// it.
const FIRST: usize = 701;

/// Largest number of samples.
const MOST: usize = 1 << 16;

/// Most times that an interval is halved.
const ROUNDS: usize = 24;

/// Largest distance of a curve from its polyline, as a share of the region's size.
const FLAT: f64 = 1e-4;

/// Longest segment, as a share of the region's size.
const LONGEST: f64 = 1.0 / 16.0;

/// A curve with a parameter.
pub struct Path {
    kernel: Box<dyn Kernel<SampleGradient, f64>>,
    ends: [f64; 2],
}

/// A value of the parameter, and the curve's point at that value.
#[derive(Clone, Copy)]
struct Sample {
    t: f64,
    at: DVec3,
    /// True if the interval up to the next sample needs no more samples.
    is_settled: bool,
}

impl Path {
    /// Prepares a curve. `None` if its range is empty or has no value, or its functions are too
    /// large.
    pub fn new(document: &Document, at: [NodeId; 3], ends: [NodeId; 2]) -> Option<Self> {
        let roots: Vec<NodeId> = at.into_iter().chain(ends).collect();
        let (graph, roots) = bound(document, &roots)?;
        let [x, y, z, low, high] = roots[..] else { return None };
        let [low, high] = [graph.number(low)?, graph.number(high)?].map(nearest);
        let is_range = low < high && (high - low).is_finite();
        is_range.then(|| Self { kernel: coordinates(&graph, [x, y, z]), ends: [low, high] })
    }

    fn samples(&self, parameters: &[f64]) -> Vec<Sample> {
        let points = points_at(&*self.kernel, parameters);
        let both = parameters.iter().zip(points);
        both.map(|(t, at)| Sample { t: *t, at, is_settled: false }).collect()
    }

    fn first(&self) -> Vec<Sample> {
        let [low, high] = self.ends;
        let place = |n: usize| match n {
            FIRST => high,
            _ => low + (high - low) * (n as f64 / FIRST as f64),
        };
        self.samples(&(0..=FIRST).map(place).collect::<Vec<_>>())
    }

    /// The corners of a box around the curve. Where few points are far from all others, the box
    /// leaves them out. `None` if no point has a value.
    pub fn extent(&self) -> Option<[DVec3; 2]> {
        let points: Vec<DVec3> =
            self.first().into_iter().map(|sample| sample.at).filter(|at| at.is_finite()).collect();
        if points.is_empty() {
            return None;
        }
        let (mut low, mut high) = (DVec3::ZERO, DVec3::ZERO);
        for axis in 0..3 {
            let mut all: Vec<f64> = points.iter().map(|at| at[axis]).collect();
            all.sort_by(f64::total_cmp);
            let quantile = |share: f64| all[((all.len() - 1) as f64 * share) as usize];
            let (from, to) = (quantile(0.1), quantile(0.9));
            let room = 4.0 * (to - from);
            // A curve that hardly moves has no far parts.
            let room = if room > 0.0 { room } else { f64::INFINITY };
            low[axis] = all[0].max(from - room);
            high[axis] = all[all.len() - 1].min(to + room);
        }
        Some([low, high])
    }

    /// The curve's pieces, and a remark if they are not exact. Parts far from the region are
    /// coarse.
    pub fn traced(&self, region: &Region, size: f64) -> (Vec<Vec<DVec3>>, Option<&'static str>) {
        let mut all = self.first();
        let mut is_complete = true;
        for _ in 0..ROUNDS {
            let open: Vec<usize> = (0..all.len() - 1).filter(|n| !all[*n].is_settled).collect();
            if open.is_empty() {
                break;
            }
            if all.len() + open.len() > MOST {
                is_complete = false;
                break;
            }
            let middle = |n: &usize| all[*n].t.midpoint(all[n + 1].t);
            let middles = self.samples(&open.iter().map(middle).collect::<Vec<_>>());
            let mut next = Vec::with_capacity(all.len() + open.len());
            let mut middles = middles.into_iter();
            for n in 0..all.len() {
                let from = all[n];
                let Some(to) = all.get(n + 1).filter(|_| !from.is_settled) else {
                    next.push(from);
                    continue;
                };
                let middle = middles.next().unwrap_or(*to);
                let is_settled = is_settled(region, size, [from.at, middle.at, to.at]);
                next.push(Sample { is_settled, ..from });
                next.push(Sample { is_settled, ..middle });
            }
            all = next;
        }
        (
            split(&all, size, is_complete),
            (!is_complete).then_some("bends too often to be drawn exactly"),
        )
    }
}

/// Returns whether the polyline through three points may stand for the curve between them.
fn is_settled(region: &Region, size: f64, [from, middle, to]: [DVec3; 3]) -> bool {
    let points = [from, middle, to];
    let finite = points.iter().filter(|at| at.is_finite()).count();
    if finite == 0 {
        return true;
    }
    if finite < 3 {
        return false;
    }
    let (low, high) = (from.min(middle).min(to), from.max(middle).max(to));
    let reach = DVec3::splat(size);
    if low.cmpgt(region.high() + reach).any() || high.cmplt(region.low() - reach).any() {
        return true;
    }
    let way = to - from;
    let share = (middle - from).dot(way) / way.length_squared().max(f64::MIN_POSITIVE);
    let off = (middle - from.lerp(to, share.clamp(0.0, 1.0))).length();
    off < FLAT * size && way.length() < LONGEST * size && (0.2..0.8).contains(&share)
        || way.length().max((middle - from).length()) < FLAT * size
}

/// Splits samples where the curve has no value or jumps, and leaves out samples on straight parts.
fn split(all: &[Sample], size: f64, is_complete: bool) -> Vec<Vec<DVec3>> {
    let mut pieces: Vec<Vec<DVec3>> = Vec::new();
    let mut piece: Vec<DVec3> = Vec::new();
    for (n, sample) in all.iter().enumerate() {
        if sample.at.is_finite() {
            piece.push(sample.at);
        }
        let continues = all.get(n + 1).is_some_and(|next| {
            let jumps = is_complete
                && !sample.is_settled
                && (next.at - sample.at).length() > 4.0 * FLAT * size;
            sample.at.is_finite() && next.at.is_finite() && !jumps
        });
        if !continues && !piece.is_empty() {
            pieces.push(straightened(&std::mem::take(&mut piece), FLAT * size / 2.0));
        }
    }
    pieces.retain(|piece| piece.len() > 1);
    pieces
}

/// Most samples that one segment replaces.
const MOST_REPLACED: usize = 64;

/// The polyline without vertices that are within `off` of a segment that replaces them.
fn straightened(line: &[DVec3], off: f64) -> Vec<DVec3> {
    let mut kept = vec![line[0]];
    let mut from = 0;
    while from + 1 < line.len() {
        let mut to = from + 1;
        while to + 1 < line.len() && to - from < MOST_REPLACED {
            let (a, b) = (line[from], line[to + 1]);
            let way = b - a;
            let is_near = |at: &DVec3| {
                let share = (*at - a).dot(way) / way.length_squared().max(f64::MIN_POSITIVE);
                (*at - a.lerp(b, share.clamp(0.0, 1.0))).length() <= off
            };
            if !line[from + 1..=to].iter().all(is_near) {
                break;
            }
            to += 1;
        }
        kept.push(line[to]);
        from = to;
    }
    kept
}
