// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

namespace tsar {

// The text escaped for HTML, between tags and inside quoted attributes.
std::string EscapeHtml(const std::string& text);

// JSON escaped for a script: without "<", which could end a <script>, and
// without the two line separators that JSON allows and older JavaScript does
// not.
std::string EscapeScript(const std::string& json);

// A file name for image `index`: the index, which makes it unique, and the
// ASCII part of the image's name. It has no separators and at most 64 letters.
std::string SafeFileName(int index, const std::string& image_name);

}  // namespace tsar
