// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/controllers/refine_workspace.h"
#include "colmap_tsar/store/restore.h"
#include "colmap_tsar/store/workspace_lock.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "python/bindings.h"
#include "python/serve_python.h"
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace py = pybind11;

namespace tsar {
namespace {

py::dict ToDict(const RunSummary& summary) {
  py::dict kept;
  for (const RunSummary::KeptImage& image : summary.kept) {
    kept[ToText(image.name)] = ToText(image.reason);
  }
  TextStream text;
  PrintSummary(summary, text);
  py::dict dict;
  dict["workspace_path"] = summary.workspace_path;
  dict["input_type"] = ToString(summary.type);
  dict["device"] = summary.device;
  dict["num_workers"] = summary.num_workers;
  dict["num_images"] = summary.num_images;
  dict["num_observed"] = summary.num_observed;
  dict["num_refined"] = summary.num_refined;
  dict["num_skipped"] = summary.num_skipped;
  dict["num_masks"] = summary.num_masks;
  dict["kept"] = kept;
  dict["num_sources_without_maps"] = summary.num_sources_without_maps;
  dict["counts"] = summary.counts;
  dict["seconds"] = summary.seconds;
  dict["wall_seconds"] = summary.wall_seconds;
  dict["peak_gpu_memory"] = ToDict(summary.peak_gpu_memory);
  dict["text"] = ToText(text.str());
  return dict;
}

py::dict Refine(const std::filesystem::path& workspace_path,
                const py::dict& options,
                const std::filesystem::path& output_path,
                const std::optional<std::string>& input_type,
                const std::filesystem::path& image_list_path,
                const std::filesystem::path& mask_path,
                const std::string& device,
                const std::string& gpu_index,
                int num_threads,
                double cache_size,
                const std::string& shard,
                const std::string& pass,
                const py::tuple& listeners) {
  WorkspaceRefineOptions workspace;
  workspace.workspace_path = workspace_path;
  workspace.output_path = output_path;
  if (input_type) {
    workspace.input_type = ToMapType(*input_type);
  }
  workspace.image_list_path = image_list_path;
  workspace.mask_path = mask_path;
  workspace.devices.choice = ParseDeviceChoice(device);
  workspace.devices.gpu_indices = ParseGpuIndices(gpu_index);
  workspace.devices.num_threads = num_threads;
  workspace.devices.cache_size = cache_size;
  workspace.shard = ParseShard(shard);
  workspace.pass = ParsePass(pass);
  const RefineOptions refine = ToRefineOptions(options);
  RunSummary summary;
  WorkWhileServingPython(
      "refine",
      ToPythonListeners(listeners),
      [&](Progress& progress, const std::function<bool()>& should_stop) {
        summary = RefineWorkspace(workspace, refine, progress, should_stop);
      });
  return ToDict(summary);
}

py::dict RestoreOriginals(const std::filesystem::path& workspace_path,
                          const std::string& conflicts) {
  PrepareStreams();
  RestoreResult result;
  {
    const py::gil_scoped_release release;
    const WorkspaceLock lock(workspace_path);
    result = Restore(workspace_path, ParseRestoreConflicts(conflicts));
  }
  // Those are for the user to decide about as well.
  result.conflicts.insert(
      result.conflicts.end(), result.lost.begin(), result.lost.end());
  return ToRestorationDict(result, result.num_restored);
}

}  // namespace

py::dict ToDict(const std::vector<RunSummary::GpuMemory>& peaks) {
  py::dict dict;
  for (const RunSummary::GpuMemory& peak : peaks) {
    dict[py::str(peak.gpu)] = peak.num_bytes;
  }
  return dict;
}

py::list ToTexts(const std::vector<std::filesystem::path>& paths) {
  py::list list;
  for (const std::filesystem::path& path : paths) {
    list.append(ToText(path.string()));
  }
  return list;
}

MapType ToMapType(const std::string& input_type) {
  for (const MapType type : {MapType::kGeometric, MapType::kPhotometric}) {
    if (ToString(type) == input_type) {
      return type;
    }
  }
  throw Error(ErrorCode::kBadOption,
              "input_type: '" + input_type +
                  "' is not known; give geometric or photometric");
}

void BindRefine(py::module_* module) {
  module->def("refine",
              &Refine,
              py::arg("workspace_path"),
              py::arg("options"),
              py::arg("output_path"),
              py::arg("input_type"),
              py::arg("image_list_path"),
              py::arg("mask_path"),
              py::arg("device"),
              py::arg("gpu_index"),
              py::arg("num_threads"),
              py::arg("cache_size"),
              py::arg("shard"),
              py::arg("pass_"),
              py::arg("listeners"));
  module->def("restore",
              &RestoreOriginals,
              py::arg("workspace_path"),
              py::arg("conflicts"));
}

}  // namespace tsar
