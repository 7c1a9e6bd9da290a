// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/patch_match_config.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/warning.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <memory>
#include <numbers>
#include <unordered_set>

#include <Eigen/Geometry>

namespace tsar {
namespace {

constexpr double kAnglePercentile = 0.75;

// Sources within this triangulation angle of each other show the same: it is
// about the two pixels of parallax, in maps 640 pixels wide, within which views
// agree.
constexpr double kSamePlaceDegrees = 0.2;

// Whether the triangulation angle of a point reaches the angle of this tangent.
// Beyond a right angle its supplement is used, since opposite rays locate a
// point no better than parallel ones.
bool HasAngle(const Eigen::Vector3d& center_a,
              const Eigen::Vector3d& center_b,
              const Eigen::Vector3d& point,
              double min_tangent) {
  const Eigen::Vector3d ray_a = point - center_a;
  const Eigen::Vector3d ray_b = point - center_b;
  const double sine = ray_a.cross(ray_b).norm();
  const double cosine = std::abs(ray_a.dot(ray_b));
  // A point in a camera's center (both are 0) has no angle.
  return sine >= min_tangent * cosine && (sine > 0.0 || min_tangent <= 0.0);
}

// Whether the percentile of the angles reaches the minimum: at most its rank of
// them are too small.
bool ReachesPercentile(int64_t num_small, int64_t num_angles) {
  const auto rank = static_cast<int64_t>(
      std::round(kAnglePercentile * static_cast<double>(num_angles - 1)));
  return num_angles > 0 && num_small <= rank;
}

bool ReachAngle(const std::vector<Eigen::Vector3d>& points,
                const Eigen::Vector3d& center_a,
                const Eigen::Vector3d& center_b,
                double min_tangent) {
  const auto num_small = std::count_if(
      points.begin(), points.end(), [&](const Eigen::Vector3d& point) {
        return !HasAngle(center_a, center_b, point, min_tangent);
      });
  return ReachesPercentile(num_small, static_cast<int64_t>(points.size()));
}

struct ConfigLine {
  int number = 0;
  std::string text;
};

std::string Trimmed(const std::string& text) {
  constexpr const char* kBlank = " \t\r\n\v\f";
  const size_t first = text.find_first_not_of(kBlank);
  if (first == std::string::npos) {
    return "";
  }
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

// The lines that are neither blank nor comments.
std::vector<ConfigLine> ReadConfigLines(const std::filesystem::path& path) {
  InputFile file(path);
  if (!file) {
    throw Error::File(ErrorCode::kNotFound,
                      path.string(),
                      "the configuration file is missing or cannot be read (" +
                          file.Reason() + ")",
                      "make the workspace with image_undistorter");
  }
  std::vector<ConfigLine> lines;
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    std::string text = Trimmed(line);
    if (!text.empty() && text[0] != '#') {
      lines.push_back({number, std::move(text)});
    }
  }
  return lines;
}

// Splits a list of names, which COLMAP separates by commas or semicolons.
std::vector<std::string> SplitNames(const std::string& text) {
  std::vector<std::string> names;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find_first_of(",;", begin), text.size());
    std::string name = Trimmed(text.substr(begin, end - begin));
    if (!name.empty()) {
      names.push_back(std::move(name));
    }
    begin = end + 1;
  }
  return names;
}

class ConfigParser {
 public:
  ConfigParser(const std::filesystem::path& path,
               const SparseModel& model,
               double min_triangulation_angle_degrees)
      : path_(path),
        model_(model),
        selector_(model, min_triangulation_angle_degrees) {}

  std::vector<StereoProblem> Parse() {
    const std::vector<ConfigLine> lines = ReadConfigLines(path_);
    std::vector<StereoProblem> problems;
    for (size_t i = 0; i < lines.size(); i += 2) {
      StereoProblem problem;
      problem.reference = FindImage(lines[i], lines[i].text);
      if (!references_.insert(problem.reference).second) {
        throw Corrupt(
            lines[i],
            "gives the sources of " + lines[i].text + " a second time");
      }
      if (i + 1 == lines.size()) {
        throw Corrupt(lines[i],
                      "names the reference " + lines[i].text +
                          ", but no line with its sources follows");
      }
      problem.sources = ParseSources(lines[i + 1], problem.reference);
      if (problem.sources.empty()) {
        problem.without_sources = WhyWithoutSources(problem.reference);
      }
      problems.push_back(std::move(problem));
    }
    WarnOfDependentSources();
    return problems;
  }

