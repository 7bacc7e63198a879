//! The command `measure`.

use crate::cli_support::Sandbox;
use serde_json::Value;
use std::f64::consts::PI;

/// The text that a run of `measure` prints, its messages and its exit code.
fn run(arguments: &[&str]) -> (String, String, Option<i32>) {
    let run = Sandbox::new().run(&[&["measure"], arguments].concat());
    (String::from_utf8(run.stdout).expect("a text"), run.stderr, run.code)
}

/// The report on a text, and the first surface of it.
fn report(arguments: &[&str]) -> (Value, Value) {
    let (text, stderr, _) = run(&[&["--json"], arguments].concat());
    let report: Value = serde_json::from_str(&text).expect(&stderr);
    let first = report["surfaces"][0].clone();
    (report, first)
}

fn pair(value: &Value) -> [f64; 2] {
    let end = |k: usize| value[k].as_f64().unwrap_or_else(|| panic!("two numbers: {value}"));
    [end(0), end(1)]
}

#[test]
fn a_ring_is_measured() {
    let (report, ring) = report(&["(sqrt(x^2+y^2)-1)^2+z^2 <= 0.16", "--relative", "1e-2"]);
    let volume = 2.0 * PI * PI * 0.16;
    let [low, high] = pair(&ring["volume"]);
    assert!(low <= volume && volume <= high && high - low <= 1e-2 * volume, "{ring}");
    for (axis, exact) in [1.4, 1.4, 0.4].into_iter().enumerate() {
        for (key, exact) in [("low", -exact), ("high", exact)] {
            let [low, high] = pair(&ring[key][axis]);
            assert!(low <= exact && exact <= high && high - low < 0.05, "{key} {axis}: {ring}");
        }
        let [low, high] = pair(&ring["centroid"][axis]);
        assert!(low <= 0.0 && 0.0 <= high, "{ring}");
    }
    // About the axis: the square of the large radius, and three quarters of that of the small one.
    let [low, high] = pair(&ring["inertia"]["zz"]);
    let exact = volume * (1.0 + 0.75 * 0.16);
    assert!(low <= exact && exact <= high, "{ring}");
    let (area, change) = (ring["area"].as_f64().unwrap(), ring["area_change"].as_f64().unwrap());
    assert!((area - 4.0 * PI * PI * 0.4).abs() <= change, "{ring}");
    assert_eq!((&ring["genus"], &ring["shape_proven"]), (&serde_json::json!([1]), &true.into()));
    assert_eq!(report["domain_found"], "bounded: proven");
}

#[test]
fn the_text_says_what_is_proven() {
    let (text, ..) = run(&["0.25 <= x^2+y^2+z^2 <= 1", "--relative", "0.1"]);
    assert!(text.starts_with("volume      3."), "{text}");
    assert!(text.ends_with("shape       1 piece with 1 hollow, of genus 0, 0: proven\n"), "{text}");
    let (text, ..) = run(&["z = x*y {x^2+y^2<1}", "--domain", "1.5"]);
    assert!(!text.contains("volume") && text.contains("1 piece with a rim"), "{text}");
}

#[test]
fn the_report_counts_pieces_as_the_text_does() {
    let (text, ..) = run(&["0.25 <= x^2+y^2+z^2 <= 1", "--relative", "0.1"]);
    assert!(text.contains("1 piece with 1 hollow, of genus 0, 0: proven"), "{text}");
    let (_, shell) = report(&["0.25 <= x^2+y^2+z^2 <= 1", "--relative", "0.1"]);
    assert_eq!([&shell["pieces"], &shell["hollows"]], [1, 1], "{shell}");
    assert_eq!(shell["genus"], serde_json::json!([0, 0]));
    // A surface that bounds no solid has no hollow, whichever side is positive.
    let (_, sphere) = report(&["1-x^2-y^2-z^2 = 0"]);
    assert_eq!([&sphere["pieces"], &sphere["hollows"]], [1, 0], "{sphere}");
}

#[test]
fn only_measures_that_are_asked_for_are_computed() {
    let rows = |options: &[&str]| {
        let (text, stderr, code) =
            run(&[&["x^2+y^2+z^2 <= 1", "--relative", "0.1"], options].concat());
        assert_eq!(code, Some(0), "{stderr}");
        let label = |line: &str| line.split("  ").next().unwrap_or_default().to_owned();
        text.lines().map(label).collect::<Vec<_>>().join(" ")
    };
    assert_eq!(rows(&["--volume"]), "volume");
    assert_eq!(rows(&["--area", "--centroid"]), "centroid area");
    assert_eq!(rows(&["--pieces"]), "shape");
    assert_eq!(rows(&["--ends"]), "from to");
    assert_eq!(rows(&["--inertia"]), "inertia ");
    assert_eq!(rows(&[]), "volume centroid inertia  from to area shape");
    let (_, ball) = report(&["x^2+y^2+z^2 <= 1", "--volume", "--shape"]);
    let keys: Vec<&String> = ball.as_object().expect("an object").keys().collect();
    let expected =
        ["boxes", "genus", "hollows", "name", "pieces", "shape_proven", "unproven", "volume"];
    let mut sorted = keys.clone();
    sorted.sort();
    assert_eq!(sorted, expected, "{ball}");
    assert_eq!(ball["pieces"], 1);
    // A solid without its mesh knows that hollows are possible.
    let (_, shell) = report(&["0.25 <= x^2+y^2+z^2 <= 1", "--shape"]);
    assert_eq!([&shell["pieces"], &shell["hollows"]], [1, 1], "{shell}");
}

