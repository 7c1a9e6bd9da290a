// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/view/refine_options.h"

#include <cstdint>

namespace tsar {

// Upper bounds of the memory of an image in the stages, in bytes: linear in the
// pixels of its map, those of its raster and its superpixels. They hold for
// maps of any shape with num_pixels pixels. The factors were measured;
// tests/compose/stage_memory_test.cc runs the stages on a device that counts,
// and fails where a bound is too small or far too large.

// The device's memory, without the uploaded sources (UploadedViewBytes).
int64_t RefineImageWorkingBytes(const RefineOptions& options,
                                int64_t num_pixels);
int64_t MeasureImageWorkingBytes(const RefineOptions& options,
                                 int64_t num_pixels);
// num_judged_pixels: of the map from which the evidence was made; num_pixels
// where it was not reduced.
int64_t ComposeImageWorkingBytes(const RefineOptions& options,
                                 int64_t num_pixels,
                                 int64_t num_judged_pixels);
// num_views: the labeled view and its sources.
int64_t LabelViewWorkingBytes(const RefineOptions& options,
                              int64_t num_pixels,
                              int num_views);
// Main memory where these run on the CPU, including its memory as a device,
// without their inputs.
int64_t MakeEvidenceMainBytes(const RefineOptions& options, int64_t num_pixels);
int64_t ModelBlockMainBytes(const RefineOptions& options,
                            int64_t num_pixels,
                            int num_views);
int64_t LabelViewMainBytes(const RefineOptions& options,
                           int64_t num_pixels,
                           int num_views);

// Main memory of the measurements of an image, of all its evidence, and of the
// part of this that its neighbors need.
int64_t MeasuredImageBytes(const RefineOptions& options, int64_t num_pixels);
int64_t ViewEvidenceBytes(const RefineOptions& options, int64_t num_pixels);
int64_t NeighborEvidenceBytes(const RefineOptions& options, int64_t num_pixels);

}  // namespace tsar
