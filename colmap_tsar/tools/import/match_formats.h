// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/tools/import/match_images.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tsar {

// The steps of MatchImages, each for some of the formats. The input path must
// be an existing folder in normal form.

// Collects the files of all images, each at most once.
class MapCollector {
 public:
  // The model must outlive the collector.
  explicit MapCollector(const SparseModel& model) : model_(model) {}

  // Throws Error kMismatch for a second map of an image.
  void Add(int image, ExternalFiles files);

  // The files by ascending image.
  const std::map<int, ExternalFiles>& Files() const { return files_; }

 private:
  const SparseModel& model_;
  std::map<int, ExternalFiles> files_;
};

// Matches the files of kAcm and kApd.
void MatchNumberedFolders(const MatchOptions& options,
                          const SparseModel& model,
                          MapCollector* collector);

// Returns the number of maps of images that are not in the model.
int MatchDepthImages(const MatchOptions& options,
                     const SparseModel& model,
                     MapCollector* collector);

// A folder's entries in an order that does not depend on the file system.
std::vector<std::filesystem::path> ListEntries(
    const std::filesystem::path& folder);

bool IsFolder(const std::filesystem::path& path);

// Throws Error kUnsupported if a map is no regular file but a folder, a FIFO, a
// device or a dangling link: its image would count as one without a map.
void RequireFile(const std::filesystem::path& path);

// Throws Error kNotFound with the option if it is no folder.
void RequireFolder(const std::filesystem::path& folder,
                   const std::string& option);

// The trailing number of a name: 12 for "2333_00000012".
std::optional<int> TrailingNumber(const std::string& name);

// The images 0, 1, 2, ... of another program as indices into
// SparseModel::images. Throws Error: kNotFound (there is no list), kMismatch
// (the list is empty, or a line names no image of the model or one twice).
std::vector<int> OrderImages(const MatchOptions& options,
                             const SparseModel& model);

// The image of this index. Throws Error kMismatch with its path if too large.
int ImageOfNumber(const std::vector<int>& order,
                  int number,
                  const std::filesystem::path& path);

}  // namespace tsar
