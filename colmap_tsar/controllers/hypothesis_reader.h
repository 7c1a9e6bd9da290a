// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/store/workspace.h"
#include "colmap_tsar/workspace/map_reader.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace tsar {

// Where the hypotheses of consecutive pixels go; as in ViewData.
struct HypothesisPiece {
  std::span<float> depth;
  std::span<Vec3f> normal;
  std::span<uint8_t> is_to_refine;
  // Empty where none were exported.
  std::span<float> min_cost;
  std::span<float> second_cost;
};

// Reads the hypotheses of one image a piece at a time: those of the map to
// refine and, where it has none, those of the other type; none where the image
// is masked. Each piece goes through the processor's cache once, however large
// the maps are.
class HypothesisReader {
 public:
  // Opens all maps of the image. Throws what Workspace::OpenOriginalMaps
  // throws; kMismatch when two of its maps differ in size; what
  // Workspace::ReadMask throws.
  HypothesisReader(const Workspace& workspace, int image);

  int Width() const { return own_.Width(); }
  int Height() const { return own_.Height(); }
  size_t NumPixels() const { return own_.NumPixels(); }
  // Whether costs of the map to refine were exported.
  bool HasCosts() const { return own_costs_.has_value(); }

  // From this pixel on, as many as the piece has room for. Throws kCorrupt
  // where a file has become shorter.
  void Read(size_t first_pixel, const HypothesisPiece& piece);

  // Of all pieces that were read: NaN or infinite values of both types; pixels
  // that are not masked; depths of the map to refine there; those of them that
  // have a normal and evidence.
  int64_t NumNotFinite() const;
  int64_t NumPixelsInUse() const { return num_pixels_in_use_; }
  int64_t NumDepths() const { return num_depths_; }
  int64_t NumDepthsToRefine() const { return num_depths_to_refine_; }

 private:
  void OpenOtherType(const Workspace& workspace, int image);
  void ReadOwn(size_t first_pixel, const HypothesisPiece& piece);
  void RemoveMasked(size_t first_pixel, const HypothesisPiece& piece);
  void FillFromOtherType(size_t first_pixel, const HypothesisPiece& piece);

  bool IsMasked(size_t pixel) const {
    return !mask_.Empty() && mask_.Data()[pixel] != 0;
  }

  DepthNormalReader own_;
  Image<uint8_t> mask_;  // Empty: none.
  std::optional<MapReader> own_costs_;
  std::optional<DepthNormalReader> other_;
  // Opened only where they are needed.
  std::optional<MapReader> other_costs_;
  // Whether the other type holds depths that count only with evidence.
  bool other_is_filtered_ = false;
  // A piece of the other type.
  std::vector<float> depth_;
  std::vector<Vec3f> normal_;
  std::vector<float> min_cost_;
  std::vector<float> second_cost_;
  int64_t num_pixels_in_use_ = 0;
  int64_t num_depths_ = 0;
  int64_t num_depths_to_refine_ = 0;
};

}  // namespace tsar
