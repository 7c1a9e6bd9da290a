// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <filesystem>
#include <string>

namespace tsar {

// Programs only read the folders images, sparse and stereo of a workspace, so
// nothing else may be written there. Throws Error kUnsupported, naming the
// option, where `path` is or lies in one of them, with links resolved: of the
// workspace `root`, or of any other around the path. Neither the path nor the
// workspace has to exist.
void RequireOutsideInputs(const std::filesystem::path& root,
                          const std::filesystem::path& path,
                          const std::string& option);

}  // namespace tsar
