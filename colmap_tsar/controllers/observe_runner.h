// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/controllers/evidence_store.h"
#include "colmap_tsar/controllers/image_pipeline.h"
#include "colmap_tsar/controllers/image_runner.h"

#include <string>
#include <vector>

namespace tsar {

// The first pass over a workspace: what each image observes goes to the store.
// Left out, unless the run has an observer, are images whose evidence is there
// already; and those that nobody needs because they and all whose sources they
// are have been refined.
class ObserveRunner : public ImageTasks {
 public:
  // All references must outlive this object. images: does the second pass.
  ObserveRunner(ImageRunner& images, EvidenceStore& evidence);

  size_t NumImages() const override { return images_.NumImages(); }
  std::string PassName() const override { return "Pass 1 of 2:"; }
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
  ImageRunner& images_;
  EvidenceStore& evidence_;
};

}  // namespace tsar
