// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/output_file.h"

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/run/store/input_folders.h"

#include <filesystem>
#include <system_error>

namespace tsar {

void RequireWritableOutput(const std::string& workspace_path,
                           const std::string& output_path,
                           const std::string& kind,
                           bool overwrite,
                           const std::string& option_key) {
  const std::filesystem::path path = output_path;
  const std::string option = OptionName(option_key);
  RequireOutsideInputs(workspace_path, path, option);
  std::error_code error;
  const std::filesystem::path folder = UserPath(path).Root();
  if (!std::filesystem::is_directory(folder, error)) {
    throw Error::File(ErrorCode::kNotFound,
                      folder.string(),
                      "no such folder to write the " + kind + " into",
                      "make it, or choose another " + option);
  }
  if (!std::filesystem::exists(std::filesystem::symlink_status(path, error))) {
    return;
  }
  if (!std::filesystem::is_regular_file(path, error)) {
    throw Error::File(ErrorCode::kUnsupported,
                      path.string(),
                      "is there already and is no " + kind,
                      "choose another " + option);
  }
  if (!overwrite) {
    throw Error::File(ErrorCode::kUnsupported,
                      path.string(),
                      "is there already",
                      "give " + OptionName("overwrite") +
                          " 1 to replace it, or choose another " + option);
  }
}

}  // namespace tsar
