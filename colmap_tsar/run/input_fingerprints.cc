// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/input_fingerprints.h"

#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/priors/depth_prior.h"
#include "colmap_tsar/run/store/originals.h"
#include "colmap_tsar/run/store/record.h"

#include <cinttypes>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <system_error>
#include <utility>

namespace tsar {
namespace {

constexpr const char* kCamera = "camera";
constexpr const char* kPhoto = "photo";
constexpr const char* kMask = "mask";
constexpr const char* kPrior = "prior";
constexpr const char* kMaps = "maps";
constexpr const char* kCosts = "costs";
constexpr const char* kSources = "sources";
constexpr const char* kScene = "scene";
// The state of the maps where there is nothing to refine.
constexpr const char* kNoMaps = "none";

std::string Get(const InputState& state, const std::string& key) {
  const auto found = state.find(key);
  return found == state.end() ? "" : found->second;
}

bool Differ(const InputState& a, const InputState& b, const std::string& key) {
  return Get(a, key) != Get(b, key);
}

// The changed inputs among those of a view.
std::vector<ChangedInput> ChangesOfView(const InputState& before,
                                        const InputState& now) {
  std::vector<ChangedInput> changes;
  const auto compare = [&](const char* key, ChangedInput change) {
    if (Differ(before, now, key)) {
      changes.push_back(std::move(change));
    }
  };
  if (Get(before, kMaps) != kNoMaps && Get(now, kMaps) != kNoMaps) {
    compare(kCamera, {"its camera", false});
    compare(kPhoto, {"its photo", false});
    compare(kMask, {"its mask", false});
    compare(kPrior, {"its depth prior", false});
    compare(kCosts, {"its cost maps", true});
  }
  compare(kMaps, {"its maps", true});
  return changes;
}

}  // namespace

std::string FingerprintOf(const std::string& text) {
  ContentHash hash;
  hash.Update(text.data(), text.size());
  char digits[17];
  std::snprintf(digits, sizeof(digits), "%016" PRIx64, hash.Value());
  return digits;
}

std::string FingerprintOf(const Camera& camera) {
  TextStream text;
  text << std::hexfloat << camera.width << " " << camera.height;
  for (const double value : {camera.fx, camera.fy, camera.cx, camera.cy}) {
    text << " " << value;
  }
  for (const double value : camera.rotation.reshaped()) {
    text << " " << value;
  }
  for (const double value : camera.translation) {
    text << " " << value;
  }
  return FingerprintOf(text.str());
}

std::string FileState(const std::filesystem::path& path) {
  std::error_code error;
  const uintmax_t size = std::filesystem::file_size(path, error);
  if (error) {
    return "-";
  }
  const auto time = std::filesystem::last_write_time(path, error);
  return std::to_string(size) + "@" +
         std::to_string(time.time_since_epoch().count());
}

std::string DescribeChanges(const std::vector<ChangedInput>& changes) {
  std::string text;
  for (size_t i = 0; i < changes.size(); ++i) {
    const char* separator = i == 0                   ? ""
                            : i + 1 < changes.size() ? ", "
                                                     : " and ";
    text += separator + changes[i].name;
  }
  const bool is_plural = changes.size() > 1 || changes.front().is_plural;
  return text + (is_plural ? " have changed" : " has changed");
}

std::string FingerprintOfPrior(const Workspace& workspace, int image) {
  const PriorFiles& files = workspace.Priors().FilesOf(image);
  return FingerprintOf(FileState(files.depth) + " " + FileState(files.normals) +
                       " " + ToString(workspace.Priors().Type()));
}

InputFingerprints::InputFingerprints(const Workspace& workspace)
    : workspace_(workspace),
      problems_(workspace.Model().images.size()),
      source_lists_(workspace.Model().images.size()),
      views_(workspace.Model().images.size()),
      is_own_(workspace.Model().images.size()) {
  for (const StereoProblem& problem : workspace.Problems()) {
    std::string names;
    for (const int source : problem.sources) {
      names += workspace_.Name(source) + "\n";  // Names have no line breaks.
    }
    problems_[problem.reference] = &problem;
    source_lists_[problem.reference] = FingerprintOf(names);
  }
}

const InputState& InputFingerprints::OfView(int image) {
  return Find(image).state;
}

const std::string& InputFingerprints::StateOfView(int image) {
  return Find(image).fingerprint;
}

const std::string& InputFingerprints::StateOfScene() {
  std::call_once(scene_flag_, [&] {
    std::vector<bool> is_used(views_.size());
    for (const StereoProblem& problem : workspace_.Problems()) {
      is_used[problem.reference] = true;
      for (const int source : problem.sources) {
        is_used[source] = true;
      }
    }
    std::string text;
    for (size_t image = 0; image < is_used.size(); ++image) {
      if (is_used[image]) {
        text += StateOfView(static_cast<int>(image)) + " " +
                source_lists_[image] + "\n";
      }
    }
    scene_ = FingerprintOf(text);
  });
  return scene_;
}

InputState InputFingerprints::OfResult(int reference,
                                       const std::string& planes) {
  InputState state = OfView(reference);
  state[kSources] = source_lists_[reference];
  state[kScene] = StateOfScene();
  state[ImageRecord::kPlanes] = planes;
  return state;
}

std::string InputFingerprints::ChangesOfResult(int reference,
                                               const InputState& recorded) {
  const InputState now = OfResult(reference);
  std::vector<ChangedInput> changes = ChangesOfView(recorded, now);
  if (Differ(recorded, now, kSources)) {
    changes.push_back({"its list of sources", false});
  }
  // Changes of the view itself are reason enough.
  if (changes.empty() && Differ(recorded, now, kScene)) {
    changes.push_back({"other images of the scene", true});
  }
  return changes.empty() ? "" : DescribeChanges(changes);
}

void InputFingerprints::Expect(std::map<int, InputState> views,
                               const std::vector<int>& own) {
  expected_ = std::move(views);
  for (const int image : own) {
    is_own_[image] = true;
  }
}

const InputFingerprints::View& InputFingerprints::Find(int image) {
  View& view = views_[image];
  std::call_once(view.flag, [&] {
    view.state = Read(image);
    std::string text = workspace_.Name(image);
    for (const auto& [key, value] : view.state) {
      text += "\n" + key + " " + value;
    }
    view.fingerprint = FingerprintOf(text);
  });
  return view;
}

InputState InputFingerprints::Read(int image) const {
  const auto expected = expected_.find(image);
  const bool reads_maps = expected == expected_.end() || is_own_[image];
  InputState state = {
      {kMaps, reads_maps ? MapsOf(image) : Get(expected->second, kMaps)}};
  if (state[kMaps] != kNoMaps) {
    state[kCamera] = FingerprintOf(workspace_.CameraOf(image));
    state[kPhoto] = FingerprintOf(FileState(workspace_.ImagePath(image)));
    if (workspace_.HasMask(image)) {
      state[kMask] = FingerprintOf(FileState(workspace_.MaskPath(image)));
    }
    if (workspace_.Priors().HasPrior(image)) {
      state[kPrior] = FingerprintOfPrior(workspace_, image);
    }
    std::string costs;
    for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
      costs += FileState(workspace_.CostPath(image, type)) + " ";
    }
    state[kCosts] = FingerprintOf(costs);
  }
  if (expected != expected_.end()) {
    const std::vector<ChangedInput> changes =
        ChangesOfView(expected->second, state);
    if (!changes.empty()) {
      throw Error(ErrorCode::kMismatch,
                  workspace_.Name(image) + ": " + DescribeChanges(changes) +
                      " since it was observed; run " + OptionName("pass") +
                      " observe of "
                      "all shards again");
    }
  }
  return state;
}

std::string InputFingerprints::MapsOf(int image) const {
  std::string text;
  for (const MapType type : {MapType::kPhotometric, MapType::kGeometric}) {
    const OriginalMaps originals = FindOriginals(
        workspace_.SourcePaths(image, type), Scrutiny::kTimeAndSamples);
    if (type == workspace_.Type() &&
        (originals.depth.state == OriginalState::kMissing ||
         originals.normal.state == OriginalState::kMissing)) {
      return kNoMaps;
    }
    text += FileState(originals.depth.path) + " " +
            FileState(originals.normal.path) + " ";
  }
  return FingerprintOf(text);
}

}  // namespace tsar
