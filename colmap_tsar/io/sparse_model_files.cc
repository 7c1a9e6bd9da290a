// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/sparse_model_files.h"

#include "colmap_tsar/base/input_file.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <iterator>
#include <string_view>
#include <system_error>
#include <utility>

namespace tsar {
namespace {

static_assert(std::endian::native == std::endian::little,
              "the files are little-endian and read as they are");

// Throws Error kIo if the file at the path could not be opened.
void RequireOpened(const std::filesystem::path& path, const InputFile& file) {
  if (!file) {
    throw Error::File(ErrorCode::kIo,
                      path.string(),
                      "cannot be read (" + file.Reason() + ")",
                      "check that it is a file and that you may read it");
  }
}

// Reads values in sequence and checks every count against the bytes left.
class BinaryReader {
 public:
  explicit BinaryReader(const std::filesystem::path& path)
      : path_(path), file_(path), num_left_(file_.Size()) {
    RequireOpened(path_, file_);
  }

  template <typename T>
  T Read() {
    T value;
    ReadInto(&value, 1);
    return value;
  }

  template <typename T>
  void ReadInto(T* values, uint64_t count) {
    Take(count * sizeof(T));
    file_.read(reinterpret_cast<char*>(values),
               static_cast<std::streamsize>(count * sizeof(T)));
    if (!file_) {
      throw Truncated();
    }
  }

  std::string ReadName() {
    std::string name;
    for (char c = Read<char>(); c != '\0'; c = Read<char>()) {
      name.push_back(c);
    }
    return name;
  }

  // Reads a number of records, each of at least min_bytes.
  uint64_t ReadCount(uint64_t min_bytes) {
    const uint64_t count = Read<uint64_t>();
    if (count > num_left_ / min_bytes) {
      throw Truncated();
    }
    return count;
  }

  // Seeks, for long ranges; seeking drops the stream's read-ahead.
  void Skip(uint64_t num_bytes) {
    Take(num_bytes);
    file_.seekg(static_cast<std::streamoff>(num_bytes), std::ios::cur);
  }

 private:
  void Take(uint64_t num_bytes) {
    if (num_bytes > num_left_) {
      throw Truncated();
    }
    num_left_ -= num_bytes;
  }

  Error Truncated() const {
    return CorruptModel(path_, "the file is shorter than its content says");
  }

  std::filesystem::path path_;
  InputFile file_;
  uint64_t num_left_ = 0;
};

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
    return CorruptModel(path_,
                        "line " + std::to_string(line_number_) + " " + what);
  }

  std::filesystem::path path_;
  InputFile file_;
  std::string line_;
  size_t position_ = 0;
  int line_number_ = 0;
};

// The number of parameters of a camera model that this program can use; throws
// Error kUnsupported for the others.
int NumCameraParams(const std::filesystem::path& path,
                    const std::string& model) {
  if (model == "PINHOLE") {
    return 4;
  }
  if (model == "SIMPLE_PINHOLE") {
    return 3;
  }
  // image_undistorter does not undistort these.
  if (model == "EQUIRECTANGULAR") {
    throw Error::File(ErrorCode::kUnsupported,
                      path.string(),
                      "a camera sees all directions (model " + model + ")",
                      "render perspective images from the panoramas and "
                      "reconstruct with those");
  }
  throw Error::File(ErrorCode::kUnsupported,
                    path.string(),
                    "a camera has lens distortion (model " + model + ")",
                    "undistort first with image_undistorter");
}

// The fields that both formats have in the same order. Reader: has Read<T>(),
// which returns the next field.

template <typename Reader>
void ReadCamera(uint32_t id,
                std::string model,
                Reader* reader,
                SparseModelFiles* files) {
  SparseModelFiles::FileCamera camera;
  camera.model = std::move(model);
  camera.width = reader->template Read<uint64_t>();
  camera.height = reader->template Read<uint64_t>();
  camera.params.resize(
      static_cast<size_t>(NumCameraParams(files->cameras_path, camera.model)));
  for (double& param : camera.params) {
    param = reader->template Read<double>();
  }
  if (!files->cameras.emplace(id, std::move(camera)).second) {
    throw CorruptModel(
        files->cameras_path,
        "camera " + std::to_string(id) + " is there more than once");
  }
}

// Reads all fields of an image except its name.
template <typename Reader>
void ReadPose(Reader* reader, SparseModelFiles::FileImage* image) {
  image->id = reader->template Read<uint32_t>();
  for (double& value : image->quaternion) {
    value = reader->template Read<double>();
  }
  for (double& value : image->translation) {
    value = reader->template Read<double>();
  }
  image->camera_id = reader->template Read<uint32_t>();
}

