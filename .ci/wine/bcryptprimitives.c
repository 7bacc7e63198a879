/* Stands in for a library of Windows that old versions of wine lack. Rust's standard library needs
 * one function of it, `ProcessPrng`, which fills memory with random bytes. */
#include <windows.h>

/* `RtlGenRandom`, by the name that it has in the library. */
BOOLEAN NTAPI SystemFunction036(PVOID bytes, ULONG length);

__declspec(dllexport) BOOL WINAPI ProcessPrng(PBYTE bytes, SIZE_T length) {
    return SystemFunction036(bytes, (ULONG)length);
}
