//! Executable memory that is freed when its last user is gone.

use crate::rounding::Entry;
use cranelift_jit::JITModule;
use std::mem::ManuallyDrop;

/// A vector of the pool, aligned as vector instructions want it.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub struct Constant(u128);

/// One finished function and the memory it lives in.
pub struct Code {
    module: ManuallyDrop<JITModule>,
    entry: Entry,
    /// What `pool` points at: kept alive, never read from here.
    _constants: Box<[Constant]>,
    /// The address of the constants, which the function reads from here.
    pool: *const Constant,
    /// Size of the machine code in bytes.
    pub bytes: usize,
}

impl Code {
    /// Owns `module`, whose finished function `entry` is.
    ///
    /// # Safety
    /// `entry` must lie in memory that `module` owns, and read no more constants than these.
    pub unsafe fn new(module: JITModule, entry: Entry, constants: Vec<u128>, bytes: usize) -> Self {
        let constants: Box<[Constant]> = constants.into_iter().map(Constant).collect();
        let pool = constants.as_ptr();
        Self { module: ManuallyDrop::new(module), entry, _constants: constants, pool, bytes }
    }

    /// The function. It must not be called after this value is dropped.
    #[inline]
    pub fn entry(&self) -> Entry {
        self.entry
    }

    /// Where the function finds the address of its constants.
    #[inline]
    pub fn constants(&self) -> *const u8 {
        (&raw const self.pool).cast()
    }
}

impl Drop for Code {
    fn drop(&mut self) {
        // SAFETY: the module is taken once, here. No pointer into its memory outlives this value: `entry` is
        // copied only for the duration of a call that borrows it.
        unsafe {
            ManuallyDrop::take(&mut self.module).free_memory();
        }
    }
}

// SAFETY: after it is finished the code is read-only, as are its constants, which move with the box that owns them
// and not in memory; the module is only touched again by `drop`, which has exclusive access.
unsafe impl Send for Code {}
// SAFETY: see above; `entry` may run on many threads at once since kernels write only to their outputs.
unsafe impl Sync for Code {}
