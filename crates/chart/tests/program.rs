//! Tests of the program: it writes and repeats rows, and detects damaged rows.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn chart(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_zeroset-chart")).args(arguments).output().expect("it runs")
}

fn run(directory: &Path) -> Output {
    let directory = directory.to_str().expect("UTF-8");
    let small = ["--size", "32", "--repeats", "2", "--views", "1", "--samples", "64"];
    let few = ["--max-depth", "8", "--tolerances", "0.5", "--precision", "f32,auto"];
    chart(&[&["run", "sphere", "-o", directory], &small[..], &few[..]].concat())
}

fn rows(directory: &Path) -> Vec<serde_json::Value> {
    let text = fs::read(directory.join("rows.json")).expect("rows");
    serde_json::from_slice(&text).expect("valid")
}

#[test]
fn rows_are_written_kept_and_checked() {
    let directory = tempfile::tempdir().expect("a directory");
    let output = run(directory.path());
    assert!(output.status.success(), "{output:?}");
    let written = rows(directory.path());
    assert!(written.len() >= 4, "{written:?}");
    let csv = fs::read_to_string(directory.path().join("rows.csv")).expect("rows");
    assert_eq!(csv.lines().count(), 1 + written.len());
    for row in &written {
        assert!(row["trace_ms"].as_f64() > Some(0.0) && row["looked_at"] == 64, "{row}");
        assert!(row["roots"].as_u64() > Some(10), "{row}");
        assert!(row["pixels_miss"].as_u64() < Some(32 * 32), "{row}");
        assert_eq!(row["status_hash"].as_str().map(str::len), Some(64));
    }
    let page = fs::read_to_string(directory.path().join("index.html")).expect("a page");
    for part in ["<svg", "data:image/png;base64,", "Pareto front", "zeroset-chart run sphere"] {
        assert!(page.contains(part), "{part}");
    }
    let drawn = directory.path().join("charts/time-distance-sphere.svg");
    assert!(fs::read_to_string(drawn).expect("a chart").contains("affine"));

    // Rows that are already stored are not measured again.
    let again = run(directory.path());
    assert!(String::from_utf8_lossy(&again.stdout).starts_with("0 rows are new"), "{again:?}");
    assert_eq!(rows(directory.path()), written);

    let path = directory.path().to_str().expect("UTF-8");
    let checked = chart(&["check", path]);
    assert_eq!(checked.status.code(), Some(0), "{checked:?}");

    // A closed pipe is no error.
    let mut command = Command::new(env!("CARGO_BIN_EXE_zeroset-chart"));
    command.args(["draw", path]).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut unread = command.spawn().expect("it runs");
    drop(unread.stdout.take());
    let unread = unread.wait_with_output().expect("it ends");
    assert!(unread.status.success() && unread.stderr.is_empty(), "{unread:?}");

    let mut damaged = written;
    damaged[0]["status_hash"] = "0".repeat(64).into();
    let text = serde_json::to_vec(&damaged).expect("rows");
    fs::write(directory.path().join("rows.json"), text).expect("written");
    let checked = chart(&["check", path]);
    assert_eq!(checked.status.code(), Some(1), "{checked:?}");
    let said = String::from_utf8_lossy(&checked.stdout);
    assert_eq!(said.lines().filter(|line| line.starts_with("differs: ")).count(), 1, "{said}");
}

#[test]
fn what_is_wrong_with_a_file_is_said_once() {
    let output = chart(&["draw", "no-such-directory"]);
    assert_eq!(output.status.code(), Some(2), "{output:?}");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(said.matches("os error").count(), 1, "{said}");
}

