//! `zeroset eval`: JSON lines in and out, and arrays.

use crate::cli_support::Sandbox;
use serde_json::{Value, json};

fn answers(arguments: &[&str], input: &str) -> Vec<Value> {
    let place = Sandbox::new();
    let all = [&["eval"], arguments].concat();
    let run = place.run_with(&all, input.as_bytes()).ok();
    run.text().lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
}

fn answer(request: &Value) -> Value {
    answers(&["-"], &request.to_string()).remove(0)
}

#[test]
fn points_have_values_and_gradients() {
    let found = answer(&json!({"f": "x^2*y - z", "at": [3, 2, 1]}));
    let expected = json!({
        "value": 17.0, "grad": [12.0, 9.0, -1.0], "precision": "f32", "defined": true, "empty": false,
    });
    assert_eq!(found, expected);
}

#[test]
fn a_slope_without_bounds_has_its_sign() {
    for (formula, at, slope) in [
        ("asin(x)", 1, "inf"),
        ("asin(x)", -1, "inf"),
        ("acos(x)", 1, "-inf"),
        ("acos(x)", -1, "-inf"),
        ("sqrt(1 - x)", 1, "-inf"),
    ] {
        for precision in ["f32", "f64"] {
            for arguments in [&["-"][..], &["-", "--reference"]] {
                let line = json!({"f": formula, "at": [at, 0, 0], "precision": precision});
                let found = answers(arguments, &line.to_string()).remove(0);
                assert_eq!(found["grad"][0], slope, "{formula} at {at}: {found}");
            }
        }
    }
}

#[test]
fn a_point_where_there_is_no_value_is_told_from_others() {
    // Each formula is undefined at 0, where rounding alone could give it a value.
    for formula in ["1/x", "atan(1/x)", "max(-1/x, 5)", "min(sqrt(-1-x^2), 3)", "0*ln(x-1)"] {
        for precision in ["f32", "f64"] {
            for arguments in [&["-"][..], &["-", "--reference"]] {
                let line = json!({"f": formula, "at": [0, 0, 0], "precision": precision});
                let found = answers(arguments, &line.to_string()).remove(0);
                assert_eq!((&found["empty"], &found["defined"]), (&json!(true), &json!(false)));
                assert_eq!(found["value"], "nan", "{formula}: {found}");
                assert_eq!(found["grad"], json!(["nan", "nan", "nan"]), "{formula}: {found}");
            }
        }
    }
    let found = answer(&json!({"f": "atan(1/x)", "at": [1, 0, 0]}));
    assert_eq!((&found["empty"], &found["defined"]), (&json!(false), &json!(true)), "{found}");
    // The point is not 0, but rounds to 0 in f32, where the logarithm is undefined.
    let found = answer(&json!({"f": "ln(x)", "at": [7e-61, 0, 0]}));
    assert_eq!((&found["empty"], &found["defined"]), (&json!(false), &json!(false)), "{found}");
    // At this point the bounds of sin contain 0, so nothing is proven.
    let found = answer(&json!({"f": "1/sin(x)", "at": [1e20, 0, 0]}));
    assert_eq!((&found["empty"], &found["defined"]), (&json!(false), &json!(false)), "{found}");
}

#[test]
fn boxes_have_bounds_and_facts() {
    let all = answer(&json!({"f": "x^2", "box": [[-1, 2], [0, 0], [0, 0]]}));
    let bounds = json!({"lo": 0.0, "hi": 4.0, "precision": "f32"});
    let facts = json!({"empty": false, "defined": true, "continuous": true});
    for (key, value) in [&bounds, &facts].iter().flat_map(|part| part.as_object().expect("keys")) {
        assert_eq!(&all[key], value, "{key}");
    }
    assert_eq!(all.as_object().map(serde_json::Map::len), Some(6));
    let part = answer(&json!({"f": "sqrt(x)", "box": [[-1, 4], [0, 0], [0, 0]]}));
    assert_eq!((&part["defined"], &part["empty"]), (&json!(false), &json!(false)));
    let none = answer(&json!({"f": "sqrt(x)", "box": [[-4, -1], [0, 0], [0, 0]]}));
    assert_eq!(none["empty"], true);
    // The function is undefined in this box, but its upper bound is not −∞.
    let power = answer(&json!({"f": "0^x*x", "box": [[-2, -1], [0, 0], [0, 0]]}));
    assert!(power["empty"] == true && power["hi"] != "-inf", "{power}");
    let jump = answer(&json!({"f": "floor(x)", "box": [[0.5, 1.5], [0, 0], [0, 0]]}));
    assert_eq!((&jump["defined"], &jump["continuous"]), (&json!(true), &json!(false)));
    let unbounded = answer(&json!({"f": "exp(x)", "box": [["-inf", "inf"], [0, 0], [0, 0]]}));
    assert_eq!((&unbounded["lo"], &unbounded["hi"]), (&json!(0.0), &json!("inf")));
}

