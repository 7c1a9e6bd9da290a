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

namespace tsar {
namespace {

// Buffers for the hypotheses of consecutive pixels, as in ViewData: those of
// `count` pixels of the view from `first` on.
struct HypothesisPiece {
  HypothesisPiece(ViewData* view, size_t first, size_t count)
      : depth(view->depth.Data() + first, count),
        normal(view->normal.Data() + first, count) {
    if (!view->min_cost.Empty()) {
      min_cost = {view->min_cost.Data() + first, count};
    }
  }

  std::span<float> depth;
  std::span<Vec3f> normal;
  std::span<float> min_cost;  // Empty where no costs were exported.
};

// Reads the hypotheses of one image piece by piece; none where the image is
// masked. Each piece passes through the processor's cache once, however large
// the maps are.
class HypothesisReader {
 public:
  // Opens all maps of the image. Throws what Workspace::OpenOriginalMaps
  // and OpenCosts throw; what Workspace::ReadMask throws.
  HypothesisReader(const Workspace& workspace, int image)
      : maps_(workspace.OpenOriginalMaps(image, workspace.Type())),
        mask_(workspace.ReadMask(image, maps_.Size())),
        costs_(workspace.OpenCosts(image, maps_.Size())) {}

  int Width() const { return maps_.Width(); }
  int Height() const { return maps_.Height(); }
  size_t NumPixels() const { return maps_.NumPixels(); }
  bool HasCosts() const { return costs_.has_value(); }
  // Empty where the image has no mask.
  const Image<uint8_t>& Mask() const { return mask_; }
  // Reads the hypotheses from this pixel on, as many as the piece has room for.
  // Throws kCorrupt where a file has become shorter.
  void Read(size_t first_pixel, const HypothesisPiece& piece);

  // Counts over all pieces that were read: NaN or infinite values, hypotheses.
  int64_t NumNotFinite() const { return maps_.NumNotFinite(); }
  int64_t NumDepths() const { return num_depths_; }

 private:
  DepthNormalReader maps_;
  Image<uint8_t> mask_;  // Empty: none.
  std::optional<MapReader> costs_;
  int64_t num_depths_ = 0;
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

void HypothesisReader::Read(size_t first_pixel, const HypothesisPiece& piece) {
  maps_.ReadDepths(first_pixel, piece.depth);
  maps_.ReadNormals(first_pixel, piece.normal);
  if (costs_) {
    ReadCosts(*costs_, first_pixel, piece.min_cost);
  }
  for (size_t i = 0; i < piece.depth.size(); ++i) {
    const bool is_masked = !mask_.Empty() && mask_.Data()[first_pixel + i] != 0;
    if (is_masked && costs_) {
      piece.min_cost[i] = kUndefinedCost;
    }
    // Without evidence from any image, it was propagated or is random.
    const bool has_evidence = !costs_ || piece.min_cost[i] != kUndefinedCost;
    // COLMAP writes unit vectors; other lengths are rounding errors or hostile.
    const Vec3f normal = Normalized(piece.normal[i]);
    const bool is_valid = piece.depth[i] > 0.f && !is_masked && has_evidence &&
                          !(normal == Vec3f{});
    piece.depth[i] = is_valid ? piece.depth[i] : 0.f;
    piece.normal[i] = is_valid ? normal : Vec3f{};
    num_depths_ += is_valid ? 1 : 0;
  }
}

// Allocates all maps without values.
ViewData MakeMaps(int width, int height, bool has_costs) {
  ViewData view;
  view.depth = Image<float>::Uninitialized(width, height);
  view.normal = Image<Vec3f>::Uninitialized(width, height);
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
  view.num_depths = reader.NumDepths();
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
