//! 3MF: a ZIP archive with an XML text, each surface an object of its own. Decimals read back as
//! the same `f64`. The core specification is version 1.3, the materials extension 1.2.1.

use crate::color::Color;
use crate::format::{Unit, triangles};
use crate::scene::Object;
use glam::DVec3;
use rustc_hash::FxHashMap;
use std::fmt::Write as _;
use std::io::{self, Cursor, Write};
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

const CONTENT_TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
"#;
const RELATIONSHIPS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
"#;
/// The id of the list of plain colors.
const MATERIALS: usize = 1;
/// A triangle with its share of vertices takes fewer bytes of XML than this.
const MOST_BYTES: u64 = 512;

pub fn write(objects: &[&Object], unit: Option<&Unit>, out: &mut dyn Write) -> io::Result<()> {
    let unit = unit.map_or("millimeter", |unit| unit.name);
    // Readers want sizes before contents, so the archive is written before the output.
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let is_large = triangles(objects) as u64 * MOST_BYTES > u64::from(u32::MAX);
    let options = SimpleFileOptions::default().large_file(is_large);
    for (name, text) in [("[Content_Types].xml", CONTENT_TYPES), ("_rels/.rels", RELATIONSHIPS)] {
        archive.start_file(name, options)?;
        archive.write_all(text.as_bytes())?;
    }
    archive.start_file("3D/3dmodel.model", options)?;
    write_model(objects, unit, &mut io::BufWriter::new(&mut archive))?;
    out.write_all(archive.finish()?.get_ref())
}

fn write_model(objects: &[&Object], unit: &str, out: &mut impl Write) -> io::Result<()> {
    write!(
        out,
        r#"<?xml version="1.0" encoding="UTF-8"?>
<model unit="{unit}" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02">
<metadata name="Application">zeroset</metadata>
<resources>
<basematerials id="{MATERIALS}">
"#
    )?;
    for Object { name, color, .. } in objects {
        let shown = hexadecimal(color.rgb, color);
        writeln!(out, r#"<base name="{}" displaycolor="{shown}"/>"#, escape(name))?;
    }
    writeln!(out, "</basematerials>")?;
    let mut build = String::new();
    for (number, object) in objects.iter().enumerate() {
        // Each object takes two ids: its own, and one for the colors of its map.
        let own = MATERIALS + 1 + 2 * number;
        write_object(object, own, number, out)?;
        // Writing to a string cannot fail.
        let _ = writeln!(build, r#"<item objectid="{own}"/>"#);
    }
    write!(out, "</resources>\n<build>\n{build}</build>\n</model>\n")?;
    out.flush()
}

fn write_object(object: &Object, id: usize, plain: usize, out: &mut impl Write) -> io::Result<()> {
    let Object { name, mesh, color } = object;
    let mapped = color.points.as_ref().map(|points| Listed::new(&points.colors));
    let (material, index) = match &mapped {
        Some(Listed { colors, .. }) => {
            writeln!(out, r#"<m:colorgroup id="{}">"#, id + 1)?;
            for rgb in colors {
                writeln!(out, r#"<m:color color="{}"/>"#, hexadecimal(*rgb, color))?;
            }
            writeln!(out, "</m:colorgroup>")?;
            (id + 1, 0)
        }
        None => (MATERIALS, plain),
    };
    // Only a closed mesh may be a model.
    let kind = if mesh.is_closed { "model" } else { "surface" };
    writeln!(
        out,
        r#"<object id="{id}" type="{kind}" name="{}" pid="{material}" pindex="{index}"><mesh><vertices>"#,
        escape(name)
    )?;
    for DVec3 { x, y, z } in &mesh.vertices {
        writeln!(out, r#"<vertex x="{x:?}" y="{y:?}" z="{z:?}"/>"#)?;
    }
    writeln!(out, "</vertices><triangles>")?;
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle;
        write!(out, r#"<triangle v1="{a}" v2="{b}" v3="{c}""#)?;
        if let Some(Listed { numbers, .. }) = &mapped {
            let [a, b, c] = triangle.map(|vertex| numbers[vertex as usize]);
            write!(out, r#" pid="{material}" p1="{a}" p2="{b}" p3="{c}""#)?;
        }
        writeln!(out, "/>")?;
    }
    writeln!(out, "</triangles></mesh></object>")
}

/// Colors, each once.
struct Listed {
    colors: Vec<[u8; 3]>,
    /// The number of each vertex's color.
    numbers: Vec<usize>,
}

impl Listed {
    /// Numbers the distinct colors in the order of their first use.
    fn new(all: &[[u8; 3]]) -> Self {
        let mut colors = Vec::new();
        let mut known = FxHashMap::default();
        let number = |rgb: &[u8; 3]| {
            *known.entry(*rgb).or_insert_with(|| {
                colors.push(*rgb);
                colors.len() - 1
            })
        };
        let numbers = all.iter().map(number).collect();
        Self { colors, numbers }
    }
}

fn hexadecimal([red, green, blue]: [u8; 3], color: &Color) -> String {
    format!("#{red:02X}{green:02X}{blue:02X}{:02X}", color.alpha())
}

/// A text as the value of an XML attribute. Control characters, which XML forbids, are replaced.
fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' => escaped.push('\u{fffd}'),
            letter if letter.is_control() => escaped.push('\u{fffd}'),
            letter => escaped.push(letter),
        }
    }
    escaped
}
