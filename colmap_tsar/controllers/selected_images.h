// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/controllers/image_pipeline.h"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace tsar {

// The tasks for some of the images only, numbered anew from 0 on.
class SelectedImages : public ImageTasks {
 public:
  // tasks must outlive this object.
  SelectedImages(ImageTasks& tasks,
                 std::vector<size_t> indices,
                 std::string pass_name)
      : tasks_(tasks),
        indices_(std::move(indices)),
        pass_name_(std::move(pass_name)) {}

  size_t NumImages() const override { return indices_.size(); }
  std::string PassName() const override { return pass_name_; }
  ImageReport Begin(size_t index) override {
    return tasks_.Begin(indices_[index]);
  }
  std::vector<int> Views(size_t index) const override {
    return tasks_.Views(indices_[index]);
  }
  void Prepare(size_t index, const ViewCache::Lease& views) override {
    tasks_.Prepare(indices_[index], views);
  }
  RefineResult Compute(size_t index,
                       size_t worker,
                       ViewCache::Lease* views,
                       ImageReport* report) override {
    return tasks_.Compute(indices_[index], worker, views, report);
  }
  void Write(size_t index, RefineResult result, ImageReport* report) override {
    tasks_.Write(indices_[index], std::move(result), report);
  }

 private:
  ImageTasks& tasks_;
  const std::vector<size_t> indices_;
  const std::string pass_name_;
};

}  // namespace tsar
