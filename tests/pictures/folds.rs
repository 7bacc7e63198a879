//! Formulas in which an operation jumps where the whole function does not: remainders, rounding and
//! angles that fold space.
//!
//! A long run: `ZEROSET_CASES=200 cargo test --test all fold -- --nocapture`.

use glam::DVec3;
use zeroset_render::model::Model;
use zeroset_render::picture::Settings;
use zeroset_scene::view::{self, DomainChoice};
use zeroset_space::{Camera, Projection};
use zeroset_syntax::{Options, read};
use zeroset_testkit::{Effort, Rng};
use zeroset_trace::{GBuffer, Status};

const SIZE: usize = 64;

/// A picture of `text` over the cube from −`half` to `half`.
fn picture(text: &str, half: f64) -> GBuffer {
    let document = read(text, &Options::default()).expect(text);
    let cube = DomainChoice::Bounds([-half, half, -half, half, -half, half]);
    let (region, _) = view::region(&document, cube, None).expect(text);
    let eye = DVec3::new(1.9, -2.9, 1.6) * half;
    let camera = Camera::new(eye, DVec3::ZERO, DVec3::Z, Projection::Perspective { fov: 40.0 });
    let settings = Settings { width: SIZE, height: SIZE, ..Settings::default() };
    let model = Model::new(&document, &region, &settings).expect(text);
    let picture = model.trace(&camera.expect("a camera"), &settings, &|_| true).expect(text);
    picture.buffer
}

fn count(buffer: &GBuffer, status: Status) -> usize {
    buffer.status.iter().filter(|found| **found == status).count()
}

/// Texts over a cube of half the given side. No face of the cube is at a jump where the sign
/// changes.
const TEXTS: [(&str, f64); 22] = [
    ("(mod(x+1,2)-1)^2+y^2+z^2 <= 0.36", 3.0),
    ("(mod(x+1,2)-1)^2+y^2+z^2 = 0.36", 3.0),
    ("hypot(mod(x+0.5,1)-0.5,y) <= 0.08", 2.0),
    ("max(abs(atan2(y,x))-2, abs(z)-0.2) <= 0", 1.0),
    ("max(abs(atan2(y,x))-2, abs(z)-0.2) = 0", 1.0),
    ("hypot(mod(x+1,2)-1,mod(y+1,2)-1,mod(z+1,2)-1) <= 0.6", 3.0),
    ("max(abs(mod(x+1,2)-1),abs(mod(y+1,2)-1),abs(mod(z+1,2)-1)) <= 0.5", 3.0),
    ("hypot(x,y)<=1+0.3cos(5atan2(y,x)) and abs(z)<=0.5", 2.0),
    ("hypot(x,y)<=1+0.3cos(2.5atan2(y,x)) and abs(z)<=0.5", 2.0),
    ("(hypot(x,y)-2)^2+z^2 <= 0.1+0.1cos(8atan2(y,x))", 3.0),
    ("hypot(x-round(x),y-round(y),z-round(z)) <= 0.3", 3.0),
    ("hypot(x-2round(x/2),y,z) <= 0.3", 3.0),
    ("abs(fract(x)-0.5)+abs(y)+abs(z) <= 0.4", 2.0),
    ("sign(x)*x + y^2+z^2 <= 1", 2.0),
    ("if(x<0, 1+x^2, 1+x^3) + y^2 <= 2", 2.0),
    ("max(abs(z)-0.3, abs(mod(hypot(x,y),0.5)-0.25)-0.1) <= 0", 2.0),
    ("max(abs(x)-1,abs(y)-1,abs(z)-1,0.3-abs(mod(3x,2)-1)) <= 0", 1.5),
    ("x^2+y^2+z^2 = 1 {mod(z,0.5) < 0.25}", 2.0),
    ("abs(mod(atan2(y,x),1)-0.5)+abs(z)+abs(hypot(x,y)-1) <= 0.4", 2.0),
    ("trunc(x)^2+y^2+z^2 <= 1.5", 2.1),
    // Faces at jumps, where the sign changes, are proven, too.
    ("floor(x)+floor(y) <= z", 2.1),
    ("z <= 1/x", 2.0),
];

#[test]
fn jumps_that_fold_away_leave_nothing_undecided() {
    for (text, half) in TEXTS {
        let buffer = picture(text, half);
        let (hit, undecided) = (count(&buffer, Status::Hit), count(&buffer, Status::Undecided));
        println!("{text}: {hit} hits, {undecided} undecided");
        assert!(hit > 40 && undecided * 500 <= SIZE * SIZE, "{text}: {undecided} of {hit}");
    }
}

/// A coordinate as it is, shifted or folded, in one of the ways in which people write it.
fn folded(axis: &str, rng: &mut Rng) -> String {
    let period = ["0.7", "1.1", "1.7"][rng.u32(0..3) as usize];
    match rng.u32(0..6) {
        0 => format!("(mod({axis}+{period}/2,{period})-{period}/2)"),
        1 => format!("({axis}-{period}*round({axis}/{period}))"),
        2 => format!("({period}*abs(fract({axis}/{period})-0.5))"),
        3 => format!("(abs(mod({axis},2*{period})-{period})-0.2)"),
        4 => format!("(sign({axis})*{axis}-0.6)"),
        _ => format!("({axis}-0.1)"),
    }
}

/// A random shape in folded space. Its function is continuous.
fn random_shape(rng: &mut Rng) -> String {
    let [x, y, z] = ["x", "y", "z"].map(|axis| folded(axis, rng));
    match rng.u32(0..6) {
        0 => format!("hypot({x},{y},{z})-0.25"),
        1 => format!("max(abs({x}),abs({y}),abs({z}))-0.21"),
        2 => format!("abs({x})+abs({y})+abs({z})-0.31"),
        3 => format!("min(hypot({x},{y}),hypot({y},{z}))-0.09"),
        4 => format!("max({x}^2+{y}^2+{z}^2-0.09, 0.04-{x}^2-{y}^2)"),
        _ => format!("hypot(hypot({x},{y})-0.25,{z})-0.08"),
    }
}

/// Where the function is continuous, a solid without its caps and the equation of its boundary have
/// the same statuses.
#[test]
fn folded_solids_and_equations_are_the_same() {
    let effort = Effort::from_environment(0x5eed_f01d, 60);
    let (mut hits, mut undecided) = (0, 0);
    for seed in effort.seed..effort.seed + effort.cases {
        let shape = random_shape(&mut Rng::with_seed(seed));
        // The ball keeps the solid away from the faces of the cube.
        let shape = format!("max({shape}, x^2+y^2+z^2-3.9)");
        let [solid, equation] =
            ["<=", "="].map(|sign| picture(&format!("{shape} {sign} 0"), 2.0).status);
        for (pixel, pair) in solid.iter().zip(&equation).enumerate() {
            let contradict =
                matches!(pair, (Status::Hit, Status::Miss) | (Status::Miss, Status::Hit));
            assert!(
                !contradict,
                "pixel {pixel}: {pair:?} of {shape}\nZEROSET_SEED={seed:#x} ZEROSET_CASES=1"
            );
            hits += usize::from(*pair.0 == Status::Hit);
            undecided += usize::from(*pair.0 == Status::Undecided);
            undecided += usize::from(*pair.1 == Status::Undecided);
        }
    }
    println!("{hits} hits, {undecided} undecided");
    assert!(hits > 100 * effort.cases as usize);
    assert!(undecided as u64 <= 2 * effort.cases * (SIZE * SIZE) as u64 / 500, "{undecided}");
}
