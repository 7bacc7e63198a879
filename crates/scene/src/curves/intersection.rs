//! Curves of two equations: the cells that may hold them, and points of the curves in these cells.

use super::functions::{bound, gradient_kernel, kernel};
use super::march::{Marcher, Pair};
use glam::DVec3;
use zeroset_eval::{Boxes, FindZeros, Kernel, LANES, Zeros};
use zeroset_interval::Interval;
use zeroset_ir::NodeId;
use zeroset_space::Region;
use zeroset_syntax::Document;

/// Number of times that the region's box is halved along each axis.
const LEVELS: u32 = 7;

/// Largest number of cells of a level. A curve has some thousand; a surface has more.
const MOST_CELLS: usize = 1 << 17;

/// A cell: the numbers of its position along each axis.
type Cell = [u32; 3];

/// The box of all cells, and the size of a cell.
struct Grid {
    low: DVec3,
    step: DVec3,
}

impl Grid {
    fn new(region: &Region, level: u32) -> Self {
        let step = (region.high() - region.low()) / f64::from(1_u32 << level);
        Self { low: region.low(), step }
    }

    fn bounds(&self, cell: Cell) -> [Interval; 3] {
        [0, 1, 2].map(|axis| {
            let at = |n: u32| self.low[axis] + self.step[axis] * f64::from(n);
            Interval { lo: at(cell[axis]), hi: at(cell[axis] + 1) }
        })
    }

    fn centre(&self, cell: Cell) -> DVec3 {
        self.low + self.step * (DVec3::from_array(cell.map(f64::from)) + 0.5)
    }
}

/// The pieces of the curve on which two functions are 0, and a remark if they are missing or not
/// exact.
pub fn traced(
    document: &Document,
    both: [NodeId; 2],
    region: &Region,
) -> (Vec<Vec<DVec3>>, Option<&'static str>) {
    const LARGE: (Vec<Vec<DVec3>>, Option<&str>) =
        (Vec::new(), Some("is too large a formula to be traced"));
    let Some((graph, roots)) = bound(document, &both) else { return LARGE };
    let gradients = [roots[0], roots[1]].map(|root| gradient_kernel(&graph, root));
    let [Some(one), Some(other)] = gradients else { return LARGE };
    // The grid's bounds may be rounded beyond the region's.
    let slack = 1e-9 * (region.high() - region.low());
    let domain = [0, 1, 2].map(|axis| Interval {
        lo: region.low()[axis] - slack[axis],
        hi: region.high()[axis] + slack[axis],
    });
    let zeros = [roots[0], roots[1]].map(|root| kernel::<FindZeros>(&graph, &[root], domain));
    let Some(cells) = cells(region, &zeros) else {
        return (Vec::new(), Some("is not drawn: the two surfaces meet in more than a curve"));
    };
    let grid = Grid::new(region, LEVELS);
    let pair = Pair::new(one, other);
    let seeds: Vec<DVec3> = cells.iter().map(|cell| grid.centre(*cell)).collect();
    let mut marcher = Marcher::new(&pair, region, grid.step);
    let found = seeds.chunks(LANES).flat_map(|seeds| pair.nearest_zeros(seeds, grid.step));
    for seed in found.flatten() {
        marcher.follow(seed);
    }
    let problem = match (marcher.pieces.is_empty(), cells.is_empty(), marcher.is_complete()) {
        (true, false, _) => Some("has no part here along which it can be followed"),
        (true, true, _) => Some("is proven to have no part here"),
        (false, _, false) => Some("is too long to be drawn whole"),
        (false, _, true) => None,
    };
    (marcher.pieces, problem)
}

/// The cells of the last level in which both functions may be 0. `None` if there are too many.
fn cells(region: &Region, zeros: &[Box<dyn Kernel<FindZeros, f64>>; 2]) -> Option<Vec<Cell>> {
    let mut cells = vec![[0; 3]];
    for level in 1..=LEVELS {
        let grid = Grid::new(region, level);
        let parts: Vec<Cell> = cells
            .iter()
            .flat_map(|cell| {
                (0..8_u32)
                    .map(|part| [0, 1, 2].map(|axis| 2 * cell[axis as usize] + (part >> axis & 1)))
            })
            .collect();
        let bounds: Vec<[Interval; 3]> = parts.iter().map(|part| grid.bounds(*part)).collect();
        cells.clear();
        for (batch, parts) in Boxes::<f64>::around(&bounds).iter().zip(parts.chunks(LANES)) {
            let mut possible = u16::MAX;
            for kernel in zeros {
                let mut found = Zeros::default();
                kernel.eval(batch, &mut found);
                possible &= found.possible;
                if possible == 0 {
                    break;
                }
            }
            let lanes = parts.iter().enumerate().filter(|(lane, _)| possible >> lane & 1 == 1);
            cells.extend(lanes.map(|(_, part)| *part));
        }
        if cells.len() > MOST_CELLS {
            return None;
        }
    }
    Some(cells)
}
