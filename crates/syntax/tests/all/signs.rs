//! Signs that look like those of the language.

use zeroset_parser::ErrorKind;
use zeroset_syntax::{Options, read};

#[test]
fn signs_that_only_look_like_ours_are_suggested() {
    for (typed, meant) in [
        ('\u{2010}', "-"),
        ('\u{2011}', "-"),
        ('⋆', "*"),
        ('：', "="),
        (':', "="),
        ('≡', "="),
        ('≈', "="),
        ('&', "and"),
    ] {
        let errors = read(&format!("x {typed} 1"), &Options::default()).expect_err("no sign");
        let mut errors = errors.iter().map(|error| error.suggestion.as_ref());
        let suggestion = errors.next().flatten().map(|suggestion| &*suggestion.replacement);
        assert_eq!(suggestion, Some(meant), "{typed}");
    }
}

#[test]
fn signs_that_are_known_need_no_suggestion() {
    for typed in "–—‒－＋＊∗•∕⁄＝（），".chars() {
        if let Err(errors) = read(&format!("x {typed} 1"), &Options::default()) {
            let unknown = |kind: &ErrorKind| matches!(kind, ErrorKind::UnexpectedCharacter { .. });
            assert!(!errors.iter().any(|error| unknown(&error.kind)), "{typed}: {errors}");
        }
    }
}
