// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"

namespace tsar {

// Moves a map that stands in the way of another one to stereo/tsar/superseded,
// where this program never touches it again, and returns where it is now; the
// caller tells the user. path: of the file; map: of the map that it is, in
// stereo, whose name it keeps there but for a number where there is such a file
// already.
ContainedPath Supersede(const ContainedPath& path, const ContainedPath& map);

}  // namespace tsar
