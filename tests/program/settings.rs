//! The table of a picture's settings: each place where a setting can be typed takes the values of
//! its row, and no others.

use crate::cli_support::Sandbox;
use zeroset::{Scene, Settings};
use zeroset_live::{Live, Request};
use zeroset_style::{CHOICES, Setting, Values, settings};

const SPHERE: &str = "x^2+y^2+z^2 = 1";

/// Texts of values at the ends of a row's range, and of values beyond them.
fn values(row: &Setting) -> (Vec<String>, Vec<String>) {
    // All digits, so that the text is exactly the float.
    let exact = |value: f64| match value {
        _ if value.abs() < f64::MIN_POSITIVE && value != 0.0 => "-1e-300".to_owned(),
        _ => format!("{value:.60}"),
    };
    match &row.values {
        Values::Switch => {
            (["on", "off"].map(str::to_owned).into(), ["maybe", "2"].map(str::to_owned).into())
        }
        Values::Number { range, on, .. } => {
            let (least, most) = (*range.start(), *range.end());
            let words = on.map(|_| ["on", "off"].map(str::to_owned)).into_iter().flatten();
            (
                [least, most].map(exact).into_iter().chain(words).collect(),
                [least.next_down(), most.next_up()].map(exact).into(),
            )
        }
        Values::OneOf { all, .. } => {
            let others = (0..130).filter(|number| !all.contains(number));
            (
                all.iter().map(usize::to_string).collect(),
                others.map(|number| number.to_string()).collect(),
            )
        }
    }
}

/// Asserts that `accepts` accepts the row's values, and refuses others for the row's reason.
fn walk(place: &str, row: &Setting, accepts: &dyn Fn(&str) -> Result<(), String>) {
    let (valid, others) = values(row);
    for value in &valid {
        let result = accepts(value);
        assert!(result.is_ok(), "{place}: {} {value}: {result:?}", row.word);
    }
    for value in &others {
        let why = accepts(value).expect_err(&format!("{place}: {} {value}", row.word));
        assert!(why.contains(&row.values.to_string()), "{place}: {} {value}: {why}", row.word);
    }
}

#[test]
fn the_command_line_takes_the_values_of_the_table() {
    let place = Sandbox::new();
    let render = |more: &[&str]| {
        let run = place.run(&[&["render", SPHERE, "-o", "p.png", "--size", "4"], more].concat());
        if run.code == Some(0) { Ok(()) } else { Err(run.stderr) }
    };
    let with_flags: Vec<&Setting> = settings().filter(|row| !row.flag.is_empty()).collect();
    assert!(with_flags.len() > CHOICES.len());
    for row in with_flags {
        let flag = format!("--{}", row.flag);
        match &row.values {
            Values::Switch => {
                assert_eq!(render(&[&flag]), Ok(()), "{flag}");
                assert!(render(&[&format!("{flag}=on")]).is_err(), "{flag}");
            }
            Values::OneOf { .. } => {
                for (count, is_valid) in [("4", row.word == "antialias"), ("8", row.word == "bits")]
                {
                    assert_eq!(render(&[&flag, count]).is_ok(), is_valid, "{flag} {count}");
                }
            }
            Values::Number { .. } => walk(&flag, row, &|value| render(&[&flag, value])),
        }
    }
}

#[test]
fn documents_take_the_values_of_the_table() {
    let lines: Vec<&Setting> = settings().filter(|row| row.is_line).collect();
    assert!(lines.len() > 7);
    for row in lines {
        walk("a document", row, &|value| {
            let text = format!("{} {value}\n(cos t, sin t, t) for t in [0, 1]\n{SPHERE}", row.word);
            match zeroset_syntax::read(&text, &zeroset_syntax::Options::default()) {
                Ok(document) => {
                    let read = (row.get)(&document.picture.choices);
                    let typed = row.values.read(value, |text| text.parse().ok());
                    assert!(read.is_none_or(|read| Ok(read) == typed), "{text}: {read:?}");
                    assert_eq!(read.is_some(), CHOICES.contains(row), "{text}");
                    Ok(())
                }
                Err(errors) => Err(errors.render(None, &text, false)),
            }
        });
    }
}

#[test]
fn the_prompt_takes_the_values_of_the_table() {
    for row in settings().filter(|row| row.is_line && !matches!(row.word, "opacity" | "shadows")) {
        walk("the prompt", row, &|value| {
            let live = Live::new(Request::default());
            live.enter(SPHERE).expect("a surface");
            let entered = live.enter(&format!(":{} {value}", row.word));
            entered.map(drop).map_err(|refusal| refusal.render(false))
        });
    }
    // These two have commands of their own, which show how they are used if they refuse a value.
    for (command, word) in [(":opacity 1", "opacity"), (":shadows", "shadows")] {
        let row = settings().find(|row| row.word == word).expect("a row");
        walk("the prompt", row, &|value| {
            let live = Live::new(Request::default());
            live.enter(SPHERE).expect("a surface");
            let entered = live.enter(&format!("{command} {value}"));
            let usage = |why: String| {
                assert!(why.contains("usage: :"), "{why}");
                row.values.to_string()
            };
            entered.map(drop).map_err(|refusal| usage(refusal.render(false)))
        });
    }
}

#[test]
fn the_library_takes_the_values_of_the_table() {
    let scene = Scene::read(SPHERE).expect("a scene");
    let render = |settings: &Settings| match scene.render(settings) {
        Ok(_) => Ok(()),
        Err(error) => Err(error.to_string()),
    };
    let names: Vec<&str> = Settings::choices().map(|(name, _)| name).collect();
    assert!(names.iter().copied().eq(CHOICES.iter().map(|row| row.word)), "{names:?}");
    for row in CHOICES {
        walk("the library", row, &|value| {
            let settings =
                Settings::new(4, 4).set(row.word, value).map_err(|why| why.to_string())?;
            assert!(settings != Settings::new(4, 4), "{} {value} changes nothing", row.word);
            render(&settings)
        });
    }
    for row in settings().filter(|row| matches!(row.values, Values::OneOf { .. })) {
        walk("the library", row, &|value| {
            let (count, settings) = (value.parse().expect("a number"), Settings::new(4, 4));
            render(&match row.word {
                "antialias" => settings.antialias(count),
                "bits" => settings.bits(count),
                other => panic!("{other} has no method here"),
            })
        });
    }
    // Methods take numbers, which are checked later.
    for value in [0.0_f64.next_down(), 1.0_f64.next_up(), f64::NAN] {
        for (word, settings) in [
            ("haze", Settings::new(4, 4).haze(value)),
            ("ambient", Settings::new(4, 4).ambient(value)),
        ] {
            let why = render(&settings).expect_err(word);
            assert!(why.starts_with(&format!("{word} must be ")), "{value}: {why}");
        }
    }
    assert!(Settings::new(4, 4).set("fog", "on").is_err());
}
