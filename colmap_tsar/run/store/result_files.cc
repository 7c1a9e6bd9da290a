// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/store/result_files.h"

#include "colmap_tsar/base/folder.h"
#include "colmap_tsar/base/path.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/run/store/evidence_file.h"
#include "colmap_tsar/run/store/record.h"

#include <algorithm>
#include <optional>
#include <set>

namespace tsar {
namespace {

// Gives one warning about these files.
void WarnOf(const std::vector<std::string>& paths, const std::string& what) {
  if (!paths.empty()) {
    Warn(AndMore(paths[0], paths.size()) + ": " + what);
  }
}

}  // namespace

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
  const std::vector<int> references = workspace.References();
  const std::set<int> is_reference(references.begin(), references.end());
  std::vector<std::string> changed;
  std::vector<std::string> missing;
  std::set<std::string> options;
  int num_refined = 0;
  int num_left = 0;
  for (int image = 0; image < workspace.NumImages(); ++image) {
    const MapPaths paths = workspace.Paths(image, workspace.Type());
    const std::optional<ImageRecord> record = ReadRecordIfValid(paths.record);
    const ImageStatus status = record ? record->status : ImageStatus::kPending;
    const bool is_done = status == ImageStatus::kDone;
    const bool is_refined = is_done && record->Has("depth", paths.depth);
    num_refined += is_refined ? 1 : 0;
    if (!is_refined && is_reference.contains(image)) {
      const bool has_depth = Exists(paths.depth);
      const bool has_both = has_depth && Exists(paths.normal);
      num_left += has_both && status != ImageStatus::kKept ? 1 : 0;
      if (!has_both && !is_done) {
        missing.push_back((has_depth ? paths.normal : paths.depth).string());
      }
    }
    if (!is_done) {
      continue;
    }
    options.insert(record->options_hash);
    const auto check = [&](const char* name, const ContainedPath& path) {
      const bool is_wanted =
          names.empty() || std::ranges::find(names, name) != names.end();
      if (is_wanted && record->files.contains(name) &&
          !(&path == &paths.depth ? is_refined : record->Has(name, path))) {
        changed.push_back(path.string());
      }
    };
    check("depth", paths.depth);
    check("normal", paths.normal);
    for (const ResultFile& file : ResultFiles(paths)) {
      check(file.name, *file.path);
    }
  }
  WarnOf(changed,
         "gone, or changed since tsar_refine wrote it, so that what is made "
         "of it lacks something or is wrong; run tsar_refine again, which "
         "makes it anew");
  if (missing.size() < references.size()) {
    WarnOf(missing,
           "there is no such map, so that its image is left out; run "
           "patch_match_stereo again for it");
  }
  // Before the first image is refined, all are observed.
  const bool has_begun =
      num_refined > 0 || Exists(GetEvidenceFolder(workspace.Root()));
  if (has_begun && num_left > 0) {
    WarnOf({workspace.Root().string()},
           std::to_string(num_refined) + " of " +
               std::to_string(num_refined + num_left) +
               " images are refined, and the others as they were before; run "
               "tsar_refine again, which goes on");
  }
  if (options.size() > 1) {
    WarnOf({workspace.Root().string()},
           "its images were refined with different options, as where a second "
           "run was stopped; run tsar_refine again, which makes them alike");
  }
}

}  // namespace tsar
