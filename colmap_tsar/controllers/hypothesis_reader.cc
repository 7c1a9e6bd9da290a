// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/controllers/hypothesis_reader.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/matching/matching_cost.h"

#include <algorithm>
#include <filesystem>
#include <string>

namespace tsar {
namespace {

MapType OtherType(MapType type) {
  return type == MapType::kGeometric ? MapType::kPhotometric
                                     : MapType::kGeometric;
}

// The exported costs of one type of map, if there are any.
std::optional<MapReader> OpenCosts(const std::filesystem::path& path,
                                   const DepthNormalReader& maps) {
  if (!std::filesystem::exists(path)) {
    return std::nullopt;
  }
  MapReader costs(path);
  const MapSize& size = costs.Size();
  if (size.channels != 2 || size.width != maps.Width() ||
      size.height != maps.Height()) {
    throw Error::File(ErrorCode::kMismatch,
                      path.string(),
                      "has " + std::to_string(size.channels) + " channels of " +
                          std::to_string(size.width) + "x" +
                          std::to_string(size.height) + ", but needs 2 of " +
                          std::to_string(maps.Width()) + "x" +
                          std::to_string(maps.Height()),
                      "write it anew with patch_match_stereo or delete it");
  }
  return costs;
}

// COLMAP gives windows without texture and views that see nothing a cost
// without evidence.
void ReadCosts(MapReader& reader,
               int channel,
               size_t first_pixel,
               std::span<float> costs) {
  reader.Read(channel, first_pixel, costs);
  for (float& cost : costs) {
    if (!(cost >= 0.f && cost < kCostWithoutEvidence)) {
      cost = kUndefinedCost;
    }
  }
}

bool IsValid(float depth, const Vec3f& normal) {
  return depth > 0.f && !(normal == Vec3f{});
}

}  // namespace

HypothesisReader::HypothesisReader(const Workspace& workspace, int image)
    : own_(workspace.OpenOriginalMaps(image, workspace.Type())),
      mask_(workspace.ReadMask(image, {own_.Width(), own_.Height()})),
      own_costs_(OpenCosts(workspace.CostPath(image, workspace.Type()), own_)) {
  OpenOtherType(workspace, image);
}

void HypothesisReader::OpenOtherType(const Workspace& workspace, int image) {
  const MapType type = OtherType(workspace.Type());
  if (!workspace.HasMaps(image, type)) {
    return;
  }
  other_.emplace(workspace.OpenOriginalMaps(image, type));
  if (other_->Width() != Width() || other_->Height() != Height()) {
    throw Error::File(
        ErrorCode::kMismatch,
        workspace.DepthPath(image, type).string(),
        "is not of the size of the " + ToString(workspace.Type()) + " map",
        "run patch_match_stereo again for this image, or delete the file");
  }
  other_is_filtered_ = type == MapType::kGeometric;
  if (HasCosts() || other_is_filtered_) {
    other_costs_ = OpenCosts(workspace.CostPath(image, type), own_);
  }
}

void HypothesisReader::Read(size_t first_pixel, const HypothesisPiece& piece) {
  ReadOwn(first_pixel, piece);
  if (other_) {
    FillFromOtherType(first_pixel, piece);
  }
  for (size_t i = 0; i < piece.depth.size(); ++i) {
    // COLMAP writes unit vectors; other lengths are rounding, or hostile.
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
  own_.depth.Read(first_pixel, piece.depth);
  own_.normal.Read(first_pixel, piece.normal);
  RemoveMasked(first_pixel, piece);
  num_depths_ += std::count_if(piece.depth.begin(),
                               piece.depth.end(),
                               [](float depth) { return depth > 0.f; });
  if (own_costs_) {
    ReadCosts(*own_costs_, 0, first_pixel, piece.min_cost);
    ReadCosts(*own_costs_, 1, first_pixel, piece.second_cost);
    for (size_t i = 0; i < piece.depth.size(); ++i) {
      if (IsMasked(first_pixel + i)) {
        piece.min_cost[i] = kUndefinedCost;
        piece.second_cost[i] = kUndefinedCost;
      } else if (piece.min_cost[i] == kUndefinedCost) {
        // The images say nothing about this depth: it follows from what is
        // around it, or from chance.
        piece.depth[i] = 0.f;
        piece.normal[i] = {};
      }
    }
  }
  int num_to_refine = 0;
  for (size_t i = 0; i < piece.depth.size(); ++i) {
    const bool is_valid = IsValid(piece.depth[i], piece.normal[i]);
    piece.is_to_refine[i] = is_valid ? 1 : 0;
    num_to_refine += is_valid ? 1 : 0;
  }
  num_depths_to_refine_ += num_to_refine;
}

void HypothesisReader::RemoveMasked(size_t first_pixel,
                                    const HypothesisPiece& piece) {
  num_pixels_in_use_ += static_cast<int64_t>(piece.depth.size());
  if (mask_.Empty()) {
    return;
  }
  for (size_t i = 0; i < piece.depth.size(); ++i) {
    if (IsMasked(first_pixel + i)) {
      piece.depth[i] = 0.f;
      piece.normal[i] = {};
      --num_pixels_in_use_;
    }
  }
}

void HypothesisReader::FillFromOtherType(size_t first_pixel,
                                         const HypothesisPiece& piece) {
  const size_t count = piece.depth.size();
  depth_.resize(count);
  normal_.resize(count);
  other_->depth.Read(first_pixel, depth_);
  other_->normal.Read(first_pixel, normal_);
  if (other_costs_) {
    min_cost_.resize(count);
    second_cost_.resize(count);
    ReadCosts(*other_costs_, 0, first_pixel, min_cost_);
    ReadCosts(*other_costs_, 1, first_pixel, second_cost_);
  }
  const bool needs_evidence = other_is_filtered_ && other_costs_;
  for (size_t i = 0; i < count; ++i) {
    if (piece.is_to_refine[i] != 0 || IsMasked(first_pixel + i) ||
        // Not measured: a planar prior filled it.
        (needs_evidence && min_cost_[i] == kUndefinedCost)) {
      continue;
    }
    piece.depth[i] = depth_[i];
    piece.normal[i] = normal_[i];
    if (HasCosts()) {
      // Without the other type's, the costs at hand are those of the hypothesis
      // that COLMAP rejected.
      piece.min_cost[i] = other_costs_ ? min_cost_[i] : kUndefinedCost;
      piece.second_cost[i] = other_costs_ ? second_cost_[i] : kUndefinedCost;
    }
  }
}

}  // namespace tsar
