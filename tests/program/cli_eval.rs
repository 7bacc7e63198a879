//! `zeroset eval`: JSON lines in and out.

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
    let found = answers(&["-"], &input);
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
    let run = place.run_with(&["eval", "-"], b"{\"f\":\"\xff\"}\n").ok();
    assert!(run.json()["error"].is_string());
}
