// Marks functions that both the host compiler and nvcc's device pass may compile.
#pragma once

#ifdef __CUDACC__
#define WEIR_HD __host__ __device__
#else
#define WEIR_HD
#endif
