// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <string_view>

namespace tsar {

// The text as one line that no terminal obeys: names and notes come from files
// of others, and what stands in them could rewrite what is on the screen. White
// space of every kind, line ends too, becomes a space; other control
// characters, those that turn the direction of writing, and bytes that are not
// UTF-8 become '?'. All else stays as it is, in any script.
std::string Printable(std::string_view text);

// Takes the first character off a text that is not empty, and gives it as
// Printable() does. Allocates nothing; valid as long as the text is.
std::string_view TakePrintable(std::string_view* text);

// Whether there are control characters in it, which no name of a file needs.
// Bytes that are not UTF-8 count as letters of another encoding.
bool HasControlCharacter(std::string_view text);

// The text as a shell takes it for one word: between quotation marks where it
// needs them.
std::string ShellWord(const std::string& text);

}  // namespace tsar
