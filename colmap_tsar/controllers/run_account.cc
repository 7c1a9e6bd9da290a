// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/run_account.h"

#include "colmap_tsar/base/text_stream.h"

namespace tsar {

std::map<std::string, std::string> RuntimeText(const DeviceOptions& options,
                                               const RefineDevices& devices) {
  TextStream cache_size;
  cache_size << options.cache_size;
  std::map<std::string, std::string> text = {
      {"device", ToString(options.choice)},
      {"gpu_index", GpuIndicesText(options.gpu_indices)},
      {"num_threads", std::to_string(options.num_threads)},
      {"cache_size", cache_size.str()},
      {"used", devices.description},
      {"images_at_a_time", std::to_string(devices.workers.size())}};
  for (const RunSummary::GpuMemory& peak : PeakGpuMemory(devices)) {
    text["peak_bytes of " + peak.gpu] = std::to_string(peak.num_bytes);
  }
  return text;
}

void RequireComplete(const PipelineOutcome& outcome, size_t num_wanted) {
  outcome.RethrowFailure();
  if (!outcome.IsComplete()) {
    throw Error(ErrorCode::kInterrupted,
                "interrupted after " + std::to_string(outcome.NumDone()) +
                    " of " + std::to_string(num_wanted) +
                    " images; run the same command again to go on");
  }
}

}  // namespace tsar
