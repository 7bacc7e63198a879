//! Invalid input on the command line gives one clear message and exit code 2. There is no panic and
//! no partial file, and the time is bounded.

use crate::cli_support::{Run, Sandbox};
#[cfg(unix)]
use crate::surroundings::zeroset;

/// File name of the picture in every run of this file.
const PICTURE: &str = "picture.png";

/// Asserts that a run ended with a user error whose only message contains `expected`.
fn assert_refused(place: &Sandbox, run: &Run, expected: &str, case: &str) {
    let stderr = &run.stderr;
    assert_eq!(run.code, Some(2), "{case}: {stderr}");
    assert!(stderr.contains(expected), "{case}: {expected:?} is not in {stderr}");
    assert_eq!(stderr.matches("error: ").count(), 1, "{case}: {stderr}");
    assert!(!stderr.contains("panicked") && !stderr.contains("internal error"), "{case}: {stderr}");
    // A message must be readable, so it must not repeat a megabyte of input.
    assert!(stderr.len() < 4000, "{case}: {} bytes of message", stderr.len());
    assert!(run.stdout.is_empty(), "{case}: output {:?}", run.text());
    let written = place.files();
    let leftover = written.iter().any(|name| name == PICTURE || name.starts_with(".zeroset"));
    assert!(!leftover, "{case}: left behind {written:?}");
}

/// Renders `formula` with further arguments and asserts that it is refused.
fn refused(formula: &str, arguments: &[&str], expected: &str) {
    let place = Sandbox::new();
    let mut all = vec!["render", formula, "-o", PICTURE];
    all.extend(arguments);
    let case: String = formula.chars().take(40).collect();
    assert_refused(&place, &place.run(&all), expected, &format!("{case:?} {arguments:?}"));
}

#[test]
fn texts_that_are_no_formula() {
    for (formula, expected) in [
        ("", "there is no formula"),
        ("   ", "there is no formula"),
        ("# only a comment", "there is no formula"),
        ("(x+", "`(` is never closed"),
        ("x+1)", "`)` closes nothing"),
        ("(x+1]", "is closed by"),
        ("x=", "a value is missing after `=`"),
        ("x+*y", "missing"),
        ("x$y", "`$` has no meaning"),
        ("f(x)=f(x)+1", "defined in terms of itself"),
        ("f(a)=g(a)\ng(a)=f(a)\nf(x)+y", "circular"),
        ("foo+x", "`foo` is not defined"),
        ("bar(x)", "bar"),
        ("sin(x,y)", "`sin` takes 1 argument, not 2"),
        ("clamp(x)", "`clamp` takes 3 arguments, not 1"),
        ("x2+y2", "x^2"),
    ] {
        refused(formula, &[], expected);
    }
}

/// Each text exceeds one limit on documents, and respects all others.
#[test]
fn each_limit_says_which_it_is() {
    let doubled = (1..40).map(|k| format!("g{k}(a) = g{}(2*a) + g{}(3*a+{k})", k - 1, k - 1));
    let doubled: Vec<String> = doubled.collect();
    for (text, expected) in [
        (
            "x".to_owned() + &" ".repeat(64 << 20),
            "the text is 67108865 bytes long; at most 67108864 are read",
        ),
        ("x+".repeat(4_000_001), "more than 8000000 numbers, names and signs"),
        ("(".repeat(201) + "x" + &")".repeat(201), "nested more than 200 levels deep"),
        ("x = 1\n".repeat(10_001), "the text draws more than 10000 surfaces"),
        (format!("g0(a) = a+x\n{}\ng39(y)", doubled.join("\n")), "more than 262144 operations"),
    ] {
        let place = Sandbox::new();
        std::fs::write(place.path("long.zset"), &text).expect("written");
        let run =
            place.run(&["render", "long.zset", "-o", PICTURE, "--domain", "2", "--size", "2"]);
        let case: String = text.chars().take(40).collect();
        assert_refused(&place, &run, expected, &case);
    }
}

