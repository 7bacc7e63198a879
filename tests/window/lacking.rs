//! Tests of the harness, run without any program in `PATH`.

use std::process::Command;

/// Number of tests that `name` selects.
fn count(name: &str) -> usize {
    let tests = crate::TESTS.iter().flat_map(|group| group.tests);
    tests.filter(|(test, _)| test.contains(name)).count()
}

/// Runs this binary without a `PATH`. Returns its exit code, standard output and standard error.
fn run(arguments: &[&str], ci: bool) -> (Option<i32>, String, String) {
    let mut command = Command::new(std::env::current_exe().expect("this program"));
    command.args(arguments).env("PATH", "").env_remove("CI").envs(ci.then_some(("CI", "true")));
    let output = command.output().expect("it runs");
    let [stdout, stderr] = [output.stdout, output.stderr].map(String::from_utf8);
    (output.status.code(), stdout.expect("UTF-8"), stderr.expect("UTF-8"))
}

pub fn tests_without_their_programs_are_ignored_with_the_reason() {
    let number = count("gallery::");
    assert!(number > 0);
    let (code, stdout, stderr) = run(&["gallery::"], false);
    assert_eq!(code, Some(0), "{stdout}");
    let reason = "ignored (needs Xvfb, xdotool)\n";
    assert_eq!(stdout.matches(reason).count(), number, "{stdout}");
    assert!(stdout.contains(&format!("0 passed; 0 failed; {number} ignored")), "{stdout}");
    assert!(stderr.contains("apt-get install xvfb "), "{stderr}");
    // Some runners list the tests first, and the list must show which tests are ignored.
    let (_, listed, _) = run(&["gallery::", "--list", "--ignored"], false);
    assert_eq!(listed.lines().count(), number, "{listed}");
}

pub fn tests_that_must_run_fail_without_their_programs() {
    let number = count("gallery::");
    for (arguments, ci) in [(&["gallery::"][..], true), (&["gallery::", "--ignored"], false)] {
        let (code, stdout, stderr) = run(arguments, ci);
        assert_eq!(code, Some(101), "{stdout}");
        assert!(stdout.contains(&format!("0 passed; {number} failed; 0 ignored")), "{stdout}");
        assert!(stdout.contains("\nneeds Xvfb, xdotool\n"), "{stdout}");
        assert!(stderr.contains("apt-get install xvfb "), "{stderr}");
    }
    let (_, listed, _) = run(&["gallery::", "--list", "--ignored"], true);
    assert_eq!(listed, "");
}

pub fn filters_select_what_libtest_selects() {
    let [both, first, all] = ["gallery::", "gallery::a_", "::"].map(count);
    for (arguments, selected) in [
        (&["gallery::", "surfaces::", "--no-capture"][..], both + count("surfaces::")),
        (&["gallery::a_", "gallery::", "--nocapture", "--test-threads=1"], both),
        (&["gallery::", "--skip", "gallery::a_"], both - first),
        (&["gallery::a_", "no such test"], first),
        (&["--exact", "gallery::", "gallery::help_is_read_in_the_window"], 1),
    ] {
        let (code, stdout, _) = run(arguments, false);
        assert_eq!(code, Some(0), "{stdout}");
        let counts = format!("{selected} ignored; 0 measured; {} filtered out", all - selected);
        assert!(stdout.contains(&counts), "{arguments:?}, {counts}: {stdout}");
    }
}
