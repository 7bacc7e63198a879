//! Points from a file in numpy's `.npy` format.
//!
//! The file may come from anywhere. So the header is read here and not by `npyz`, which trusts it:
//! its parser recurses into nested brackets, and it multiplies sizes without a check.

use anyhow::{Context, Result, bail, ensure};
use std::fs::File;
use std::io::{BufReader, ErrorKind, Read};
use std::path::Path;

/// Longest header that is read, in bytes. numpy's own limit is the same.
const LONGEST_HEADER: usize = 10_000;

const MAGIC: &[u8] = b"\x93NUMPY";

/// Points, and the shape of the array that they came from.
#[derive(Debug, PartialEq)]
pub struct PointArray {
    /// The shape without its last axis, along which x, y and z lie.
    pub shape: Vec<u64>,
    /// The points, in C order.
    pub points: Vec<[f64; 3]>,
}

/// Reads points from a file, or from standard input for `-`.
///
/// # Errors
/// If the file cannot be read, or is not an array of shape (…, 3) in `float32` or `float64`.
pub fn read_points(path: &Path) -> Result<PointArray> {
    let shown = path.display();
    if path == Path::new("-") {
        return parse(std::io::stdin().lock()).context("standard input");
    }
    ensure!(!path.is_dir(), "'{shown}' is a directory, not an array");
    let file = File::open(path).with_context(|| format!("cannot read '{shown}'"))?;
    parse(BufReader::new(file)).with_context(|| format!("'{shown}'"))
}

/// Reads points from the bytes of a file.
fn parse(mut file: impl Read) -> Result<PointArray> {
    let header = header(&mut file)?;
    let value = |key| value_of(&header, key).with_context(|| format!("its header has no {key}"));
    let floats = Floats::named(value("descr")?)?;
    let is_fortran = match value("fortran_order")? {
        text if text.starts_with("True") => true,
        text if text.starts_with("False") => false,
        _ => bail!("its header does not say whether it is in Fortran order"),
    };
    let shape = shape(value("shape")?)?;
    let wrong = || {
        let sides: Vec<String> = shape.iter().map(u64::to_string).collect();
        let turned = if shape.first() == Some(&3) { "; transpose it" } else { "" };
        let sides = sides.join(", ") + if shape.len() == 1 { "," } else { "" };
        format!(
            "its shape is ({sides}), and points need (N, 3): x, y and z in the last axis{turned}"
        )
    };
    let [shape @ .., 3] = &shape[..] else { bail!(wrong()) };
    ensure!(!shape.is_empty(), wrong());
    let size = |count: usize| count.checked_mul(3 * floats.bytes()).filter(|all| *all < 1 << 48);
    let count =
        shape.iter().try_fold(1_usize, |all, side| all.checked_mul(usize::try_from(*side).ok()?));
    let (count, size) = count
        .and_then(|count| Some((count, size(count)?)))
        .with_context(|| format!("its shape is {shape:?}, too large for any memory"))?;
    // No memory is taken in advance for data that may not be there.
    let mut bytes = Vec::new();
    file.take(size as u64).read_to_end(&mut bytes).context("cannot be read")?;
    ensure!(
        bytes.len() == size,
        "it ends after {} of {count} points",
        bytes.len() / (3 * floats.bytes())
    );
    let point = |number: usize| {
        let place =
            |axis: usize| if is_fortran { axis * count + number } else { 3 * number + axis };
        [0, 1, 2].map(|axis| floats.read(&bytes[place(axis) * floats.bytes()..]))
    };
    let points = if is_fortran {
        fortran_order(shape).map(point).collect()
    } else {
        (0..count).map(point).collect()
    };
    Ok(PointArray { shape: shape.to_vec(), points })
}