#[test]
fn texts_made_to_break_a_parser() {
    let brackets = "(".repeat(100_000);
    refused(&brackets, &[], "nested more than");
    let powers = format!("x{}", "^2".repeat(20_000));
    refused(&powers, &[], "nested more than");
    let signs = format!("{}x", "-".repeat(100_000));
    refused(&signs, &[], "error: ");
    let pasted = Sandbox::new();
    // This line is longer than an argument may be. It comes from standard input and from a file.
    let line = format!("x{}", "+x".repeat(5 << 20));
    let run = pasted.run_with(&["render", "-", "-o", PICTURE], line.as_bytes());
    assert_refused(&pasted, &run, "more than", "a line of ten megabytes");
    pasted.write("long.zset", &line[..9_000_001]);
    let run = pasted.run(&["render", "long.zset", "-o", PICTURE]);
    assert_refused(&pasted, &run, "more than", "a file of nine megabytes");
    let endless = vec![b'x'; 81 << 20];
    let run = pasted.run_with(&["render", "-", "-o", PICTURE], &endless);
    assert_refused(&pasted, &run, "longer than", "81 MB");
}

#[test]
fn formulas_without_a_surface() {
    for (formula, expected) in [
        ("3", "it is 3 at every point"),
        ("0", "every point is a zero"),
        ("1 = 2", "differ by -1 at every point"),
        ("x-x", "every point is a zero"),
        ("1/0", "defined nowhere"),
        ("0/0", "defined nowhere"),
        ("sqrt(-1)", "defined nowhere"),
        ("sqrt(-1-x^2)", "defined nowhere"),
        ("ln(0)", "defined nowhere"),
        ("9^9^9^9", "is constant"),
        ("-(9^9^9^9)", "is constant"),
        ("a = 2", "nothing to draw"),
    ] {
        refused(formula, &[], expected);
    }
}

#[test]
fn files_that_cannot_be_read() {
    let place = Sandbox::new();
    place.write("latin1.zset", b"x^2 # caf\xe9\n");
    let run = place.run(&["render", "latin1.zset", "-o", PICTURE]);
    assert_refused(&place, &run, "'latin1.zset' is not valid UTF-8 text: line 1", "invalid UTF-8");
    let run = place.run_with(&["render", "-", "-o", PICTURE], b"x\n\xff");
    assert_refused(&place, &run, "not valid UTF-8 text: line 2", "invalid UTF-8 on standard input");
    let run = place.run(&["render", "missing.zset", "-o", PICTURE]);
    assert_refused(&place, &run, "there is no file 'missing.zset'", "a missing file");
    for name in ["missing.txt", "folder/missing.glsl"] {
        let run = place.run(&["render", name, "-o", PICTURE]);
        assert_refused(&place, &run, &format!("there is no file '{name}'"), "a missing text");
    }
    std::fs::create_dir(place.path("folder.zset")).expect("made");
    let run = place.run(&["render", "folder.zset", "-o", PICTURE]);
    assert_refused(&place, &run, "is a directory", "a directory");
    let run = place.run(&["eval", "missing.jsonl"]);
    assert_refused(&place, &run, "there is no file 'missing.jsonl'", "a missing file of lines");
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("nowhere", place.path("x")).expect("made");
        let run = place.run(&["render", "x", "-o", PICTURE]);
        assert_refused(&place, &run, "cannot read 'x'", "a link that leads nowhere");
    }
}

#[cfg(unix)]
#[test]
fn files_that_cannot_be_read_and_names_that_are_no_text() {
    use std::os::unix::ffi::OsStrExt;
    let place = Sandbox::new();
    // The superuser may open any file whatever its permissions, but nobody can open a socket.
    let _socket = std::os::unix::net::UnixListener::bind(place.path("socket.zset")).expect("made");
    let run = place.run(&["render", "socket.zset", "-o", PICTURE]);
    assert_refused(&place, &run, "cannot read 'socket.zset'", "a file that cannot be opened");
    // Nobody can read the process's own memory at address 0.
    if cfg!(target_os = "linux") {
        let run = place.run(&["render", "/proc/self/mem", "-o", PICTURE]);
        assert_refused(&place, &run, "cannot read '/proc/self/mem'", "an unreadable file");
    }
    let formula = std::ffi::OsStr::from_bytes(b"x+\xff");
    let arguments = ["render".as_ref(), formula, "-o".as_ref(), PICTURE.as_ref()];
    let run = place.run(&arguments);
    assert_refused(&place, &run, "not valid UTF-8", "a formula in invalid UTF-8");
}

