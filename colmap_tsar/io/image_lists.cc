// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/image_lists.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/parse_number.h"
#include "colmap_tsar/base/printable.h"
#include "colmap_tsar/io/source_selector.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <unordered_set>
#include <utility>

#include <boost/algorithm/string/classification.hpp>
#include <boost/algorithm/string/split.hpp>
#include <boost/algorithm/string/trim.hpp>

namespace tsar {
namespace {

// Upper bound of the length of file names.
constexpr size_t kMaxNameLength = 4096;

struct Line {
  int number = 0;
  std::string text;
};

// The index of the image that this line of a file names.
int IndexOf(const std::string& name,
            const SparseModel& model,
            const std::filesystem::path& path,
            int line,
            const std::string& advice) {
  const int index = model.IndexOf(name);
  if (index < 0) {
    const auto longer = std::ranges::find_if(
        model.images,
        [&](const auto& image) { return image.name.starts_with(name + " "); });
    throw Error::File(
        ErrorCode::kMismatch,
        path.string(),
        "line " + std::to_string(line) + " names " + name +
            ", which is not in the sparse model" +
            (longer == model.images.end()
                 ? ""
                 : "; it has \"" + longer->name +
                       "\", with text behind the name"),
        longer == model.images.end() ? advice : "take that out of images.txt");
  }
  return index;
}

// The lines of a file that are not blank, without the blanks around them. noun,
// advice: for a missing file.
std::vector<Line> ReadLines(const std::filesystem::path& path,
                            const std::string& noun,
                            const std::string& advice) {
  InputFile file(path);
  file.RequireOpened(noun, advice);
  std::vector<Line> lines;
  std::string line;
  for (int number = 1; ReadLine(file, number == 1, &line); ++number) {
    if (std::string text = boost::trim_copy(line); !text.empty()) {
      lines.push_back({number, std::move(text)});
    }
  }
  return lines;
}

// Splits a list of names, which COLMAP separates by commas or semicolons.
std::vector<std::string> SplitNames(const std::string& text) {
  std::vector<std::string> names;
  boost::split(names, text, boost::is_any_of(",;"));
  for (std::string& name : names) {
    boost::trim(name);
  }
  std::erase(names, "");
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
    std::vector<Line> lines = ReadLines(path_,
                                        "configuration file",
                                        "make the workspace with "
                                        "image_undistorter");
    std::erase_if(lines, [](const Line& line) { return line.text[0] == '#'; });
    std::vector<StereoProblem> problems;
    for (size_t i = 0; i < lines.size(); i += 2) {
      if (model_.without_pose.contains(lines[i].text)) {
        continue;
      }
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
        problem.without_sources =
            selector_.HasOverlap(problem.reference)
                ? "all images that share its sparse points were taken from "
                  "nearly the same place, which tells nothing of depth; take "
                  "some from other places"
                : "no other image shares enough of its sparse points";
      }
      problems.push_back(std::move(problem));
    }
    return problems;
  }

 private:
  std::vector<int> ParseSources(const Line& line, int reference) {
    const std::vector<std::string> names = SplitNames(line.text);
    if (!names.empty() && names[0] == "__auto__") {
      return SelectSources(line, names, reference);
    }
    const std::vector<int> named = names.size() == 1 && names[0] == "__all__"
                                       ? AllBut(reference)
                                       : FindSources(line, names, reference);
    return selector_.SelectIndependent(reference, named);
  }

  std::vector<int> AllBut(int reference) const {
    std::vector<int> images(model_.images.size());
    std::iota(images.begin(), images.end(), 0);
    images.erase(images.begin() + reference);
    return images;
  }

  std::vector<int> FindSources(const Line& line,
                               const std::vector<std::string>& names,
                               int reference) const {
    std::vector<int> sources;
    std::unordered_set<int> seen = {reference};
    if (names.empty()) {
      throw Corrupt(line, "lists no source image");
    }
    for (const std::string& name : names) {
      if (model_.without_pose.contains(name)) {
        continue;
      }
      sources.push_back(FindImage(line, name));
      if (!seen.insert(sources.back()).second) {
        throw Corrupt(
            line,
            "lists " + name + ", which is the reference or already listed");
      }
    }
    return sources;
  }

  std::vector<int> SelectSources(const Line& line,
                                 const std::vector<std::string>& names,
                                 int reference) {
    const int count =
        names.size() == 2 ? ParseNumber<int>(names[1]).value_or(0) : 0;
    if (count < 1) {
      throw Corrupt(line,
                    "must have the form \"__auto__, N\" with a number N > 0");
    }
    return selector_.SelectSources(reference, count);
  }

  int FindImage(const Line& line, const std::string& name) const {
    return IndexOf(name,
                   model_,
                   path_,
                   line.number,
                   "correct the name or make the workspace again");
  }

  Error Corrupt(const Line& line, const std::string& what) const {
    return Error::File(ErrorCode::kCorrupt,
                       path_.string(),
                       "line " + std::to_string(line.number) + " " + what,
                       "correct the line or make the workspace again");
  }

  const std::filesystem::path& path_;
  const SparseModel& model_;
  const SourceSelector selector_;
  std::unordered_set<int> references_;
};

}  // namespace

std::vector<ListedImage> ReadImageList(const std::filesystem::path& path,
                                       const SparseModel& model,
                                       const std::string& option) {
  std::vector<ListedImage> images;
  for (const auto& [number, name] :
       ReadLines(path, "list of images", "check " + option)) {
    if (name.size() > kMaxNameLength || HasControlCharacter(name)) {
      throw Error::File(ErrorCode::kCorrupt,
                        path.string(),
                        "line " + std::to_string(number) + " is no image name",
                        "give a text file with one image name per line");
    }
    if (!model.without_pose.contains(name)) {
      images.push_back(
          {IndexOf(name, model, path, number, "correct the line"), number});
    }
  }
  if (images.empty()) {
    throw Error::File(ErrorCode::kMismatch,
                      path.string(),
                      "the list names no image",
                      "write one image name per line");
  }
  return images;
}

std::vector<StereoProblem> ReadPatchMatchConfig(
    const std::filesystem::path& path,
    const SparseModel& model,
    double min_triangulation_angle_degrees) {
  return ConfigParser(path, model, min_triangulation_angle_degrees).Parse();
}

}  // namespace tsar
