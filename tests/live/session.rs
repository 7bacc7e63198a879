//! Tests of typing, errors, commands and the view of the live picture.

use super::live_support::{LIMIT, settled, start};
use std::sync::Arc;
use std::time::Instant;
use zeroset_live::{DocumentSource, Live, Rendering, Reply, Request};
use zeroset_render::model::render;
use zeroset_render::picture::{Precision, Settings};
use zeroset_scene::{gallery, view};
use zeroset_shade::Pattern;
use zeroset_trace::TraceOptions;

/// The picture that `zeroset render` draws from the same text and camera.
fn rendered(frame: &Rendering) -> Vec<u8> {
    let request = &frame.request;
    let options = zeroset_syntax::Options {
        overrides: &request.overrides,
        time: request.time,
        ..zeroset_syntax::Options::default()
    };
    let document = zeroset_syntax::read(&request.text, &options).expect("reads");
    let (region, _) = view::region(&document, frame.request.domain, None).expect("a region");
    let settings = &frame.request.settings;
    render(&document, &region, &frame.camera, settings).expect("renders").rgb
}

#[test]
fn what_is_typed_is_seen_and_what_is_entered_stays() {
    let live = start("", 48);
    assert!(live.snapshot().rendering.is_none());
    live.type_line("x^2+y^2+z^2 = 1");
    let sphere = settled(&live);
    assert_eq!(sphere.document.surfaces[0].echo, "x^2 + y^2 + z^2 = 1");
    assert!(!sphere.coarse && sphere.picture.rgb == rendered(&sphere));
    assert_eq!(live.text(), "");
    live.enter("x^2+y^2+z^2 = 1").expect("valid");
    live.enter("r = 0.5").expect("valid");
    live.enter(":add x^2+y^2 = r^2").expect("valid");
    assert_eq!(settled(&live).document.surfaces.len(), 2);
    // Changing a definition changes everything that depends on it.
    let before = settled(&live).picture.rgb.clone();
    live.enter(":set r = 0.9").expect("valid");
    assert_ne!(settled(&live).picture.rgb, before);
    assert_eq!(live.text(), "x^2+y^2+z^2 = 1\nr = 0.9\nx^2+y^2 = r^2");
    live.enter("z = x").expect("valid");
    assert_eq!(settled(&live).document.surfaces.len(), 1);
}

#[test]
fn other_light_traces_nothing() {
    let text = "x^4+y^4+z^4-5*(x^2+y^2+z^2)+11.8";
    let settings = Settings { width: 64, height: 64, ..Settings::default() };
    let antialias = Pattern::of(16).expect("a pattern");
    let settings = Settings { occlusion: true, antialias, ..settings };
    let live = Live::new(Request { text: text.into(), settings, ..Request::default() });
    let plain = settled(&live);
    assert!(plain.picture.rgb == rendered(&plain) && plain.picture.statistics.edge_rays > 0);
    assert_eq!(live.enter(":look night").ok(), Some(Reply::Done));
    let night = settled(&live);
    let (before, after) = (&plain.picture.statistics, &night.picture.statistics);
    assert_eq!((before.times.trace, before.work), (after.times.trace, after.work));
    assert!(night.picture.rgb == rendered(&night) && night.picture.rgb != plain.picture.rgb);
    assert!(night.command("out.png", false, zeroset_live::quote).contains(" --look night "));
    assert!(night.revision > plain.revision && night.picture.buffer == plain.picture.buffer);
    // Turning shadows on traces rays to the lights, but no rays from the eye.
    live.enter(":shadows on").expect("valid");
    let shadowed = settled(&live);
    assert_eq!(shadowed.picture.statistics.times.trace, after.times.trace);
    assert!(
        shadowed.picture.rgb == rendered(&shadowed) && shadowed.picture.rgb != night.picture.rgb
    );
    live.enter(":shadows off").expect("valid");
    assert!(settled(&live).picture.rgb == night.picture.rgb);
}

