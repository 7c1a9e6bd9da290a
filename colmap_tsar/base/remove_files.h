// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/folder.h"

namespace tsar {

// Removes a file or link if it exists. Throws Error kIo.
void RemoveFile(const ContainedPath& path);

// Removes a folder if it is empty; returns whether it did.
bool RemoveFolderIfEmpty(const ContainedPath& path);

// Removes this folder and those below it as far as they are empty.
void RemoveEmptyFolders(const ContainedPath& folder);

// Removes a folder and its content without following links. Throws Error kIo.
void RemoveTree(const ContainedPath& folder);

// Removes the temporaries of AtomicFile that killed programs left behind, in a
// folder and all below it, but no folders of such names. Throws Error kIo.
void RemoveTemporaries(const ContainedPath& folder);

}  // namespace tsar
