// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <filesystem>
#include <string>

namespace tsar {

// The input folder (images, sparse, sparse/0 where that is a link, or stereo)
// of the workspace `root`, or of the one that it is the output of, in which a
// path is or lies, with links resolved; empty where it is outside of all.
// Neither the path nor the workspace has to exist.
std::string FindInputFolder(const std::filesystem::path& root,
                            const std::filesystem::path& path);

// Programs only read these folders, so nothing else may be written there.
// Throws Error kUnsupported, naming the option, where `path` lies in one of
// them.
void RequireOutsideInputs(const std::filesystem::path& root,
                          const std::filesystem::path& path,
                          const std::string& option);

}  // namespace tsar
