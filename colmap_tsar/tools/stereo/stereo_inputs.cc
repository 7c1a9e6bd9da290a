// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/tools/stereo/stereo_inputs.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/text_stream.h"
#include "colmap_tsar/run/input_fingerprints.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string_view>

namespace tsar {
namespace {

// The inputs by the words of a line, which ends in the image's name.
constexpr std::array<const char*, 4> kWords = {
    "camera", "photo", "sources", "depths"};
// The inputs that stand behind the word of another one, after a plus sign, and
// only where the image has them.
struct Appended {
  const char* word;
  const char* key;
};
constexpr std::array<Appended, 2> kAppended = {Appended{"photo", "mask"},
                                               {"depths", "prior"}};
constexpr char kSign = '+';

struct Part {
  const char* key;
  ChangedInput change;
};
const std::array<Part, 6> kParts = {
    Part{"camera", {"its camera", false}},
    Part{"photo", {"its photo", false}},
    Part{"mask", {"its mask", false}},
    Part{"sources", {"its list of sources", false}},
    Part{"depths", {"the range of its sparse points", false}},
    Part{"prior", {"its depth prior", false}}};
// The value of an unused input.
constexpr const char* kNone = "-";
// The first line of a file.
const std::string kHead = std::string("fingerprints ") + kContentHashName;

// Splits words into their input and the one that is appended to it.
void SplitWords(InputState* state) {
  for (const auto& [word, key] : kAppended) {
    std::string& value = (*state)[word];
    const size_t sign = value.find(kSign);
    (*state)[key] = sign == std::string::npos ? kNone : value.substr(sign + 1);
    value = value.substr(0, sign);
  }
}

std::string FingerprintOfSources(const Workspace& workspace,
                                 const std::vector<int>& sources) {
  std::string names;
  for (const int source : sources) {
    // Names have no line breaks.
    names += workspace.Model().images[source].name + "\n";
  }
  return FingerprintOf(names);
}

std::string FingerprintOfDepths(const DepthInterval& depths) {
  TextStream text;
  text << std::hexfloat << depths.min << " " << depths.max;
  return FingerprintOf(text.str());
}

}  // namespace

std::vector<int> StereoSources(const StereoProblem& problem,
                               const StereoOptions& options) {
  std::vector<int> sources = problem.sources;
  if (sources.size() > static_cast<size_t>(options.num_sources)) {
    sources.resize(static_cast<size_t>(options.num_sources));
  }
  return sources;
}

DepthInterval StereoDepths(const Workspace& workspace,
                           int image,
                           const StereoOptions& options) {
  if (options.depth_min > 0.0) {
    return {options.depth_min, options.depth_max};
  }
  const std::optional<DepthInterval> range =
      SparseDepthInterval(workspace.Model(), image);
  if (!range) {
    throw Error::File(
        ErrorCode::kNotFound,
        workspace.ImagePath(image).string(),
        "sees none of the sparse points, so that its depths cannot be guessed",
        "give " + OptionName("depth_min") + " and " + OptionName("depth_max"));
  }
  return *range;
}

std::pair<int, int> MapSizeOf(const Camera& camera, int max_image_size) {
  const int side = std::max(camera.width, camera.height);
  const double scale = max_image_size > 0 && max_image_size < side
                           ? static_cast<double>(max_image_size) / side
                           : 1.0;
  return {std::max(1, static_cast<int>(std::lround(camera.width * scale))),
          std::max(1, static_cast<int>(std::lround(camera.height * scale)))};
}

StereoInputs FindStereoInputs(const Workspace& workspace,
                              const StereoOptions& options) {
  StereoInputs inputs;
  const auto find = [&](int image) -> InputState& {
    const SparseModel::ModelImage& entry = workspace.Model().images[image];
    InputState& state = inputs[entry.name];
    if (state.empty()) {
      state = {{"camera", FingerprintOf(entry.camera)},
               {"photo", FingerprintOf(FileState(workspace.ImagePath(image)))},
               {"mask",
                workspace.HasMask(image)
                    ? FingerprintOf(FileState(workspace.MaskPath(image)))
                    : kNone},
               {"sources", kNone},
               {"depths", kNone},
               {"prior", kNone}};
    }
    return state;
  };
  for (const StereoProblem& problem : workspace.Problems()) {
    if (problem.sources.empty()) {
      continue;
    }
    const std::vector<int> sources = StereoSources(problem, options);
    std::ranges::for_each(sources, find);
    InputState& state = find(problem.reference);
    state["sources"] = FingerprintOfSources(workspace, sources);
    state["depths"] = FingerprintOfDepths(
        StereoDepths(workspace, problem.reference, options));
    if (workspace.Priors().HasPrior(problem.reference)) {
      state["prior"] = FingerprintOfPrior(workspace, problem.reference);
    }
  }
  return inputs;
}

std::optional<StereoInputs> ReadStereoInputs(
    const std::filesystem::path& path) {
  InputFile file(path);
  std::string line;
  if (!std::getline(file, line) || line != kHead) {
    return std::nullopt;
  }
  StereoInputs inputs;
  while (std::getline(file, line)) {
    InputState state;
    size_t begin = 0;
    for (const char* word : kWords) {
      const size_t end = line.find(' ', begin);
      if (end == std::string::npos) {
        return std::nullopt;
      }
      state[word] = line.substr(begin, end - begin);
      begin = end + 1;
    }
    SplitWords(&state);
    inputs[line.substr(begin)] = std::move(state);
  }
  return inputs;
}

void WriteStereoInputs(const ContainedPath& path, const StereoInputs& inputs) {
  AtomicFile file(path);
  file.Stream() << kHead << "\n";
  for (const auto& [name, state] : inputs) {
    for (const char* word : kWords) {
      file.Stream() << state.at(word);
      for (const auto& [before, key] : kAppended) {
        if (std::string_view(word) == before && state.at(key) != kNone) {
          file.Stream() << kSign << state.at(key);
        }
      }
      file.Stream() << " ";
    }
    file.Stream() << name << "\n";
  }
  file.Commit();
}

std::optional<StereoChange> FindStereoChange(const StereoInputs& before,
                                             const StereoInputs& now) {
  std::optional<StereoChange> first;
  int num_others = 0;
  for (const auto& [name, state] : now) {
    const auto found = before.find(name);
    if (found == before.end() || found->second == state) {
      continue;
    }
    if (first) {
      ++num_others;
      continue;
    }
    std::vector<ChangedInput> changes;
    for (const Part& part : kParts) {
      if (found->second.at(part.key) != state.at(part.key)) {
        changes.push_back(part.change);
      }
    }
    first = {name, DescribeChanges(changes) + " since the maps were made"};
  }
  if (num_others > 0) {
    first->text +=
        ", and " + std::to_string(num_others) +
        (num_others == 1 ? " other image has" : " other images have") +
        " changed, too";
  }
  return first;
}

}  // namespace tsar