 private:
  std::vector<int> ParseSources(const ConfigLine& line, int reference) {
    const std::vector<std::string> names = SplitNames(line.text);
    if (!names.empty() && names[0] == "__auto__") {
      return SelectSources(line, names, reference);
    }
    const std::vector<int> sources = names.size() == 1 && names[0] == "__all__"
                                         ? AllBut(reference)
                                         : FindSources(line, names, reference);
    std::vector<int> independent =
        selector_.SelectIndependent(reference, sources);
    num_named_ += sources.size();
    num_dependent_ += sources.size() - independent.size();
    return independent;
  }

  std::vector<int> AllBut(int reference) const {
    std::vector<int> images;
    for (int i = 0; i < static_cast<int>(model_.images.size()); ++i) {
      if (i != reference) {
        images.push_back(i);
      }
    }
    return images;
  }

  std::vector<int> FindSources(const ConfigLine& line,
                               const std::vector<std::string>& names,
                               int reference) const {
    std::vector<int> sources;
    std::unordered_set<int> seen = {reference};
    for (const std::string& name : names) {
      sources.push_back(FindImage(line, name));
      if (!seen.insert(sources.back()).second) {
        throw Corrupt(
            line,
            "lists " + name + ", which is the reference or already listed");
      }
    }
    if (sources.empty()) {
      throw Corrupt(line, "lists no source image");
    }
    return sources;
  }

  std::vector<int> SelectSources(const ConfigLine& line,
                                 const std::vector<std::string>& names,
                                 int reference) {
    int count = 0;
    if (names.size() == 2) {
      const char* end = names[1].data() + names[1].size();
      const auto result = std::from_chars(names[1].data(), end, count);
      count = result.ec == std::errc() && result.ptr == end ? count : 0;
    }
    if (count < 1) {
      throw Corrupt(line,
                    "must have the form \"__auto__, N\" with a number N > 0");
    }
    return selector_.SelectSources(reference, count);
  }

  std::string WhyWithoutSources(int reference) const {
    return selector_.HasOverlap(reference)
               ? "all images that share its sparse points were taken from "
                 "nearly the same place, which tells nothing of depth; take "
                 "some from other places"
               : "no other image shares enough of its sparse points";
  }

  void WarnOfDependentSources() const {
    if (num_dependent_ > 0) {
      Warn(path_.string() + ": " + std::to_string(num_dependent_) + " of " +
           std::to_string(num_named_) +
           " sources are left out: they were taken from nearly the same place "
           "as the reference or another source, and so confirm no depth");
    }
  }

  int FindImage(const ConfigLine& line, const std::string& name) const {
    const int index = model_.IndexOf(name);
    if (index < 0) {
      throw Error::File(ErrorCode::kMismatch,
                        path_.string(),
                        "line " + std::to_string(line.number) + " names " +
                            name + ", which is not in the sparse model",
                        "correct the name or make the workspace again");
    }
    return index;
  }

  Error Corrupt(const ConfigLine& line, const std::string& what) const {
    return Error::File(ErrorCode::kCorrupt,
                       path_.string(),
                       "line " + std::to_string(line.number) + " " + what,
                       "correct the line or make the workspace again");
  }

  const std::filesystem::path& path_;
  const SparseModel& model_;
  const SourceSelector selector_;
  std::unordered_set<int> references_;
  size_t num_named_ = 0;  // Number of sources that the file names.
  size_t num_dependent_ = 0;
};

}  // namespace

SourceSelector::SourceSelector(const SparseModel& model,
                               double min_triangulation_angle_degrees)
    : model_(model),
      min_tangent_(
          std::tan(min_triangulation_angle_degrees * std::numbers::pi / 180.0)),
      track_begins_(model.points.size() + 1, 0) {
  for (const SparseModel::ModelImage& image : model.images) {
    centers_.push_back(image.camera.Center());
    for (const int point : image.point_indices) {
      ++track_begins_[static_cast<size_t>(point) + 1];
    }
  }
  for (size_t i = 1; i < track_begins_.size(); ++i) {
    track_begins_[i] += track_begins_[i - 1];
  }
  track_images_.resize(track_begins_.back());
  std::vector<size_t> ends = track_begins_;
  for (size_t i = 0; i < model.images.size(); ++i) {
    for (const int point : model.images[i].point_indices) {
      track_images_[ends[static_cast<size_t>(point)]++] = static_cast<int>(i);
    }
  }
}

