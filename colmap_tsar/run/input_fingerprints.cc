// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/input_fingerprints.h"

#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/priors/depth_prior.h"
#include "colmap_tsar/run/store/originals.h"

#include <set>

namespace tsar {

std::string FingerprintOf(const std::string& text) {
  ContentHash hash;
  hash.Update(text.data(), text.size());
  return HexDigits(hash.Value());
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

InputFingerprints::InputFingerprints(const Workspace& workspace) {
  for (const StereoProblem& problem : workspace.Problems()) {
    std::string names;
    for (const int source : problem.sources) {
      names += workspace.Name(source) + "\n";  // Names have no line breaks.
    }
    states_["the list of sources of " + workspace.Name(problem.reference)] =
        FingerprintOf(names);
  }
  for (const int image : workspace.ImagesInUse()) {
    AddView(workspace, image);
  }
  std::string text =
      std::string(TSAR_VERSION) + " " + ToString(workspace.Type()) + "\n";
  for (const auto& [input, state] : states_) {
    text += input + " " + state + "\n";
  }
  fingerprint_ = FingerprintOf(text);
}

void InputFingerprints::AddView(const Workspace& workspace, int image) {
  const auto add = [&](const std::string& what, const std::string& state) {
    states_["the " + what + " of " + workspace.Name(image)] = state;
  };
  const MapPaths paths = workspace.Paths(image, workspace.Type());
  const OriginalMaps originals = FindOriginals(paths);
  if (originals.depth.path.empty() || originals.normal.path.empty()) {
    return;  // Nobody reads what else there is.
  }
  const std::string type = ToString(workspace.Type());
  add(type + " depth map", FileState(originals.depth.path));
  add(type + " normal map", FileState(originals.normal.path));
  add(type + " cost map", FileState(paths.cost));
  add("camera", FingerprintOf(workspace.CameraOf(image)));
  add("photo", FileState(workspace.ImagePath(image)));
  if (workspace.HasMask(image)) {
    add("mask", FileState(workspace.MaskPath(image)));
  }
  if (workspace.Priors().HasPrior(image)) {
    const PriorFolder& priors = workspace.Priors();
    const PriorFiles& files = priors.FilesOf(image);
    add("depth prior",
        FingerprintOf(FileState(files.depth) + " " + FileState(files.normals) +
                      " " + ToString(priors.Type())));
  }
}

std::string InputFingerprints::ChangesSince(
    const std::map<std::string, std::string>& states) const {
  std::set<std::string> changed;
  const auto compare = [&](const auto& from, const auto& to) {
    for (const auto& [input, state] : from) {
      const auto found = to.find(input);
      if (found == to.end() || found->second != state) {
        changed.insert(input);
      }
    }
  };
  compare(states, states_);
  compare(states_, states);
  if (changed.empty()) {
    return "";
  }
  return *changed.begin() +
         (changed.size() == 1
              ? " has changed"
              : " and " + std::to_string(changed.size() - 1) +
                    (changed.size() == 2 ? " other input" : " other inputs") +
                    " have changed");
}

}  // namespace tsar
