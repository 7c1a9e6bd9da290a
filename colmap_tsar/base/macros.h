// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Marks a function that runs on the host and, if compiled by nvcc, on the GPU
// too. Per-pixel arithmetic is written once, with this mark.
#ifdef __CUDACC__
#define TSAR_HD __host__ __device__
#else
#define TSAR_HD
#endif
