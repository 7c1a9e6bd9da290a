// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/import/target_workspace.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"

#include <string>
#include <system_error>

namespace tsar {
namespace {

namespace fs = std::filesystem;

void WriteTextFile(const ContainedPath& path, const std::string& text) {
  AtomicFile file(path);
  file.Stream() << text;
  file.Commit();
}

}  // namespace

SparseModel ReadTargetModel(const fs::path& root) {
  std::error_code error;
  for (const char* folder : {"images", "sparse"}) {
    if (!fs::is_directory(root / folder, error)) {
      throw Error::File(ErrorCode::kNotFound,
                        (root / folder).string(),
                        "no such folder, so this is not a dense workspace",
                        "check " + OptionName("workspace_path") +
                            ", or make the workspace with image_undistorter");
    }
  }
  const fs::path model_folder = FindModelFolder(root);
  SparseModel model = ReadWorkspaceModel(model_folder);
  if (model.images.empty()) {
    throw Error::File(ErrorCode::kNotFound,
                      model_folder.string(),
                      "the sparse model holds no images",
                      "make the workspace again with image_undistorter");
  }
  return model;
}

void WriteInputs(const fs::path& source,
                 const SparseModel& model,
                 const ContainedPath& root) {
  std::string patch_match;
  std::string fusion;
  for (const SparseModel::ModelImage& image : model.images) {
    patch_match += image.name + "\n__auto__, 20\n";
    fusion += image.name + "\n";
    std::error_code error;
    // A link to a photo may be relative.
    const fs::path photo = fs::canonical(source / "images" / image.name, error);
    if (!error) {
      LinkOrCopyFile(photo, root / "images" / image.name);
    }
  }
  CreateFolders(root / "images");
  CreateFolders(root / "sparse");
  for (const fs::path& file : FindSparseModelFiles(FindModelFolder(source))) {
    CopyFile(file, root / "sparse" / file.filename());
  }
  for (const char* folder : {"depth_maps", "normal_maps"}) {
    CreateFolders(root / "stereo" / folder);
  }
  WriteTextFile(root / "stereo" / "patch-match.cfg", patch_match);
  WriteTextFile(root / "stereo" / "fusion.cfg", fusion);
}

}  // namespace tsar
