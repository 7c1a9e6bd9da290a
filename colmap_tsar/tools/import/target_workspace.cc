// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/target_workspace.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/io/sparse_model.h"

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
                            ", or make the workspace with image_undistorter");
    }
  }
  const std::filesystem::path model_folder = FindModelFolder(root);
  SparseModel model = ReadWorkspaceModel(model_folder);
  if (model.images.empty()) {
    throw Error::File(ErrorCode::kNotFound,
                      model_folder.string(),
                      "the sparse model holds no images",
                      "make the workspace again with image_undistorter");
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
      // The empty folder remains.
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
