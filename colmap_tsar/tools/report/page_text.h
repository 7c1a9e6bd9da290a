// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/run_summary.h"
#include "colmap_tsar/tools/report/image_page.h"

#include <map>
#include <string>
#include <vector>

namespace tsar {

// The content of the page. Texts may be any bytes.
struct PageData {
  std::string version;
  std::string workspace;
  std::string type;
  std::vector<ImagePage> images;
  std::vector<RunSummary::KeptImage> kept;
  // The options of the run that made the maps; empty: not known.
  std::map<std::string, std::string> options;
};

// The page: HTML with its style and script, and pictures in images/FOLDER.
std::string PageHtml(const PageData& data);

// The text escaped for HTML, between tags and inside quoted attributes.
std::string EscapeHtml(const std::string& text);

// A file name for image `index`: the index, which makes it unique, and the
// ASCII part of the image's name. It has no separators and at most 64 letters.
std::string SafeFileName(int index, const std::string& image_name);

}  // namespace tsar
