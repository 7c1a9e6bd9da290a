// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/refine_setup.h"

#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/controllers/workspace_check.h"

#include <algorithm>
#include <exception>

namespace tsar {

Workspace OpenWorkspace(const WorkspaceRefineOptions& options) {
  Workspace workspace(options.workspace_path,
                      options.input_type.value_or(MapType::kGeometric));
  if (!options.input_type && !HasAnyMap(workspace, MapType::kGeometric) &&
      HasAnyMap(workspace, MapType::kPhotometric)) {
    Warn(options.workspace_path.string() +
         ": there are no geometric maps; refining the photometric ones");
    return Workspace(options.workspace_path, MapType::kPhotometric);
  }
  return workspace;
}

std::map<std::string, std::string> RuntimeText(
    const WorkspaceRefineOptions& options, const RefineDevices& devices) {
  TextStream cache_size;
  cache_size << options.cache_size;
  std::map<std::string, std::string> text = {
      {"device", options.device},
      {"gpu_index", options.gpu_index},
      {"num_threads", std::to_string(options.num_threads)},
      {"cache_size", cache_size.str()},
      {"used", devices.description},
      {"images_at_a_time", std::to_string(devices.workers.size())}};
  for (const RunSummary::GpuMemory& peak : PeakGpuMemory(devices)) {
    text["peak_bytes of " + peak.gpu] = std::to_string(peak.num_bytes);
  }
  return text;
}

void RethrowFailure(const ImagePipeline& pipeline) {
  if (pipeline.FirstFailure()) {
    std::rethrow_exception(pipeline.FirstFailure());
  }
}

bool IsComplete(const ImagePipeline& pipeline) {
  return std::none_of(pipeline.Reports().begin(),
                      pipeline.Reports().end(),
                      [](const ImageReport& report) {
                        return report.outcome == ImageReport::Outcome::kNotDone;
                      });
}

Error Interrupted(int num_done, int num_images) {
  return Error(ErrorCode::kInterrupted,
               "interrupted after " + std::to_string(num_done) + " of " +
                   std::to_string(num_images) +
                   " images; run the same command again to go on");
}

}  // namespace tsar
