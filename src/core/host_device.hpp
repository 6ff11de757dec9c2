// PSK_HD marks functions that run on the host and, when compiled by nvcc, on the device too.
#pragma once

#ifdef __CUDACC__
#define PSK_HD __host__ __device__
#else
#define PSK_HD
#endif