/// A density is read with the names of the text. It weights the mass, and not the volume.
#[test]
fn a_density_weights_mass_centroid_and_inertia() {
    let ball = "x^2+y^2+z^2 <= 1";
    let holds = |value: &Value, exact: f64, of: &str| {
        let [low, high] = pair(value);
        assert!(low <= exact && exact <= high && high - low < 0.05, "{of}: {value}, {exact}");
    };
    let few = ["--relative", "0.01", "--mass", "--centroid", "--inertia", "--volume"];
    let (_, found) = report(&[&[ball, "--density", "x^2+y^2+z^2"], &few[..]].concat());
    holds(&found["mass"], 0.8 * PI, "mass");
    holds(&found["volume"], 4.0 / 3.0 * PI, "volume");
    // The integral of r^2 (x^2+y^2).
    holds(&found["inertia"]["zz"], 8.0 / 21.0 * PI, "inertia");
    let half = "0 <= x and x <= 1 and 0 <= y and y <= 1 and 0 <= z and z <= 1";
    let text = format!("a = 3 in [1, 5]; {half}");
    for (options, exact) in [(&[][..], 2.5), (&["-D", "a=1"], 1.5)] {
        let (_, found) = report(&[&[&*text, "--density", "1 + a x"], &few[..], options].concat());
        holds(&found["mass"], exact, "a cube");
        holds(&found["centroid"][0], (0.5 + (exact - 1.0) * 2.0 / 3.0) / exact, "a cube");
    }
    // A name that the density alone uses has a value, and a definition has a use.
    for options in
        [&["r = 2", "--density", "1 + r x"][..], &["", "-D", "a=2", "--density", "a x+1"]]
    {
        let text = [options[0], half].join("; ");
        let (_, stderr, code) = run(&[&[&*text], &options[1..], &few[..]].concat());
        assert!(code == Some(0) && !stderr.contains("never used"), "{stderr}");
    }
    let (_, stderr, _) =
        run(&[ball, "--density", "t", "--time", "2", "--mass", "--relative", "0.1"]);
    assert!(!stderr.contains("--time changes nothing"), "{stderr}");
    let (text, ..) = run(&[ball, "--density", "2", "--relative", "0.1"]);
    let labels: Vec<&str> = text.lines().map(|line| line.split(' ').next().unwrap()).collect();
    assert_eq!(
        labels,
        ["volume", "mass", "centroid", "inertia", "", "from", "to", "area", "shape"]
    );
    let (_, plain) = report(&[ball, "--relative", "0.1"]);
    assert_eq!(plain.get("mass"), None);
    for (density, expected) in [
        ("1/x", "the density is not proven to be bounded in the solid near (0"),
        ("ln(x)", "the density has no value in the solid near (-0."),
        ("1 + q", "--density:1:5"),
        ("x < 1", "--density:1:1"),
        ("1; 2", "--density:1:4"),
        ("x = 1", "--density:1:1"),
    ] {
        let (_, stderr, code) = run(&[ball, "--density", density, "--mass"]);
        assert!(code == Some(2) && stderr.contains(expected), "{density}: {stderr}");
    }
    let (_, stderr, code) = run(&[ball, "--mass"]);
    assert!(code == Some(2) && stderr.contains("--density <FORMULA>"), "{stderr}");
}

/// The area has proven bounds beside the estimate, and a lower one where nothing bounds it.
#[test]
fn an_area_has_bounds() {
    let (_, ball) = report(&["x^2+y^2+z^2 <= 1", "--area"]);
    let [low, high] = pair(&ball["area_bounds"]);
    assert!(low <= 4.0 * PI && 4.0 * PI <= high && high - low < 1e-3 * high, "{ball}");
    let (text, ..) = run(&["max(abs(x), abs(y), abs(z)) <= 1", "--area"]);
    let (bounds, estimate) = text.split_once("; ").expect(&text);
    assert!(bounds.starts_with("area        23.999999999") && bounds.len() < 50, "{text}");
    assert!(estimate.ends_with("estimated by two meshes\n"), "{text}");
    let steps = ["z = floor(x + 0.3) + 0.5", "--domain", "1", "--area", "--relative", "0.01"];
    let (text, ..) = run(&steps);
    assert!(text.starts_with("area        at least 3.3"), "{text}");
    let (_, steps) = report(&steps);
    assert!(steps["area_bounds"][0].as_f64() > Some(3.3) && steps["area_bounds"][1].is_null());
    // All measures at once come with the estimate alone, which is much faster.
    let (_, all) = report(&["x^2+y^2+z^2 <= 1"]);
    assert!(all["area_bounds"].is_null() && all["area"].is_number(), "{all}");
}