#[test]
fn outputs_that_cannot_be_written() {
    let place = Sandbox::new();
    std::fs::create_dir(place.path("folder")).expect("made");
    let run = place.run(&["render", "sphere", "-o", "nowhere/picture.png"]);
    assert_refused(&place, &run, "there is no directory 'nowhere'", "a missing directory");
    let run = place.run(&["render", "sphere", "-o", "folder"]);
    assert_refused(&place, &run, "it is a directory", "a directory");
    let run = place.run(&["render", "sphere", "-o", PICTURE, "--status", "folder"]);
    assert_refused(&place, &run, "it is a directory", "one of two outputs");
    let run = place.run(&["render", "sphere", "-o", ""]);
    assert_refused(&place, &run, "error: ", "no name");
    let run = place.run(&["render", "sphere", "-o", "-", "--json"]);
    assert_refused(&place, &run, "only one thing", "two things on standard output");
    let run = place.run(&["render", "sphere"]);
    assert_refused(&place, &run, "nothing to write", "no output");
    place.write("file", "");
    let run = place.run(&["gallery", "-o", "file"]);
    assert_refused(&place, &run, "cannot make the directory 'file'", "a file as a directory");
    if cfg!(target_os = "linux") {
        let run = place.run(&["render", "sphere", "-o", "/dev/full"]);
        assert_eq!(run.code, Some(2));
        assert!(run.stderr.contains("cannot write '/dev/full'"), "{}", run.stderr);
    }
}

/// Writing through a symbolic link replaces the link's target atomically, and keeps the link.
#[cfg(unix)]
#[test]
fn links_stay_links() {
    use std::os::unix::fs::symlink;
    let place = Sandbox::new();
    std::fs::create_dir(place.path("folder")).expect("made");
    place.write("folder/old.png", "old");
    symlink("folder/old.png", place.path("link.png")).expect("made");
    symlink("link.png", place.path("second.png")).expect("made");
    symlink("folder/new.png", place.path("new.png")).expect("made");
    for (link, target) in [
        ("link.png", "folder/old.png"),
        ("second.png", "folder/old.png"),
        ("new.png", "folder/new.png"),
    ] {
        place.write("folder/old.png", "old");
        place.run(&["render", "x+y", "--size", "8", "-o", link]).ok();
        assert!(place.path(link).is_symlink(), "{link} is no link any more");
        let written = std::fs::read(place.path(target)).expect("there");
        assert!(written.starts_with(b"\x89PNG"), "{target} is no picture");
    }
    // After an error the target is unchanged.
    place.write("folder/old.png", "old");
    let run = place.run(&["render", "x+", "-o", "link.png"]);
    assert_eq!(run.code, Some(2), "{}", run.stderr);
    assert_eq!(std::fs::read(place.path("folder/old.png")).expect("there"), b"old");
    // Both outputs are the same file, by two paths.
    let both = ["render", "x", "-o", "link.png", "--status", "folder/../folder/old.png"];
    let run = place.run(&both);
    assert_refused(&place, &run, "is given for two outputs", "a link and its target");
    symlink("circle.png", place.path("circle.png")).expect("made");
    let run = place.run(&["render", "x", "-o", "circle.png"]);
    assert_refused(
        &place,
        &run,
        "cannot write 'circle.png': its symbolic links form a loop",
        "a circle",
    );
    assert_eq!(std::fs::read_dir(place.path("folder")).expect("there").count(), 2);
}

#[test]
fn pictures_in_another_format_than_png() {
    let place = Sandbox::new();
    for (name, meant) in [("c.jpg", "'c.png'"), ("a.b.svg", "'a.b.png'")] {
        let run = place.run(&["render", "x+y", "-o", name]);
        assert_refused(&place, &run, &format!("PNG only: '{name}'"), name);
        assert!(run.stderr.contains(meant), "{}", run.stderr);
    }
    let run = place.run(&["render", "x+y", "-o", "d.gif"]);
    assert_refused(&place, &run, "so 'd.gif' needs --frames N", "d.gif");
    assert!(run.stderr.contains("'d.png'"), "{}", run.stderr);
    for name in ["C.PNG", "c"] {
        place.run(&["render", "x+y", "--size", "8", "-o", name]).ok();
    }
}

#[test]
fn an_error_leaves_an_old_picture_as_it_was() {
    let place = Sandbox::new();
    place.write(PICTURE, "old");
    let run = place.run(&["render", "x+", "-o", PICTURE]);
    assert_eq!(run.code, Some(2));
    assert_eq!(place.files(), [PICTURE]);
    assert_eq!(std::fs::read(place.path(PICTURE)).expect("there"), b"old");
}

