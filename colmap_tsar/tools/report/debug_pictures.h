// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/view/refine_observer.h"

#include <filesystem>
#include <memory>
#include <string>

namespace tsar {

// Draws the results of the stages of a run: for each image a folder of its
// name, including subfolders, with a PNG for each stage named by its index and
// name, such as "left/0001.jpg/07_score.png".
class DebugPictures : public RefineObserver {
 public:
  // Creates the folder; pictures of earlier runs with the same names are
  // replaced. Throws Error: kUnsupported (it has other content), kIo.
  explicit DebugPictures(const std::filesystem::path& folder);

  // Drawing throws Error kIo.
  std::unique_ptr<StageObserver> Observe(const std::string& image_name,
                                         const Image<float>& depth) override;

 private:
  std::filesystem::path folder_;
};

// The path of the picture of a stage in the folder.
std::filesystem::path DebugPicturePath(const std::filesystem::path& folder,
                                       const std::string& image_name,
                                       RefineStage stage);

// The names and descriptions of all pictures, for help texts.
std::string DebugPicturesText();

}  // namespace tsar
