//! Layers found in small blocks equal layers found at once.

use super::super::Model;
use super::super::trace::RenderPass;
use super::BlockLimits;
use super::block::Block;
use crate::picture::{Picture, Settings};
use zeroset_scene::camera::{self, CameraChoice};
use zeroset_scene::view::{self, DomainChoice};
use zeroset_shade::Pattern;
use zeroset_space::Camera;
use zeroset_syntax::{Options, read};
use zeroset_trace::RayGrid;

/// Texts with colored values, contour lines, solids, opaque and undecided surfaces.
const TEXTS: [&str; 3] = [
    "domain 2\ncolor viridis(z) 40%\ncontours x\nx^4-5x^2+y^4-5y^2+z^4-5z^2+11.8=0\n\
     color steelblue 60%\n(x-1)^2+y^2<=0.1\ncolor plasma(x*y)\nz=0.3*sin(3x)",
    "domain 3\nopacity 30%\nsin x cos y + sin y cos z + sin z cos x = 0\nfloor(2x)+y^2 <= z",
    "domain 1\nopacity 5%\n(x^2+y^2+z^2-0.8)^2=0\nx^2+y^2=z^2\nmax(abs(x),abs(y),abs(z))=0.7",
];

/// The model of a text, and the rays of a picture that is no multiple of the bands.
fn scene(text: &str, settings: &Settings) -> (Model, RayGrid) {
    let document = read(text, &Options::default()).expect("reads");
    let (region, _) = view::region(&document, DomainChoice::Document, None).expect("a region");
    let camera: Camera =
        camera::camera(&CameraChoice::typed(&document), &region).expect("a camera");
    let model = Model::new(&document, &region, settings).expect("compiles");
    (model, RayGrid::new(&camera, settings.width, settings.height))
}

#[test]
fn a_picture_does_not_depend_on_its_blocks() {
    let antialias = Pattern::of(4).expect("a pattern");
    let settings = Settings { width: 106, height: 75, antialias, ..Settings::default() };
    for text in TEXTS {
        let (model, rays) = scene(text, &settings);
        let draw = |block: BlockLimits| -> Picture {
            let mut pass = RenderPass::<f32>::new(&model, &settings, &|_| true);
            pass.block = block;
            pass.draw(&rays).expect("compiled")
        };
        let whole = draw(BlockLimits::default());
        let pixels = settings.width * settings.height;
        for (pixels, points) in [(16 * settings.width, pixels), (pixels, 2000), (pixels, 0)] {
            let picture = draw(BlockLimits { pixels, points });
            let differ = whole.rgb.iter().zip(&picture.rgb).filter(|(one, other)| one != other);
            assert_eq!(differ.count(), 0, "{text}: {pixels} pixels, {points} points");
            assert_eq!(picture.statistics.edge_rays, whole.statistics.edge_rays, "{text}");
        }
    }
}

#[test]
fn blocks_cover_each_pixel_once_however_they_are_divided() {
    let (_, rays) =
        scene("x^2+y^2+z^2=1", &Settings { width: 70, height: 53, ..Settings::default() });
    let mut blocks = Block::of_picture(&rays, 70 * 40);
    assert_eq!(blocks.len(), 2);
    let (mut seen, mut count) = (vec![0; 70 * 53], 0);
    while let Some(mut block) = blocks.pop() {
        while let Some(rest) = block.halve(&rays) {
            blocks.push(rest);
        }
        let known = block.known(&rays);
        for (pixel, own) in block.pixels_of(&known, 70) {
            seen[pixel] += 1;
            let (column, row) =
                (known.columns.start + own % known.columns.len(), own / known.columns.len());
            assert_eq!(pixel, (known.rows.start + row) * 70 + column);
            assert!(block.contains(pixel, 70));
        }
        count += 1;
    }
    assert_eq!((count, seen.iter().all(|times| *times == 1)), (5 * 4, true));
}
