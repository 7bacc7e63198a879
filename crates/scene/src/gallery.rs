//! The gallery, parametric surfaces and models: function files embedded in the program. No source
//! checkout is needed.

use include_dir::{Dir, include_dir};

static FILES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../examples");

/// A surface of the gallery, a parametric surface, or a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Example {
    /// The name that selects it: lower case, with hyphens.
    pub slug: &'static str,
    /// The text of its function file.
    pub text: &'static str,
}

impl Example {
    /// The title, from the file's first line.
    pub fn title(&self) -> &'static str {
        self.comment(0)
    }

    /// The description of the surface and its difficulty, from the file's second line. Its history
    /// may follow on the third line.
    pub fn summary(&self) -> &'static str {
        self.comment(1)
    }

    fn comment(&self, line: usize) -> &'static str {
        self.text.lines().nth(line).and_then(|line| line.strip_prefix('#')).unwrap_or("").trim()
    }
}

/// All equations and solids of the gallery, sorted by slug.
pub fn examples() -> Vec<Example> {
    sorted(&FILES)
}

/// All parametric surfaces of the gallery, sorted by slug. They have a directory of their own,
/// since checks of equations and solids walk over [`examples`].
pub fn parametric() -> Vec<Example> {
    FILES.get_dir("parametric").map_or_else(Vec::new, sorted)
}

/// All surfaces of the gallery: [`examples`], then [`parametric`] ones.
pub fn surfaces() -> Vec<Example> {
    [examples(), parametric()].concat()
}

/// All texts: [`surfaces`], then [`models`].
pub fn all() -> Vec<Example> {
    [surfaces(), models()].concat()
}

/// All models, sorted by slug. They are solids of many parts, made by builders.
pub fn models() -> Vec<Example> {
    FILES.get_dir("models").map_or_else(Vec::new, sorted)
}

/// The function files of a directory, sorted by slug.
fn sorted(directory: &'static Dir<'_>) -> Vec<Example> {
    let mut examples: Vec<Example> = directory
        .files()
        .filter_map(|file| {
            let slug = file.path().file_name()?.to_str()?.strip_suffix(".zset")?;
            Some(Example { slug, text: file.contents_utf8()? })
        })
        .collect();
    examples.sort_by_key(|example| example.slug);
    examples
}

/// The surface of the gallery, or the model, whose slug or title is `name`, in upper or lower case.
pub fn example(name: &str) -> Option<Example> {
    let name = name.trim();
    let called = |other: &str| other.eq_ignore_ascii_case(name);
    all().into_iter().find(|example| called(example.slug) || called(example.title()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lower case, with everything between letters and digits collapsed to a hyphen.
    fn slug(name: &str) -> String {
        let words = name.split(|c: char| !c.is_ascii_alphanumeric()).filter(|w| !w.is_empty());
        words.map(str::to_ascii_lowercase).collect::<Vec<_>>().join("-")
    }

    #[test]
    fn every_file_of_the_directory_is_embedded() {
        let directory = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
        let files = std::fs::read_dir(directory).expect("a directory");
        let mut found: Vec<String> = files
            .map(|file| file.expect("readable").file_name().into_string().expect("UTF-8"))
            .filter_map(|name| name.strip_suffix(".zset").map(str::to_owned))
            .collect();
        found.sort();
        let embedded: Vec<&str> = examples().iter().map(|example| example.slug).collect();
        assert_eq!(embedded, found);
        assert!(embedded.len() >= 65);
        assert_eq!(models().len(), 5);
        assert!(parametric().len() >= 30);
    }

    #[test]
    fn no_two_texts_share_a_name() {
        let mut slugs: Vec<&str> = all().iter().map(|example| example.slug).collect();
        let count = slugs.len();
        slugs.sort_unstable();
        slugs.dedup();
        assert_eq!(slugs.len(), count);
    }

    #[test]
    fn every_example_says_what_it_is_under_its_own_name() {
        for example in all() {
            assert_eq!(slug(example.title()), example.slug);
            let summary = example.summary();
            assert!(summary.len() > 30 && summary.ends_with('.'), "{}", example.slug);
            let history = example.comment(2);
            assert!(history.is_empty() || history.ends_with('.'), "{}", example.slug);
        }
    }

    #[test]
    fn examples_are_found_by_slug_or_title_but_not_by_formula() {
        let barth = example("barth-sextic").expect("there");
        assert_eq!(example("Barth Sextic"), Some(barth));
        assert_eq!(example("Temple").map(|found| found.slug), Some("temple"));
        assert_eq!(example("x^2+y^2+z^2-1"), None);
        assert_eq!(example(""), None);
    }
}
