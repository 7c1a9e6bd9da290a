// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/json_file.h"

#include "colmap_tsar/base/atomic_file.h"

#include <nlohmann/json.hpp>

namespace tsar {
namespace {

template <typename Json>
void Write(const ContainedPath& path, const Json& json) {
  CreateFolders(path.Parent());
  AtomicFile file(path);
  file.Stream() << json.dump(2, ' ', false, Json::error_handler_t::replace)
                << "\n";
  file.Commit();
}

}  // namespace

void WriteJson(const ContainedPath& path, const nlohmann::json& json) {
  Write(path, json);
}

void WriteOrderedJson(const ContainedPath& path,
                      const nlohmann::ordered_json& json) {
  Write(path, json);
}

}  // namespace tsar