#[test]
fn a_mistake_keeps_the_last_good_picture_and_says_what_is_wrong() {
    let live = start("x^2+y^2+z^2 = 1", 32);
    let good = settled(&live);
    for (typed, expected) in [
        ("x^2+y^2+foo = 1", "`foo` is not defined"),
        ("x^2+(y^2+", "never closed"),
        ("3", "is constant"),
        ("sqrt(-1)", "defined nowhere"),
    ] {
        live.type_line(typed);
        assert!(live.wait(LIMIT));
        let view = live.snapshot();
        let fault = view.fault.expect(typed);
        assert!(fault.message().contains(expected), "{typed}: {}", fault.message());
        assert!(fault.render(false).contains(expected));
        let frame = view.rendering.expect("the last good picture");
        assert_eq!(frame.picture.rgb, good.picture.rgb, "{typed}");
    }
    let refusal = live.enter("x^2+y^2+foo = 1").expect_err("wrong");
    assert!(refusal.render(false).contains('^'), "no caret: {}", refusal.render(false));
    // A line that gives no surface is refused.
    for (line, expected) in [("3", "is constant: it is 3"), ("sqrt(-1)", "defined nowhere")] {
        let refusal = live.enter(line).expect_err(line).render(false);
        assert!(refusal.contains(expected), "{line}: {refusal}");
        assert_eq!(live.text(), "x^2+y^2+z^2 = 1");
    }
    live.type_line("");
    assert_eq!(settled(&live).picture.rgb, good.picture.rgb);
    assert_eq!(live.text(), "x^2+y^2+z^2 = 1");
}

#[test]
fn while_a_line_is_wrong_the_picture_before_is_finished_and_turned() {
    // This surface is so slow that the full picture is not finished at once.
    let live = start("(x^2+y^2+z^2-1)^2", 200);
    assert!(live.wait_for_news(LIMIT, 0), "there is no picture");
    live.type_line("x^2:y");
    assert!(live.wait(LIMIT));
    let seen = live.snapshot();
    assert!(seen.fault.is_some());
    let finished = seen.rendering.expect("a picture");
    assert!(!finished.coarse && finished.picture.buffer.width == 200);
    live.turn(|orbit| orbit.turn(30.0, 0.0, 200));
    assert!(live.wait(LIMIT));
    let seen = live.snapshot();
    let turned = seen.rendering.expect("a picture");
    assert!(turned.camera != finished.camera && !turned.coarse);
    // The error is still reported. The picture is not saved, since it does not show the typed line.
    assert!(seen.fault.is_some_and(|fault| fault.revision == turned.revision));
    assert!(live.finished(turned.revision, LIMIT).is_none());
    live.type_line("");
    assert!(live.wait(LIMIT));
    let seen = live.snapshot();
    assert!(seen.fault.is_none() && seen.rendering.is_some_and(|seen| !seen.coarse));
}

#[test]
fn typing_goes_on_from_the_last_text_that_could_be_read() {
    let live = start("r = 0.5\nx^2+y^2+z^2 = r", 32);
    settled(&live);
    // This is the text of a file that was half saved.
    live.load(DocumentSource::Typed, "r = 0.5\nx^2+(", true);
    assert!(live.wait(LIMIT) && live.snapshot().fault.is_some());
    live.type_line("z = r");
    assert_eq!(settled(&live).document.surfaces[0].echo, "z = r");
    live.enter("r = 0.7").expect("valid");
    settled(&live);
    assert_eq!(live.text(), "r = 0.7\nx^2+y^2+z^2 = r");
    // A new document replaces the old one even if it has an error.
    live.load(DocumentSource::Typed, "y^2+(", false);
    live.enter("x = y").expect("valid");
    assert_eq!(live.text(), "x = y");
}

#[test]
fn the_latest_edit_ends_the_work_for_those_before() {
    // This picture takes several seconds at least.
    let heavy = gallery::example("barth-decic").expect("there").text;
    let settings = Settings {
        options: TraceOptions { depth: 16, ..TraceOptions::default() },
        width: 3000,
        height: 3000,
        ..Settings::default()
    };
    let live = Live::new(Request { text: heavy.into(), settings, ..Request::default() });
    assert!(live.wait_for_news(LIMIT, 0), "no coarse picture");
    live.resize(40, 40);
    live.enter("domain 2").expect("valid");
    let started = Instant::now();
    live.enter("x+y+z").expect("valid");
    let frame = settled(&live);
    assert_eq!(frame.document.surfaces[0].echo, "x + y + z = 0");
    assert_eq!((frame.picture.buffer.width, frame.coarse), (40, false));
    println!("settled after {:?}", started.elapsed());
}

#[test]
fn large_pictures_come_coarse_first_and_are_then_refined() {
    let live = start(gallery::example("barth-sextic").expect("there").text, 1200);
    assert!(live.wait_for_news(LIMIT, 0));
    let first = live.snapshot().rendering.expect("a picture");
    assert!(first.coarse && first.picture.buffer.width == 150, "{}", first.summary());
    assert_eq!(first.picture.rgb.len(), 3 * 150 * 150);
    let last = settled(&live);
    assert_eq!((last.coarse, last.picture.buffer.width), (false, 1200));
    // The code is compiled once, and freed with the last frame that uses it.
    assert!(Arc::ptr_eq(&first.model, &last.model));
    let model = Arc::downgrade(&last.model);
    live.enter("x+y+z").expect("valid");
    settled(&live);
    drop((first, last));
    assert!(model.upgrade().is_none(), "the old code is still there");
}

