// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/view/refine_options.h"

#include <cstdint>

namespace tsar {

// What an image takes of memory on its way through the stages, in bytes: linear
// in the pixels of its map, those of its raster and its superpixels. Each
// number holds for maps of any shape with num_pixels pixels. The factors were
// measured; tests/pipeline/stage_memory_test.cc runs the stages on a device
// that counts, and fails where a number is too small or far too large.

// Of the device's memory, beside the sources that were uploaded
// (UploadedViewBytes).
int64_t RefineImageWorkingBytes(const RefineOptions& options,
                                int64_t num_pixels);
int64_t MeasureImageWorkingBytes(const RefineOptions& options,
                                 int64_t num_pixels);
// What both take more where the image has a label image.
int64_t SegmentsWorkingBytes(int64_t num_pixels);
// num_judged_pixels: of the map that the evidence was made of, num_pixels where
// it was not reduced.
int64_t ComposeImageWorkingBytes(const RefineOptions& options,
                                 int64_t num_pixels,
                                 int64_t num_judged_pixels);
// num_views: the one that is labelled, and its sources.
int64_t LabelViewWorkingBytes(const RefineOptions& options,
                              int64_t num_pixels,
                              int num_views);
// Of main memory, where these run on the CPU: with what they take of its memory
// as a device, beside what they read.
int64_t MakeEvidenceMainBytes(const RefineOptions& options, int64_t num_pixels);
int64_t ModelBlockMainBytes(const RefineOptions& options,
                            int64_t num_pixels,
                            int num_views);
int64_t LabelViewMainBytes(const RefineOptions& options,
                           int64_t num_pixels,
                           int num_views);

// Of main memory: what was measured in an image, all of its evidence, and the
// part of this that its neighbours need.
int64_t MeasuredImageBytes(const RefineOptions& options, int64_t num_pixels);
int64_t ViewEvidenceBytes(const RefineOptions& options, int64_t num_pixels);
int64_t NeighbourEvidenceBytes(const RefineOptions& options,
                               int64_t num_pixels);

}  // namespace tsar
