//! Executable memory that is freed when its last user is gone.

use crate::rounding::Entry;
use cranelift_jit::JITModule;
use cranelift_module::FuncId;
use std::mem::ManuallyDrop;

/// A vector of the pool, aligned as vector instructions want it.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub struct Constant(u128);

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
        // SAFETY: the module is taken once, here. No use of its memory outlives this value: an entry is copied only for
        // the duration of a call that borrows its `Code`.
        unsafe {
            ManuallyDrop::take(&mut self.0).free_memory();
        }
    }
}

/// One finished function and the memory it lives in.
pub struct Code {
    _memory: Memory,
    entry: Entry,
    /// What `pool` points at: kept alive, never read from here.
    _constants: Box<[Constant]>,
    /// The address of the constants, which the function reads from here.
    pool: *const Constant,
    /// Size of the machine code in bytes.
    pub bytes: usize,
}

impl Code {
    /// The function that was finished in `memory` as `id`, and the constants that it reads.
    pub fn new(memory: Memory, id: FuncId, constants: Vec<u128>, bytes: usize) -> Self {
        let entry = memory.0.get_finalized_function(id);
        let constants: Box<[Constant]> = constants.into_iter().map(Constant).collect();
        let pool = constants.as_ptr();
        Self { _memory: memory, entry, _constants: constants, pool, bytes }
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

// SAFETY: after it is finished the code is read-only, as are its constants, which move with the box that owns them
// and not in memory. `JITModule` has interior mutability, but nothing reaches it through `&Code`: the module is only
// touched again by `drop`, which has exclusive access.
unsafe impl Send for Code {}
// SAFETY: see above; `entry` may run on many threads at once since kernels write only to their outputs.
unsafe impl Sync for Code {}