#[test]
fn the_view_survives_edits_until_it_is_reset() {
    let live = start("domain 2\nx^2+y^2+z^2 = 1", 32);
    let eye = settled(&live).camera.eye();
    live.turn(|orbit| orbit.turn(40.0, 10.0, 100));
    let turned = settled(&live).camera;
    assert!((turned.eye() - eye).length() > 0.5);
    live.enter("x^2+y^4+z^2 = 1").expect("valid");
    assert_eq!(settled(&live).camera, turned);
    live.load(DocumentSource::Typed, "domain 2\nx^4+y^4+z^4 = 1", true);
    assert_eq!(settled(&live).camera, turned);
    // After a reset, the view is fitted to the visible part.
    let fresh = |text: &str| settled(&start(text, 32)).camera;
    live.reset_view();
    assert_eq!(settled(&live).camera, fresh("domain 2\nx^4+y^4+z^4 = 1"));
    live.enter(":view top").expect("valid");
    assert!(settled(&live).camera.basis().forward.z < -0.99);
    // A new document resets the view.
    live.load(DocumentSource::Typed, "domain 2\nx+y+z", false);
    assert_eq!(settled(&live).camera, fresh("domain 2\nx+y+z"));
}

#[test]
fn commands_are_answered() {
    let live = start("t = 0 in [0, 1]\nr = 2 in [0, 5]\nx^2+y^2 = r^2 + t", 32);
    settled(&live);
    let say = |line: &str| match live.enter(line) {
        Ok(Reply::Say(text)) => text,
        other => panic!("{line}: {other:?}"),
    };
    assert!(say(":help").contains(":domain 3") && say(":help").contains("smoothstep"));
    assert!(say(":help sin").contains("radians"));
    assert!(say(":help :save").contains("document"));
    assert!(say(":help color").contains("viridis"));
    assert!(say(":list").contains("r = 2 in [0, 5]"));
    assert!(say(":method").starts_with("* affine") && say(":method").contains("  knoll"));
    assert!(say(":precision").starts_with("precision auto (32 bits"));
    assert!(say(":tolerance 0.1").contains("within 0.1 pixels"));
    assert!(say(":depth").contains("the method affine does not use that, but knoll, raa do"));
    let exact = settled(&live);
    assert_eq!(exact.request.settings.options.tolerance, 0.1);
    assert_eq!(exact.picture.statistics.pixels.undecided, 0);
    assert!(exact.summary().contains(" · affine auto 0.1 px · 0 undecided"), "{}", exact.summary());
    assert!(say(":status").contains("method      affine, precision auto (32 bits"));
    let command = exact.command("out.png", false, zeroset_live::quote);
    assert!(command.contains(" --tolerance 0.1 ") && !command.contains("--method"), "{command}");
    assert_eq!(live.enter(":method knoll").ok(), Some(Reply::Done));
    assert!(say(":steps").contains("the method knoll does not use that, but sphere, march do"));
    live.enter(":precision f32").expect("a precision");
    assert!(say(":depth 12").starts_with("depth 12 of at most 20: slabs of at most "));
    assert_eq!(live.settings().options.depth, 12);
    let coarse = settled(&live);
    assert!(
        coarse
            .command("out.png", false, zeroset_live::quote)
            .contains(" --method knoll --precision f32 --max-depth 12")
    );
    assert!(say(":status").contains("undecided   this method proves misses"));
    // `f64` allows a greater depth than `f32`. Back in `f32`, the depth is reduced.
    assert!(say(":precision").starts_with("precision f32"));
    assert!(say(":precision f64").starts_with("precision f64"));
    assert!(say(":depth 33").contains("depth 33"));
    let fine = settled(&live);
    assert!(fine.picture.precision == Precision::F64 && fine.picture.rgb == rendered(&fine));
    assert!(
        fine.summary().contains(" f64 33 0.1 px · ") && say(":status").contains(", precision f64")
    );
    let command = fine.command("out.png", false, zeroset_live::quote);
    assert!(command.contains("--precision f64"), "{command}");
    assert!(say(":precision f32").ends_with("; depth 20 of at most 20"));
    assert!(say(":depth").starts_with("depth 20 of at most 20"));
    let coarse = settled(&live);
    assert!(
        coarse.picture.precision == Precision::F32 && coarse.request.settings.options.depth == 20
    );
    settled(&live);
    assert!(say(":status").contains("surface") && say(":status").contains("undecided"));
    live.enter(":set r = 3").expect("in range");
    assert!(live.text().contains("r = 3 in [0, 5]"));
    live.enter(":set r = 7").expect("out of range, which then holds it");
    assert!(live.text().contains("r = 7 in [0, 7]\n"));
    assert_eq!(live.enter(":time 0.5").ok(), Some(Reply::Done));
    assert!(say(":list").contains("t = 0.5 in [0, 1]"));
    let still = start("x+y+z", 16).enter(":time 1").expect("valid");
    assert!(
        matches!(still, Reply::Say(text) if text.contains("nothing that is drawn depends on the time"))
    );
    live.enter(":domain 4").expect("valid");
    assert_eq!(settled(&live).model.region().high().x, 4.0);
    assert_eq!(live.enter(":quit").ok(), Some(Reply::Quit));
    assert_eq!(live.enter(":load gyroid").ok(), Some(Reply::Load("gyroid".into())));
    for (line, expected) in [
        (":halp", "did you mean :help?"),
        (":help qqqqqq", "no function or command named 'qqqqqq'"),
        (":help sinn", "did you mean sin?"),
        (":method rays", "no method named 'rays'; there is affine, knoll"),
        (":look bright", "no look named 'bright'; there is studio, flat, paper, textbook, night"),
        (":shadows maybe", "usage: :shadows [on|off]"),
        (":steps 1", "steps are between 2 and 1048576"),
        (":domain 1,0,1,2,1,2", "is empty"),
        (":set x = 1", "x"),
        (":add 2 +", "missing"),
    ] {
        let before = live.text();
        let refusal = live.enter(line).expect_err(line).render(false);
        assert!(refusal.contains(expected), "{line}: {refusal}");
        assert_eq!(live.text(), before, "{line}");
    }
}

