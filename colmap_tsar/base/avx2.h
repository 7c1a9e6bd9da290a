// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Dispatch at run time between code for AVX2 and portable code, so that a build
// runs on every machine. AVX2 has vectors of eight floats instead of four, and
// gather loads, and its processors have FMA. Multiplications and additions are
// fused by MultiplyAdd() alone (-ffp-contract=off), so that both give the same
// bits.

// Marks a function that is called only where HasAvx2(): it is compiled for
// AVX2, and so is a copy of everything that it calls.
#if defined(__x86_64__) && defined(__GNUC__)
#define TSAR_FOR_AVX2 __attribute__((target("avx2,fma"), flatten))
#else
#define TSAR_FOR_AVX2
#endif

namespace tsar {

// Whether this machine's processor has AVX2 and FMA; false if it is no x86-64.
bool HasAvx2();

}  // namespace tsar
