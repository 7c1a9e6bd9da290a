// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/workspace_model.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/path.h"

#include <algorithm>
#include <string>
#include <vector>

namespace tsar {
namespace {

std::vector<std::string> MissingFiles(const std::filesystem::path& folder,
                                      const std::string& extension) {
  std::vector<std::string> missing;
  for (const char* name : {"cameras", "images", "points3D"}) {
    if (!Exists(folder / (name + extension))) {
      missing.push_back(name + extension);
    }
  }
  return missing;
}

std::string Joined(const std::vector<std::string>& names) {
  std::string joined;
  for (const std::string& name : names) {
    joined += (joined.empty() ? "" : ", ") + name;
  }
  return joined;
}

// Throws if only some files of a model exist: another folder's model may be a
// different one.
bool HoldsModel(const std::filesystem::path& folder) {
  const std::vector<std::string> binary = MissingFiles(folder, ".bin");
  const std::vector<std::string> text = MissingFiles(folder, ".txt");
  if (binary.empty() || text.empty()) {
    return true;
  }
  const std::vector<std::string>& fewer =
      text.size() < binary.size() ? text : binary;
  if (fewer.size() == 3) {
    return false;
  }
  throw Error::File(ErrorCode::kNotFound,
                    folder.string(),
                    "the sparse model is not complete: " + Joined(fewer) +
                        (fewer.size() == 1 ? " is" : " are") + " missing",
                    "copy it again, or make the workspace with "
                    "image_undistorter");
}

// Every path of an image is derived from its name, so a name must not leave the
// workspace.
void RequireSafeName(const std::filesystem::path& folder,
                     const std::string& name) {
  const std::filesystem::path path(name);
  if (path.is_absolute() ||
      std::find(path.begin(), path.end(), "..") != path.end()) {
    throw Error::File(ErrorCode::kUnsupported,
                      folder.string(),
                      "the image name " + name + " leads out of the workspace",
                      "rename the image and make the workspace again");
  }
}

}  // namespace

std::filesystem::path FindModelFolder(const std::filesystem::path& root) {
  const std::filesystem::path sparse = root / "sparse";
  for (const std::filesystem::path& folder : {sparse, sparse / "0"}) {
    if (HoldsModel(folder)) {
      return folder;
    }
  }
  throw Error::File(ErrorCode::kNotFound,
                    sparse.string(),
                    "no sparse model: cameras, images and points3D, .bin or "
                    ".txt, are neither there nor in its folder 0",
                    "make the workspace with image_undistorter");
}

SparseModel ReadWorkspaceModel(const std::filesystem::path& model_folder) {
  SparseModel model = ReadSparseModel(model_folder);
  for (const SparseModel::ModelImage& image : model.images) {
    RequireSafeName(model_folder, image.name);
  }
  return model;
}

}  // namespace tsar