// Reads the fields of a point except its color, error and track.
template <typename Reader>
void ReadPosition(Reader* reader, SparseModelFiles::FilePoint* point) {
  point->id = reader->template Read<uint64_t>();
  for (int i = 0; i < 3; ++i) {
    point->position(i) = reader->template Read<double>();
  }
}

// The name of COLMAP's camera model of this id, for messages.
std::string CameraModelName(int id) {
  static const char* const kNames[] = {"SIMPLE_PINHOLE",
                                       "PINHOLE",
                                       "SIMPLE_RADIAL",
                                       "RADIAL",
                                       "OPENCV",
                                       "OPENCV_FISHEYE",
                                       "FULL_OPENCV",
                                       "FOV",
                                       "SIMPLE_RADIAL_FISHEYE",
                                       "RADIAL_FISHEYE",
                                       "THIN_PRISM_FISHEYE",
                                       "RAD_TAN_THIN_PRISM_FISHEYE",
                                       "SIMPLE_DIVISION",
                                       "DIVISION",
                                       "SIMPLE_FISHEYE",
                                       "FISHEYE",
                                       "EUCM",
                                       "EQUIRECTANGULAR"};
  return id >= 0 && id < static_cast<int>(std::size(kNames))
             ? kNames[id]
             : "with number " + std::to_string(id);
}

void ReadCameras(BinaryReader reader, SparseModelFiles* files) {
  // The bytes of a camera without parameters, whose number depends on the
  // model.
  const uint64_t count = reader.ReadCount(24);
  for (uint64_t i = 0; i < count; ++i) {
    const uint32_t id = reader.Read<uint32_t>();
    ReadCamera(id, CameraModelName(reader.Read<int32_t>()), &reader, files);
  }
}

void ReadImages(BinaryReader reader, SparseModelFiles* files) {
  const uint64_t count = reader.ReadCount(73);
  files->images.resize(count);
  for (SparseModelFiles::FileImage& image : files->images) {
    ReadPose(&reader, &image);
    image.name = reader.ReadName();
    // Keypoints: x, y and the point's id, which the tracks have too.
    constexpr uint64_t kKeypointBytes = 24;
    reader.Skip(kKeypointBytes * reader.ReadCount(kKeypointBytes));
  }
}

void ReadPoints(BinaryReader reader, SparseModelFiles* files) {
  struct TrackElement {
    uint32_t image_id;
    uint32_t keypoint;
  };
  struct ColorAndError {
    char bytes[3 + sizeof(double)];
  };
  const uint64_t count = reader.ReadCount(51);
  files->points.resize(count);
  std::vector<TrackElement> track;
  for (SparseModelFiles::FilePoint& point : files->points) {
    ReadPosition(&reader, &point);
    reader.Read<ColorAndError>();
    point.track_begin = files->track_image_ids.size();
    track.resize(reader.ReadCount(sizeof(TrackElement)));
    reader.ReadInto(track.data(), track.size());
    for (const TrackElement& element : track) {
      files->track_image_ids.push_back(element.image_id);
    }
    point.track_end = files->track_image_ids.size();
  }
}

void ReadCameras(TextReader reader, SparseModelFiles* files) {
  while (reader.NextRecord()) {
    const auto id = reader.Read<uint32_t>();
    ReadCamera(id, std::string(reader.Word()), &reader, files);
  }
}

void ReadImages(TextReader reader, SparseModelFiles* files) {
  while (reader.NextRecord()) {
    SparseModelFiles::FileImage image;
    ReadPose(&reader, &image);
    image.name = reader.Rest();
    files->images.push_back(std::move(image));
    // The keypoints have a separate line, which may be blank.
    reader.NextLine();
  }
}

void ReadPoints(TextReader reader, SparseModelFiles* files) {
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

template <typename Reader>
void ReadFiles(SparseModelFiles* files) {
  ReadCameras(Reader(files->cameras_path), files);
  ReadImages(Reader(files->images_path), files);
  ReadPoints(Reader(files->points_path), files);
}

}  // namespace

Error CorruptModel(const std::filesystem::path& path, const std::string& what) {
  return Error::File(ErrorCode::kCorrupt,
                     path.string(),
                     what,
                     "copy or make the sparse model again");
}

SparseModelFiles ReadSparseModelFiles(
    const std::array<std::filesystem::path, 3>& paths) {
  SparseModelFiles files;
  files.cameras_path = paths[0];
  files.images_path = paths[1];
  files.points_path = paths[2];
  if (paths[0].extension() == ".bin") {
    ReadFiles<BinaryReader>(&files);
  } else {
    ReadFiles<TextReader>(&files);
  }
  return files;
}

}  // namespace tsar
