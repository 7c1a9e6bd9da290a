// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

namespace tsar {

// Checks, before the work is done, whether a command may write a file to a path
// that an option gives. Throws Error kNotFound where its folder is missing,
// kUnsupported where it lies among the inputs of the workspace, where it is
// something else than a file, and where the file exists and is not to be
// overwritten. kind: the name of the kind of file, "picture".
void RequireWritableOutput(const std::string& workspace_path,
                           const std::string& output_path,
                           const std::string& kind,
                           bool overwrite,
                           const std::string& option_key = "output_path");

}  // namespace tsar
