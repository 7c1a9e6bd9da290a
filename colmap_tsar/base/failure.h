// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <exception>
#include <string>

namespace tsar {

// For the user where memory ran out; in a form that takes none.
inline constexpr char kOutOfMemory[] =
    "out of memory; close other programs or work on smaller images";

// Whether an exception, also one of OpenCV, says that memory ran out.
bool IsOutOfMemory(const std::exception_ptr& failure);

// An exception as a line for the user: errors of this project as they are, all
// others with what can be said about them. Not null. Throws std::bad_alloc
// where there is no memory for the text.
std::string FailureText(const std::exception_ptr& failure);

}  // namespace tsar
