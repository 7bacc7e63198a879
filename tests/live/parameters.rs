//! Sliders and time change the picture without compiling. A fresh compilation gives the same one.

use super::live_support::{LIMIT, settled, start};
use std::time::Duration;
use zeroset_live::{DocumentSource, Rendering};
use zeroset_render::model::render;
use zeroset_scene::view;
use zeroset_syntax::Options;

/// Asserts that a fresh compilation gives the same colors, statuses and painted distances.
fn assert_as_compiled_afresh(frame: &Rendering) {
    let request = &frame.request;
    let options = Options { time: request.time, ..Options::default() };
    let document = zeroset_syntax::read(&request.text, &options).expect("reads");
    let (region, _) = view::region(&document, request.domain, None).expect("a region");
    // After a slider moves, the previous domain stays as long as the surface fits into it.
    let before = *frame.model.region();
    let inside = before.low().cmple(region.low()).all() && region.high().cmple(before.high()).all();
    assert!(region == before || frame.searched.is_some() && inside, "{}", request.text);
    let region = before;
    let fresh = render(&document, &region, &frame.camera, &request.settings);
    let fresh = fresh.expect("renders");
    assert!(fresh.rgb == frame.picture.rgb, "{}: other colors", request.text);
    assert!(fresh.buffer.status == frame.picture.buffer.status, "{}: other statuses", request.text);
    assert!(fresh.buffer.drawn == frame.picture.buffer.drawn, "{}: elsewhere", request.text);
}

/// Enters each line in turn. Returns for each line whether the code was reused.
fn code_reused(text: &str, lines: &[&str]) -> Vec<bool> {
    let live = start(text, 28);
    let mut last = settled(&live);
    assert!(!last.model.is_rebound());
    let enter = |line: &&str| {
        live.enter(line).expect(line);
        let next = settled(&live);
        assert_as_compiled_afresh(&next);
        let shared =
            next.model.is_rebound() && next.model.program().made() == last.model.program().made();
        assert_eq!(shared, next.model.is_rebound(), "{line}");
        last = next;
        shared
    };
    lines.iter().map(enter).collect()
}

#[test]
fn sliders_and_time_move_within_their_ranges_without_compiling() {
    for (text, lines) in [
        ("domain 5\nr = 2 in [0, 5]\nx^2+y^2+z^2 = r^2", &[":set r = 3", "r = 0.1 in [0, 5]"][..]),
        ("domain 2\nr = 1 in [-2, 2]\nsqrt(r^2 - x^2)*y = z", &[":set r = 1.5", ":set r = -0.7"]),
        ("domain 2\nr = 1 in [0, 2]\nr/x - y + sin(r z)", &[":set r = 1/3", ":set r = 0"]),
        (
            "domain 2\na = 1 in [0, 2]; b = 2 in [1, 3]\nx/a + y/b = z",
            &[":set a = 2", ":set b = 1"],
        ),
        ("t = 0.5 in [0, 1]\nx^2+y^2+z^2 = 1+t", &[":time 0.75", ":time 0.1"]),
        ("domain 2\nsin(x+t)+y = z", &[":time 1", ":time -2.5"]),
        // With each value, the surface fits into a domain found earlier.
        ("r = 2 in [0, 5]\nx^2+y^2+z^2 = r^2", &[":set r = 1", ":set r = 1.9", ":set r = 0.6"]),
        ("r = 1 in [1, 4]\nx^2+y^2+z^2 <= 1+0*r", &[":set r = 4", ":set r = 2"]),
        // Each value needs another domain: the previous domain is too small or far too large.
        ("r = 2 in [0, 5]\nx^2+y^2+z^2 = r^2", &[":set r = 0.1", ":set r = 3", ":set r = 5"]),
    ] {
        assert_eq!(code_reused(text, lines), vec![true; lines.len()], "{text}");
    }
}

#[test]
fn what_other_code_is_needed_for_is_compiled() {
    for (text, line) in [
        // In the first text, the new value is out of range. In the second one, `r` has no range.
        ("domain 2\nr = 2 in [0, 5]\nx^2+y^2+z^2 = r^2", ":set r = 7"),
        ("domain 2\nr = 2\nx^2+y^2+z^2 = r^2", ":set r = 1"),
        // This value is an exponent, which selects the operation.
        ("domain 2\nn = 2 in [1, 5]\nx^n+y^2+z^2 = 1", ":set n = 3"),
        ("x^2+y^2+z^2 = 1+t", ":time 3"),
        ("domain 2\nr = 2 in [0, 5]\nx^2+y^2+z^2 = r^2", "domain 3"),
        ("domain 2\nr = 2 in [0, 5]\nx^2+y^2+z^2 = r^2", "x^2+y^2+z^4 = r^2"),
        ("domain 2\nr = 2 in [0, 5]\n1/x = r y", "1/x <= r y"),
        ("domain 2\nr = 2 in [0, 5]\nx^2+y^2+z^2 = r^2", ":set r = 0.5 in [0, 6]"),
    ] {
        assert_eq!(code_reused(text, &[line]), [false], "{text} and {line}");
    }
}

#[test]
fn a_slider_changes_the_picture_and_the_status_tells_that_nothing_was_compiled() {
    let live = start("domain 4\nr = 2 in [0.5, 4]\nx^2+y^2+z^2 = r^2", 28);
    let before = settled(&live);
    assert!(before.summary().contains("compiled in"), "{}", before.summary());
    live.type_line(":set r = 3");
    live.enter(":set r = 3").expect("in range");
    let after = settled(&live);
    assert!(before.picture.rgb != after.picture.rgb, "the same picture");
    assert!(after.summary().contains("not compiled again"), "{}", after.summary());
    let times = after.picture.statistics.times;
    assert_eq!((times.simplify, times.compile), (Duration::ZERO, Duration::ZERO));
    // A document without a surface at one value of a parameter may have one at another value.
    live.enter("r = 2 in [-4, 4]").expect("valid");
    live.load(DocumentSource::Typed, "r = 2 in [-4, 4]\ndomain 2\nsqrt(-r - x^2) + y", false);
    assert!(live.wait(LIMIT));
    let fault = live.snapshot().fault.expect("no surface").message();
    assert!(fault.contains("defined nowhere"), "{fault}");
    live.enter(":set r = -2").expect("in range");
    assert_as_compiled_afresh(&settled(&live));
}
