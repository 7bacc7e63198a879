//! Executable memory that is freed when its last user is gone.

use crate::rounding::Entry;
use cranelift_jit::JITModule;
use cranelift_module::FuncId;
use std::mem::ManuallyDrop;

/// A module that frees its memory when it is dropped.
pub struct Memory(ManuallyDrop<JITModule>);

impl Memory {
    pub fn new(module: JITModule) -> Self {
        Self(ManuallyDrop::new(module))
    }

    pub fn module(&mut self) -> &mut JITModule {
        &mut self.0
    }
}

impl Drop for Memory {
    fn drop(&mut self) {
        // SAFETY: the module is taken once, here. No use of its memory outlives this value: an
        // entry is copied only for the duration of a call that borrows its `Code`.
        unsafe {
            ManuallyDrop::take(&mut self.0).free_memory();
        }
    }
}

/// One finished function and the memory it lives in.
pub struct Code {
    _memory: Memory,
    entry: Entry,
    /// Size of the machine code in bytes.
    pub bytes: usize,
    /// Bytes of the vectors that it computes with.
    pub width: usize,
}

impl Code {
    /// The function that was finished in `memory` as `id`.
    pub fn new(memory: Memory, id: FuncId, bytes: usize, width: usize) -> Self {
        let entry = memory.0.get_finalized_function(id);
        Self { _memory: memory, entry, bytes, width }
    }

    /// The function. It must not be called after this value is dropped.
    #[inline]
    pub fn entry(&self) -> Entry {
        self.entry
    }
}

// SAFETY: after it is finished the code is read-only. `JITModule` has interior mutability, but
// nothing reaches it through `&Code`: the module is only touched again by `drop`, which has
// exclusive access.
unsafe impl Send for Code {}
// SAFETY: see above; `entry` may run on many threads at once since kernels write only to their
// outputs.
unsafe impl Sync for Code {}
