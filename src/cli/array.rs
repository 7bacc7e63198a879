//! Arrays in numpy's `.npy` format.

use npyz::{AutoSerialize, WriterBuilder};
use std::io::{self, Write};

/// Writes `values` in C order under `shape`.
///
/// # Errors
/// If the sink fails.
pub fn write<T: AutoSerialize + Copy>(
    out: &mut dyn Write,
    shape: &[usize],
    values: impl IntoIterator<Item = T>,
) -> io::Result<()> {
    let shape: Vec<u64> = shape.iter().map(|&side| side as u64).collect();
    let mut writer =
        npyz::WriteOptions::new().default_dtype().shape(&shape).writer(out).begin_nd()?;
    writer.extend(values)?;
    writer.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_are_read_back() {
        let mut bytes = Vec::new();
        let values = [1.5_f32, f32::INFINITY, 0.0, -0.0, 3.0, 4.0];
        write(&mut bytes, &[2, 3], values).expect("memory takes all");
        let array = npyz::NpyFile::new(&bytes[..]).expect("valid");
        assert_eq!(array.shape(), [2, 3]);
        assert_eq!(array.dtype().descr(), "'<f4'");
        assert_eq!(array.into_vec::<f32>().expect("f32"), values);
    }
}
