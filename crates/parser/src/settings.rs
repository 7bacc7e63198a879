//! The table of settings. A setting is a line about the picture that begins with a known word.

/// A row of the table: a word that begins a line about the picture.
pub struct SettingRow {
    /// The word.
    pub word: &'static str,
    /// The setting that the line changes.
    pub kind: SettingKind,
    /// How to write the line, for error messages.
    pub hint: &'static str,
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
    /// Turns shadows on or off.
    Shadows,
    /// Turns the ground on or off, on which surfaces stand.
    Ground,
    /// The strength of haze.
    Haze,
    /// Turns on or off lines where surfaces end, bend, meet or hide each other.
    Outlines,
    /// Turns the domain's box and axes on or off.
    Axes,
    /// Turns the legend on or off.
    Legend,
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
}

const fn plain(word: &'static str, kind: SettingKind, hint: &'static str) -> SettingRow {
    SettingRow { word, kind, hint }
}

const COLOR: SettingRow = SettingRow {
    word: "color",
    kind: SettingKind::Color,
    hint: "write a name of CSS such as `orange`, `#ff8800`, or a color map such as `viridis(z)`; \
           perhaps how opaque it is behind that, as `50%`",
};

/// All settings and their words.
pub const SETTINGS: &[SettingRow] = &[
    SettingRow {
        word: "domain",
        kind: SettingKind::Domain,
        hint: "write `domain 3`, `domain ball 3`, `domain auto`, `domain [-2, 2]`, \
               `domain x in [-2, 2], y in [-1, 1]` or six numbers",
    },
    SettingRow {
        word: "view",
        kind: SettingKind::View,
        hint: "write a side such as `view front`, or `view eye (4, 3, 6) target (0, 0, 0) fov 40`",
    },
    COLOR,
    SettingRow { word: "colour", ..COLOR },
    SettingRow {
        word: "look",
        kind: SettingKind::Look,
        hint: "write the name of a look, such as `paper`",
    },
    SettingRow {
        word: "background",
        kind: SettingKind::Background,
        hint: "write a name of CSS such as `orange`, `#ff8800`, or `transparent`",
    },
    plain("clip", SettingKind::Clip, "write a, b, c and d: `clip 1, 0, 0, 0.5` keeps x <= 0.5"),
    plain("light", SettingKind::Light, "write where it is: `light 4, -3, 6`"),
    plain("opacity", SettingKind::Opacity, "write a share from 0 to 1, or from `0%` to `100%`"),
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
    plain("shadows", SettingKind::Shadows, "write `shadows on` or `shadows off`"),
    plain("ground", SettingKind::Ground, "write `ground on` or `ground off`"),
    plain(
        "haze",
        SettingKind::Haze,
        "write `haze on`, `haze off`, or its strength from 0 to 1: `haze 0.5`",
    ),
    plain("outlines", SettingKind::Outlines, "write `outlines on` or `outlines off`"),
    plain("axes", SettingKind::Axes, "write `axes on` or `axes off`"),
    plain("mesh", SettingKind::Mesh, "write `mesh on` or `mesh off`"),
    plain("legend", SettingKind::Legend, "write `legend on` or `legend off`"),
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
    plain(
        "width",
        SettingKind::Width,
        "write how wide curves are, from 0.1 to 100 pixels: `width 3px`",
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
