// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <string_view>

namespace tsar {

// The text as one line without control characters: names and notes come from
// untrusted files and could rewrite the screen. White space, including line
// ends, becomes a space, other control characters and what is not UTF-8 '?'.
std::string Printable(std::string_view text);

// Removes the first character of a nonempty text and returns it as Printable()
// does. Allocates nothing; valid as long as the text.
std::string_view TakePrintable(std::string_view* text);

// Whether a text has control characters, which no file name needs.
bool HasControlCharacter(std::string_view text);

}  // namespace tsar
