// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/import/target_workspace.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"

#include <algorithm>
#include <string>
#include <system_error>

namespace tsar {
namespace {

void WriteTextFile(const ContainedPath& path, const std::string& text) {
  AtomicFile file(path);
  file.Stream() << text;
  file.Commit();
}

}  // namespace

SparseModel ReadTargetModel(const std::filesystem::path& root) {
  std::error_code error;
  for (const char* folder : {"images", "sparse"}) {
    if (!std::filesystem::is_directory(root / folder, error)) {
      throw Error::File(ErrorCode::kNotFound,
                        (root / folder).string(),
                        "no such folder, so this is not a dense workspace",
                        "check " + OptionName("workspace_path") +
                            ", or make the workspace with "
                            "image_undistorter");
    }
  }
  SparseModel model = ReadSparseModel(root / "sparse");
  if (model.images.empty()) {
    throw Error::File(ErrorCode::kNotFound,
                      (root / "sparse").string(),
                      "the sparse model holds no images",
                      "make the workspace again with image_undistorter");
  }
  for (const SparseModel::ModelImage& image : model.images) {
    // Every path of an image is made from its name.
    const std::filesystem::path name(image.name);
    if (name.is_absolute() ||
        std::find(name.begin(), name.end(), "..") != name.end()) {
      throw Error::File(
          ErrorCode::kUnsupported,
          (root / "sparse").string(),
          "the image name " + image.name + " leads out of the workspace",
          "rename the image and make the workspace again");
    }
  }
  return model;
}

StereoFolder::StereoFolder(const std::filesystem::path& root)
    : path_(root, "stereo") {
  is_new_ = !Exists(path_);
  CreateFolders(path_);
}

StereoFolder::~StereoFolder() {
  if (is_new_) {
    try {
      RemoveFolderIfEmpty(path_);
    } catch (const std::exception&) {
      // It stays, empty.
    }
  }
}

void WriteMissingConfigs(const std::filesystem::path& root,
                         const SparseModel& model) {
  std::string patch_match;
  std::string fusion;
  for (const SparseModel::ModelImage& image : model.images) {
    patch_match += image.name + "\n__auto__, 20\n";
    fusion += image.name + "\n";
  }
  const ContainedPath stereo(root, "stereo");
  if (!Exists(stereo / "patch-match.cfg")) {
    WriteTextFile(stereo / "patch-match.cfg", patch_match);
  }
  if (!Exists(stereo / "fusion.cfg")) {
    WriteTextFile(stereo / "fusion.cfg", fusion);
  }
}

}  // namespace tsar
