//! Executable memory that is freed when its last user is gone.

use crate::rounding::Entry;
use cranelift_jit::JITModule;
use std::mem::ManuallyDrop;

/// One finished function and the memory it lives in.
pub struct Code {
    module: ManuallyDrop<JITModule>,
    entry: Entry,
    /// Size of the machine code in bytes, constants included.
    pub bytes: usize,
}

impl Code {
    /// Owns `module`, whose finished function `entry` is.
    ///
    /// # Safety
    /// `entry` must lie in memory that `module` owns.
    pub unsafe fn new(module: JITModule, entry: Entry, bytes: usize) -> Self {
        Self { module: ManuallyDrop::new(module), entry, bytes }
    }

    /// The function. It must not be called after this value is dropped.
    #[inline]
    pub fn entry(&self) -> Entry {
        self.entry
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

// SAFETY: after it is finished the code is read-only, and the module is only touched again by `drop`, which has
// exclusive access.
unsafe impl Send for Code {}
// SAFETY: see above; `entry` may run on many threads at once since kernels write only to their outputs.
unsafe impl Sync for Code {}
