// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"

namespace tsar {

// Moves a file that has to make room for another map to stereo/tsar/superseded,
// where this program never touches it again, and returns its new path; the
// caller tells the user. path: the file; map: its map in stereo, whose name it
// keeps, with a number appended where that is taken.
ContainedPath Supersede(const ContainedPath& path, const ContainedPath& map);

}  // namespace tsar
