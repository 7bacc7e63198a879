//! Thousands of slider drags compile no code, and memory does not grow.
//!
//! A long run: `ZEROSET_CASES=100000 cargo test --release --test memory drags -- --nocapture`.

use super::{alone, resident};
use std::time::{Duration, Instant};
use zeroset_live::{Live, Request};
use zeroset_render::picture::Settings;
use zeroset_testkit::Effort;

const DRAGS: u64 = 2_000;
const SEED: u64 = 20_070_003;
const LIMIT: Duration = Duration::from_mins(2);
const ALLOWED_BYTES: usize = 10 << 20;

#[test]
fn no_drag_compiles_or_keeps_memory() {
    alone("drags::no_drag_compiles_or_keeps_memory", drag_and_measure);
}

fn drag_and_measure() {
    let Effort { seed, cases: drags } = Effort::from_environment(SEED, DRAGS);
    let mut random = fastrand::Rng::with_seed(seed);
    let settings = Settings { width: 64, height: 64, ..Settings::default() };
    // The domain is automatic, so each value gives another domain.
    let text = "r = 1 in [0.2, 5]; t = 0 in [0, 6]; (x-sin(t))^2+y^2+z^2 = r^2";
    let live = Live::new(Request { text: text.into(), settings, ..Request::default() });
    assert!(live.wait(LIMIT), "the first picture does not settle");
    let sliders = live.snapshot().rendering.expect("a picture").sliders();
    assert_eq!(sliders.len(), 2);
    let started = Instant::now();
    let (mut first, mut compiled) = (None, 0);
    for number in 0..drags {
        let slider = random.choice(&sliders).expect("some");
        let value = slider.low + random.f64() * (slider.high - slider.low);
        let before = live.revision();
        live.drag(slider, value);
        assert!(live.wait_for_news(LIMIT, before), "drag {number} shows nothing");
        let seen = live.snapshot();
        assert!(seen.fault.is_none(), "{:?}", seen.fault.map(|fault| fault.message()));
        let model = &seen.rendering.expect("a picture").model;
        compiled += usize::from(!model.is_rebound());
        // Memory that is allocated once at the start is no leak.
        if number == drags / 4 {
            first = resident();
        }
    }
    println!("{drags} drags in {:?}, code made for {compiled}", started.elapsed());
    assert_eq!(compiled, 0);
    if let (Some(first), Some(last)) = (first, resident()) {
        println!("resident: {} kB, then {} kB", first >> 10, last >> 10);
        assert!(last < first + ALLOWED_BYTES, "memory grew from {first} to {last}");
    }
}