#[test]
fn difficult_formulas_are_named_after_what_becomes_of_them() {
    let directory = tempfile::tempdir().expect("a directory");
    let path = directory.path().to_str().expect("UTF-8");
    let cases = ["thin-cylinder", "seventh-power", "double-sphere", "radius-1e-6", "radius-1000"];
    let methods = ["--methods", "affine,knoll", "-o", path];
    let output = chart(&[&["stability"], &cases[..], &methods[..]].concat());
    assert!(output.status.success(), "{output:?}");
    let text = fs::read_to_string(directory.path().join("stability.txt")).expect("a table");
    assert_eq!(String::from_utf8_lossy(&output.stdout), text);
    let outcomes = |case: &str| {
        let line = text.lines().find(|line| line.starts_with(case)).expect("a line");
        let words =
            line.split_whitespace().skip(1).filter(|word| word.starts_with(char::is_alphabetic));
        words.map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(outcomes("thin-cylinder"), ["sound", "sound"]);
    // Rewriting makes multiple roots simple before any method traces them.
    assert_eq!(outcomes("seventh-power"), ["sound", "sound"]);
    assert_eq!(outcomes("double-sphere"), ["sound", "sound"]);
    // At these sizes, slabs and thresholds chosen for a unit cube would miss everything. These
    // cases have no stored roots, so the certified tracer alone judges them.
    assert_eq!(outcomes("radius-1e-6"), ["sound", "sound"]);
    assert_eq!(outcomes("radius-1000"), ["sound", "sound"]);
    let sheet = fs::read(directory.path().join("stability.png")).expect("a sheet");
    assert!(sheet.starts_with(b"\x89PNG"));
    let rows = fs::read(directory.path().join("stability.json")).expect("rows");
    let rows: Vec<serde_json::Value> = serde_json::from_slice(&rows).expect("valid");
    assert_eq!(rows.len(), 10);
    assert_eq!(rows[4]["errors"]["roots"], 400, "{}", rows[4]);
}

#[test]
fn what_cannot_be_done_is_said_once() {
    let directory = tempfile::tempdir().expect("a directory");
    let path = directory.path().to_str().expect("UTF-8");
    let wrong: [(&[&str], &str); 8] = [
        (&["stability", "no-such-case", "-o", path], "there is no case 'no-such-case'"),
        (&["stability", "--budget", "0", "-o", path], "a number of seconds"),
        (&["run", "no-such-surface", "-o", path], "there is no surface 'no-such-surface'"),
        (&["run", "sphere", "--methods", "no-such", "-o", path], "no-such"),
        (&["run", "sphere", "--tolerances", "0", "-o", path], "a tolerance is a number of pixels"),
        (&["run", "sphere", "--precision", "f16", "-o", path], "f32, f64, auto"),
        (&["run", "sphere"], "--output"),
        (&["check", path], "rows.json"),
    ];
    for (arguments, expected) in wrong {
        let output = chart(arguments);
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(expected) && said.matches("error:").count() == 1, "{said}");
    }
}

#[test]
fn rays_are_followed_and_kept_for_others() {
    let directory = tempfile::tempdir().expect("a directory");
    let path = directory.path().to_str().expect("UTF-8");
    let output = chart(&["rays", "sphere", "--random", "200", "-o", path]);
    assert!(output.status.success(), "{output:?}");
    let said = String::from_utf8_lossy(&output.stdout);
    for method in ["affine", "knoll", "mitchell", "march"] {
        let line = said.lines().find(|line| line.starts_with(method)).expect(method);
        assert!(line.ends_with("; 0 false"), "{line}");
    }
    let read = |name: &str| {
        let file = fs::File::open(directory.path().join(name)).expect(name);
        zeroset_testkit::npy::read_f64(file).expect(name)
    };
    let (rays, hits, certain) = (read("rays.npy"), read("affine.npy"), read("certified.npy"));
    assert_eq!((rays.shape, hits.shape), (vec![200, 6], vec![200, 4]));
    // Compare with the exact roots on the unit sphere.
    let mut seen = [0; 2];
    for (ray, (hit, certain)) in rays
        .data
        .as_chunks::<6>()
        .0
        .iter()
        .zip(hits.data.as_chunks::<4>().0.iter().zip(certain.data.as_chunks::<3>().0))
    {
        let (origin, way) =
            (glam::DVec3::from_slice(&ray[..3]), glam::DVec3::from_slice(&ray[3..]));
        let way = way.normalize();
        let middle = -origin.dot(way);
        let square = middle * middle - origin.length_squared() + 1.0;
        seen[usize::from(square > 0.0)] += 1;
        let expected = middle - square.sqrt();
        if square > 1e-9 {
            assert!(hit[0] == 1.0 && certain[0] == 1.0, "{ray:?}: {hit:?}, {certain:?}");
            assert!(hit[1] <= expected + 1e-12 && expected - 1e-12 <= hit[2], "{hit:?} {expected}");
            assert!((hit[3] - expected).abs() < 1e-5, "{hit:?} {expected}");
        } else if square < -1e-9 {
            assert_eq!((hit[0], certain[0]), (0.0, 0.0), "{ray:?}");
        }
    }
    assert!(seen[0] > 20 && seen[1] > 20, "{seen:?}");

    // Rays that are read back give the same hits. A file of another shape is refused.
    let again = tempfile::tempdir().expect("a directory");
    let (given, there) = (directory.path().join("rays.npy"), again.path());
    let arguments = |file: &Path| {
        let [file, there] = [file, there].map(|path| path.to_str().expect("UTF-8").to_owned());
        chart(&["rays", "sphere", "--rays", &file, "--methods", "affine", "-o", &there])
    };
    assert!(arguments(&given).status.success());
    let bytes = |directory: &Path| fs::read(directory.join("affine.npy")).expect("hits");
    assert_eq!(bytes(there), bytes(directory.path()));
    let refused = arguments(&directory.path().join("affine.npy"));
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
    let said = String::from_utf8_lossy(&refused.stderr);
    assert!(said.contains("200×4 numbers, where rays are rows of 6"), "{said}");
}
