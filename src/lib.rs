//! Functions of x, y and z and their zero sets, with proofs.
//!
//! A text such as `x^2+y^2+z^2 = 1` is compiled to native code at run time. The code bounds the
//! function over boxes and along rays in rigorous arithmetic. So this library can prove that a
//! function has a zero in some place, or that it has none there.
//!
//! # Values and bounds
//!
//! A [`Function`] is one formula. [`Function::eval`] samples it. [`Function::enclose`] bounds it
//! over boxes and tells where it is defined and continuous; each bound and each fact is a proof.
//!
//! ```
//! use zeroset::Function;
//!
//! let sphere = Function::parse("x^2+y^2+z^2-1")?;
//! assert_eq!(sphere.eval(&[[0.0, 0.0, 1.0], [0.0, 2.0, 0.0]]), [0.0, 3.0]);
//!
//! let found = sphere.enclose(&[[0.0..=0.5, 0.0..=0.5, 1.0..=2.0]])?;
//! assert_eq!(found[0].bounds, 0.0..=3.5);
//! assert!(found[0].continuous);
//! # Ok::<(), zeroset::Error>(())
//! ```
//!
//! # Rays
//!
//! [`Function::trace`] finds where rays first meet a zero. For each ray it proves a hit, with a
//! bracket around the first zero, or it proves a miss, or it says why it can do neither.
//!
//! ```
//! use zeroset::{Function, Ray, RayResult};
//!
//! let sphere = Function::parse("x^2+y^2+z^2-1")?;
//! let towards = |x: f64| Ray { origin: [x, 0.0, 3.0], direction: [0.0, 0.0, -1.0] };
//! let results = sphere.trace(&[towards(0.0), towards(1.5)])?;
//! for result in results {
//!     match result {
//!         RayResult::Hit { bracket: [near, far], .. } => println!("a zero in {near}..{far}"),
//!         RayResult::Miss => println!("no zero"),
//!         RayResult::Undecided { from, reason, .. } => println!("from {from} on: {reason}"),
//!         _ => {}
//!     }
//! }
//! # Ok::<(), zeroset::Error>(())
//! ```
//!
//! A miss is proven within a domain: by default a box that holds the whole zero set, if that is
//! proven to be bounded. [`TraceSettings`] choose another domain, method or precision.
//!
//! # Pictures
//!
//! A [`Scene`] is a text that draws one or more surfaces or solids. [`Settings`] say how a picture
//! is made. The [`Picture`] has colors and, for each pixel, what is proven of its ray;
//! [`Picture::save`] writes it to a PNG file.
//!
//! ```
//! use zeroset::{Scene, Settings};
//!
//! let picture = Scene::read("z = x*y {x^2+y^2 < 4}")?.render(&Settings::new(128, 96))?;
//! let counts = picture.counts();
//! assert_eq!(counts.hit + counts.miss + counts.undecided, 128 * 96);
//! # Ok::<(), zeroset::Error>(())
//! ```
//!
//! # Meshes
//!
//! [`Scene::mesh`] makes triangles of the surfaces, and proves that they have the same shape.
//! [`Scene::measure`] bounds the volume and the centroid of solids.
//! [`Mesh::save`] writes them to a file.
//!
//! ```
//! use zeroset::{MeshSettings, Scene};
//!
//! let mesh = Scene::read("x^2+y^2+z^2 = 1")?.mesh(&MeshSettings::new().tolerance(0.05))?;
//! assert!(mesh.is_proven());
//! let sphere = &mesh.surfaces()[0];
//! assert!(sphere.is_closed());
//! // Vertices less edges, plus triangles: Euler's number of a sphere.
//! assert_eq!(sphere.vertices().len() - sphere.faces().len() / 2, 2);
//! # Ok::<(), zeroset::Error>(())
//! ```
//!
//! [`gallery`] lists texts that are part of the library.
//!
//! # The language
//!
//! A text has one statement in each line: a formula that is drawn, a definition such as
//! `f(a) = a^2` or `r = 2`, or a line on how surfaces are shown, such as `color gold`. A number
//! with a name is a [`Parameter`]: `r = 2 in [0, 5]` is a slider, and `t` is the time.
//! [`Function::set`] and [`Scene::set`] set it without reading the text again. Text behind `#`
//! is a comment. `docs/language.md` describes the language.
//!
//! # Proofs and floats
//!
//! Arguments and results are `f64`, taken as exact real numbers. Kernels round outward, in 32 or
//! 64 bits, so that a proof holds for real arithmetic. A proof about a pixel is one about the ray
//! through its center. Colors, normals, sampled values, and the point of a bracket at
//! which a hit is drawn are not proven.
//!
//! # Errors
//!
//! All functions return the same type [`Error`]. Its message shows the place of a fault in a text.
//! Wrong arguments are errors, and no function of this library panics on them.
//!
//! # Features
//!
//! The default feature `window` builds the program `zeroset` with its window, and `cli` builds it
//! without one. The library needs neither: depend on it with `default-features = false`.

mod error;
mod function;
mod gallery;
mod measure;
mod mesh;
mod picture;
mod ray;
mod scene;
mod settings;
mod text;

pub use error::{Diagnostic, Error, ErrorKind};
pub use function::{Enclosure, Function};
pub use gallery::{Example, gallery};
pub use measure::{Measure, MeasureSettings, Measures};
pub use mesh::{Mesh, MeshSettings, SurfaceMesh};
pub use picture::{Counts, Picture, Status, Viewpoint};
pub use ray::{Ray, RayResult, Reason};
pub use scene::Scene;
pub use settings::{
    Background, Camera, Domain, Look, Method, Precision, Settings, TraceSettings, UndecidedStyle,
    View,
};
pub use text::Parameter;