#[test]
fn definitions_may_come_first() {
    let live = start("", 32);
    assert!(matches!(live.enter("w = 2"), Ok(Reply::Say(_))));
    live.enter("x^2+y^2+z^2 = w^2").expect("now it is complete");
    settled(&live);
    assert_eq!(live.text(), "w = 2\nx^2+y^2+z^2 = w^2");
    // Alone, `r = 2` is a cylinder. Beside a line that uses r, it is a value.
    let live = start("", 32);
    live.enter("r = 2").expect("a cylinder");
    settled(&live);
    live.enter("x^2+y^2+z^2 = r^2").expect("a sphere");
    assert_eq!(settled(&live).document.parameters.len(), 1);
    assert_eq!(live.text(), "r = 2\nx^2+y^2+z^2 = r^2");
}

#[test]
fn ideas_that_are_left_out_are_told_and_repeated() {
    let settings = Settings {
        options: TraceOptions { tiles: false, ..TraceOptions::default() },
        width: 24,
        height: 24,
        ..Settings::default()
    };
    let live =
        Live::new(Request { text: "x^2+y^2+z^2 = 1".into(), settings, ..Request::default() });
    let alone = settled(&live);
    assert!(alone.summary().contains(" · affine auto no-tiles · "), "{}", alone.summary());
    assert!(
        alone.command("a.png", false, zeroset_live::quote).contains(" --no-tiles -o"),
        "{}",
        alone.command("a.png", false, zeroset_live::quote)
    );
    // The method `knoll` reads none of the options that were set.
    live.enter(":method knoll").expect("a method");
    assert!(!settled(&live).command("a.png", false, zeroset_live::quote).contains("--no-"));
}

#[test]
fn a_refused_value_leaves_the_one_from_the_command_line() {
    let settings = Settings { width: 32, height: 32, ..Settings::default() };
    let text = "r = 1\nx^2+y^2+z^2 = r^2".into();
    let overrides = vec![("r".to_owned(), "2".to_owned())];
    let live = Live::new(Request { text, overrides, settings, ..Request::default() });
    let before = settled(&live);
    for line in [":set r = (", ":set r = 1/0"] {
        live.enter(line).expect_err(line);
        live.enter(":view front").expect("a view");
        let after = settled(&live);
        assert_eq!(after.request.overrides, before.request.overrides, "{line}");
        live.enter(":view iso").expect("a view");
        assert_eq!(settled(&live).picture.rgb, before.picture.rgb, "{line}");
    }
    live.enter(":set r = 1.5").expect("a value");
    assert!(settled(&live).request.overrides.is_empty());
}

