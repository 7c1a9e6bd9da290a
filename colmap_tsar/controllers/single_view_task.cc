// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/single_view_task.h"

namespace tsar {

ImageReport SingleViewTask::Begin(size_t index) {
  ImageReport report = RefineMapsTask::Begin(index);
  if (report.outcome == ImageReport::Outcome::kNotDone) {
    images_.WarnOfChanges(index);
  }
  return report;
}

RefineResult SingleViewTask::RefineMaps(size_t index,
                                        size_t worker,
                                        ViewCache::Lease* views) {
  return RunSingleView(index, worker, views, &RefineImage);
}

}  // namespace tsar