std::vector<int> SourceSelector::SelectSources(int reference,
                                               int max_num_sources) const {
  const SparseModel::ModelImage& image =
      model_.images.at(static_cast<size_t>(reference));
  std::vector<int64_t> num_shared(model_.images.size(), 0);
  std::vector<int> candidates;
  for (const int point : image.point_indices) {
    const auto p = static_cast<size_t>(point);
    for (size_t i = track_begins_[p]; i < track_begins_[p + 1]; ++i) {
      const int other = track_images_[i];
      if (other != reference && num_shared[static_cast<size_t>(other)]++ == 0) {
        candidates.push_back(other);
      }
    }
  }
  std::sort(candidates.begin(), candidates.end(), [&](int a, int b) {
    const int64_t shared_a = num_shared[static_cast<size_t>(a)];
    const int64_t shared_b = num_shared[static_cast<size_t>(b)];
    return shared_a != shared_b ? shared_a > shared_b : a < b;
  });

  const std::vector<Eigen::Vector3d> points = PointsOf(reference);
  std::vector<int> sources;
  for (const int candidate : candidates) {
    if (static_cast<int>(sources.size()) >= max_num_sources) {
      break;
    }
    if (HasTriangulationAngle(reference, candidate) &&
        IsIndependent(points, candidate, sources)) {
      sources.push_back(candidate);
    }
  }
  return sources;
}

std::vector<int> SourceSelector::SelectIndependent(
    int reference, const std::vector<int>& images) const {
  const std::vector<Eigen::Vector3d> points = PointsOf(reference);
  if (points.empty()) {
    return images;
  }
  std::vector<int> sources;
  std::copy_if(images.begin(),
               images.end(),
               std::back_inserter(sources),
               [&](int image) {
                 return AreDifferent(points, reference, image) &&
                        IsIndependent(points, image, sources);
               });
  return sources;
}

bool SourceSelector::HasOverlap(int reference) const {
  const std::vector<int>& points =
      model_.images[static_cast<size_t>(reference)].point_indices;
  return std::any_of(points.begin(), points.end(), [&](int point) {
    const auto p = static_cast<size_t>(point);
    return std::any_of(&track_images_[track_begins_[p]],
                       &track_images_[track_begins_[p]] +
                           (track_begins_[p + 1] - track_begins_[p]),
                       [&](int image) { return image != reference; });
  });
}

std::vector<Eigen::Vector3d> SourceSelector::PointsOf(int reference) const {
  const std::vector<int>& indices =
      model_.images[static_cast<size_t>(reference)].point_indices;
  const size_t count = std::min(indices.size(), kMaxNumPoints);
  std::vector<Eigen::Vector3d> points;
  for (size_t i = 0; i < count; ++i) {
    points.push_back(
        model_
            .points[static_cast<size_t>(indices[i * indices.size() / count])]);
  }
  return points;
}

bool SourceSelector::AreDifferent(const std::vector<Eigen::Vector3d>& points,
                                  int image_a,
                                  int image_b) const {
  return ReachAngle(points,
                    centers_[static_cast<size_t>(image_a)],
                    centers_[static_cast<size_t>(image_b)],
                    min_tangent_);
}

bool SourceSelector::IsIndependent(const std::vector<Eigen::Vector3d>& points,
                                   int image,
                                   const std::vector<int>& sources) const {
  static const double min_tangent =
      std::tan(kSamePlaceDegrees * std::numbers::pi / 180.0);
  return std::all_of(sources.begin(), sources.end(), [&](int source) {
    return ReachAngle(points,
                      centers_[static_cast<size_t>(image)],
                      centers_[static_cast<size_t>(source)],
                      min_tangent);
  });
}

bool SourceSelector::HasTriangulationAngle(int reference, int source) const {
  const auto a = static_cast<size_t>(reference);
  const auto b = static_cast<size_t>(source);
  const std::vector<int>& points_b = model_.images[b].point_indices;
  int64_t num_angles = 0;
  int64_t num_small = 0;
  // Both lists ascend. A point that is observed several times counts once for
  // each pair of observations, as in the number of shared points.
  auto run = points_b.begin();
  for (const int point : model_.images[a].point_indices) {
    while (run != points_b.end() && *run < point) {
      ++run;
    }
    for (auto it = run; it != points_b.end() && *it == point; ++it) {
      ++num_angles;
      num_small += HasAngle(centers_[a],
                            centers_[b],
                            model_.points[static_cast<size_t>(point)],
                            min_tangent_)
                       ? 0
                       : 1;
    }
  }
  return ReachesPercentile(num_small, num_angles);
}

std::vector<StereoProblem> ReadPatchMatchConfig(
    const std::filesystem::path& path,
    const SparseModel& model,
    double min_triangulation_angle_degrees) {
  return ConfigParser(path, model, min_triangulation_angle_degrees).Parse();
}

}  // namespace tsar
