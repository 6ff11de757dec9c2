// What nvcc and the host compiler spell differently.
#pragma once

/// PSK_HD marks functions that run on the host and, when compiled by nvcc, on the device too.
#ifdef __CUDACC__
#define PSK_HD __host__ __device__
#else
#define PSK_HD
#endif

/// PSK_SELDOM keeps a function that few threads call out of the code, and its variables out of the registers, of the others.
#ifdef __CUDACC__
#define PSK_SELDOM __noinline__
#else
#define PSK_SELDOM
#endif

/// PSK_INTO_LOOP puts a function into the loops that use it, where g++ and clang would leave a call. nvcc needs no word for it.
#if defined(__GNUC__) && !defined(__CUDACC__)
#define PSK_INTO_LOOP inline __attribute__((always_inline))
#else
#define PSK_INTO_LOOP inline
#endif

/// PSK_UNROLL unrolls the loop after it, so that small arrays indexed by its counter stay in registers.
/// PSK_UNROLL_BY_4 lets a GPU fetch what four rounds of a longer loop need before it uses it.
#if defined(__CUDA_ARCH__)
#define PSK_UNROLL_BY_4 _Pragma("unroll 4")
#else
#define PSK_UNROLL_BY_4
#endif
#if defined(__CUDA_ARCH__)
#define PSK_UNROLL _Pragma("unroll")
#elif defined(__CUDACC__)  // the host half of a .cu file: small, and each of its compilers knows another spelling
#define PSK_UNROLL
#else
#define PSK_UNROLL _Pragma("GCC unroll 64")
#endif
