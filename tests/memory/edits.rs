//! Thousands of random edits of the live picture, bounded in time and memory. At the end the
//! picture shows the last valid text.
//!
//! A long run: `ZEROSET_CASES=10000 cargo test --release --test memory edits -- --nocapture`.

use super::edit_support::{beginnings, edit};
use super::{alone, resident};
use std::time::{Duration, Instant};
use zeroset_live::{DocumentSource, Live, Request};
use zeroset_render::picture::Settings;
use zeroset_testkit::Effort;
use zeroset_trace::TraceOptions;

const EDITS: u64 = 2_000;
const SEED: u64 = 20_070_002;
const LIMIT: Duration = Duration::from_mins(2);

#[test]
fn no_edit_leaves_a_stale_picture() {
    alone("edits::no_edit_leaves_a_stale_picture", edit_and_measure);
}

fn edit_and_measure() {
    let Effort { seed, cases: edits } = Effort::from_environment(SEED, EDITS);
    let mut random = fastrand::Rng::with_seed(seed);
    let settings = Settings {
        options: TraceOptions { depth: 8, ..TraceOptions::default() },
        width: 64,
        height: 64,
        ..Settings::default()
    };
    let live = Live::new(Request { settings, ..Request::default() });
    let started = Instant::now();
    let mut first = None;
    for number in 0..edits {
        let edit = edit(&mut random);
        for line in beginnings(&edit.line, edit.typed) {
            live.type_line(line);
        }
        if edit.entered {
            let _ = live.enter(&edit.line);
        }
        if random.u8(0..16) == 0 {
            live.turn(|orbit| orbit.turn(3.0, 1.0, 64));
        }
        if random.u8(0..64) == 0 {
            assert!(live.wait(LIMIT), "edit {number} does not settle");
        }
        // Memory that the first edits allocate once is no leak.
        if number == EDITS / 4 {
            first = resident();
        }
    }
    live.enter(":domain 2").expect("valid");
    live.enter("x^2+y^2+z^2 = 1").expect("valid");
    // Wait for the picture of the last edit, then turn it.
    assert!(live.wait(LIMIT), "the last edit does not settle");
    live.turn(|orbit| orbit.turn(3.0, 1.0, 64));
    assert!(live.wait(LIMIT), "the last edit does not settle");
    println!("{edits} edits in {:?}", started.elapsed());
    let view = live.snapshot();
    assert!(view.fault.is_none(), "{:?}", view.fault.map(|fault| fault.message()));
    let frame = view.rendering.expect("a picture");
    assert_eq!(frame.document.surfaces[0].echo, "x^2 + y^2 + z^2 = 1");
    assert_eq!((frame.revision, frame.coarse), (view.settled, false));
    // A fresh start with the last text gives the same picture.
    let again =
        Live::new(Request { settings: frame.request.settings.clone(), ..Request::default() });
    again.load(DocumentSource::Typed, &live.text(), false);
    again.enter(":domain 2").expect("valid");
    assert!(again.wait(LIMIT));
    again.turn(|orbit| *orbit = frame.request.orbit.expect("turned"));
    assert!(again.wait(LIMIT));
    let fresh = again.snapshot().rendering.expect("a picture");
    assert_eq!(fresh.picture.rgb, frame.picture.rgb);
    if let (Some(first), Some(last)) = (first, resident()) {
        println!("resident: {} kB, then {} kB", first >> 10, last >> 10);
        assert!(last < first + (10 << 20), "memory grew from {first} to {last}");
    }
}
