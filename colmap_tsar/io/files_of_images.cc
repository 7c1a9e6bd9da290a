// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/files_of_images.h"

#include "colmap_tsar/base/error.h"

#include <system_error>

namespace tsar {

namespace fs = std::filesystem;

void RequireNoImageFolder(const fs::path& folder,
                          const fs::path& images,
                          const std::string& content,
                          const std::string& option) {
  std::error_code error;
  if (fs::equivalent(folder, images, error)) {
    throw Error::File(ErrorCode::kBadOption,
                      folder.string(),
                      "is the folder of the images",
                      "give that of their " + content + " as " + option);
  }
}

std::vector<fs::path> FindFilesOfImages(
    const fs::path& folder,
    const std::vector<std::string>& image_names,
    const ImageFileNames& names,
    const std::string& option) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) {
    throw Error::File(ErrorCode::kNotFound,
                      folder.string(),
                      "there is no such folder of " + names.noun + "s",
                      "check " + option);
  }
  std::vector<fs::path> paths;
  bool has_any = false;
  for (const std::string& name : image_names) {
    paths.push_back(names.find(folder, name));
    has_any = has_any || !paths.back().empty();
  }
  if (!has_any) {
    const std::string example = image_names.empty()
                                    ? ""
                                    : "; that of " + image_names.front() +
                                          " would be " +
                                          names.describe(image_names.front());
    throw Error::File(ErrorCode::kNotFound,
                      folder.string(),
                      "holds no " + names.noun + " of any image" + example,
                      "check " + option);
  }
  return paths;
}

}  // namespace tsar
