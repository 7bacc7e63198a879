//! The tables of formats and units.

use super::{glb, obj, ply, stl, three_mf};
use crate::scene::Object;
use std::io::{self, Write};
use std::path::Path;

/// A format of mesh files.
#[derive(Debug)]
pub struct Format {
    /// Name of the format, and its extension in capitals.
    pub name: &'static str,
    /// True if a file keeps several surfaces as separate objects.
    pub has_objects: bool,
    /// True if coordinates are `f32`.
    pub is_single: bool,
    /// True if a file states the unit of its coordinates.
    pub has_unit: bool,
    /// Writes meshes that have triangles.
    write: fn(&[&Object], Option<&Unit>, &mut dyn Write) -> io::Result<()>,
}

/// Every format.
pub const FORMATS: [Format; 5] = [
    Format {
        name: "STL",
        has_objects: false,
        is_single: true,
        has_unit: false,
        write: |objects, _, out| stl::write(objects, out),
    },
    Format {
        name: "OBJ",
        has_objects: true,
        is_single: false,
        has_unit: false,
        write: |objects, _, out| obj::write(objects, out),
    },
    Format {
        name: "PLY",
        has_objects: false,
        is_single: false,
        has_unit: false,
        write: |objects, _, out| ply::write(objects, out),
    },
    Format {
        name: "3MF",
        has_objects: true,
        is_single: false,
        has_unit: true,
        write: three_mf::write,
    },
    Format { name: "GLB", has_objects: true, is_single: true, has_unit: true, write: glb::write },
];

/// A unit of length for coordinates.
#[derive(Debug, PartialEq)]
pub struct Unit {
    /// Name, as in 3MF.
    pub name: &'static str,
    /// The length in meters.
    pub meters: f64,
}

/// Every unit of 3MF. The first is its default.
pub const UNITS: [Unit; 6] = [
    Unit { name: "millimeter", meters: 1e-3 },
    Unit { name: "centimeter", meters: 1e-2 },
    Unit { name: "meter", meters: 1.0 },
    Unit { name: "inch", meters: 0.0254 },
    Unit { name: "foot", meters: 0.3048 },
    Unit { name: "micron", meters: 1e-6 },
];

impl Unit {
    /// The unit with this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        const { &UNITS }.iter().find(|unit| unit.name == name)
    }
}

impl Format {
    /// The format that a file's extension names.
    ///
    /// # Errors
    /// If the extension names none. The error is one sentence.
    pub fn of(path: &Path) -> Result<&'static Self, String> {
        let named = |extension: &std::ffi::OsStr| {
            FORMATS.iter().find(|format| extension.eq_ignore_ascii_case(format.name))
        };
        path.extension().and_then(named).ok_or_else(|| {
            let known = FORMATS.map(|format| format!(".{}", format.name.to_lowercase()));
            format!("cannot write '{}': a mesh file ends in {}", path.display(), known.join(", "))
        })
    }

    /// Writes the meshes that have triangles. Without a unit, coordinates are millimeters in 3MF,
    /// and meters in GLB.
    ///
    /// # Errors
    /// If writing to `out` fails, or the format cannot hold so many triangles.
    pub fn write(
        &self,
        objects: &[Object],
        unit: Option<&Unit>,
        out: &mut dyn Write,
    ) -> io::Result<()> {
        let objects = objects.iter().filter(|object| !object.mesh.triangles.is_empty());
        (self.write)(&objects.collect::<Vec<_>>(), unit, out)
    }
}

/// The number of triangles of all objects.
pub fn triangles(objects: &[&Object]) -> usize {
    objects.iter().map(|object| object.mesh.triangles.len()).sum()
}

/// `count` as the length of a list in a file. Fails if the format cannot hold it.
pub fn length(count: usize) -> io::Result<u32> {
    let fits = i32::try_from(count).ok().and_then(|count| u32::try_from(count).ok());
    fits.ok_or_else(|| io::Error::other("the format holds no more than 2147483647 parts"))
}

/// Writes floats, little endian.
pub fn write_floats(out: &mut dyn Write, floats: &[f32]) -> io::Result<()> {
    floats.iter().try_for_each(|float| out.write_all(&float.to_le_bytes()))
}
