// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/report/write_page.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/io/map_paths.h"
#include "colmap_tsar/run/store/image_maps.h"
#include "colmap_tsar/run/store/input_folders.h"
#include "colmap_tsar/run/store/output_folder.h"
#include "colmap_tsar/run/store/record.h"
#include "colmap_tsar/run/store/result_files.h"
#include "colmap_tsar/run/store/workspace_lock.h"
#include "colmap_tsar/tools/report/image_page.h"
#include "colmap_tsar/tools/report/page_text.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace tsar {
namespace {

namespace fs = std::filesystem;

// The folder of a page; the list of its files identifies it.
constexpr OutputFolderKind kPageFolder = {"report",
                                          "a report",
                                          "tsar_report",
                                          "report_path",
                                          "tsar_report.txt",
                                          "tsar_report.txt",
                                          "unfinished_page"};

// The name of the workspace's folder, which identifies it.
std::string WorkspaceName(const Workspace& workspace) {
  const fs::path root = fs::absolute(workspace.Root()).lexically_normal();
  return (root.has_filename() ? root : root.parent_path()).filename().string();
}

std::vector<RunSummary::KeptImage> ListKept(const Workspace& workspace,
                                            const std::vector<int>& refined) {
  std::vector<RunSummary::KeptImage> kept;
  for (const StereoProblem& problem : workspace.Problems()) {
    const int image = problem.reference;
    if (std::ranges::binary_search(refined, image)) {
      continue;
    }
    const std::optional<ImageRecord> record =
        ReadRecord(workspace.Paths(image, workspace.Type()).record);
    kept.push_back(
        {workspace.Name(image),
         record && !record->note.empty() ? record->note : "not refined yet"});
  }
  return kept;
}

// The options in the manifest of the last run; none where there is no manifest.
std::map<std::string, std::string> ReadRunOptions(const Workspace& workspace) {
  InputFile file(GetTsarFolder(workspace.Root()) / "manifest.json");
  const nlohmann::json json =
      nlohmann::json::parse(file, nullptr, /*allow_exceptions=*/false);
  std::map<std::string, std::string> options;
  if (json.is_object() && json.contains("options")) {
    for (const auto& [name, value] : json["options"].items()) {
      options[name] = value.is_string() ? value.get<std::string>() : "";
    }
  }
  return options;
}

std::vector<ImagePage> WriteImages(const Workspace& workspace,
                                   const std::vector<int>& refined,
                                   const fs::path& folder,
                                   const PageOptions& options,
                                   Progress& progress) {
  std::vector<ImagePage> pages(refined.size());
  progress.Start(static_cast<int>(refined.size()));
  ForEachImage(workspace, refined, options.num_threads, [&](size_t i) {
    progress.ThrowIfStopped("interrupted; no page was written");
    pages[i] = WriteImagePage(workspace,
                              refined[i],
                              static_cast<int>(i),
                              folder,
                              options.max_picture_size);
    progress.Advance(true);
  });
  progress.Finish();
  return pages;
}

}  // namespace

int WritePage(const Workspace& workspace,
              const PageOptions& options,
              Progress& progress) {
  RequireOutsideInputs(
      workspace.Root(), options.report_path, OptionName("report_path"));
  // The lock keeps the maps before and after consistent.
  const WorkspaceLock lock(workspace.Root(), WorkspaceLock::Mode::kShared);
  const std::vector<int> refined = RequireRefinedImages(workspace);
  OutputFolder folder(kPageFolder, options.report_path, options.overwrite);
  WarnOfChangedResults(workspace);
  PageData data;
  data.version = TSAR_VERSION;
  data.workspace = WorkspaceName(workspace);
  data.type = ToString(workspace.Type());
  data.options = ReadRunOptions(workspace);
  data.kept = ListKept(workspace, refined);
  data.images = WriteImages(
      workspace, refined, folder.Temporary() / "images", options, progress);
  AtomicFile page(ContainedPath(folder.Temporary(), "index.html"));
  page.Stream() << PageHtml(data);
  page.Commit();
  folder.Commit();
  return static_cast<int>(refined.size());
}

}  // namespace tsar