/// A line that is refused on one thread does not undo an edit by another thread.
#[test]
fn a_refused_value_undoes_nothing_that_another_thread_has_set() {
    let text: Arc<str> = "r = 1\nq = 1\nx^2+y^2+z^2 = r^2+q".into();
    let overrides = vec![("r".to_owned(), "2".to_owned()), ("q".to_owned(), "2".to_owned())];
    let settings = Settings {
        options: TraceOptions { depth: 4, ..TraceOptions::default() },
        width: 8,
        height: 8,
        ..Settings::default()
    };
    for _ in 0..100 {
        let request = Request {
            text: Arc::clone(&text),
            overrides: overrides.clone(),
            settings: settings.clone(),
            ..Request::default()
        };
        let live = Live::new(request);
        std::thread::scope(|scope| {
            scope.spawn(|| {
                (0..4).for_each(|_| drop(live.enter(":set r = 1/0").expect_err("no value")));
            });
            live.enter(":set q = 3").expect("a value");
        });
        let request = live.request();
        assert_eq!(request.overrides, [("r".to_owned(), "2".to_owned())]);
        assert_eq!(&*request.text, "r = 1\nq = 3\nx^2+y^2+z^2 = r^2+q");
    }
}

/// Simplifying a long formula does not lock the picture, so dragging and reading go on.
#[test]
fn a_long_formula_is_simplified_without_the_lock() {
    let live = start("x+y+z", 16);
    settled(&live);
    let long: Vec<String> =
        (1..600).map(|k| format!("sin({k}*x+y)*cos({k}*y-z)^2/(x^2+{k})")).collect();
    let long = long.join("+");
    let (entered, longest) = std::thread::scope(|scope| {
        let entering = scope.spawn(|| {
            let started = Instant::now();
            live.enter(&long).expect("valid");
            started.elapsed()
        });
        let mut longest = std::time::Duration::ZERO;
        while !entering.is_finished() {
            let started = Instant::now();
            live.turn(|orbit| orbit.turn(1.0, 0.0, 100));
            longest = longest.max(started.elapsed());
            std::thread::yield_now();
        }
        (entering.join().expect("entered"), longest)
    });
    println!("entered in {entered:?}, with waits of at most {longest:?}");
    assert!(longest < entered / 2, "a wait of {longest:?} in {entered:?}");
}

#[test]
fn a_picture_is_waited_for_only_until_another_is_asked_for() {
    let heavy = gallery::example("barth-decic").expect("there").text;
    let settings = Settings {
        options: TraceOptions { depth: 16, ..TraceOptions::default() },
        width: 3000,
        height: 3000,
        ..Settings::default()
    };
    let live = Live::new(Request { text: heavy.into(), settings, ..Request::default() });
    std::thread::scope(|scope| {
        let waiting = scope.spawn(|| live.finished(live.revision(), LIMIT).is_none());
        assert!(live.wait_for_news(LIMIT, 0), "no coarse picture");
        assert!(!waiting.is_finished());
        live.resize(20, 20);
        assert!(waiting.join().expect("no panic"), "that picture was never finished");
    });
    let picture = live.finished(live.revision(), LIMIT).expect("a small picture");
    assert_eq!((picture.picture.buffer.width, picture.coarse), (20, false));
}

#[test]
fn values_that_nothing_depends_on_are_noted() {
    let live = start("r = 1\nx^2+y^2+z^2 = r^2", 16);
    let say = |line: &str| match live.enter(line) {
        Ok(Reply::Say(text)) => text,
        other => panic!("{line}: {other:?}"),
    };
    assert!(say(":set q = 3").contains("nothing that is drawn depends on `q`"));
    assert!(say(":set t = 3").contains("nothing that is drawn depends on the time"));
    assert_eq!(live.enter(":set r = 2").ok(), Some(Reply::Done));
}

#[test]
fn a_definition_that_nothing_drawn_uses_is_told() {
    let live = start("x^2+y^2+z^2 = 1", 16);
    let pasted = "float crust(vec3 p) { return length(p) - 2.0; }";
    let said = "noted; `crust` is defined and never used";
    assert_eq!(live.enter(pasted).ok(), Some(Reply::Say(said.into())));
    assert_eq!(live.enter("crust(vec3(x, y, z)) = 0").ok(), Some(Reply::Done));
    assert_eq!(live.enter("crust(p) = length(p) - 3").ok(), Some(Reply::Done));
}
