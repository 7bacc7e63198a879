//! The gallery: function files that are part of the library.

use zeroset_scene::gallery;

/// A surface of the gallery.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Example {
    /// The name to call it by: lower case, with hyphens.
    pub name: &'static str,
    /// The title for people.
    pub title: &'static str,
    /// One line on what the surface is and why it is hard.
    pub summary: &'static str,
    /// Its function file, for [`Scene::read`](crate::Scene::read).
    pub text: &'static str,
}

/// Returns every surface of the gallery, in the order of their names.
///
/// ```
/// let gyroid = zeroset::gallery().find(|example| example.name == "gyroid").unwrap();
/// let scene = zeroset::Scene::read(gyroid.text)?;
/// # Ok::<(), zeroset::Error>(())
/// ```
pub fn gallery() -> impl Iterator<Item = Example> {
    gallery::examples().into_iter().map(|example| Example {
        name: example.slug,
        title: example.title(),
        summary: example.summary(),
        text: example.text,
    })
}
