// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

namespace tsar {

// The text as it may stand in HTML, between tags and inside quoted attributes.
std::string EscapeHtml(const std::string& text);

// JSON as it may stand in a script: without "<", which could end a <script>,
// and without the two line separators that JSON allows and older JavaScript
// does not.
std::string EscapeScript(const std::string& json);

// A name for files about image number `index`: the number, which makes it
// unique, and what of the image's name is plain ASCII. It has no separators and
// is at most 64 letters long.
std::string SafeFileName(int index, const std::string& image_name);

}  // namespace tsar
