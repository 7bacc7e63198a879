//! The exact first roots of `tests/data/truth` and `tests/data/stability`, which were computed
//! without this project's code.

pub mod table;

use serde::Deserialize;
use std::fs::File;
use std::path::{Path, PathBuf};
use zeroset_render::picture::Precision;

/// Side of every reference picture, in pixels.
pub const SIDE: usize = 64;

/// The reference of one surface.
pub struct Truth {
    pub view: View,
    /// Pixels row by row from the top.
    pub pixels: Vec<Pixel>,
}

/// The view of a surface.
#[derive(Deserialize)]
pub struct View {
    pub slug: String,
    /// Lower and upper bounds of x, y and z, in that order.
    pub domain: [f64; 6],
    pub eye: [f64; 3],
    pub target: [f64; 3],
    pub up: [f64; 3],
    /// Vertical field of view, in degrees.
    pub fov: f64,
}

/// The reference of one ray. Distances are from the eye, in world units.
#[derive(Clone, Copy, Debug)]
pub struct Pixel {
    /// The first root at which the function changes sign; infinite if there is none.
    pub crossing: f64,
    /// The first root of any multiplicity; infinite if there is none.
    pub zero: f64,
    /// Whether the reference could not decide this ray.
    pub open: bool,
}

/// Flags in `pixels.npy`.
const CROSSES: u8 = 1;
const TOUCHES: u8 = 2;
const OPEN: u8 = 4;

/// Corrected roots of `sin(40/x)-y` on two rays, computed with 50 digits. The stored roots are
/// wrong by up to 1.2e-8 on these rays, since a whole wave is only a millionth long.
const CORRECTED: [(&str, usize, f64); 2] = [
    ("essential-fast", 18 * SIDE + 38, 8.371_880_956_302_741),
    ("essential-fast", 41 * SIDE + 16, 6.423_417_971_048_07),
];

/// Tolerance of distances. It covers the rounding of the reference's rays and, for `f32`, 2⁻²⁴.
pub fn rounding(precision: Precision) -> f64 {
    match precision {
        Precision::Auto | Precision::F32 => 1e-6,
        Precision::F64 => 1e-10,
    }
}

/// Compares results with a stored file line by line. `ZEROSET_BLESS=1` writes the file first.
pub fn compare(name: &str, found: &str) {
    let path = path(name);
    if std::env::var_os("ZEROSET_BLESS").is_some() {
        std::fs::write(&path, found).expect("written");
    }
    let expected = std::fs::read_to_string(&path).expect("a table");
    for (number, (now, before)) in found.lines().zip(expected.lines()).enumerate() {
        assert_eq!(now, before, "line {} of {}", number + 1, path.display());
    }
    assert_eq!(found.lines().count(), expected.lines().count(), "{}", path.display());
}

/// Path of a reference file or directory.
pub fn path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name)
}

/// The references in a directory, in the order of its `index.json`.
pub fn read(directory: &str) -> Vec<Truth> {
    let file = |name: &str| format!("{directory}/{name}");
    let index = File::open(path(&file("index.json"))).expect("an index");
    let views: Vec<View> = serde_json::from_reader(index).expect("a valid index");
    let kinds: Vec<u8> = array(&file("pixels.npy"));
    assert_eq!(kinds.len(), views.len() * SIDE * SIDE);
    let mut crossings = array::<f64>(&file("crossing.npy")).into_iter();
    let mut touching = array::<f64>(&file("touching.npy")).into_iter();
    let mut next = |kind: u8| {
        let crossing = if kind & CROSSES == 0 { Some(f64::INFINITY) } else { crossings.next() };
        let crossing = crossing.expect("a distance for each crossing");
        let zero = if kind & TOUCHES == 0 { Some(crossing) } else { touching.next() };
        let zero = zero.expect("a distance for each touching root");
        assert!(zero <= crossing, "the first root is no later than the first crossing");
        Pixel { crossing, zero, open: kind & OPEN != 0 }
    };
    let mut truths: Vec<Truth> = views
        .into_iter()
        .zip(kinds.chunks(SIDE * SIDE))
        .map(|(view, kinds)| Truth { view, pixels: kinds.iter().map(|&k| next(k)).collect() })
        .collect();
    assert!(crossings.next().is_none() && touching.next().is_none(), "distances left over");
    for (slug, ray, root) in CORRECTED {
        if let Some(truth) = truths.iter_mut().find(|truth| truth.view.slug == slug) {
            (truth.pixels[ray].crossing, truth.pixels[ray].zero) = (root, root);
        }
    }
    truths
}

fn array<T: npyz::Deserialize>(name: &str) -> Vec<T> {
    let file = File::open(path(name)).expect("an array");
    let array = npyz::NpyFile::new(std::io::BufReader::new(file)).expect("an array");
    assert_eq!(array.order(), npyz::Order::C);
    array.into_vec().expect("of this type")
}
