// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/load_view.h"

#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/vector.h"
#include "colmap_tsar/io/map_io.h"
#include "colmap_tsar/matching/matching_cost.h"
#include "colmap_tsar/view/view_data.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace tsar {
namespace {

// Buffers for the hypotheses of consecutive pixels, as in ViewData: those of
// `count` pixels of the view from `first` on.
struct HypothesisPiece {
  HypothesisPiece(ViewData* view, size_t first, size_t count)
      : depth(view->depth.Data() + first, count),
        normal(view->normal.Data() + first, count),
        is_to_refine(view->is_to_refine.Data() + first, count) {
    if (!view->min_cost.Empty()) {
      min_cost = {view->min_cost.Data() + first, count};
    }
  }

  std::span<float> depth;
  std::span<Vec3f> normal;
  std::span<uint8_t> is_to_refine;
  std::span<float> min_cost;  // Empty where no costs were exported.
};

// Reads the hypotheses of one image piece by piece: those of the map to refine
// and, where it has none, those of the other type; none where the image is
// masked. Each piece passes through the processor's cache once, however large
// the maps are.
class HypothesisReader {
 public:
  // Opens all maps of the image. Throws what Workspace::OpenOriginalMaps
  // and OpenCosts throw; kMismatch when two of its maps differ in size; what
  // Workspace::ReadMask throws.
  HypothesisReader(const Workspace& workspace, int image);

  int Width() const { return own_.Width(); }
  int Height() const { return own_.Height(); }
  size_t NumPixels() const { return own_.NumPixels(); }
  // Whether costs of the map to refine were exported.
  bool HasCosts() const { return own_costs_.has_value(); }
  // At the size of the maps; empty: none.
  const Image<uint8_t>& Mask() const { return mask_; }

  // Reads the hypotheses from this pixel on, as many as the piece has room for.
  // Throws kCorrupt where a file has become shorter.
  void Read(size_t first_pixel, const HypothesisPiece& piece);

  // Counts over all pieces that were read: NaN or infinite values of both
  // types; depths of the map to refine that are not masked and have a normal
  // and evidence.
  int64_t NumNotFinite() const;
  int64_t NumDepthsToRefine() const { return num_depths_to_refine_; }

 private:
  void OpenOtherType(const Workspace& workspace, int image);
  void ReadOwn(size_t first_pixel, const HypothesisPiece& piece);
  void FillFromOtherType(size_t first_pixel, const HypothesisPiece& piece);

  bool IsMasked(size_t pixel) const {
    return !mask_.Empty() && mask_.Data()[pixel] != 0;
  }