#[test]
fn bounds_that_are_no_f32_are_rounded_outward() {
    let found = answer(&json!({"f": "x", "box": [[0.1, 0.1], [0, 0], [0, 0]]}));
    let end = |key: &str| found[key].as_f64().expect("a number");
    assert!(end("lo") < 0.1 && 0.1 < end("hi"));
    assert_eq!(end("lo") as f32, (end("hi") as f32).next_down());
}

#[test]
fn in_double_precision_numbers_stay_as_they_are() {
    let line = json!({"f": "x", "box": [[0.1, 0.1], [0, 0], [0, 0]], "precision": "f64"});
    let found = answer(&line);
    assert_eq!((&found["lo"], &found["hi"]), (&json!(0.1), &json!(0.1)));
    assert_eq!(found["precision"], "f64");
    // The flag sets the precision of lines without one.
    let square = |precision: Option<&str>| {
        let mut line = json!({"f": "x^2 - 1e8", "box": [[1e4, 1e4], [0, 0], [0, 0]]});
        if let Some(precision) = precision {
            line["precision"] = precision.into();
        }
        line["box"][0][1] = 10_000.000_001.into();
        let found = answers(&["-", "--precision", "f64"], &line.to_string()).remove(0);
        found["hi"].as_f64().expect("a bound") - found["lo"].as_f64().expect("a bound")
    };
    assert!(square(None) < 0.021 && square(Some("f64")) < 0.021, "{}", square(None));
    assert!(square(Some("f32")) > 1.0, "{}", square(Some("f32")));
    let value = answers(&["-", "--precision", "f64"], r#"{"f":"x/3","at":[1,0,0]}"#).remove(0);
    assert_eq!(value["value"], (1.0_f64 / 3.0).next_up());
}

#[test]
fn numbers_are_read_and_written_exactly() {
    let exact = "0x1.fffffep-3";
    let value = f64::from(0.25_f32.next_down());
    assert_eq!(answer(&json!({"f": "x", "at": [exact, 0, 0]}))["value"], value);
    assert_eq!(answer(&json!({"f": "x", "at": [value, 0, 0]}))["value"], value);
    assert_eq!(answer(&json!({"f": "x", "at": ["-inf", 0, 0]}))["value"], "-inf");
    assert_eq!(answer(&json!({"f": "x", "at": ["nan", 0, 0]}))["value"], "nan");
}

#[test]
fn compiled_code_and_the_reference_agree() {
    let formulas =
        ["x*y - sin(z)", "x^3/y + exp(z)", "min(x, max(y, z)) - floor(x)", "x^y - ln(z)"];
    let mut input = String::new();
    for formula in formulas {
        for k in 0..20 {
            let a = f64::from(k) * 0.37 - 3.0;
            input += &json!({"f": formula, "at": [a, a * 0.5 + 1.0, a * a]}).to_string();
            input += "\n";
            let bounds = [[a, a + 0.7], [-1.0, a.abs()], [0.0, 2.0]];
            input += &json!({"f": formula, "box": bounds}).to_string();
            input += "\n";
        }
    }
    for precision in ["f32", "f64"] {
        let compiled = answers(&["-", "--precision", precision], &input);
        assert_eq!(compiled.len(), 160);
        assert!(compiled.iter().all(|answer| answer["precision"] == precision));
        assert_eq!(compiled, answers(&["-", "--reference", "--precision", precision], &input));
    }
}

#[test]
fn a_bad_line_is_answered_and_the_next_one_too() {
    let long = format!("{{\"f\":\"{}\",\"at\":[0,0,0]}}", "x+".repeat(3_000_000));
    let wrong = [
        "nonsense",
        "[]",
        "{}",
        r#"{"f":"x"}"#,
        r#"{"f":3,"at":[0,0,0]}"#,
        r#"{"f":"x+","at":[0,0,0]}"#,
        r#"{"f":"x\ny","at":[0,0,0]}"#,
        r#"{"f":"x","at":[0,0]}"#,
        r#"{"f":"x","at":[0,0,"z"]}"#,
        r#"{"f":"x","at":[0,0,0],"box":[[0,1],[0,1],[0,1]]}"#,
        r#"{"f":"x","box":[[1,0],[0,1],[0,1]]}"#,
        r#"{"f":"x","box":[["inf","inf"],[0,1],[0,1]]}"#,
        r#"{"f":"x","box":[["nan",1],[0,1],[0,1]]}"#,
        r#"{"f":"x","at":[0,0,0],"typo":1}"#,
        r#"{"f":"x","at":[0,0,0],"precision":"f16"}"#,
        &long,
    ];
    let input: String =
        wrong.iter().flat_map(|line| [line, "\n", "\n{\"f\":\"x\",\"at\":[1,0,0]}\n"]).collect();
    let run = Sandbox::new().run_with(&["eval", "-"], input.as_bytes());
    // The exit code tells of errors, and so does a note.
    assert_eq!(run.code, Some(2));
    assert!(run.stderr.contains("16 of 32 lines are answered by an error"), "{}", run.stderr);
    let found: Vec<Value> =
        run.text().lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
    assert_eq!(found.len(), 2 * wrong.len());
    for (pair, line) in found.chunks(2).zip(wrong) {
        let shown = &line[..line.len().min(60)];
        assert!(pair[0]["error"].as_str().is_some_and(|e| e.len() < 300), "{shown}: {}", pair[0]);
        assert_eq!(pair[1]["value"], 1.0, "after {shown}");
    }
}

#[test]
fn bytes_that_are_no_text_are_answered() {
    let place = Sandbox::new();
    let run = place.run_with(&["eval", "-"], b"{\"f\":\"\xff\"}\n");
    assert_eq!(run.code, Some(2));
    assert!(run.json()["error"].is_string());
}

#[test]
fn a_name_of_the_gallery_stands_for_its_formula() {
    let found = answer(&json!({"f": "heart-taubin", "at": [0, 0, 0]}));
    assert_eq!(found["value"], -1.0, "{found}");
    // As the argument, it is the formula of lines without one.
    let lines =
        "{\"at\":[0,0,0]}\n{\"at\":[2,0,0],\"precision\":\"f64\"}\n{\"f\":\"x\",\"at\":[7,0,0]}\n";
    let found = answers(&["heart-taubin"], lines);
    assert_eq!((&found[0]["value"], &found[2]["value"]), (&json!(-1.0), &json!(7.0)));
    assert_eq!(found[1]["precision"], "f64");
    // A model of so many parts that its gradient is found by parts of space.
    let line = json!({"f": "rook", "at": [1, 2, 0]}).to_string();
    assert_eq!(answers(&["-"], &line), answers(&["--reference"], &line));
    let place = Sandbox::new();
    let run = place.run(&["eval", "hart-taubin"]);
    assert_eq!(run.code, Some(2));
    assert!(run.stderr.contains("did you mean 'heart-taubin'"), "{}", run.stderr);
    let run = place.run_with(&["eval"], b"{\"f\":\"hart-taubin\",\"at\":[0,0,0]}");
    assert_eq!(run.code, Some(2));
    let error = run.json()["error"].to_string();
    assert!(error.contains("did you mean 'heart-taubin' of the gallery"), "{error}");
}

#[test]
fn the_argument_may_be_a_formula_or_a_file() {
    let place = Sandbox::new();
    place.write("plane.zset", "r = 1\nx + r");
    place.write("lines.jsonl", "\n {\"f\":\"x\",\"at\":[3,0,0]}\n");
    place.write("nothing.jsonl", "");
    let value = |arguments: &[&str]| {
        let run = place.run_with(&[&["eval"], arguments].concat(), b"{\"at\":[2,0,0]}").ok();
        run.json()["value"].as_f64()
    };
    assert_eq!(value(&["x^2"]), Some(4.0));
    assert_eq!(value(&["-x"]), Some(-2.0));
    assert_eq!(value(&["plane.zset"]), Some(3.0));
    assert_eq!(value(&["plane.zset", "-D", "r=5"]), Some(7.0));
    assert_eq!(value(&["lines.jsonl"]), Some(3.0));
    assert!(place.run(&["eval", "nothing.jsonl"]).ok().stdout.is_empty());
    for (arguments, why) in [
        (&["x +"][..], "a value is missing after `+`"),
        (&["none.zset"], "there is no file 'none.zset'"),
        (&["x\ny", "--at", "-"], "--at needs exactly one formula, not 2"),
        (&["curve x^2+y^2 = 1, z = 0"], "there is no formula to evaluate"),
        (&["x", "-D", "q=1"], "q"),
        (&["x", "-D", "q"], "-D 'q' is not of the form name=value"),
        (&["x", "--time", "soon"], "--time 'soon' is not a finite number"),
        (&["."], "is a directory"),
    ] {
        let run = place.run_with(&[&["eval"], arguments].concat(), b"{\"at\":[2,0,0]}");
        assert_eq!(run.code, Some(2), "{arguments:?}");
        assert!(run.stdout.is_empty() && run.stderr.contains(why), "{why}: {}", run.stderr);
    }
}

#[test]
fn a_line_names_one_of_several_formulas_by_its_number() {
    let place = Sandbox::new();
    let ask =
        |line: &str| place.run_with(&["eval", "x^2 = 3\nr = 2\nx + r*y <= 1"], line.as_bytes());
    let value = |line: &str| ask(line).ok().json()["value"].as_f64();
    assert_eq!(value(r#"{"at":[2,1,0],"surface":1}"#), Some(1.0));
    assert_eq!(value(r#"{"at":[2,1,0],"surface":2}"#), Some(3.0));
    for (key, why) in [
        ("", "there are 2 formulas: add the key \"surface\", from 1 to 2"),
        (r#","surface":0"#, "\"surface\" is a number from 1 to 2, not 0"),
        (r#","surface":3"#, "\"surface\" is a number from 1 to 2, not 3"),
        (r#","surface":"x""#, "\"surface\" is a number from 1 to 2, not \"x\""),
    ] {
        let run = ask(&format!("{{\"at\":[2,1,0]{key}}}"));
        assert_eq!(run.code, Some(2));
        assert_eq!(run.json()["error"].as_str(), Some(why));
    }
}

#[test]
fn a_time_without_a_value_is_an_error() {
    let place = Sandbox::new();
    let line = "{\"f\":\"sin(t) + x\",\"at\":[1,0,0]}\n{\"f\":\"x\",\"at\":[1,0,0]}";
    let run = place.run_with(&["eval"], line.as_bytes());
    assert_eq!(run.code, Some(2));
    assert!(run.stderr.contains("1 of 2 lines are answered by an error"), "{}", run.stderr);
    assert!(run.text().contains("depends on the time `t`, which has no value"), "{}", run.text());
    assert!(run.text().lines().nth(1).is_some_and(|line| line.contains("\"value\":1.0")));
    let run = place.run_with(&["eval", "x + t"], b"{\"at\":[1,0,0]}");
    assert_eq!(run.code, Some(2));
    assert!(run.stdout.is_empty() && run.stderr.contains("--time 0.5"), "{}", run.stderr);
    let value = |arguments: &[&str], line: &Value| answers(arguments, &line.to_string()).remove(0);
    let line = json!({"f": "x + t", "at": [1, 0, 0]});
    assert_eq!(value(&["--time", "1/2"], &line)["value"], 1.5);
    assert_eq!(value(&["-D", "t=2"], &line)["value"], 3.0);
    assert_eq!(value(&["-"], &json!({"f": "x + t; t = 4", "at": [1, 0, 0]}))["value"], 5.0);
    // The time may color the surface, and be the parameter of a function.
    assert_eq!(value(&["-"], &json!({"f": "color viridis(t)\nx", "at": [1, 0, 0]}))["value"], 1.0);
    let square = json!({"f": "f(t) = t^2\nf(x)", "at": [3, 0, 0]});
    assert_eq!(value(&["-"], &square)["value"], 9.0);
}

/// An array of floats in numpy's format, with all axes in one of two orders.
fn npy(descr: &str, fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let mut header =
        format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}");
    header += &" ".repeat(63 - (10 + header.len()) % 64);
    header.push('\n');
    let length = (header.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], header.as_bytes(), data].concat()
}

fn floats<T: npyz::Deserialize>(place: &Sandbox, name: &str) -> (Vec<u64>, Vec<T>) {
    let bytes = std::fs::read(place.path(name)).expect("written");
    let array = npyz::NpyFile::new(&bytes[..]).expect("an array");
    (array.shape().to_vec(), array.into_vec().expect("of this type"))
}

#[test]
fn arrays_of_points_give_arrays_of_values() {
    let place = Sandbox::new();
    // More points than a batch has, some without a value.
    let points: Vec<[f64; 3]> = (0..50)
        .map(|k| f64::from(k) * 0.37 - 3.0)
        .map(|a| [a, a * 0.5 + 1.0, a * a])
        .chain([[0.0; 3], [f64::NAN, 1.0, 1.0], [1.0, f64::INFINITY, 1.0]])
        .collect();
    let rows: Vec<f64> = points.as_flattened().to_vec();
    let columns: Vec<f64> =
        (0..3).flat_map(|axis| points.iter().map(move |point| point[axis])).collect();
    let little = |numbers: &[f64]| numbers.iter().flat_map(|n| n.to_le_bytes()).collect::<Vec<_>>();
    let big = |numbers: &[f64]| numbers.iter().flat_map(|n| n.to_be_bytes()).collect::<Vec<_>>();
    place.write("c.npy", npy("<f8", false, "(53, 3)", &little(&rows)));
    place.write("fortran.npy", npy("<f8", true, "(53, 3)", &little(&columns)));
    place.write("big.npy", npy(">f8", true, "(53, 3)", &big(&columns)));
    let formula = "x*y - atan(1/x) + ln(z)";
    for precision in ["f32", "f64"] {
        // The values are those of lines.
        let run = |more: &[&str]| {
            let fixed = ["eval", formula, "--precision", precision, "--at"];
            place.run(&[&fixed[..], more].concat()).ok()
        };
        let lines = run(&["c.npy"]);
        let lines: Vec<Value> =
            lines.text().lines().map(|line| serde_json::from_str(line).expect("JSON")).collect();
        assert_eq!(lines.len(), 53);
        for file in ["c.npy", "fortran.npy", "big.npy"] {
            let silent = run(&[file, "-o", "values.npy", "--gradient", "gradients.npy"]);
            assert!(silent.stdout.is_empty() && silent.stderr.is_empty(), "{}", silent.stderr);
            let read = |name| -> (Vec<u64>, Vec<f64>) {
                if precision == "f64" {
                    return floats(&place, name);
                }
                let (shape, numbers) = floats::<f32>(&place, name);
                (shape, numbers.into_iter().map(f64::from).collect())
            };
            let ((shape, values), (wide, gradients)) = (read("values.npy"), read("gradients.npy"));
            assert_eq!((&shape[..], &wide[..]), (&[53][..], &[53, 3][..]));
            for (k, point) in points.iter().enumerate() {
                let is_defined = lines[k]["empty"] == false && point.iter().all(|c| c.is_finite());
                assert_eq!(values[k].is_nan(), !is_defined, "{file}, {k}");
                if is_defined {
                    assert_eq!(lines[k]["value"], values[k], "{file}, {k}");
                    assert_eq!(lines[k]["grad"], json!(gradients[3 * k..][..3]), "{file}, {k}");
                }
            }
        }
    }
    // Points of a picture, in any shape, lie on its surface.
    let sphere = "x^2+y^2+z^2 = 1";
    place.run(&["render", sphere, "--points", "p.npy", "--size", "9x7"]).ok();
    place.run(&["eval", sphere, "--at", "p.npy", "-ov.npy", "--precision", "f64"]).ok();
    let (shape, values) = floats::<f64>(&place, "v.npy");
    assert_eq!(shape, [7, 9]);
    assert!(values.iter().filter(|value| !value.is_nan()).count() > 10);
    assert!(values.iter().all(|value| value.is_nan() || value.abs() < 0.3), "{values:?}");
    // The formula may come from standard input, too.
    let run = place.run_with(&["eval", "-", "--at", "c.npy", "-o", "v.npy"], b"x + 1").ok();
    assert!(run.stdout.is_empty());
    assert_eq!(floats::<f32>(&place, "v.npy").1[50], 1.0);
    // Standard input and output serve for arrays.
    let bytes = std::fs::read(place.path("c.npy")).expect("written");
    let run = place.run_with(&["eval", "x", "--at", "-", "-o", "-"], &bytes).ok();
    let array = npyz::NpyFile::new(&run.stdout[..]).expect("an array");
    assert_eq!(array.shape(), [53]);
}

#[test]
fn arrays_that_hold_no_points_are_refused() {
    let place = Sandbox::new();
    let whole = npy("<f8", false, "(2, 3)", &[0; 48]);
    place.write("good.npy", &whole);
    place.write("header.npy", &whole[..40]);
    place.write("data.npy", &whole[..whole.len() - 1]);
    place.write("huge.npy", npy("<f8", false, "(99999999999999, 99999999999999, 3)", &[]));
    place.write("large.npy", npy("<f8", false, "(9999999999999, 3)", &[]));
    place.write("object.npy", npy("|O", false, "(2, 3)", b"\x80\x03]."));
    place.write("integers.npy", npy("<i8", false, "(2, 3)", &[0; 48]));
    place.write("turned.npy", npy("<f8", false, "(3, 2)", &[0; 48]));
    place.write("text.npy", "1 2 3\n");
    place.write("empty.npy", "");
    place.write("lines.jsonl", "{\"f\":\"x\",\"at\":[3,0,0]}\n");
    let at = |file: &'static str| ["x", "--at", file, "-o", "v.npy"];
    for (arguments, why) in [
        (&at("header.npy")[..], "'header.npy': it ends within its header"),
        (&at("data.npy"), "'data.npy': it ends after 1 of 2 points"),
        (&at("huge.npy"), "too large for any memory"),
        (&at("large.npy"), "it ends after 0 of 9999999999999 points"),
        (&at("object.npy"), "its type is |O, and points need float32 or float64"),
        (&at("integers.npy"), "save points.astype(float)"),
        (&at("turned.npy"), "its shape is (3, 2), and points need (N, 3)"),
        (&at("text.npy"), "'text.npy': it is not an array of NumPy"),
        (&at("empty.npy"), "'empty.npy': it is not an array of NumPy"),
        (&at("none.npy"), "cannot read 'none.npy'"),
        (&at("."), "'.' is a directory"),
        (&["x + t", "--at", "good.npy", "-o", "v.npy"], "the time `t`"),
        (&["x", "--at", "good.npy", "-o", "none/v.npy"], "there is no directory 'none'"),
        (&["x", "--at", "good.npy", "-o", "v.npy", "--gradient", "v.npy"], "two outputs"),
        (&["x", "--at", "good.npy", "-o", "-", "--gradient", "-"], "only one thing"),
        (&["--at", "good.npy"], "--at needs a formula"),
        (&["lines.jsonl", "--at", "good.npy"], "has lines of JSON; --at needs a formula"),
        (&["-", "--at", "-"], "cannot both come from standard input"),
        (&["x", "-o", "v.npy"], "--at"),
    ] {
        let run = place.run(&[&["eval"], arguments].concat());
        assert_eq!(run.code, Some(2), "{arguments:?}: {}", run.stderr);
        assert!(run.stdout.is_empty() && run.stderr.contains(why), "{why}: {}", run.stderr);
        assert!(!place.path("v.npy").exists(), "{arguments:?}");
    }
}