/// Reads up to the end of the header, and returns its text.
fn header(file: &mut impl Read) -> Result<String> {
    let mut read = |bytes: &mut [u8]| {
        file.read_exact(bytes).map_err(|error| match error.kind() {
            ErrorKind::UnexpectedEof => anyhow::anyhow!("it ends within its header"),
            _ => anyhow::Error::new(error).context("cannot be read"),
        })
    };
    let mut magic = [0; MAGIC.len()];
    let is_array = read(&mut magic).is_ok() && magic == MAGIC;
    ensure!(is_array, "it is not an array of NumPy: write one with numpy.save");
    let mut version = [0; 2];
    read(&mut version)?;
    let length = match version[0] {
        1 => {
            let mut length = [0; 2];
            read(&mut length)?;
            u16::from_le_bytes(length).into()
        }
        2 | 3 => {
            let mut length = [0; 4];
            read(&mut length)?;
            u32::from_le_bytes(length) as usize
        }
        other => bail!("its format has the version {other}, which is unknown"),
    };
    ensure!(
        length <= LONGEST_HEADER,
        "its header has {length} bytes: too many for an array of points"
    );
    let mut header = vec![0; length];
    read(&mut header)?;
    String::from_utf8(header).ok().context("its header is not text")
}

/// The text after `key` and a colon in a dictionary of Python.
fn value_of<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let after = |quoted: String| Some(header.split_once(&quoted)?.1);
    let rest = after(format!("'{key}'")).or_else(|| after(format!("\"{key}\"")))?;
    Some(rest.trim_start().strip_prefix(':')?.trim_start())
}

/// Reads a tuple of sizes, such as `(100, 3)`.
fn shape(text: &str) -> Result<Vec<u64>> {
    let inner = text.strip_prefix('(').and_then(|text| Some(text.split_once(')')?.0));
    let inner = inner.context("its header has no shape")?.trim();
    let sides = inner.strip_suffix(',').unwrap_or(inner).split(',').map(str::trim);
    // Python 2 wrote `100L`.
    let side = |side: &str| side.strip_suffix('L').unwrap_or(side).parse::<u64>().ok();
    if inner.is_empty() {
        return Ok(Vec::new());
    }
    sides
        .map(side)
        .collect::<Option<_>>()
        .context("its shape is not one of whole numbers up to 2^64")
}

/// The places in Fortran order of an array's entries, in C order.
fn fortran_order(shape: &[u64]) -> impl Iterator<Item = usize> {
    let sides: Vec<usize> = shape.iter().map(|side| *side as usize).collect();
    (0..sides.iter().product()).map(move |mut rest: usize| {
        let (mut place, mut block) = (0, sides.iter().product::<usize>());
        for side in sides.iter().rev() {
            block /= side;
            place += rest % side * block;
            rest /= side;
        }
        place
    })
}

/// A type of floats in a file.
#[derive(Clone, Copy)]
struct Floats {
    is_double: bool,
    is_big_endian: bool,
}

impl Floats {
    /// Reads a name of numpy, in quotes, such as `'<f8'`.
    fn named(descr: &str) -> Result<Self> {
        let quote = descr.chars().next().filter(|c| "'\"".contains(*c));
        let name = quote.and_then(|quote| descr[1..].split(quote).next());
        let (is_double, is_big_endian) = match name {
            Some("<f4") => (false, false),
            Some("<f8") => (true, false),
            Some(">f4") => (false, true),
            Some(">f8") => (true, true),
            other => {
                let kind: String = other.unwrap_or("a record").chars().take(20).collect();
                bail!(
                    "its type is {kind}, and points need float32 or float64: save points.astype(float)"
                )
            }
        };
        Ok(Self { is_double, is_big_endian })
    }

    fn bytes(self) -> usize {
        if self.is_double { 8 } else { 4 }
    }