#[test]
fn numbers_out_of_range() {
    for (arguments, expected) in [
        (["--size", "0x0"], "at least one pixel"),
        (["--size", "-5"], "number of pixels"),
        (["--size", "1000000x1000000"], "at most"),
        (["--size", "big"], "number of pixels"),
        (["--domain", "1,1,0,1,0,1"], "the x range of the domain, 1 to 1, is empty"),
        (["--domain", "0,1,2,-2,0,1"], "the y range of the domain"),
        (["--domain", "0,1,0,1,nan,1"], "the z range of the domain"),
        (["--domain", "inf"], "the x range of the domain"),
        (["--domain", "0"], "is empty"),
        (["--domain", "1e300"], "within"),
        (["--domain", "1,2"], "found 2 numbers"),
        (["--fov", "0"], "field of view is 0 degrees"),
        (["--fov", "180"], "field of view is 180 degrees"),
        (["--fov", "-40"], "field of view is -40 degrees"),
        (["--fov", "nan"], "field of view"),
        (["--fov", "1e-8"], "it must be at least 1e-7"),
        (["--ortho", "0"], "orthographic height is 0"),
        (["--ortho", "1e-301"], "orthographic height is 1e-301; it must be from 1e-300"),
        (["--ortho", "inf"], "orthographic height is inf"),
        (["--ortho", "1e-12"], "can tell the rays apart from a height of about"),
        (["--eye", "1e101,0,0"], "the eye has a coordinate that is not a number within ±1e100"),
        (["--eye", "nan,0,0"], "the eye has a coordinate"),
        (["--eye", "1,2"], "expected 3 numbers"),
        (["--up", "0,0,0"], "the up vector is zero"),
        (["--clip", "0,0,0,1"], "clipping plane"),
        (["--max-depth", "0"], "--max-depth 0: a depth is between 1 and 20, or 40"),
        (["--depth", "99"], "--max-depth 99: a depth is between 1 and 20"),
        (["--steps", "1"], "--steps 1: steps are between 2 and 1048576"),
        (["--tolerance", "0"], "a tolerance is a number of pixels, above 0"),
        (["--tolerance", "-1"], "--tolerance -1: a tolerance is"),
        (["--tolerance", "nan"], "a tolerance is a number of pixels"),
        (["--tolerance", "101"], "at most 100; 0.5 is the default"),
        (["--budget", "0"], "--budget 0: without time nothing can be found"),
        (["--budget", "nan"], "--budget NaN: without time"),
        (["--budget", "inf"], "--budget inf: no such time"),
        (["--precision", "f16"], "possible values: auto, f32, f64"),
        (["--threads", "0"], "--threads must be between 1 and"),
        (["--ambient", "nan"], "'--ambient <SHARE>': must be a share from 0 to 1"),
        (["--background", "reddish"], "neither a color such as white"),
        (["--time", "soon"], "--time 'soon' is not a finite number"),
        (["-D", "r"], "not of the form name=value"),
        (["-D", "q=1"], "`q` does not occur"),
        (["-D", "r=1/0"], "no value"),
        (["-D", "r="], "error: "),
        (["--view", "above"], "possible values"),
        (["--method", "magic"], "possible values"),
    ] {
        refused("r = 1\nx^2+y^2+z^2 = r^2", &arguments, expected);
    }
}

#[test]
fn one_path_for_two_outputs() {
    let expected = "'picture.png' is given for two outputs";
    refused("x", &["--status", PICTURE], expected);
}

