// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

namespace tsar {

// Whether there is memory for the initialization of libraries when a program
// starts. Without it, some end the program or write to invalid addresses.
// Allocates none itself, and may be called before they are initialized.
bool HasMemoryToStart();

// Forces the lazy initialization of libraries that must not fail later, so that
// memory can run out later without harm. Throws std::bad_alloc where there is
// not enough to begin with.
void PrepareForLowMemory();

}  // namespace tsar
