// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/tools/import/match_images.h"

#include <filesystem>
#include <map>
#include <vector>

namespace tsar {

// The steps of MatchImages, each for some of the formats. The input path must
// be an existing folder in normal form.

// Collects the files of all images; each image may come once.
class MapCollector {
 public:
  // The model must outlive the collector.
  explicit MapCollector(const SparseModel& model) : model_(model) {}

  // Throws Error kMismatch for a second map of an image.
  void Add(int image, ExternalFiles files);

  // By ascending image.
  const std::map<int, ExternalFiles>& Files() const { return files_; }

 private:
  const SparseModel& model_;
  std::map<int, ExternalFiles> files_;
};

// For kAcm and kApd.
void MatchNumberedFolders(const MatchOptions& options,
                          const SparseModel& model,
                          MapCollector* collector);

// These two return the number of maps of images that the model does not hold.
int MatchDmaps(const MatchOptions& options,
               const SparseModel& model,
               MapCollector* collector);
int MatchDepthImages(const MatchOptions& options,
                     const SparseModel& model,
                     MapCollector* collector);

// A folder's entries in an order that does not depend on the file system.
std::vector<std::filesystem::path> ListEntries(
    const std::filesystem::path& folder);

bool IsFolder(const std::filesystem::path& path);

// Throws Error kUnsupported where what has the name of an image's map is no
// file: a folder, a FIFO, a device, a link that leads nowhere. To pass it over
// would count the image among those without a map.
void RequireFile(const std::filesystem::path& path);

// Error kNotFound that names the option where it is no folder.
void RequireFolder(const std::filesystem::path& folder,
                   const std::string& option);

}  // namespace tsar
