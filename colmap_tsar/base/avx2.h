// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// Code for processors with AVX2 beside the code for all, chosen when the
// program runs, so that what is built on one machine runs on every other.
// Vectors hold eight numbers there instead of four, and are loaded from eight
// places at once. Multiplications and additions stay apart (-ffp-contract=off),
// and so both give the same bits.

// Marks a function that is called only where HasAvx2(): it is compiled for
// AVX2, and so is a copy of everything that it calls.
#if defined(__x86_64__) && defined(__GNUC__)
#define TSAR_FOR_AVX2 __attribute__((target("avx2"), flatten))
#else
#define TSAR_FOR_AVX2
#endif

namespace tsar {

// Of this machine's processor; false where it is no x86-64.
bool HasAvx2();

}  // namespace tsar
