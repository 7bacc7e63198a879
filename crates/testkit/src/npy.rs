//! Arrays of truth and of pictures, as stored in the `.npy` format.

use std::io::{Error, ErrorKind, Read, Result};

/// An array in C order: the last index moves fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct Array<T> {
    /// The length of each dimension.
    pub shape: Vec<u64>,
    /// As many elements as the product of `shape`.
    pub data: Vec<T>,
}

/// Reads an array of `f64`.
///
/// # Errors
/// If reading fails, or the data are no such array in C order.
pub fn read_f64(source: impl Read) -> Result<Array<f64>> {
    read(source)
}

/// Reads an array of `f32`.
///
/// # Errors
/// If reading fails, or the data are no such array in C order.
pub fn read_f32(source: impl Read) -> Result<Array<f32>> {
    read(source)
}

/// Reads an array of `u8`.
///
/// # Errors
/// If reading fails, or the data are no such array in C order.
pub fn read_u8(source: impl Read) -> Result<Array<u8>> {
    read(source)
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
    fn other_data_are_refused() {
        assert!(read_u8(&b"nothing"[..]).is_err());
        let header = "{'descr': '<f8', 'fortran_order': False, 'shape': (1,), }";
        assert!(read_u8(&*file(header, &[0; 8])).is_err());
        assert!(read_f64(&*file(header, &[0; 4])).is_err());
        let header = "{'descr': '|u1', 'fortran_order': True, 'shape': (1, 1), }";
        assert!(read_u8(&*file(header, &[0])).is_err());
    }
}
