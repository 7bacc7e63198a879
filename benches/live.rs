//! Times the live pipeline from a key to its picture, at the window's size of 512×512.
//!
//! `cargo bench --bench live` first replays 200 keys. They are a fixed sample of the keys that
//! leave valid text while the gallery's formulas are typed. Each key follows the previous one of
//! its line after 100 ms, so work for the older text must often be cancelled. The output gives the
//! times to the first picture, which may be coarse, and to the full one. Both have targets for the
//! 95th percentile. In a full picture a few pixels may still be undecided for lack of time. The
//! picture is settled when these are refined, and that time is printed, too. A list shows the
//! slowest keys.
//!
//! The second part prints each surface's median times to the first and to the full picture, also of
//! parametric surfaces. In the third part a slider moves each surface. The output gives the
//! pictures per second, and the factor by which they have fewer columns than the window.
//! `-- gyroid` at the end of the command selects the surfaces whose names contain `gyroid`.

use std::time::{Duration, Instant};
use zeroset_live::{DocumentSource, Live, Request};
use zeroset_scene::gallery::{self, Example};
use zeroset_syntax::{Options, read};

const EDITS: usize = 200;
const SEED: u64 = 20_070_002;
/// Time between two keys.
const PACE: Duration = Duration::from_millis(100);
const ROUNDS: usize = 5;
/// Number of measured slider steps per surface.
const DRAGS: i32 = 40;
/// Least rate of a smooth drag, in pictures per second. Its pictures must also have at least half
/// of the window's columns.
const SMOOTH: f64 = 30.0;
/// After this time without news, the picture before may be kept.
const KEPT: Duration = Duration::from_secs(2);
const LIMIT: Duration = Duration::from_mins(1);
/// Names in the output, with targets for the 95th percentile.
const FIRST: &str = "first picture (target 30 ms)";
const FULL: &str = "full picture (target 100 ms)";
/// Length of the list of the slowest keys.
const SLOWEST: usize = 12;

/// A key, pressed while a formula is typed, that leaves valid text.
struct Edit {
    example: usize,
    /// The line before and after the key.
    lines: [String; 2],
}

/// Types the line of each example's first surface key by key. Returns the keys that leave valid
/// text.
fn edits(examples: &[Example]) -> Vec<Edit> {
    let mut edits = Vec::new();
    for (number, example) in examples.iter().enumerate() {
        let document = read(example.text, &Options::default()).expect(example.slug);
        let line = &document.surfaces[0].echo;
        // The example's text already defines every name that the line needs.
        let valid = |line: &str| {
            let text = zeroset_live::entered(example.text, line, false);
            read(&text, &Options::default()).is_ok()
        };
        let ends: Vec<usize> = line.char_indices().map(|(at, c)| at + c.len_utf8()).collect();
        let before = std::iter::once(0).chain(ends.iter().copied());
        let keys = before.zip(&ends).map(|(start, &end)| [&line[..start], &line[..end]]);
        // Skips a space typed at the end of the line, which changes nothing.
        let changing = keys.filter(|[before, after]| before.trim() != after.trim());
        edits.extend(
            changing
                .filter(|[_, after]| valid(after))
                .map(|lines| Edit { example: number, lines: lines.map(str::to_owned) }),
        );
    }
    edits
}

