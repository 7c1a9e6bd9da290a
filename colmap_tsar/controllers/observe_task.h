// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/controllers/evidence_store.h"
#include "colmap_tsar/controllers/refine_task.h"

#include <cstddef>
#include <vector>

namespace tsar {

// The first of two passes: what each image observes goes to the store. Left
// out, unless everything is to be done anew, are images whose evidence is there
// already; and those that nobody needs because they and all whose sources they
// are have been refined.
class ObserveTask : public RefineTask {
 public:
  // evidence must outlive this object. has_model: whether the planes of the
  // scene are known already, so that only images that are to be refined and
  // their sources have to be observed.
  ObserveTask(const RefineTaskInputs& inputs,
              EvidenceStore& evidence,
              bool has_model)
      : RefineTask(inputs), evidence_(evidence), has_model_(has_model) {}

  ImageReport Begin(size_t index) override;
  std::vector<int> Views(size_t index) const override {
    return images_.SourcesAndReference(index);
  }
  RefineResult Compute(size_t index,
                       size_t worker,
                       ViewCache::Lease* views,
                       ImageReport* report) override;
  void Write(size_t index, RefineResult result, ImageReport* report) override;

 private:
  EvidenceStore& evidence_;
  const bool has_model_;
};

}  // namespace tsar
