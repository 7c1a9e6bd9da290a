// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/io/sparse_model_files.h"

#include <charconv>
#include <string_view>

namespace tsar {
namespace {

constexpr std::string_view kBlank = " \t\r";

// The lines of a text file, and the words of the current line.
class TextReader {
 public:
  explicit TextReader(const std::filesystem::path& path)
      : path_(path), file_(path) {
    RequireOpened(path_, file_);
  }

  bool NextLine() {
    if (!std::getline(file_, line_)) {
      return false;
    }
    ++line_number_;
    position_ = 0;
    return true;
  }

  // Moves to the next line that is neither blank nor a comment.
  bool NextRecord() {
    while (NextLine()) {
      const size_t first = line_.find_first_not_of(kBlank);
      if (first != std::string::npos && line_[first] != '#') {
        return true;
      }
    }
    return false;
  }

  bool AtEndOfLine() {
    position_ =
        std::min(line_.find_first_not_of(kBlank, position_), line_.size());
    return position_ == line_.size();
  }

  std::string_view Word() {
    if (AtEndOfLine()) {
      throw Corrupt("ends too early");
    }
    const size_t end =
        std::min(line_.find_first_of(kBlank, position_), line_.size());
    const std::string_view word(line_.data() + position_, end - position_);
    position_ = end;
    return word;
  }

  template <typename T>
  T Read() {
    const std::string_view word = Word();
    T value{};
    const auto [end, error] =
        std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) {
      throw Corrupt("has \"" + std::string(word) +
                    "\" in the place of a number");
    }
    return value;
  }

  // The rest of the line, without blanks around it.
  std::string Rest() {
    AtEndOfLine();
    const size_t end = line_.find_last_not_of(kBlank) + 1;
    return end > position_ ? line_.substr(position_, end - position_)
                           : std::string();
  }

 private:
  Error Corrupt(const std::string& what) const {
    return Error::File(ErrorCode::kCorrupt,
                       path_.string(),
                       "line " + std::to_string(line_number_) + " " + what,
                       "copy or make the sparse model again");
  }

  std::filesystem::path path_;
  InputFile file_;
  std::string line_;
  size_t position_ = 0;
  int line_number_ = 0;
};

void ReadCameras(SparseModelFiles* files) {
  TextReader reader(files->cameras_path);
  while (reader.NextRecord()) {
    const auto id = reader.Read<uint32_t>();
    ReadCamera(id, std::string(reader.Word()), &reader, files);
  }
}

void ReadImages(SparseModelFiles* files) {
  TextReader reader(files->images_path);
  while (reader.NextRecord()) {
    SparseModelFiles::FileImage image;
    ReadPose(&reader, &image);
    image.name = reader.Rest();
    files->images.push_back(std::move(image));
    // The keypoints have a separate line, which may be blank.
    reader.NextLine();
  }
}

void ReadPoints(SparseModelFiles* files) {
  TextReader reader(files->points_path);
  while (reader.NextRecord()) {
    SparseModelFiles::FilePoint point;
    ReadPosition(&reader, &point);
    for (int i = 0; i < 4; ++i) {
      reader.Word();  // Color and error.
    }
    point.track_begin = files->track_image_ids.size();
    while (!reader.AtEndOfLine()) {
      files->track_image_ids.push_back(reader.Read<uint32_t>());
      reader.Read<uint32_t>();  // The keypoint's index.
    }
    point.track_end = files->track_image_ids.size();
    files->points.push_back(point);
  }
}

}  // namespace

void ReadSparseModelText(SparseModelFiles* files) {
  ReadCameras(files);
  ReadImages(files);
  ReadPoints(files);
}

}  // namespace tsar
