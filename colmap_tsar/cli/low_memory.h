// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

namespace tsar {

// Whether there is memory for what libraries set up when a program starts. Some
// of them end the program, or write to where nothing is, if there is none.
// Takes none itself, and may be called before they are there.
bool HasMemoryToStart();

// Has that done now which libraries put off until it is needed and which must
// not fail then, so that memory can run out later without harm. Throws
// std::bad_alloc where there is not enough to begin with.
void PrepareForLowMemory();

}  // namespace tsar
