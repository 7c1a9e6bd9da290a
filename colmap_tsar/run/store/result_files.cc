// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/result_files.h"

#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/run/store/record.h"

#include <algorithm>
#include <optional>

namespace tsar {

std::array<ResultFile, 4> ResultFiles(const MapPaths& paths) {
  return {{{"confidence", &paths.confidence},
           {"provenance", &paths.provenance},
           {"planes", &paths.planes},
           {"sigma", &paths.sigma}}};
}

void RemoveResults(const MapPaths& paths) {
  for (const ResultFile& file : ResultFiles(paths)) {
    RemoveFile(*file.path);
  }
}

void WarnOfChangedResults(const Workspace& workspace,
                          const std::vector<std::string>& names) {
  std::string first;
  int num_changed = 0;
  for (int image = 0; image < workspace.NumImages(); ++image) {
    const MapPaths paths = workspace.Paths(image, workspace.Type());
    const std::optional<ImageRecord> record = ReadRecordIfValid(paths.record);
    if (!record || record->status != ImageStatus::kDone) {
      continue;
    }
    for (const ResultFile& file : ResultFiles(paths)) {
      const bool is_wanted =
          names.empty() || std::ranges::find(names, file.name) != names.end();
      if (!is_wanted || !record->files.contains(file.name) ||
          record->Has(file.name, *file.path)) {
        continue;
      }
      first = num_changed == 0 ? file.path->string() : first;
      ++num_changed;
    }
  }
  if (num_changed > 0) {
    Warn(first +
         (num_changed > 1 ? " and " + std::to_string(num_changed - 1) + " more"
                          : std::string()) +
         ": gone, or changed since tsar_refine wrote it, so that what is made "
         "of it lacks something or is wrong; run tsar_refine again, which "
         "makes it anew");
  }
}

}  // namespace tsar
