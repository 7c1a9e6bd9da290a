// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/progress.h"
#include "colmap_tsar/base/start_thread.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/cli/print_summary.h"
#include "colmap_tsar/cli/standard_streams.h"
#include "colmap_tsar/controllers/refine_workspace.h"
#include "colmap_tsar/store/restore.h"
#include "colmap_tsar/store/workspace_lock.h"

#include <atomic>
#include <chrono>
#include <exception>
#include <filesystem>
#include <future>
#include <mutex>
#include <optional>
#include <ostream>
#include <string>
#include <thread>
#include <utility>

#include "python/bindings.h"
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace py = pybind11;

namespace tsar {
namespace {

// How long a Ctrl-C may wait to be seen, and a line of progress to be shown.
constexpr std::chrono::milliseconds kPollInterval(50);

// Keeps what several threads write to a stream, up to the last flush, until the
// one that may call Python fetches it.
class TextQueue : public std::stringbuf {
 public:
  std::string Take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::exchange(flushed_, "");
  }

 protected:
  int sync() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    flushed_ += str();
    str("");
    return 0;
  }

 private:
  std::mutex mutex_;
  std::string flushed_;
};

// Warnings go to standard error, as those of the program; into none of the maps
// where that is closed.
void PrepareStreams() {
  OpenClosedStandardStreams();
  PrepareWarnings("colmap_tsar");
}

py::dict ToDict(const RunSummary& summary) {
  py::dict kept;
  for (const RunSummary::KeptImage& image : summary.kept) {
    kept[ToText(image.name)] = ToText(image.reason);
  }
  py::dict peak_gpu_memory;
  for (const RunSummary::GpuMemory& peak : summary.peak_gpu_memory) {
    peak_gpu_memory[py::str(peak.gpu)] = peak.num_bytes;
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
  dict["kept"] = kept;
  dict["num_sources_without_maps"] = summary.num_sources_without_maps;
  dict["counts"] = summary.counts;
  dict["seconds"] = summary.seconds;
  dict["wall_seconds"] = summary.wall_seconds;
  dict["peak_gpu_memory"] = peak_gpu_memory;
  dict["text"] = ToText(text.str());
  return dict;
}

// Runs the handlers of signals that came in, and shows what the work has
// written. Both may raise.
void ServePython(TextQueue* text, const py::object& report) {
  if (PyErr_CheckSignals() != 0) {
    throw py::error_already_set();
  }
  const std::string lines = text->Take();
  if (!lines.empty() && !report.is_none()) {
    report(lines);
  }
}

// The work is done on another thread, without the GIL. This one sleeps, also
// without it, and wakes to serve Python. What a signal's handler or the report
// raises has the work end in order, and is raised once it has.
RunSummary RefineWhileServingPython(const WorkspaceRefineOptions& workspace,
                                    const RefineOptions& options,
                                    const py::object& report,
                                    bool is_terminal) {
  TextQueue text;
  std::ostream out(&text);
  Progress progress(out, is_terminal);
  std::atomic<bool> should_stop = false;
  std::packaged_task<RunSummary()> task([&] {
    return RefineWorkspace(
        workspace, options, progress, [&] { return should_stop.load(); });
  });
  std::future<RunSummary> work = task.get_future();
  const std::jthread thread = StartThread(std::move(task));
  std::exception_ptr raised;
  for (bool is_done = false; !is_done;) {
    {
      const py::gil_scoped_release release;
      is_done = work.wait_for(kPollInterval) == std::future_status::ready;
    }
    try {
      ServePython(&text, raised ? py::none() : report);
    } catch (...) {
      // A second Ctrl-C neither hurries the work, which cannot be left alone,
      // nor stays behind for what the caller does next.
      raised = std::current_exception();
      should_stop = true;
    }
  }
  if (raised) {
    std::rethrow_exception(raised);
  }
  return work.get();
}

py::dict Refine(const std::filesystem::path& workspace_path,
                const py::dict& options,
                const std::filesystem::path& output_path,
                const std::optional<std::string>& input_type,
                const std::string& device,
                const std::string& gpu_index,
                int num_threads,
                double cache_size,
                const std::string& shard,
                const std::string& pass,
                const py::object& report,
                bool is_terminal) {
  WorkspaceRefineOptions workspace;
  workspace.workspace_path = workspace_path;
  workspace.output_path = output_path;
  if (input_type) {
    workspace.input_type = ToMapType(*input_type);
  }
  workspace.devices.choice = ParseDeviceChoice(device);
  workspace.devices.gpu_indices = ParseGpuIndices(gpu_index);
  workspace.devices.num_threads = num_threads;
  workspace.devices.cache_size = cache_size;
  workspace.shard = ParseShard(shard);
  workspace.pass = ParsePass(pass);
  PrepareStreams();
  return ToDict(RefineWhileServingPython(
      workspace, ToRefineOptions(options), report, is_terminal));
}

py::list ToList(const std::vector<std::filesystem::path>& paths) {
  py::list list;
  for (const std::filesystem::path& path : paths) {
    list.append(ToText(path.string()));
  }
  return list;
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
  py::dict dict;
  dict["num_restored"] = result.num_restored;
  dict["kept"] = ToList(result.kept);
  dict["superseded"] = ToList(result.superseded);
  dict["conflicts"] = ToList(result.conflicts);
  return dict;
}

}  // namespace

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
              py::arg("device"),
              py::arg("gpu_index"),
              py::arg("num_threads"),
              py::arg("cache_size"),
              py::arg("shard"),
              py::arg("pass_"),
              py::arg("report"),
              py::arg("is_terminal"));
  module->def("restore",
              &RestoreOriginals,
              py::arg("workspace_path"),
              py::arg("conflicts"));
}

}  // namespace tsar