#[cfg(target_os = "linux")]
#[test]
fn standard_output_that_is_full_or_closed() {
    use std::process::Stdio;
    let place = Sandbox::new();
    let zeroset = || zeroset(&[], &place.path("data"));
    let commands: [&[&str]; 9] = [
        &["--help"],
        &["render", "-h"],
        &["--version"],
        &["help", "eval"],
        &["render", "x", "--size", "16", "-o", "-"],
        &["render", "x", "--size", "16", "--json"],
        &["explain", "x"],
        &["gallery", "--list"],
        &["completions", "bash"],
    ];
    for arguments in commands {
        let full = std::fs::File::options().write(true).open("/dev/full").expect("a full device");
        let output = zeroset().args(arguments).stdout(full).output().expect("runs");
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {stderr}");
        assert!(stderr.contains("cannot write to standard output"), "{arguments:?}: {stderr}");

        let mut child = zeroset()
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("runs");
        drop(child.stdout.take());
        let status = child.wait().expect("ends");
        assert_eq!(status.code(), Some(0), "{arguments:?} with nobody reading");
    }
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_leaves_nothing() {
    let (place, outside) = (Sandbox::new(), Sandbox::new());
    let mut child = zeroset(&[], &outside.path("data"))
        .args(["render", "gyroid", "--size", "4000", "--max-depth", "18", "-o", PICTURE])
        .args(["--status", "status.npy"])
        .current_dir(place.path("."))
        .stderr(std::process::Stdio::null())
        .spawn()
        .expect("runs");
    // Both files are there without names, or under other names, until they are whole.
    let place_of_files = place.path(".").canonicalize().expect("there");
    let opened = || {
        let files = std::fs::read_dir(format!("/proc/{}/fd", child.id())).ok()?;
        let paths = files.filter_map(|file| std::fs::read_link(file.ok()?.path()).ok());
        Some(paths.filter(|path| path.starts_with(&place_of_files)).count())
    };
    crate::terminal_support::until("both files are open", || {
        opened().is_none_or(|count| count >= 2)
    });
    let early = child.try_wait().expect("known").is_none();
    assert!(early, "the run was meant to take longer than opening its files");
    child.kill().expect("ends");
    child.wait().expect("ended");
    assert!(place.files().is_empty(), "{:?}", place.files());
}

#[test]
fn a_misspelt_name_of_the_gallery_is_recognised() {
    for (typed, expected) in [
        ("spher", "did you mean 'sphere' of the gallery?"),
        ("gyroyd", "did you mean 'gyroid'"),
        ("barth-dec", "did you mean 'barth-decic'"),
        ("sphere.zset", "the gallery has 'sphere'"),
        ("qwertz", "`qwertz` is not defined"),
        ("xyzz+", "missing after"),
    ] {
        refused(typed, &[], expected);
    }
    refused("x+y+z", &["-D", "t=3"], "`t` does not occur");
}

#[cfg(unix)]
#[test]
fn whoever_has_read_enough_ends_the_output_without_an_error() {
    use std::io::Read;
    use std::process::Stdio;
    let outside = Sandbox::new();
    for arguments in [
        &["render", "x^2+y^2+z^2 = 1", "-o", "-", "--size", "600"][..],
        &["explain", "--code", "barth-decic"],
    ] {
        let mut child = zeroset(&[], &outside.path("data"))
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("starts");
        // Standard output is closed before anything is written to it.
        drop(child.stdout.take());
        let mut said = String::new();
        child.stderr.take().expect("piped").read_to_string(&mut said).expect("UTF-8");
        assert_eq!(child.wait().expect("ends").code(), Some(0), "{arguments:?}: {said}");
        assert!(!said.contains("error"), "{arguments:?}: {said}");
    }
}

#[test]
fn a_prompt_whose_input_is_not_text_says_so() {
    let run = Sandbox::new().run_with(&["--preview", "x+y+z"], b"x = 0.5\n\xff\xfe\n:list\n");
    assert_eq!(run.code, Some(2), "{}", run.stderr);
    assert!(run.stderr.contains("the prompt has stopped"), "{}", run.stderr);
}

#[test]
fn a_directory_hides_no_surface_of_the_gallery() {
    let place = Sandbox::new();
    for name in ["gyroid", "pictures"] {
        std::fs::create_dir(place.path(name)).expect("made");
    }
    place.run(&["explain", "gyroid"]).ok();
    let run = place.run(&["explain", "pictures"]);
    assert_eq!(run.code, Some(2), "{}", run.stderr);
    assert!(run.stderr.contains("is a directory"), "{}", run.stderr);
}

#[test]
fn a_mark_of_utf_8_is_no_part_of_a_text() {
    let place = Sandbox::new();
    place.write("marked.zset", "\u{feff}x^2+y^2+z^2 = 1\n");
    let input = b":hide 1\n:show\n:save plain.zset\n";
    let run = place.run_with(&["--preview", "marked.zset"], input).ok();
    assert!(!run.stderr.contains("error"), "{}", run.stderr);
    let saved = std::fs::read_to_string(place.path("plain.zset")).expect("saved");
    assert_eq!(saved, "x^2+y^2+z^2 = 1\n");
}
