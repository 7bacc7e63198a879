//! The gallery: texts of surfaces that are part of the library.

use zeroset_scene::gallery;

/// A surface of the gallery.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Example {
    /// Identifier, in lower case with hyphens.
    pub name: &'static str,
    /// Title, in plain English.
    pub title: &'static str,
    /// One line that says what the surface is and why it is hard to render.
    pub summary: &'static str,
    /// The surface's text, for [`Scene::read`](crate::Scene::read).
    pub text: &'static str,
}

/// Returns all surfaces of the gallery: equations and solids in alphabetical order of their names,
/// then parametric surfaces.
///
/// ```
/// let gyroid = zeroset::gallery().find(|example| example.name == "gyroid").unwrap();
/// let scene = zeroset::Scene::read(gyroid.text)?;
/// # Ok::<(), zeroset::Error>(())
/// ```
pub fn gallery() -> impl Iterator<Item = Example> {
    gallery::surfaces().into_iter().map(|example| Example {
        name: example.slug,
        title: example.title(),
        summary: example.summary(),
        text: example.text,
    })
}