    /// The float with which `bytes` begin.
    fn read(self, bytes: &[u8]) -> f64 {
        fn first<const N: usize>(bytes: &[u8]) -> [u8; N] {
            *bytes.first_chunk().expect("a whole float")
        }
        match (self.is_double, self.is_big_endian) {
            (true, false) => f64::from_le_bytes(first(bytes)),
            (true, true) => f64::from_be_bytes(first(bytes)),
            (false, false) => f32::from_le_bytes(first(bytes)).into(),
            (false, true) => f32::from_be_bytes(first(bytes)).into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(header: &str, data: &[u8]) -> Vec<u8> {
        let length = (header.len() as u16).to_le_bytes();
        [MAGIC, &[1, 0], &length, header.as_bytes(), data].concat()
    }

    fn array(descr: &str, order: &str, shape: &str, data: &[u8]) -> Result<PointArray> {
        let dict = format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}\n");
        parse(&file(&dict, data)[..])
    }

    #[test]
    fn every_order_and_type_is_read() {
        let numbers: Vec<f64> = (0..6).map(f64::from).collect();
        let little: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
        let big: Vec<u8> = numbers.iter().flat_map(|n| n.to_be_bytes()).collect();
        let single: Vec<u8> = numbers.iter().flat_map(|n| (*n as f32).to_le_bytes()).collect();
        let single_big: Vec<u8> = numbers.iter().flat_map(|n| (*n as f32).to_be_bytes()).collect();
        let rows = PointArray { shape: vec![2], points: vec![[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]] };
        for (descr, data) in
            [("'<f8'", &little), ("'>f8'", &big), ("\"<f4\"", &single), ("'>f4'", &single_big)]
        {
            assert_eq!(array(descr, "False", "(2, 3)", data).expect("points"), rows, "{descr}");
            let columns = array(descr, "True", "(2L, 3L)", data).expect("points");
            assert_eq!(columns.points, [[0.0, 2.0, 4.0], [1.0, 3.0, 5.0]], "{descr}");
        }
        assert_eq!(array("'<f8'", "False", "(0, 3)", &[]).expect("none").points, [[0.0; 3]; 0]);
        // The entry (i, j, k) of this array in Fortran order is i + 2j + 6k.
        let data: Vec<u8> = (0..18).flat_map(|n| f64::from(n).to_le_bytes()).collect();
        let cube = array("'<f8'", "True", "(2, 3, 3)", &data).expect("points");
        let expected =
            [0, 1].map(|i| [0, 1, 2].map(|j| [0, 1, 2].map(|k| f64::from(i + 2 * j + 6 * k))));
        assert_eq!((cube.shape, &cube.points[..]), (vec![2, 3], expected.as_flattened()));
    }

    #[test]
    fn whatever_else_a_file_holds_is_refused() {
        let huge = "(99999999999999, 99999999999999, 3)";
        for (descr, order, shape, why) in [
            ("'|O'", "False", "(2, 3)", "its type is |O, and points need"),
            ("'<i8'", "False", "(2, 3)", "astype(float)"),
            ("[('shape', '<f8')]", "False", "(2, 3)", "its type is a record"),
            ("'<f8", "False", "(2, 3)", "its type is"),
            ("'é'", "False", "(2, 3)", "its type is é"),
            ("'<f8'", "0", "(2, 3)", "Fortran order"),
            (
                "'<f8'",
                "False",
                "(3, 2)",
                "its shape is (3, 2), and points need (N, 3): x, y and z in the last axis; transpose it",
            ),
            ("'<f8'", "False", "(3,)", "its shape is (3,), and"),
            ("'<f8'", "False", "()", "its shape is (), and"),
            ("'<f8'", "False", "(2, -3)", "whole numbers"),
            ("'<f8'", "False", "(99999999999999999999, 3)", "whole numbers"),
            ("'<f8'", "False", "(2, 3", "no shape"),
            ("'<f8'", "False", huge, "too large"),
            ("'<f8'", "True", "(4611686018427387904, 4, 3)", "too large"),
            ("'<f8'", "False", "(9000000000000, 3)", "it ends after 2 of 9000000000000 points"),
            ("'<f8'", "False", "(3, 3)", "it ends after 2 of 3 points"),
            ("'<f8'", "True", "(0, 9000000000000, 3)", ""),
        ] {
            let found = array(descr, order, shape, &[0; 48]);
            match found {
                Ok(found) => assert!(why.is_empty() && found.points.is_empty(), "{shape}"),
                Err(error) => {
                    assert!(!why.is_empty() && error.to_string().contains(why), "{error}");
                }
            }
        }
        let whole = file("{'descr': '<f8', 'fortran_order': False, 'shape': (1, 3)}", &[0; 24]);
        assert!(parse(&whole[..]).is_ok());
        for length in 0..whole.len() {
            assert!(parse(&whole[..length]).is_err(), "{length}");
        }
        let nested = file(&"(".repeat(9000), &[]);
        assert!(parse(&nested[..]).is_err());
        for version in [[0, 0], [4, 0], [9, 9]] {
            let mut other = whole.clone();
            other[6..8].copy_from_slice(&version);
            assert!(parse(&other[..]).is_err());
        }
        let long = [MAGIC, &[2, 0], &[255; 4], &[b' '; 99]].concat();
        assert!(parse(&long[..]).expect_err("too long").to_string().contains("too many"));
    }
}
