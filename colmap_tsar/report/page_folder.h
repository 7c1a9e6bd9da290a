// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/store/output_folder.h"

namespace tsar {

// The folder of a page.
inline constexpr OutputFolderKind kPageFolder = {"report",
                                                 "a report",
                                                 "tsar_report",
                                                 "report_path",
                                                 "data/report.js",
                                                 "data/files.txt",
                                                 "unfinished_page"};

}  // namespace tsar
