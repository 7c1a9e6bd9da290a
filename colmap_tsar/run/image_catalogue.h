// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/run/input_fingerprints.h"
#include "colmap_tsar/run/pipeline_outcome.h"
#include "colmap_tsar/run/store/workspace.h"
#include "colmap_tsar/run/view_cache.h"
#include "colmap_tsar/view/refined_maps.h"

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace tsar {

// The images of a run, by their places in Workspace::Problems(): what each is
// made from, what is to be done with it, and the only way to its maps while
// threads read and write them. Images of the sparse model, which may also be
// sources alone, are called `image` and given by their places there. Can be
// used from several threads.
class ImageCatalogue {
 public:
  // All references must outlive this object. has_maps: see WorkspaceOverview.
  // options_hash: of the options that the images are refined with.
  // planes: what stands for the planes of the scene as they are, where images
  // share them; those that were refined with others are refined again.
  // reuses_results: whether images that were refined before the run stay so.
  // distrust_unmatched: see RefineOptions.
  ImageCatalogue(const Workspace& workspace,
                 std::vector<bool> has_maps,
                 std::string options_hash,
                 InputFingerprints& inputs,
                 std::string planes,
                 bool reuses_results,
                 bool distrust_unmatched);

  // Which images of the run are to be refined, where it is not all of them: the
  // others stay as they are, and serve as sources alone.
  void RefineOnly(std::vector<bool> is_listed);

  size_t NumImages() const { return workspace_.Problems().size(); }
  int Reference(size_t index) const { return Problem(index).reference; }
  const std::string& Name(int image) const;
  bool HasMaps(int image) const;
  // See load_view.h.
  bool IsMaskedAway(int image) const;
  // Those that have maps.
  std::vector<int> Sources(size_t index) const;
  // The views that single-view stages need.
  std::vector<int> SourcesAndReference(size_t index) const;
  int NumSourcesWithoutMaps(size_t index) const;
  // Whether the image and one of its sources have maps.
  bool CanRefine(size_t index) const;

  bool ReusesResults() const { return reuses_results_; }
  // Whether the image had been refined before the run and is not to be refined
  // again; looks at its maps and inputs in the first call.
  bool HasBeenRefined(size_t index);
  // Whether the image is to be refined, can be, and has not been before the
  // run.
  bool IsToBeRefined(size_t index);
  // Whether the image was refined before the run with other options, or from
  // what has changed since.
  bool WasRefinedOtherwise(size_t index);
  // Whether this is so of the image or of one whose source it is: that it is to
  // be refined.
  bool IsNeeded(size_t index);
  // Whether some image is to be refined.
  bool IsAnyNeeded();
  bool IsListed(size_t index) const { return is_listed_[index]; }
  size_t NumListed() const;
  // Warns where it is to be refined again because of what it depends on.
  void WarnOfChanges(size_t index);

  // Whether images share the planes of the scene, those that are refined from
  // now on have these.
  void UsePlanes(std::string planes) { used_planes_ = std::move(planes); }

  // Reads a view while nobody renames its files.
  ViewCache::View Load(int image);
  // At the size at which it is judged.
  ViewCache::View LoadReduced(int image);

  // Keeps the image where it cannot be refined, with a record of the reason;
  // the outcome is kNotDone where it is to be refined.
  ImageReport BeginRefining(size_t index);
  // Leaves the image refined, with a record of the counts and times in the
  // report and those of its earlier passes.
  // Nothing is left of the maps where the image is masked.
  void WriteRefined(size_t index, RefinedMaps maps, ImageReport* report);
  // Leaves the image with its original maps, and a record of the reason.
  void Keep(size_t index, const std::string& reason, ImageReport* report);

  // Books seconds that an earlier pass took for an image, by stages.
  void AddSeconds(size_t index, const std::map<std::string, double>& seconds);

 private:
  const StereoProblem& Problem(size_t index) const {
    return workspace_.Problems()[index];
  }
  // See RefineOptions::distrust_unmatched.
  // See InputFingerprints::OfResult; with what stands for the planes.
  InputState InputsOf(int image, const std::string& planes);
  void DropUnmatchedDepths(size_t index, ViewData* view);

  const Workspace& workspace_;
  const std::vector<bool> has_maps_;
  const std::string options_hash_;
  InputFingerprints& inputs_;
  const std::string planes_;
  std::string used_planes_;
  const bool reuses_results_;
  const bool distrust_unmatched_;
  std::vector<bool> is_listed_;  // By image of the run.
  // By image of the run: whether it had been refined before the run, once the
  // flag is set.
  std::vector<std::once_flag> is_done_flags_;
  std::vector<uint8_t> is_done_;
  std::once_flag is_any_needed_flag_;
  bool is_any_needed_ = false;
  // By image of the sparse model, its place among those of the run; -1: none.
  std::vector<int64_t> index_of_;
  // By image of the sparse model, the images of the run that need it, as their
  // reference or as a source.
  std::vector<std::vector<size_t>> users_;
  // By image of the run, what was booked by AddSeconds.
  std::vector<std::map<std::string, double>> seconds_;
  // While one thread gives an image's maps their new names, another that reads
  // the originals of that image could take the refined ones for maps that
  // COLMAP wrote anew.
  std::vector<std::mutex> file_mutexes_;
};

// Adds seconds, by stages, to their sums.
void AddStageSeconds(const std::map<std::string, double>& seconds,
                     std::map<std::string, double>* sums);

}  // namespace tsar
