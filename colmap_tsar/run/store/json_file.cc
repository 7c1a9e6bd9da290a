// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/json_file.h"

#include "colmap_tsar/base/atomic_file.h"

#include <nlohmann/json.hpp>

namespace tsar {

void WriteJson(const ContainedPath& path, const nlohmann::json& json) {
  CreateFolders(path.Parent());
  AtomicFile file(path);
  file.Stream() << json.dump(
                       2, ' ', false, nlohmann::json::error_handler_t::replace)
                << "\n";
  file.Commit();
}

}  // namespace tsar
