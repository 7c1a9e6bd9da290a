// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

namespace tsar {

// Before the work is done: whether a file may be written where --output_path of
// a command says. Throws Error kNotFound where its folder is missing,
// kUnsupported where it lies among the inputs of
// the workspace, where something else than a file is there, and where a file is
// there and is not to be overwritten. kind: what the file is, "picture".
void RequireWritableOutput(const std::string& workspace_path,
                           const std::string& output_path,
                           const std::string& kind,
                           bool overwrite);

}  // namespace tsar
