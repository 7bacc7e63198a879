//! Ambient occlusion from a smaller picture of the same scene, for strips of a picture that is too
//! large to be held whole.

use crate::edges::slope;
use rayon::prelude::*;
use zeroset_trace::{GBuffer, RayGrid};

/// Points of the two pictures are on the same part of a surface if their depths differ by at most
/// this. The unit is a pixel width of the smaller picture, times the slope.
const FAR: f64 = 4.0;

/// Returns the occlusion of each painted point: the mean over the four pixels of `small` that are
/// nearest in the picture. Only pixels that show the same part of the same surface count. If
/// `small` is as large as the picture, its values are copied.
pub fn borrow_occlusion(
    buffer: &GBuffer,
    rays: &RayGrid,
    small: &GBuffer,
    small_rays: &RayGrid,
) -> Vec<u8> {
    let GBuffer { drawn, surface, normal, .. } = buffer;
    let mut occlusion = vec![0; drawn.len()];
    let hidden_there = |there: usize| small.occlusion.get(there).copied().unwrap_or_default();
    let row = |(row, hidden): (usize, &mut [u8])| {
        for (column, hidden) in hidden.iter_mut().enumerate() {
            let pixel = row * rays.width() + column;
            let (distance, surface) = (drawn[pixel], surface[pixel]);
            if !distance.is_finite() {
                continue;
            }
            let near = neighbors(rays, small_rays, [column, row]);
            let reach = FAR * small_rays.footprint(distance);
            let along = rays.ray_of(pixel).direction.normalize().as_vec3();
            let reach = reach * f64::from(slope(normal[pixel], along).max(1.0));
            let (mut sum, mut weights, mut nearest, mut least) = (0.0, 0.0, 0, f64::INFINITY);
            for (there, weight) in near {
                let off = (small.drawn[there] - distance).abs();
                if !off.is_finite() || small.surface[there] != surface {
                    continue;
                }
                if off < least {
                    (nearest, least) = (hidden_there(there), off);
                }
                if off <= reach {
                    sum += weight * f64::from(hidden_there(there));
                    weights += weight;
                }
            }
            *hidden = if weights > 0.0 { (sum / weights).round() as u8 } else { nearest };
        }
    };
    occlusion.par_chunks_mut(rays.width().max(1)).enumerate().for_each(row);
    occlusion
}

/// The pixels of a smaller picture of the same scene that are nearest to a pixel's center, at most
/// four, with their weights for interpolation. In the picture's middle, the weights add up to 1.
pub fn neighbors(
    rays: &RayGrid,
    small: &RayGrid,
    [column, row]: [usize; 2],
) -> impl Iterator<Item = (usize, f64)> {
    let (width, height) = (small.width(), small.height());
    let [across, upward] = rays.screen(2 * column, 2 * row).map(|place| place / small.unit);
    // Fractional column and row in the smaller picture.
    let place = [0.5 * (across + width as f64 - 1.0), 0.5 * (height as f64 - 1.0 - upward)];
    let axes = place.map(|place| {
        let (first, part) = (place.floor() as i64, place - place.floor());
        [(first, 1.0 - part), (first + 1, part)]
    });
    let [columns, rows] = axes;
    let all = rows.into_iter().flat_map(move |row| columns.map(|column| (column, row)));
    all.filter_map(move |((column, across), (row, down))| {
        let is_inside = (0..width as i64).contains(&column) && (0..height as i64).contains(&row);
        is_inside.then(|| (row as usize * width + column as usize, across * down))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use zeroset_space::{Camera, Projection};

    fn wall(width: usize, height: usize) -> (GBuffer, RayGrid) {
        let projection = Projection::Orthographic { height: 2.0 };
        let camera = Camera::new(DVec3::NEG_Y * 5.0, DVec3::ZERO, DVec3::Z, projection);
        let mut buffer = GBuffer::new(width, height, 0);
        buffer.drawn.fill(4.0);
        buffer.normal.fill([0.0, -1.0, 0.0]);
        (buffer, RayGrid::new(&camera.expect("valid"), width, height))
    }

    #[test]
    fn a_picture_of_the_same_size_gives_its_own_values() {
        let (mut small, rays) = wall(37, 21);
        small.occlusion = (0..37 * 21).map(|n| (n * 89 % 256) as u8).collect();
        let (part, _) = wall(37, 5);
        let borrowed = borrow_occlusion(&part, &rays.part(0..37, 16..21), &small, &rays);
        assert_eq!(borrowed, small.occlusion[16 * 37..]);
    }

    #[test]
    fn values_are_mixed_on_one_surface_and_not_across() {
        let (mut small, small_rays) = wall(8, 8);
        small.occlusion = (0..64).map(|n| if n % 8 < 4 { 0 } else { 200 }).collect();
        let occlusion = |small: &GBuffer| {
            let (large, rays) = wall(32, 32);
            let occlusion = borrow_occlusion(&large, &rays, small, &small_rays);
            occlusion[10 * 32..11 * 32].to_vec()
        };
        let mixed = occlusion(&small);
        assert!(mixed.is_sorted() && mixed[0] == 0 && mixed[31] == 200);
        assert_eq!(mixed[14..18], [25, 75, 125, 175]);
        // The right half is another wall, far behind.
        for n in (0..64).filter(|n| n % 8 >= 4) {
            small.drawn[n] = 9.0;
        }
        assert_eq!(occlusion(&small)[..18], [0; 18]);
    }
}
