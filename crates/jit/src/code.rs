//! Executable memory that is freed when its last user is gone.

use crate::rounding::KernelEntry;
use cranelift_jit::JITModule;
use cranelift_module::FuncId;
use std::mem::ManuallyDrop;

/// A module that frees its memory when it is dropped.
pub struct ExecutableMemory(ManuallyDrop<JITModule>);

impl ExecutableMemory {
    pub fn new(module: JITModule) -> Self {
        Self(ManuallyDrop::new(module))
    }

    pub fn module(&mut self) -> &mut JITModule {
        &mut self.0
    }
}

impl Drop for ExecutableMemory {
    fn drop(&mut self) {
        // SAFETY: the module is taken once, here. No use of its memory outlives this value: a copy
        // of an entry exists only during a call that borrows its `Code`.
        unsafe {
            ManuallyDrop::take(&mut self.0).free_memory();
        }
    }
}

/// One finished function and the memory it lives in.
pub struct Code {
    _memory: ExecutableMemory,
    entry: KernelEntry,
    /// Size of the machine code in bytes.
    pub bytes: usize,
    /// Width in bytes of the vectors that the code computes with.
    pub width: usize,
}

impl Code {
    /// Takes the function `id`, which has been finalized in `memory`.
    pub fn new(memory: ExecutableMemory, id: FuncId, bytes: usize, width: usize) -> Self {
        let entry = memory.0.get_finalized_function(id);
        Self { _memory: memory, entry, bytes, width }
    }

    /// Entry point of the function. It must not be called after the `Code` is dropped.
    #[inline]
    pub fn entry(&self) -> KernelEntry {
        self.entry
    }
}

// SAFETY: finished code is read-only. `JITModule` has interior mutability, but nothing reaches it
// through `&Code`: only `drop`, which has exclusive access, touches the module again.
unsafe impl Send for Code {}
// SAFETY: as above. Many threads may run `entry` at once, since kernels write only to their
// outputs.
unsafe impl Sync for Code {}
