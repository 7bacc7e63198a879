//! Encloses a surface in ever smaller boxes. Space outside the boxes is proven to hold no zero.
//!
//! `cargo run --example root_region`

use std::ops::RangeInclusive;
use zeroset::{Error, Function};

type Box3 = [RangeInclusive<f64>; 3];

/// The eight parts of a box that is halved along each axis.
fn parts(whole: &Box3) -> impl Iterator<Item = Box3> {
    (0..8).map(|part| {
        [0, 1, 2].map(|axis| {
            let (low, high) = (*whole[axis].start(), *whole[axis].end());
            let middle = low.midpoint(high);
            if part >> axis & 1 == 0 { low..=middle } else { middle..=high }
        })
    })
}

fn volume(boxes: &[Box3]) -> f64 {
    let sides = |b: &Box3| b.iter().map(|side| side.end() - side.start()).product::<f64>();
    boxes.iter().map(sides).sum()
}

fn main() -> Result<(), Error> {
    let heart = Function::parse("(x^2+9/4*y^2+z^2-1)^3 - x^2*z^3 - 9/80*y^2*z^3")?;
    // Intervals prove that the whole surface lies in this box.
    let domain = heart.domain()?;
    println!("domain {domain:?}");
    let mut boxes = vec![domain];
    for depth in 1..=6 {
        let candidates: Vec<Box3> = boxes.iter().flat_map(parts).collect();
        let enclosures = heart.enclose(&candidates)?;
        let pairs = candidates.into_iter().zip(enclosures);
        boxes = pairs.filter(|(_, found)| found.may_vanish()).map(|(part, _)| part).collect();
        println!("depth {depth}: {} boxes, volume {:.4}", boxes.len(), volume(&boxes));
    }
    Ok(())
}
