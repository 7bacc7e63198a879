//! The calls into native code, the one place where the rounding mode changes.

/// Address of a kernel's first instruction. Kernels use the System V convention on `x86_64` and
/// AAPCS64 on `aarch64`, on any operating system. Their arguments are the input batch, the output
/// batch, the number of lanes in use, the parameters, and guard words (reserved, null).
pub type KernelEntry = *const u8;

/// Two values of MXCSR: for rounding to +∞, and for rounding to nearest, the default. Both mask all
/// exceptions and keep subnormals.
#[cfg(target_arch = "x86_64")]
static ROUND_UP: u32 = 0x5f80;
#[cfg(target_arch = "x86_64")]
static ROUND_NEAREST: u32 = 0x1f80;

/// Calls `entry` with the rounding mode set to +∞, then restores the default mode.
///
/// # Safety
/// `entry` must be a kernel that may read and write the memory at these pointers. It must not
/// unwind.
#[inline]
pub unsafe fn call_rounding_up(
    entry: KernelEntry,
    input: *const u8,
    output: *mut u8,
    count: usize,
    parameters: *const u8,
) {
    // SAFETY: the block declares every register that a function of this convention may change. The
    // callee preserves R12 and R13, which hold `entry` and the stack pointer. MXCSR ends at the
    // default that Rust assumes. The two statics are plain memory. The caller vouches for the
    // memory that the callee accesses. The kernel's frame begins at a multiple of 64 bytes, below a
    // return address and a saved register. Otherwise each of its widest vectors would span two
    // cache lines.
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
    // SAFETY: as above. In FPCR, 01 in bits 23:22 rounds to +∞; 0 is the default. The callee
    // preserves x20 to x22.
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
