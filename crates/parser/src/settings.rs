//! The table of settings. A setting is a line about the picture that begins with a known word.

use std::borrow::Cow;
use std::sync::LazyLock;
use zeroset_style::{CHOICES, OPACITY, Setting, WIDTH};

/// A row of the table: a word that begins a line about the picture.
#[derive(Clone)]
pub struct SettingRow {
    /// The word.
    pub word: &'static str,
    /// The setting that the line changes.
    pub kind: SettingKind,
    /// How to write the line, for error messages.
    pub hint: Cow<'static, str>,
}

/// The setting that a line about the picture changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SettingKind {
    /// The box or ball in which surfaces are looked for.
    Domain,
    /// The camera.
    View,
    /// The color of a surface.
    Color,
    /// The style of the whole picture.
    Look,
    /// The color where nothing is painted.
    Background,
    /// The plane that cuts the region.
    Clip,
    /// The direction of the light.
    Light,
    /// The opacity of a surface.
    Opacity,
    /// The material of a surface.
    Material,
    /// Leaves a drawing out of the picture.
    Hidden,
    /// The picture's title.
    Title,
    /// Turns on or off lines of equal x, y and z on surfaces.
    Mesh,
    /// Displays lengths along all axes alike.
    Aspect,
    /// Contour lines of a value.
    Contours,
    /// The width of curves.
    Width,
    /// A choice for the whole picture.
    Choice(&'static Setting),
}

const fn plain(word: &'static str, kind: SettingKind, hint: &'static str) -> SettingRow {
    SettingRow { word, kind, hint: Cow::Borrowed(hint) }
}

/// The row of a setting that the command line, the window and Python also have.
fn shared(row: &'static Setting, kind: SettingKind) -> SettingRow {
    SettingRow { word: row.word, kind, hint: row.hint().into() }
}

/// The hint for a color.
const COLOR: &str = "write a name of CSS such as `orange`, `#ff8800`, or a color map such as \
                     `viridis(z)`; perhaps how opaque it is behind that, as `50%`";

/// All settings and their words.
pub static SETTINGS: LazyLock<Vec<SettingRow>> = LazyLock::new(|| {
    let lines = CHOICES.iter().filter(|row| row.is_line);
    let choices = lines.map(|row| shared(row, SettingKind::Choice(row)));
    let others = [shared(&OPACITY, SettingKind::Opacity), shared(&WIDTH, SettingKind::Width)];
    OWN.iter().cloned().chain(others).chain(choices).collect()
});

/// Settings that only documents have.
const OWN: &[SettingRow] = &[
    plain(
        "domain",
        SettingKind::Domain,
        "write `domain 3`, `domain ball 3`, `domain auto`, `domain [-2, 2]`, \
         `domain x in [-2, 2], y in [-1, 1]` or six numbers",
    ),
    plain(
        "view",
        SettingKind::View,
        "write a side such as `view front`, or `view eye (4, 3, 6) target (0, 0, 0) fov 40`",
    ),
    plain("color", SettingKind::Color, COLOR),
    plain("colour", SettingKind::Color, COLOR),
    plain("look", SettingKind::Look, "write the name of a look, such as `paper`"),
    plain(
        "background",
        SettingKind::Background,
        "write a name of CSS such as `orange`, `#ff8800`, or `transparent`",
    ),
    plain("clip", SettingKind::Clip, "write a, b, c and d: `clip 1, 0, 0, 0.5` keeps x <= 0.5"),
    plain("light", SettingKind::Light, "write where it is: `light 4, -3, 6`"),
    plain(
        "material",
        SettingKind::Material,
        "write `material` and `matte`, `satin`, `gloss`, `metal` or `glass`",
    ),
    plain(
        "hidden",
        SettingKind::Hidden,
        "write `hidden` above what is not to be seen, and `hidden off` above what is",
    ),
    plain("mesh", SettingKind::Mesh, "write `mesh on` or `mesh off`"),
    plain(
        "title",
        SettingKind::Title,
        "write the title behind the word: `title A torus`; in quotes if it has a `;` or `#`, or \
         begins with a bracket",
    ),
    plain("aspect", SettingKind::Aspect, "write `aspect auto` or `aspect equal`"),
    plain(
        "contours",
        SettingKind::Contours,
        "write what is the same along a line, how far the lines are apart, or both: \
         `contours z`, `contours 0.5`, `contours z, 0.5`",
    ),
];

/// The row of the setting whose lines begin with `word`.
pub fn setting(word: &str) -> Option<&'static SettingRow> {
    SETTINGS.iter().find(|setting| setting.word == word)
}

/// The main spelling of a setting's word, such as `color` for `colour`; `None` if no line about the
/// picture begins with `word`.
pub fn setting_word(word: &str) -> Option<&'static str> {
    let found = setting(word)?;
    let first = SETTINGS.iter().find(|other| other.kind == found.kind);
    first.map(|setting| setting.word)
}
