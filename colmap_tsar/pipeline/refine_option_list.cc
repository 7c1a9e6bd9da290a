// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/pipeline/refine_option_list.h"

#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/segmentation/region_planes.h"

#include <charconv>
#include <cstdint>
#include <iomanip>
#include <limits>
#include <system_error>
#include <type_traits>
#include <utility>

namespace tsar {
namespace {

template <typename T>
std::string ValueText(T value) {
  if constexpr (std::is_same_v<T, bool>) {
    return value ? "1" : "0";
  } else {
    char text[64];
    const std::to_chars_result result =
        std::to_chars(text, text + sizeof(text), value);
    return std::string(text, result.ptr);
  }
}

}  // namespace

std::vector<RefineField> ListRefineFields(RefineOptions* options) {
  return {
      {"denoise",
       &options->denoise,
       "Take the noise out of the images in which superpixels, regions, "
       "textures and borders are found. Matching sees the images as they "
       "are."},
      {"distrust_unmatched",
       &options->distrust_unmatched,
       "In maps without holes, from which no filter removed anything, let "
       "depths count only where two sources agree and match better there than "
       "at depths beside. For maps that fill bare walls by guesses, as ACMMP's "
       "do; not for those of sensors and networks."},
      {"filter",
       &options->filter,
       "Tell reliable depths from wrong ones. If 0, every depth counts as "
       "reliable."},
      {"filter_confidence",
       &options->filter_confidence,
       "Judge depths by their matching costs."},
      {"filter_discontinuity",
       &options->filter_discontinuity,
       "Judge depths by the size of the smooth surface around them."},
      {"cost_ratio",
       &options->cost_ratio,
       "Let the quotient of the two smallest costs count among the matching "
       "costs, as in the paper: depths that two source images match equally "
       "well gain by it."},
      {"view_agreement",
       &options->view_agreement,
       "Judge depths by the number of source images whose depths agree."},
      {"min_aggregated_score",
       &options->min_aggregated_score,
       "Score above which a depth is reliable; the best have about 1 (eta in "
       "the paper).",
       0.0,
       2.0},
      {"confidence_weight",
       &options->confidence_weight,
       "Weight of the matching confidence against the discontinuity in the "
       "score, in [0, 1] (tau in the paper).",
       0.0,
       1.0},
      {"refine",
       &options->refine,
       "Spread reliable depths over superpixels and by weighted medians. If "
       "0, the three switches below have no effect."},
      {"superpixel_planes",
       &options->superpixel_planes,
       "Fit a plane to every superpixel that has enough reliable depths."},
      {"weighted_median",
       &options->weighted_median,
       "Confirm and fill depths by weighted medians of their surroundings."},
      {"readmit_filtered",
       &options->readmit_filtered,
       "Let depths that the filter rejected return where the weighted median "
       "of their surroundings confirms them."},
      {"spread_medians",
       &options->spread_medians,
       "Give depths that the weighted median of their surroundings confirms "
       "the depth of this median, as in the paper. If 0, they keep their own. "
       "Has no effect with scene_planes."},
      {"small_windows",
       &options->small_windows,
       "Confirm depths by windows half as wide, as the paper prints them: from "
       "2^(num_iterations - 1) times window_radius down to window_radius."},
      {"pixel_distances",
       &options->pixel_distances,
       "Let a neighbour's weight in weighted medians fall with its distance in "
       "pixels of a map 3110 wide, as printed in the paper. If 0, with that in "
       "steps of the window's sampling."},
      {"fill_wide_holes",
       &options->fill_wide_holes,
       "Fill holes by weighted medians wherever any sample of the window holds "
       "a depth. If 0, a third of them must."},
      {"fill_before_regions",
       &options->fill_before_regions,
       "Fill holes by weighted medians before planes are fitted to regions, "
       "and let these planes replace what is there, as in the paper. If 0, "
       "after them. Has no effect with scene_planes."},
      {"num_iterations",
       &options->num_iterations,
       "Rounds of the weighted median filters (N_t in the paper).",
       1,
       10},
      {"superpixel_size",
       &options->superpixel_size,
       "Area of a superpixel, in pixels of the image reduced to a long side "
       "of at most 777 (S_sp in the paper).",
       40,
       100000},
      {"min_plane_support",
       &options->min_plane_support,
       "Share of a superpixel's depths that must lie on its plane, and of the "
       "depths on a region's rim where nothing inside it carries one, in "
       "[0, 1] (sigma in the paper).",
       0.0,
       1.0},
      {"loose_plane_tolerance",
       &options->loose_plane_tolerance,
       "Find the planes of superpixels in two steps, as the paper prints it: "
       "first with this tolerance, in the unit of the sparse model, then, "
       "where the plane is credible, with 0.001 of the depth. The paper has "
       "0.005 m. If 0, in one step.",
       0.0,
       1e9},
      {"window_radius",
       &options->window_radius,
       "Radius of the smallest median window, in pixels of a map 3110 wide "
       "(delta in the paper).",
       1,
       100},
      {"spatial_sigma",
       &options->spatial_sigma,
       "How fast a neighbour's weight falls with its distance, in steps of the "
       "window's sampling (alpha in the paper).",
       0.01,
       100.0},
      {"color_sigma",
       &options->color_sigma,
       "How fast a neighbour's weight falls with the difference of colour, in "
       "levels of 0-255 (beta in the paper).",
       0.01,
       255.0},
      {"disparity_tolerance",
       &options->disparity_tolerance,
       "How far a depth may be from the median of its surroundings, in pixels "
       "of disparity in a map 3110 wide (mu in the paper).",
       0.01,
       10000.0},
      {"segment",
       &options->segment,
       "Find regions without texture and fit planes to them."},
      {"edge_threshold",
       &options->edge_threshold,
       "Step of brightness that bounds a region, in levels of 0-255.",
       0.0,
       255.0},
      {"edges_of_roots",
       &options->edges_of_roots,
       "Take the roots of brightness before the differences of the edge "
       "detector, whose summed squares must exceed edge_threshold, as printed "
       "in the paper. If 0, the root of the summed squares counts."},
      {"short_lines",
       &options->short_lines,
       "Let straight lines of any length bound a region. If 0, those of at "
       "least a thirtieth of the image's shorter side."},
      {"hough_min_votes",
       &options->hough_min_votes,
       "Edge pixels that a straight line needs (epsilon in the paper).",
       2,
       10000},
      {"hough_max_gap",
       &options->hough_max_gap,
       "Largest gap that a straight line may close, in pixels of an image 777 "
       "wide (upsilon in the paper).",
       1,
       10000},
      {"region_cores",
       &options->region_cores,
       "Let depths well inside a region decide about its plane before those on "
       "its rim, which belong to whatever hangs in front. If 0, one fit takes "
       "both."},
      {"region_rims",
       &options->region_rims,
       "Let depths around a region help to find its plane. If 0, only those "
       "inside it."},
      {"bounded_regions",
       &options->bounded_regions,
       "Let the plane of a region reach no further than three standard "
       "deviations of where depths lie on it. If 0, it fills the region."},
      {"max_region_planes",
       &options->max_region_planes,
       "Most planes that one region may hold.",
       1,
       kMaxPlanesPerRegion},
      {"min_region_size",
       &options->min_region_size,
       "Area of the smallest region, in pixels of an image 777 wide (kappa "
       "times 10000 in the paper).",
       1,
       100000000},
      {"max_boundary_error",
       &options->max_boundary_error,
       "How far a region's plane, where only the rim carries it, may be from "
       "the reliable depths along the rim, as a fraction of the depth (gamma "
       "in the paper).",
       0.0,
       1.0},
      {"max_boundary_gap",
       &options->max_boundary_gap,
       "How far a region's plane may be on average from the depths beside the "
       "region's border, in the unit of the sparse model, as the paper prints "
       "it (gamma, 0.1 m). If above 0, this alone decides whether a plane "
       "stands, and max_boundary_error has no effect.",
       0.0,
       1e9},
      {"confirmed_depths",
       &options->confirmed_depths,
       "Keep a measured depth that another view confirms, where the pixel has "
       "texture of its own, also where a plane would take its place; on weak "
       "texture, planes of the scene give way only if they are more than "
       "1.5 % off. Has no effect without view_agreement or with "
       "off_plane_depths 0."},
      {"scene_planes",
       &options->scene_planes,
       "Find planes in all views of a surface together and let them decide. If "
       "0, or if refine is 0, each image is refined by itself, and the "
       "switches below have no effect."},
      {"foreground_fattening",
       &options->foreground_fattening,
       "Let depths count little for the planes of the scene where the pattern "
       "that was matched lies beside the pixel: they are those of the frame or "
       "poster beside a wall."},
      {"manhattan_frame",
       &options->manhattan_frame,
       "Make planes exactly parallel and at right angles where that agrees "
       "with what was measured."},
      {"adjust_planes",
       &options->adjust_planes,
       "In scenes of more than 32 images, where planes are found in parts of "
       "the scene, adjust the planes of all parts together."},
      {"bounded_planes",
       &options->bounded_planes,
       "Leave holes where a plane was observed on one side only."},
      {"bounding_creases",
       &options->bounding_creases,
       "Let planes end at creases that three or more views see, and let "
       "another one begin there at right angles: ceilings over walls, though "
       "nothing of them was measured. Has no effect without manhattan_frame."},
      {"curved_surfaces",
       &options->curved_surfaces,
       "Let smooth curved surfaces stand where they explain the depths better "
       "than planes do."},
      {"cylinders",
       &options->cylinders,
       "Find bare columns and pipes by their outlines in four or more views, "
       "and fill them: round ones along an axis of the Manhattan frame. Has no "
       "effect without manhattan_frame."},
      {"off_plane_depths",
       &options->off_plane_depths,
       "Let depths that were measured off their plane stand."},
      {"pixel_borders",
       &options->pixel_borders,
       "Move the borders between planes from those of superpixels to the edges "
       "of the image, and drop depths that spill over these. If 0, borders are "
       "those of superpixels."},
      {"photometric",
       &options->photometric,
       "Compare composed maps of up to 1280 pixels with the images, and move "
       "textured pixels that stand a little off their surface, such as posters "
       "and doors. Larger maps gain nothing from it, and keep their depths."},
      {"plane_tolerance",
       &options->plane_tolerance,
       "How far a depth may be off a plane, in standard deviations of the "
       "depths about the planes of their superpixels.",
       0.1,
       1000.0},
      {"min_scene_plane",
       &options->min_scene_plane,
       "Pixels that a plane of the scene must explain that no other does, in "
       "images reduced to a long side of at most 777.",
       1.0,
       1e9},
      {"unlabelled_cost",
       &options->unlabelled_cost,
       "What a pixel costs that is left empty, against 0.05 for one on a plane "
       "that is not known there: the higher, the fewer holes.",
       0.0,
       1.0},
      {"min_confidence",
       &options->min_confidence,
       "Leave depths out whose confidence, the probability of being right to "
       "1 %, is less than this. 0 keeps all: fusion leaves out most of the "
       "wrong ones itself. Without scene_planes, confidences are only ranks.",
       0.0,
       1.0},
      {"sigma_maps",
       &options->sigma_maps,
       "Write stereo/sigma_maps: how far each depth may be off, as a standard "
       "deviation in the unit of the depth map, if its surface is the right "
       "one. Arrays of NumPy, of 16-bit floats."},
      {"seed",
       &options->seed,
       "Another number gives other random draws, and so tells how much of a "
       "result is luck; the same number always gives the same maps.",
       0,
       std::numeric_limits<int>::max()},
  };
}

const std::vector<RenamedOption>& RenamedRefineOptions() {
  static const std::vector<RenamedOption> renamed = {
      {"own_texture", "foreground_fattening"},
      {"regular_directions", "manhattan_frame"},
      {"cost_of_none", "unlabelled_cost"},
      {"distrust_untextured", "distrust_unmatched"},
  };
  return renamed;
}

std::map<std::string, std::string> RefineOptionsText(
    const RefineOptions& options) {
  RefineOptions copy = options;
  std::map<std::string, std::string> text;
  for (const RefineField& field : ListRefineFields(&copy)) {
    text[field.name] = std::visit(
        [](const auto* value) { return ValueText(*value); }, field.value);
  }
  return text;
}

std::string HashRefineOptions(const RefineOptions& options) {
  std::map<std::string, std::string> values = RefineOptionsText(options);
  for (const RenamedOption& renamed : RenamedRefineOptions()) {
    auto value = values.extract(renamed.name);
    value.key() = renamed.former_name;
    values.insert(std::move(value));
  }
  std::string text = TSAR_VERSION;
  for (const auto& [name, value] : values) {
    text += "\n" + name + "=" + value;
  }
  ContentHash hash;
  hash.Update(text.data(), text.size());
  TextStream hex;
  hex << std::hex << std::setfill('0') << std::setw(16) << hash.Value();
  return hex.str();
}

}  // namespace tsar
