// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/workspace/mask_folder.h"

#include "colmap_tsar/base/error.h"

#include <system_error>

namespace tsar {

void RequireNoImageFolder(const std::filesystem::path& masks,
                          const std::filesystem::path& images,
                          const std::string& option) {
  std::error_code error;
  if (std::filesystem::equivalent(masks, images, error)) {
    throw Error::File(ErrorCode::kBadOption,
                      masks.string(),
                      "is the folder of the images",
                      "give that of their masks as " + option);
  }
}

}  // namespace tsar