#[test]
fn equations_get_a_hint_how_to_write_the_solid() {
    for (arguments, expected) in [
        (&["x^2+y^2+z^2 = 1"][..], "measure 'x^2 + y^2 + z^2 <= 1' for the volume inside"),
        (
            &["shell(sphere(1), 0.1)", "--volume"],
            "measure 'shell(sphere(1), 0.1) <= 0' for the volume",
        ),
        (
            &["z = x^2+y^2; z = 1", "--domain", "2", "--volume"],
            "measure 'z >= x^2 + y^2 and z <= 1', or with other signs, for the volume between both",
        ),
        (&["z = x*y {x^2+y^2<1}", "--domain", "2", "--volume"], "use <= or >= in place of ="),
    ] {
        let (text, stderr, code) = run(arguments);
        assert_eq!(code, Some(0), "{stderr}");
        assert!(!text.contains("volume") && stderr.contains(expected), "{arguments:?}: {stderr}");
    }
    // The hint for two equations is a solid: that of a paraboloid up to z = 1.
    let (_, cup) = report(&["z >= x^2+y^2 and z <= 1", "--volume", "--relative", "0.01"]);
    let [low, high] = pair(&cup["volume"]);
    assert!(low <= PI / 2.0 && PI / 2.0 <= high && high - low < 0.02, "{cup}");
    for arguments in [&["x^2+y^2+z^2 = 1", "--shape"][..], &["x^2+y^2+z^2 <= 1", "--volume"]] {
        let (_, stderr, _) = run(arguments);
        assert!(!stderr.contains("no volume"), "{arguments:?}: {stderr}");
    }
}

#[test]
fn a_thin_wall_has_a_narrow_volume() {
    for (share, width) in [("0.01", 0.01), ("0.001", 0.001)] {
        let (_, wall) = report(&["shell(sphere(1), 0.001) <= 0", "--volume", "--relative", share]);
        let exact = 4.0 / 3.0 * PI * 1e-3 * (3.0 - 3e-3 + 1e-6);
        let [low, high] = pair(&wall["volume"]);
        assert!(low <= exact && exact <= high && high - low <= width * exact, "{wall}");
    }
}

/// A share above 1 does not make bounds narrow that begin at 0.
#[test]
fn bounds_that_are_not_narrow_say_why() {
    let (_, ball) = report(&["x^2+y^2+z^2 <= 1", "--volume", "--relative", "10"]);
    let [low, high] = pair(&ball["volume"]);
    let exact = 4.0 / 3.0 * PI;
    assert!(0.0 < low && low <= exact && exact <= high && high - low <= 10.0 * low, "{ball}");
    let (text, ..) = run(&["x^2+y^2+z^2 <= 1", "--volume", "--relative", "10"]);
    assert!(!text.contains("not narrower"), "{text}");
    let (text, ..) = run(&["x <= 0", "--domain", "1", "--volume", "--relative", "1e-15"]);
    assert!(text.contains(" (not narrower, because of rounding)\n"), "{text}");
}

/// Thinner than the cells of any mesh here.
const WIRE: [&str; 5] = ["x^2+y^2 <= 1e-10", "--domain", "1", "--area", "--shape"];

#[test]
fn a_solid_that_the_mesh_misses_is_not_said_to_be_nothing() {
    let (text, ..) = run(&WIRE);
    assert!(text.starts_with("area        0.0000..0.00"), "{text}");
    assert!(text.contains("; not estimated: the mesh has no triangle\n"), "{text}");
    assert!(text.contains("shape       not known: "), "{text}");
    let (_, wire) = report(&WIRE);
    for key in ["area", "area_change", "pieces", "hollows"] {
        assert!(wire[key].is_null(), "{key}: {wire}");
    }
    assert!(wire["unproven"].as_u64() > Some(0) && wire["shape_proven"] == false, "{wire}");
}

#[test]
fn mistakes_get_one_message() {
    for (arguments, expected) in [
        (
            &["z >= x^2+y^2"][..],
            "error: the surface is not proven to be bounded, so its measures may be infinite: \
             --domain=",
        ),
        (&["x^2+y^2+z^2 <= -1"], "error: nothing to measure: the surface is proven empty"),
        (&["x^2+y^2+z^2 <= 1", "--relative", "0"], "error: --relative needs a finite number"),
        (&["(x^2)^1.1+y^6+sin(9z)^2 <= 1", "--domain", "3", "--budget", "1e-9"], "not done within"),
    ] {
        let (text, stderr, code) = run(arguments);
        assert_eq!((code, &*text), (Some(2), ""), "{stderr}");
        assert!(stderr.contains(expected), "{arguments:?}: {stderr}");
    }
}