/// Presses the keys. Returns the milliseconds from each key to the first, full and settled picture.
fn replay(examples: &[Example], sample: &[Edit]) -> [Vec<f64>; 3] {
    let live = Live::new(Request::default());
    let [mut first, mut full, mut settled] = [const { Vec::new() }; 3];
    let mut refused = 0;
    let mut coarse = 0;
    let mut slowest = Vec::new();
    for edit in sample {
        let example = &examples[edit.example];
        live.load(DocumentSource::Gallery(*example), example.text, false);
        assert!(live.wait(LIMIT), "{} does not settle", example.slug);
        live.type_line(&edit.lines[0]);
        std::thread::sleep(PACE);
        let revision = live.revision();
        let pressed = Instant::now();
        live.type_line(&edit.lines[1]);
        let has_news = live.wait_for_news(KEPT, revision);
        let taken = pressed.elapsed();
        assert!(has_news || live.wait(LIMIT), "{:?} does not settle", edit.lines[1]);
        // A text without a surface, for example a constant, gets no picture. If there is proven to
        // be nothing to see, the picture before is kept.
        match live.snapshot().rendering {
            Some(frame) if frame.revision > revision => {
                coarse += usize::from(frame.coarse);
                first.push(taken.as_secs_f64() * 1e3);
                assert!(live.wait_for_full(LIMIT), "no full picture of {:?}", edit.lines[1]);
                let taken = pressed.elapsed().as_secs_f64() * 1e3;
                full.push(taken);
                assert!(live.wait(LIMIT), "{:?} does not settle", edit.lines[1]);
                settled.push(pressed.elapsed().as_secs_f64() * 1e3);
                let parts = live.snapshot().rendering.expect("settled").picture.statistics.times;
                slowest.push((taken, example.slug, &edit.lines[1], parts));
            }
            Some(_) | None => refused += 1,
        }
    }
    println!(
        "{} keys: {} with a picture, {coarse} of them coarse; {refused} leave nothing to draw",
        sample.len(),
        first.len()
    );
    slowest.sort_by(|a, b| b.0.total_cmp(&a.0));
    println!("{:>10}{:>10}{:>10}   ms", "full", "compiling", "tracing");
    for (taken, slug, line, parts) in slowest.into_iter().take(SLOWEST) {
        let [made, traced] =
            [parts.simplify + parts.compile, parts.trace].map(|part| part.as_secs_f64() * 1e3);
        println!("{taken:10.1}{made:10.1}{traced:10.1}   {slug}: {line}");
    }
    [first, full, settled]
}

/// Returns the median times to the first and to the full picture, in milliseconds.
fn pictures(example: &Example) -> [f64; 2] {
    let live = Live::new(Request::default());
    let (mut first, mut full) = (Vec::new(), Vec::new());
    for round in 0..=ROUNDS {
        let revision = live.revision();
        // A different text in each round prevents reuse of earlier results.
        let text = format!("{}\n# {round}", example.text);
        let pressed = Instant::now();
        live.load(DocumentSource::Gallery(*example), &text, true);
        assert!(live.wait_for_news(LIMIT, revision), "{}: no picture", example.slug);
        first.push(pressed.elapsed().as_secs_f64() * 1e3);
        assert!(live.wait_for_full(LIMIT), "{}: no full picture", example.slug);
        full.push(pressed.elapsed().as_secs_f64() * 1e3);
        assert!(live.wait(LIMIT), "{} does not settle", example.slug);
        let view = live.snapshot();
        assert!(view.fault.is_none() && view.rendering.is_some_and(|frame| !frame.coarse));
    }
    // Leaves out the first round, which warms up.
    [percentile(&mut first[1..], 0.5), percentile(&mut full[1..], 0.5)]
}

/// Returns the formula with every `x` replaced by `(x + s/10)`.
fn moved(formula: &str) -> String {
    let is_letter = |c: char| c.is_alphanumeric() || c == '_';
    let mut text = String::new();
    let mut rest = formula;
    while let Some(first) = rest.chars().next() {
        let end = rest.find(|c| is_letter(c) != is_letter(first)).unwrap_or(rest.len());
        let (part, after) = rest.split_at(end);
        text.push_str(if part == "x" { "(x + s/10)" } else { part });
        rest = after;
    }
    text
}

/// Results of dragging a slider back and forth.
struct Dragging {
    /// Pictures per second.
    rate: f64,
    /// Median factor by which a picture of the drag has fewer columns than the full picture.
    scale: f64,
    /// Number of slider steps that had to compile code.
    compiled: usize,
}

