//! The one place where the rounding mode changes: a call into native code and back.

/// A kernel's first instruction. It is called by the System V convention on `x86_64` and by AAPCS64
/// on `aarch64`, whatever the operating system's own may be, with: the input batch, the output
/// batch, lanes in use, parameters, guard words (reserved: null for now).
pub type Entry = *const u8;

/// MXCSR: all exceptions masked, subnormals kept, rounding to +∞ or (the default everywhere else)
/// to nearest.
#[cfg(target_arch = "x86_64")]
static ROUND_UP: u32 = 0x5f80;
#[cfg(target_arch = "x86_64")]
static ROUND_NEAREST: u32 = 0x1f80;

/// Calls `entry` with the rounding mode as it is: to nearest.
///
/// # Safety
/// As [`call_rounding_up`].
#[cfg(feature = "comparison")]
#[inline]
pub unsafe fn call_rounding_to_nearest(
    entry: Entry,
    input: *const u8,
    output: *mut u8,
    count: usize,
    parameters: *const u8,
) {
    #[cfg(not(target_arch = "x86_64"))]
    type Kernel = unsafe extern "C" fn(*const u8, *mut u8, usize, *const u8, usize);
    #[cfg(target_arch = "x86_64")]
    type Kernel = unsafe extern "sysv64" fn(*const u8, *mut u8, usize, *const u8, usize);
    // SAFETY: the caller's promise; kernels have this signature and convention, and know nothing of
    // the mode.
    unsafe {
        let kernel: Kernel = std::mem::transmute(entry);
        kernel(input, output, count, parameters, 0);
    }
}

/// Calls `entry` with the rounding mode set to +∞, and restores the default mode.
///
/// # Safety
/// `entry` must be a kernel whose input, output and parameters these pointers satisfy. It must not
/// unwind.
#[inline]
pub unsafe fn call_rounding_up(
    entry: Entry,
    input: *const u8,
    output: *mut u8,
    count: usize,
    parameters: *const u8,
) {
    // SAFETY: the block declares every register that a function of this convention may change,
    // keeps `entry` in one that the callee preserves, and leaves MXCSR at the default that Rust
    // code assumes. The stack is given back as it was; until then what a kernel puts on it, below a
    // return address and a register, is aligned as the widest vectors are, or each of them would
    // lie in two lines of the cache. The two statics are plain memory that `ldmxcsr` reads. What
    // the callee reads and writes is the caller's promise.
    #[cfg(target_arch = "x86_64")]
    unsafe {
        std::arch::asm!(
            "mov r13, rsp",
            "and rsp, -64",
            "sub rsp, 48",
            "ldmxcsr [rip + {up}]",
            "call r12",
            "ldmxcsr [rip + {nearest}]",
            "mov rsp, r13",
            up = sym ROUND_UP,
            nearest = sym ROUND_NEAREST,
            in("r12") entry,
            out("r13") _,
            in("rdi") input,
            in("rsi") output,
            in("rdx") count,
            in("rcx") parameters,
            in("r8") 0usize,
            clobber_abi("sysv64"),
        );
    }
    // SAFETY: as above; FPCR bits 23:22 = 01 round to +∞, and 0 is the default. x20 to x22 are
    // preserved by the callee.
    #[cfg(target_arch = "aarch64")]
    unsafe {
        std::arch::asm!(
            "msr fpcr, x21",
            "blr x20",
            "msr fpcr, x22",
            in("x20") entry,
            in("x21") 1u64 << 22,
            in("x22") 0u64,
            in("x0") input,
            in("x1") output,
            in("x2") count,
            in("x3") parameters,
            in("x4") 0u64,
            clobber_abi("C"),
        );
    }
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
    {
        let _ = (entry, input, output, count, parameters);
        unreachable!("no kernel is ever compiled for this processor");
    }
}
