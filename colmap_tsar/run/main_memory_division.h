// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/image_pipeline.h"
#include "colmap_tsar/run/memory_plan.h"
#include "colmap_tsar/run/workspace_check.h"

#include <cstddef>
#include <cstdint>
#include <string>

namespace tsar {

// The main memory that the machine and the user allow a run.
class MemoryBudget {
 public:
  // cache_size: in gigabytes; see DeviceOptions. machine_bytes: main
  // memory that this program can have, of which it uses four fifths.
  MemoryBudget(double cache_size, int64_t machine_bytes);

  int64_t NumBytes() const { return num_bytes_; }
  int64_t MachineBytes() const { return machine_bytes_; }
  // Text for the user: which of the two is the limit.
  std::string Describe() const;

 private:
  double cache_size_;
  int64_t machine_bytes_;
  int64_t num_bytes_;
};

// Divides main memory between the images at work and the cached views.
class MainMemoryDivision {
 public:
  struct Sizes {
    PipelineSizes pipeline;
    size_t view_bytes = 0;  // For views.
  };

  // All references must outlive this object. on_cpu: the CPU computes, so that
  // workers take main memory and find surfaces themselves; where GPUs compute,
  // the reading threads find them.
  MainMemoryDivision(const MemoryPlanner& planner,
                     const WorkspaceOverview& overview,
                     int num_images,
                     bool on_cpu);

  // The largest number of workers, from 1 to max_num_workers, that fit into
  // memory beside one reading and one writing thread.
  int NumCpuWorkers(const MemoryBudget& budget, int max_num_workers) const;

  // Takes fewer than max_num_loaders where the views of one image would not fit
  // beside their memory. A warning says where not even one fits into the
  // budget. Throws kOutOfMemory where the machine cannot hold even that.
  Sizes Divide(const MemoryBudget& budget,
               int num_workers,
               int max_num_loaders) const;

 private:
  PipelineSizes MakeSizes(int num_loaders, int num_workers) const;
  // The buffers of reading views, and the results, each of which is with a
  // worker, waits, or is being written.
  int64_t ReadingAndResultBytes(const MemoryPlan& plan,
                                int num_workers,
                                const PipelineSizes& sizes) const;
  // Main memory that is not for views: the above, and that of the workers.
  int64_t BytesBesideViews(const MemoryPlan& plan,
                           int num_workers,
                           const PipelineSizes& sizes) const;
  // The largest maps that fit into the machine's memory, in parentheses.
  std::string WhatFits(int64_t machine_bytes,
                       int64_t needed,
                       int num_workers) const;

  const MemoryPlanner& planner_;
  const WorkspaceOverview& overview_;
  const MemoryPlan plan_;
  const int num_images_;
  const bool on_cpu_;
};

}  // namespace tsar