fn drag(example: &Example) -> Dragging {
    let document = read(example.text, &Options::default()).expect(example.slug);
    let text = zeroset_live::entered(example.text, "s = 0 in [-1, 1]", false);
    let text = zeroset_live::entered(&text, &moved(&document.surfaces[0].echo), false);
    let live = Live::new(Request::default());
    live.load(DocumentSource::Gallery(*example), &text, false);
    assert!(live.wait(LIMIT), "{} does not settle", example.slug);
    let fault = live.snapshot().fault.map(|fault| fault.message());
    assert!(fault.is_none(), "{}: {fault:?} in {text}", example.slug);
    let sliders = live.snapshot().rendering.expect("a picture").sliders();
    let slider = sliders.iter().find(|slider| slider.name == "s").expect("it moves");
    let full = live.settings().width as f64;
    let (mut scales, mut compiled) = (Vec::new(), 0);
    let mut spent = Duration::ZERO;
    // The steps before 0 let the pipeline estimate the cost of a picture. They are not measured.
    for step in -5..DRAGS {
        let value = (f64::from(step) * 0.13).sin();
        let before = live.revision();
        let pressed = Instant::now();
        live.drag(slider, value);
        assert!(live.wait_for_news(LIMIT, before), "{}: no picture", example.slug);
        let taken = pressed.elapsed();
        let seen = live.snapshot().rendering.expect("a picture");
        if step >= 0 {
            spent += taken;
            compiled += usize::from(!seen.model.is_rebound());
            scales.push(full / seen.picture.buffer.width as f64);
        }
    }
    let rate = f64::from(DRAGS) / spent.as_secs_f64();
    Dragging { rate, scale: percentile(&mut scales, 0.5), compiled }
}

fn percentile(times: &mut [f64], share: f64) -> f64 {
    times.sort_by(f64::total_cmp);
    times[((times.len() as f64 * share) as usize).min(times.len() - 1)]
}

/// Prints the times from a key to its pictures.
fn keys(examples: &[Example]) {
    let mut sample = edits(examples);
    println!("{} keys of {} formulas leave valid text; seed {SEED}", sample.len(), examples.len());
    fastrand::Rng::with_seed(SEED).shuffle(&mut sample);
    sample.truncate(EDITS);
    let times = replay(examples, &sample);
    for (name, mut times) in [FIRST, FULL, "settled picture"].into_iter().zip(times) {
        let [median, high, worst] = [0.5, 0.95, 1.0].map(|share| percentile(&mut times, share));
        println!(
            "live/{name}: median {median:.1} ms, 95th percentile {high:.1} ms, worst {worst:.1} ms"
        );
    }
    println!();
}

/// Prints the times from each surface's text to its pictures.
fn texts(examples: &[Example], kind: &str) {
    println!("{kind:34}{:>10}{:>10}   ms, median of {ROUNDS}", "first", "full");
    let mut table = Vec::new();
    for example in examples {
        let times = pictures(example);
        println!("{:34}{:10.1}{:10.1}", example.slug, times[0], times[1]);
        table.push(times);
    }
    let column = |n: usize| {
        let mut times: Vec<f64> = table.iter().map(|times| times[n]).collect();
        [percentile(&mut times, 0.5), percentile(&mut times, 1.0)]
    };
    let ([first, slowest_first], [full, slowest_full]) = (column(0), column(1));
    println!("{:34}{first:10.1}{full:10.1}", "median");
    println!("{:34}{slowest_first:10.1}{slowest_full:10.1}\n", "worst");
}

/// Prints the rates of pictures while a slider moves each surface.
fn drags(examples: &[Example]) {
    println!("{:34}{:>10}{:>10}{:>10}", "dragging a slider", "pictures/s", "scale", "compiled");
    let mut smooth = 0;
    for example in examples {
        let Dragging { rate, scale, compiled } = drag(example);
        let is_smooth = rate >= SMOOTH && scale <= 2.0;
        smooth += usize::from(is_smooth);
        let mark = if is_smooth { "" } else { "  !" };
        println!("{:34}{rate:10.1}{scale:10.2}{compiled:10}{mark}", example.slug);
    }
    println!(
        "{smooth} of {} follow at {SMOOTH} pictures a second, with at least half of the columns",
        examples.len()
    );
}

fn main() {
    // Skips the flag `--bench`, which Cargo adds.
    let filter = std::env::args().skip(1).find(|argument| !argument.starts_with('-'));
    let [examples, parametric] = [gallery::examples(), gallery::parametric()].map(|mut all| {
        all.retain(|example| filter.as_ref().is_none_or(|part| example.slug.contains(part)));
        all
    });
    assert!(examples.len() + parametric.len() > 0, "no surface has a name like {filter:?}");
    if !examples.is_empty() {
        keys(&examples);
        texts(&examples, "surface");
    }
    if !parametric.is_empty() {
        texts(&parametric, "parametric surface");
    }
    if !examples.is_empty() {
        drags(&examples);
    }
}
