// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace tsar {

// One of the files of page/, which the build embeds in the program.
struct PageFile {
  std::string_view name;
  std::string_view content;
};

// All embedded files.
const std::vector<PageFile>& PageFiles();

void ReplaceAll(std::string_view from, std::string_view to, std::string* text);

// The text escaped for HTML, between tags and inside quoted attributes.
std::string EscapeHtml(const std::string& text);

// JSON escaped for a script: without "<", which could end a <script>, and the
// two line separators that older JavaScript forbids.
std::string EscapeScript(const std::string& json);

// A file name for image `index`: the index, which makes it unique, and the
// ASCII part of the image's name. It has no separators and at most 64 letters.
std::string SafeFileName(int index, const std::string& image_name);

}  // namespace tsar
