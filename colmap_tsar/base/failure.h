// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <exception>
#include <string>

namespace tsar {

// The user's message for exhausted memory; it needs no allocation.
inline constexpr char kOutOfMemory[] =
    "out of memory; close other programs or work on smaller images";

// Whether an exception, also one of OpenCV, reports exhausted memory.
bool IsOutOfMemory(const std::exception_ptr& failure);

// The message of an exception (not null) as one line for the user: errors of
// this project unchanged, others with an explanation. Throws std::bad_alloc if
// there is no memory for the text.
std::string FailureText(const std::exception_ptr& failure);

}  // namespace tsar
