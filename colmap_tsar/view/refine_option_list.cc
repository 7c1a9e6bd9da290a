// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/view/refine_option_list.h"

#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/parse_number.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/view/regions/region_planes.h"

#include <limits>
#include <type_traits>

namespace tsar {
namespace {

template <typename T>
void CheckRange(const RefineField& field, const T* value) {
  if constexpr (!std::is_same_v<T, bool>) {
    // The comparison is not negated, since NaN would pass.
    const bool is_inside = *value >= field.min && *value <= field.max;
    if (!is_inside) {
      TextStream text;
      text << OptionName(field.name) << ": " << *value
           << " makes no sense; give a value from " << field.min << " to "
           << field.max;
      throw Error(ErrorCode::kBadOption, text.str());
    }
  }
}

}  // namespace

// Name and address of a member.
#define TSAR_FIELD(member) .name = #member, .value = &options->member

std::vector<RefineField> ListRefineFields(RefineOptions* options) {
  return {
      {TSAR_FIELD(denoise),
       .description = "Take the noise out of the images in which superpixels, "
                      "regions, textures and borders are found. Matching sees "
                      "the images as they are.",
       .paper = 0},
      {TSAR_FIELD(filter),
       .description = "Tell reliable depths from wrong ones. If 0, every depth "
                      "counts as reliable."},
      {TSAR_FIELD(filter_confidence),
       .description = "Judge depths by their matching costs."},
      {TSAR_FIELD(filter_discontinuity),
       .description =
           "Judge depths by the size of the smooth surface around them."},
      {TSAR_FIELD(view_agreement),
       .description =
           "Judge depths by the number of source images whose depths agree.",
       .paper = 0},
      {TSAR_FIELD(min_aggregated_score),
       .description = "Score above which a depth is reliable; the best have "
                      "about 1 (eta in the paper).",
       .min = 0.0,
       .max = 2.0},
      {TSAR_FIELD(confidence_weight),
       .description =
           "Weight of the matching confidence against the discontinuity in the "
           "score, in [0, 1] (tau in the paper).",
       .min = 0.0,
       .max = 1.0},
      {TSAR_FIELD(refine),
       .description =
           "Spread reliable depths over superpixels and by weighted medians. "
           "If 0, the three switches below have no effect."},
      {TSAR_FIELD(superpixel_planes),
       .description =
           "Fit a plane to every superpixel that has enough reliable depths."},
      {TSAR_FIELD(weighted_median),
       .description = "Confirm and fill depths by weighted medians of their "
                      "surroundings."},
      {TSAR_FIELD(readmit_filtered),
       .description = "Let depths that the filter rejected return where the "
                      "weighted median of their surroundings confirms them.",
       .paper = 1},
      {TSAR_FIELD(num_iterations),
       .description =
           "Rounds of the weighted median filters (N_t in the paper).",
       .min = 1,
       .max = 10},
      {TSAR_FIELD(superpixel_size),
       .description = "Area of a superpixel, in pixels of the image reduced to "
                      "a long side of at most 777 (S_sp in the paper, whose "
                      "400 are 25 there on maps 3110 wide).",
       .min = 25,
       .max = 100000},
      {TSAR_FIELD(min_plane_support),
       .description =
           "Share of a superpixel's depths that must lie on its plane, and of "
           "the depths on a region's rim where nothing inside it carries one, "
           "in [0, 1] (sigma in the paper).",
       .min = 0.0,
       .max = 1.0},
      {TSAR_FIELD(window_radius),
       .description = "Radius of the smallest median window, in pixels of a "
                      "map 3110 wide (delta in the paper).",
       .min = 1,
       .max = 100},
      {TSAR_FIELD(spatial_sigma),
       .description = "How fast a neighbor's weight falls with its distance, "
                      "in steps of the window's sampling (alpha in the paper).",
       .min = 0.01,
       .max = 100.0},
      {TSAR_FIELD(color_sigma),
       .description = "How fast a neighbor's weight falls with the difference "
                      "of color, in levels of 0-255 (beta in the paper).",
       .min = 0.01,
       .max = 255.0},
      {TSAR_FIELD(disparity_tolerance),
       .description =
           "How far a depth may be from the median of its surroundings, in "
           "pixels of disparity in a map 3110 wide (mu in the paper).",
       .min = 0.01,
       .max = 10000.0},
      {TSAR_FIELD(segment),
       .description = "Find regions without texture and fit planes to them."},
      {TSAR_FIELD(edge_threshold),
       .description =
           "Step of brightness that bounds a region, in levels of 0-255.",
       .min = 0.0,
       .max = 255.0},
      {TSAR_FIELD(hough_max_gap),
       .description = "Largest gap that a straight line may close, in pixels "
                      "of an image 777 wide (upsilon in the paper).",
       .min = 1,
       .max = 10000},
      {TSAR_FIELD(region_cores),
       .description = "Let depths well inside a region decide about its plane "
                      "before those on its rim, which belong to whatever hangs "
                      "in front. If 0, one fit takes both.",
       .paper = 0},
      {TSAR_FIELD(max_region_planes),
       .description = "Most planes that one region may hold.",
       .min = 1,
       .max = kMaxPlanesPerRegion,
       .paper = 1},
      {TSAR_FIELD(min_region_size),
       .description = "Area of the smallest region, in pixels of an image 777 "
                      "wide (kappa times 10000 in the paper).",
       .min = 1,
       .max = 100000000},
      {TSAR_FIELD(max_boundary_error),
       .description = "How far a region's plane, where only the rim carries "
                      "it, may be from the reliable depths along the rim, as a "
                      "fraction of the depth (gamma in the paper).",
       .min = 0.0,
       .max = 1.0},
      {TSAR_FIELD(confirmed_depths),
       .description =
           "Keep a measured depth that another view confirms, where the pixel "
           "has texture of its own, though the view itself did not trust it; "
           "where a plane of the scene would take its place, the views decide. "
           "Has no effect without view_agreement.",
       .paper = 0},
      {TSAR_FIELD(scene_planes),
       .description =
           "Find planes in all views of a surface together and let them "
           "decide. If 0, or if refine is 0, each image is refined by itself, "
           "and the switches below have no effect.",
       .is_option = true,
       .paper = 0},
      {TSAR_FIELD(foreground_fattening),
       .description =
           "Let depths count little for the planes of the scene where the "
           "pattern that was matched lies beside the pixel: they are those of "
           "the frame or poster beside a wall."},
      {TSAR_FIELD(manhattan_frame),
       .description = "Make planes exactly parallel and at right angles where "
                      "that agrees with what was measured."},
      {TSAR_FIELD(adjust_planes),
       .description =
           "In scenes of more than 32 images, where planes are found in parts "
           "of the scene, adjust the planes of all parts together.",
       .paper = 0},
      {TSAR_FIELD(bounded_planes),
       .description =
           "Leave holes where a plane was observed on one side only."},
      {TSAR_FIELD(bounding_creases),
       .description = "Let planes end at creases that three or more views see, "
                      "and let another one begin there at right angles: "
                      "ceilings over walls, though nothing of them was "
                      "measured. Has no effect without manhattan_frame."},
      {TSAR_FIELD(cylinders),
       .description =
           "Find bare columns and pipes by their outlines in four or more "
           "views, and fill them: round ones along an axis of the Manhattan "
           "frame. Has no effect without manhattan_frame.",
       .paper = 0},
      {TSAR_FIELD(plane_tolerance),
       .description =
           "How far a depth may be off a plane, in standard deviations of the "
           "depths about the planes of their superpixels.",
       .min = 0.1,
       .max = 1000.0},
      {TSAR_FIELD(min_scene_plane),
       .description =
           "Pixels that a plane of the scene must explain that no other does, "
           "in images reduced to a long side of at most 777.",
       .min = 1.0,
       .max = 1e9},
      {TSAR_FIELD(unlabeled_cost),
       .description =
           "What a pixel costs that is left empty, against 0.05 for one on a "
           "plane that is not known there: the higher, the fewer holes.",
       .min = 0.0,
       .max = 1.0},
      {TSAR_FIELD(min_confidence),
       .description = "Leave depths out whose confidence, the probability of "
                      "being right to 1 %, is less than this. 0 keeps all: "
                      "fusion leaves out most of the wrong ones itself. "
                      "Without scene_planes, confidences are only ranks.",
       .min = 0.0,
       .max = 1.0,
       .is_option = true},
      {TSAR_FIELD(min_fill_confidence),
       .description =
           "Leave pixels empty that were not measured and whose surface is "
           "less likely "
           "the right one than this. 0 fills as much as possible. With "
           "scene_planes.",
       .min = 0.0,
       .max = 1.0},
      {TSAR_FIELD(sigma_maps),
       .description =
           "Write stereo/sigma_maps: how far each depth may be off, as a "
           "standard deviation in the unit of the depth map, if its surface is "
           "the right one. Arrays of NumPy, of 16-bit floats.",
       .is_option = true},
      {TSAR_FIELD(seed),
       .description =
           "Another number gives other random draws, and so tells how much of "
           "a result is luck; the same number always gives the same maps.",
       .min = 0,
       .max = std::numeric_limits<int>::max(),
       .is_option = true},
  };
}

#undef TSAR_FIELD

std::string RefineField::Text() const {
  // A bool is 1 or 0.
  return std::visit([](const auto* value) { return NumberText(+*value); },
                    value);
}

void RefineOptions::Check() const {
  if (filter && !filter_confidence && !filter_discontinuity &&
      !view_agreement) {
    throw Error(
        ErrorCode::kBadOption,
        OptionName("filter") +
            ": nothing is left to judge depths by; leave "
            "filter_confidence, filter_discontinuity or view_agreement on, "
            "or set filter to 0");
  }
  RefineOptions copy = *this;
  for (const RefineField& field : ListRefineFields(&copy)) {
    std::visit([&](const auto* value) { CheckRange(field, value); },
               field.value);
  }
}

RefineOptions PresetOptions(RefinePreset preset) {
  RefineOptions options;
  for (const RefineField& field : ListRefineFields(&options)) {
    if (preset == RefinePreset::kPaper && field.paper) {
      std::visit(
          [&](auto* value) {
            *value = static_cast<std::remove_pointer_t<decltype(value)>>(
                *field.paper);
          },
          field.value);
    }
  }
  return options;
}

std::map<std::string, std::string> RefineOptionsText(
    const RefineOptions& options) {
  RefineOptions copy = options;
  std::map<std::string, std::string> text;
  for (const RefineField& field : ListRefineFields(&copy)) {
    text[field.name] = field.Text();
  }
  return text;
}

std::string HashRefineOptions(const RefineOptions& options) {
  std::string text = TSAR_VERSION;
  for (const auto& [name, value] : RefineOptionsText(options)) {
    text += "\n" + name + "=" + value;
  }
  ContentHash hash;
  hash.Update(text.data(), text.size());
  return HexDigits(hash.Value());
}

}  // namespace tsar
