#pragma once
// Ahead of a wave the motion of the soil falls to numbers that are too small for all their digits. Many
// processors take microcode to compute with these, and twenty times as long; GPUs do not mind them.

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace mpm {

#if defined(__SSE2__) || defined(__aarch64__)
inline constexpr bool k_flushes_subnormals = true;
#else
inline constexpr bool k_flushes_subnormals = false;
#endif

/// From here on this thread takes numbers below the smallest normal one (1.2e-38 in single, 2.2e-308 in
/// double precision) for zero. Threads that it starts later do so too (POSIX, pthread_create), so call it
/// before MPI, Kokkos and all else. Nothing changes on a processor that is neither x86-64 nor ARM.
inline void flush_subnormals() {
#if defined(__SSE2__)
  constexpr unsigned k_results = 0x8000,
                     k_arguments = 0x0040;  // of MXCSR: flush to zero, denormals are zeros
  _mm_setcsr(_mm_getcsr() | k_results | k_arguments);
#elif defined(__aarch64__)
  constexpr unsigned long k_flush = 1UL << 24;  // FPCR.FZ
  unsigned long control = 0;
  asm volatile("mrs %0, fpcr" : "=r"(control));
  asm volatile("msr fpcr, %0" : : "r"(control | k_flush));
#endif
}

}  // namespace mpm
