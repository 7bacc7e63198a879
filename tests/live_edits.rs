//! Thousands of random edits of the live picture: bounded in time and memory, and at the end the picture is that of the
//! last text that can be drawn.

use std::time::{Duration, Instant};
use zeroset::live::{Live, Start};
use zeroset::picture::Settings;

const EDITS: usize = 2_000;
const LIMIT: Duration = Duration::from_mins(2);

/// What lines are made of.
const PARTS: &[&str] = &[
    "x", "y", "z", "x^2", "y^2", "z^2", "+", "-", "*", "/", "^", "(", ")", "=", "1", "0.5", "sin(",
    "sqrt(", "abs(x)", "r", " ", "<", "and ", "max(x,", "{z>0}", "|", "é", "²", "foo", "2", ",",
    ";",
];

/// Whole lines, among which random ones are strewn.
const LINES: &[&str] = &[
    "x^2+y^2+z^2 = 1",
    "sin(x)*cos(y)+sin(y)*cos(z)+sin(z)*cos(x)",
    "r = 0.7",
    "z = x^2 - y^2",
    "x^2+y^2 < r",
    "domain 2",
    "1/x = y",
    ":add x = z",
    ":view top",
    ":set r = 0.3",
    ":domain auto",
];

/// Resident memory of this process in bytes.
fn resident() -> Option<usize> {
    let statm = std::fs::read_to_string("/proc/self/statm").ok()?;
    Some(statm.split_whitespace().nth(1)?.parse::<usize>().ok()? * 4096)
}

#[test]
fn no_edit_leaves_a_stale_picture() {
    let seed = std::env::var("ZEROSET_SEED").ok().and_then(|seed| seed.parse().ok());
    let seed: u64 = seed.unwrap_or(20_070_002);
    println!("reproduce with ZEROSET_SEED={seed}");
    let mut random = fastrand::Rng::with_seed(seed);
    let settings = Settings { width: 64, height: 64, max_depth: 8, ..Settings::default() };
    let live = Live::new(Start { settings, ..Start::default() });
    let started = Instant::now();
    let mut first = None;
    for edit in 0..EDITS {
        if random.bool() {
            // Typed letter by letter, as far as it goes.
            let line = random.choice(LINES).expect("some");
            let reach = random.usize(0..=line.len());
            for end in (0..=reach).filter(|end| line.is_char_boundary(*end)) {
                live.type_line(&line[..end]);
            }
            if random.bool() {
                let _ = live.enter(line);
            }
        } else {
            let parts = random.usize(1..12);
            let line: String = (0..parts).map(|_| *random.choice(PARTS).expect("some")).collect();
            live.type_line(&line);
            if random.u8(0..8) == 0 {
                let _ = live.enter(&line);
            }
        }
        if random.u8(0..16) == 0 {
            live.turn(|orbit| orbit.turn(3.0, 1.0, 64));
        }
        if random.u8(0..64) == 0 {
            assert!(live.wait(LIMIT), "edit {edit} does not settle");
        }
        // What is allocated once, by the first edits, is no leak.
        if edit == EDITS / 4 {
            first = resident();
        }
    }
    live.enter(":domain 2").expect("valid");
    live.enter("x^2+y^2+z^2 = 1").expect("valid");
    assert!(live.wait(LIMIT), "the last edit does not settle");
    println!("{EDITS} edits in {:?}", started.elapsed());
    let view = live.view();
    assert!(view.fault.is_none(), "{:?}", view.fault.map(|fault| fault.message()));
    let frame = view.frame.expect("a picture");
    assert_eq!(frame.document.surfaces[0].echo, "x^2 + y^2 + z^2 = 1");
    assert_eq!((frame.revision, frame.coarse), (view.settled, false));
    // The same picture as one made afresh.
    let again = Live::new(Start { settings: frame.wish.settings.clone(), ..Start::default() });
    again.load("again", &live.text(), false);
    again.enter(":domain 2").expect("valid");
    assert!(again.wait(LIMIT));
    again.turn(|orbit| *orbit = frame.wish.orbit.expect("turned"));
    assert!(again.wait(LIMIT));
    let fresh = again.view().frame.expect("a picture");
    assert_eq!(fresh.picture.rgb, frame.picture.rgb);
    if let (Some(first), Some(last)) = (first, resident()) {
        println!("resident: {} kB, then {} kB", first >> 10, last >> 10);
        assert!(last < first + (10 << 20), "memory grew from {first} to {last}");
    }
}