  DepthNormalReader own_;
  Image<uint8_t> mask_;  // Empty: none.
  std::optional<MapReader> own_costs_;
  std::optional<DepthNormalReader> other_;
  // Opened only if needed.
  std::optional<MapReader> other_costs_;
  // Whether the other type holds depths that count only with evidence.
  bool other_is_filtered_ = false;
  // A piece of the other type.
  std::vector<float> depth_;
  std::vector<Vec3f> normal_;
  std::vector<float> min_cost_;
  int64_t num_depths_to_refine_ = 0;
};

// Reads the smallest costs; the second channel has the second smallest. COLMAP
// assigns a cost without evidence to windows without texture and to views that
// do not see the point.
void ReadCosts(MapReader& reader, size_t first_pixel, std::span<float> costs) {
  reader.Read(/*channel=*/0, first_pixel, costs);
  for (float& cost : costs) {
    if (!(cost >= 0.f && cost < kCostWithoutEvidence)) {
      cost = kUndefinedCost;
    }
  }
}

HypothesisReader::HypothesisReader(const Workspace& workspace, int image)
    : own_(workspace.OpenOriginalMaps(image, workspace.Type())),
      mask_(workspace.ReadMask(image, own_.Size())),
      own_costs_(workspace.OpenCosts(image, workspace.Type(), own_.Size())) {
  OpenOtherType(workspace, image);
}

void HypothesisReader::OpenOtherType(const Workspace& workspace, int image) {
  const MapType type = workspace.OtherType();
  if (!workspace.HasMaps(image, type)) {
    return;
  }
  other_.emplace(workspace.OpenOriginalMaps(image, type));
  RequireSizeOfDepthMap(
      workspace.Paths(image, type).depth, other_->Size(), own_.Size());
  other_is_filtered_ = type == MapType::kGeometric;
  if (HasCosts() || other_is_filtered_) {
    other_costs_ = workspace.OpenCosts(image, type, own_.Size());
  }
}

void HypothesisReader::Read(size_t first_pixel, const HypothesisPiece& piece) {
  ReadOwn(first_pixel, piece);
  if (other_) {
    FillFromOtherType(first_pixel, piece);
  }
  for (size_t i = 0; i < piece.depth.size(); ++i) {
    // COLMAP writes unit vectors; other lengths are rounding errors or hostile.
    piece.normal[i] = Normalized(piece.normal[i]);
    if (piece.normal[i] == Vec3f{}) {
      piece.depth[i] = 0.f;
      piece.is_to_refine[i] = 0;
    }
  }
}

int64_t HypothesisReader::NumNotFinite() const {
  return own_.NumNotFinite() + (other_ ? other_->NumNotFinite() : 0);
}

void HypothesisReader::ReadOwn(size_t first_pixel,
                               const HypothesisPiece& piece) {
  own_.ReadDepths(first_pixel, piece.depth);
  own_.ReadNormals(first_pixel, piece.normal);
  if (own_costs_) {
    ReadCosts(*own_costs_, first_pixel, piece.min_cost);
  }
  for (size_t i = 0; i < piece.depth.size(); ++i) {
    bool counts = !IsMasked(first_pixel + i);
    if (own_costs_ && !counts) {
      piece.min_cost[i] = kUndefinedCost;
    } else if (own_costs_) {
      // Otherwise no image supports this depth: it was propagated or is random.
      counts = piece.min_cost[i] != kUndefinedCost;
    }
    if (!counts) {
      piece.depth[i] = 0.f;
      piece.normal[i] = {};
    }
    const bool is_valid = piece.depth[i] > 0.f && !(piece.normal[i] == Vec3f{});
    piece.is_to_refine[i] = is_valid ? 1 : 0;
    num_depths_to_refine_ += is_valid ? 1 : 0;
  }
}

void HypothesisReader::FillFromOtherType(size_t first_pixel,
                                         const HypothesisPiece& piece) {
  const size_t count = piece.depth.size();
  depth_.resize(count);
  normal_.resize(count);
  other_->ReadDepths(first_pixel, depth_);
  other_->ReadNormals(first_pixel, normal_);
  if (other_costs_) {
    min_cost_.resize(count);
    ReadCosts(*other_costs_, first_pixel, min_cost_);
  }
  const bool needs_evidence = other_is_filtered_ && other_costs_;
  for (size_t i = 0; i < count; ++i) {
    if (piece.is_to_refine[i] != 0 || IsMasked(first_pixel + i) ||
        // No image supports this depth of the other type.
        (needs_evidence && min_cost_[i] == kUndefinedCost)) {
      continue;
    }
    piece.depth[i] = depth_[i];
    piece.normal[i] = normal_[i];
    if (HasCosts()) {
      // Without the other type's costs, only those of the hypothesis that
      // COLMAP rejected are available.
      piece.min_cost[i] = other_costs_ ? min_cost_[i] : kUndefinedCost;
    }
  }
}

// Allocates all maps without values.
ViewData MakeMaps(int width, int height, bool has_costs) {
  ViewData view;
  view.depth = Image<float>::Uninitialized(width, height);
  view.normal = Image<Vec3f>::Uninitialized(width, height);
  view.is_to_refine = Image<uint8_t>::Uninitialized(width, height);
  if (has_costs) {
    view.min_cost = Image<float>::Uninitialized(width, height);
  }
  return view;
}

// Reads the image's depth prior without masked pixels; null where it has none.
// mask: of the image's maps, or empty.
std::shared_ptr<const DepthPrior> LoadPrior(const Workspace& workspace,
                                            int image,
                                            const Image<uint8_t>& mask) {
  std::shared_ptr<DepthPrior> prior = workspace.ReadPrior(image);
  if (prior == nullptr || mask.Empty()) {
    return prior;
  }
  const auto clear = [&](auto* values) {
    if (!values->Empty()) {
      ClearMasked(ResizeMask(mask, {values->Width(), values->Height()}),
                  values);
    }
  };
  clear(&prior->values);
  clear(&prior->normals);
  return prior;
}

}  // namespace

ViewData LoadView(const Workspace& workspace, int image) {
  HypothesisReader reader(workspace, image);
  const int width = reader.Width();
  const int height = reader.Height();
  ViewData view = MakeMaps(width, height, reader.HasCosts());
  ForEachPiece(reader.NumPixels(), [&](size_t first, size_t count) {
    reader.Read(first, HypothesisPiece(&view, first, count));
  });
  view.num_depths_to_refine = reader.NumDepthsToRefine();
  view.num_not_finite = reader.NumNotFinite();
  view.color = workspace.ReadImage(image, width, height);
  view.camera = workspace.CameraOf(image).Resized(width, height);
  view.prior = LoadPrior(workspace, image, reader.Mask());
  return view;
}

ViewData LoadReducedView(const Workspace& workspace, int image, int max_side) {
  HypothesisReader reader(workspace, image);
  const int width = reader.Width();
  const int height = reader.Height();
  const int factor = ReductionFactor(width, height, max_side);
  if (factor == 1) {
    return LoadView(workspace, image);
  }
  ViewReducer reducer(workspace.CameraOf(image).Resized(width, height),
                      factor,
                      reader.HasCosts());
  ViewData rows;
  for (int row = 0; row < height; row += factor) {
    const int num_rows = std::min(factor, height - row);
    if (rows.depth.Height() != num_rows) {
      rows = MakeMaps(width, num_rows, reader.HasCosts());
    }
    reader.Read(static_cast<size_t>(row) * static_cast<size_t>(width),
                HypothesisPiece(&rows, 0, rows.depth.NumPixels()));
    reducer.Add(rows);
  }
  ViewData reduced = reducer.Finish(workspace.ReadImage(image, width, height));
  reduced.num_not_finite = reader.NumNotFinite();
  reduced.prior = LoadPrior(workspace, image, reader.Mask());
  return reduced;
}

bool IsMaskedAway(const Workspace& workspace, int image) {
  if (!workspace.HasMask(image)) {
    return false;
  }
  Image<float> depth =
      workspace.ReadOriginalMaps(image, workspace.Type()).depth;
  if (!HasDepth(depth)) {
    return false;
  }
  ClearMasked(workspace.ReadMask(image, {depth.Width(), depth.Height()}),
              &depth);
  return !HasDepth(depth);
}

}  // namespace tsar
