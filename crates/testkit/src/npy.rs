//! Arrays of reference values and of pictures in the `.npy` format.

use npyz::WriterBuilder;
use std::io::{Error, ErrorKind, Read, Result};

/// An array in C order: the last index varies fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Array<T> {
    /// The length of each dimension.
    pub shape: Vec<u64>,
    /// The elements, as many as the product of `shape`.
    pub data: Vec<T>,
}

/// Reads an array of `f64`.
///
/// # Errors
/// If reading fails, or the source is not an array of `f64` in C order.
pub fn read_f64(source: impl Read) -> Result<Array<f64>> {
    read(source)
}

/// Reads an array of `f32`.
///
/// # Errors
/// If reading fails, or the source is not an array of `f32` in C order.
pub fn read_f32(source: impl Read) -> Result<Array<f32>> {
    read(source)
}

/// Reads an array of `u8`.
///
/// # Errors
/// If reading fails, or the source is not an array of `u8` in C order.
pub fn read_u8(source: impl Read) -> Result<Array<u8>> {
    read(source)
}

/// Returns the content of an `.npy` file with these numbers in rows of `columns`.
///
/// # Errors
/// If the last row is not full.
pub fn write_f64(columns: usize, data: &[f64]) -> Result<Vec<u8>> {
    let rows = data.len() / columns.max(1);
    if rows * columns != data.len() {
        return Err(Error::new(ErrorKind::InvalidInput, "the last row is not full"));
    }
    let mut bytes = Vec::new();
    let options = npyz::WriteOptions::new().default_dtype();
    let options = options.shape(&[rows as u64, columns as u64]).writer(&mut bytes);
    let mut writer = options.begin_nd()?;
    writer.extend(data.iter().copied())?;
    writer.finish()?;
    Ok(bytes)
}

fn read<T: npyz::Deserialize>(source: impl Read) -> Result<Array<T>> {
    let file = npyz::NpyFile::new(source)?;
    if file.order() != npyz::Order::C {
        return Err(Error::new(ErrorKind::InvalidData, "Fortran order"));
    }
    Ok(Array { shape: file.shape().to_vec(), data: file.into_vec()? })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(header: &str, data: &[u8]) -> Vec<u8> {
        let header = format!("{header}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    #[test]
    fn arrays_read_back() {
        let header = "{'descr': '|u1', 'fortran_order': False, 'shape': (2, 3), }";
        let array = read_u8(&*file(header, &[1, 2, 3, 4, 5, 6])).expect("an array");
        assert_eq!((array.shape, array.data), (vec![2, 3], vec![1, 2, 3, 4, 5, 6]));
        let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (2,), }";
        let data = [1.5_f64.to_le_bytes(), f64::INFINITY.to_le_bytes()].concat();
        let array = read_f64(&*file(header, &data)).expect("an array");
        assert_eq!((array.shape, array.data), (vec![2], vec![1.5, f64::INFINITY]));
        let header = "{'descr': '<f4', 'fortran_order': False, 'shape': (1,), }";
        let array = read_f32(&*file(header, &0.5_f32.to_le_bytes())).expect("an array");
        assert_eq!(array.data, [0.5]);
    }

    #[test]
    fn what_is_written_reads_back() {
        let data = [1.0, f64::NAN, f64::INFINITY, -0.0, 5e-324, 6.5];
        let array = read_f64(&*write_f64(3, &data).expect("two rows")).expect("an array");
        assert_eq!(array.shape, [2, 3]);
        assert!(array.data.iter().zip(data).all(|(a, b)| a.to_bits() == b.to_bits()));
        assert!(write_f64(4, &data).is_err() && write_f64(0, &data).is_err());
    }

    #[test]
    fn other_data_are_refused() {
        assert!(read_u8(&b"nothing"[..]).is_err());
        let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (1,), }";
        assert!(read_u8(&*file(header, &[0; 8])).is_err());
        assert!(read_f64(&*file(header, &[0; 4])).is_err());
        let header = "{'descr': '|u1', 'fortran_order': True, 'shape': (1, 1), }";
        assert!(read_u8(&*file(header, &[0])).is_err());
    }
}
