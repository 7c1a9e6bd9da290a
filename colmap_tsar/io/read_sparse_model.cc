// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/parse_number.h"
#include "colmap_tsar/base/printable.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/io/sparse_model.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <unordered_set>
#include <utility>

#include <Eigen/Geometry>

namespace tsar {
namespace {

static_assert(std::endian::native == std::endian::little,
              "the files are little-endian and read as they are");

using Path = std::filesystem::path;

Error CorruptModel(const Path& path, const std::string& what) {
  return Error::File(ErrorCode::kCorrupt,
                     path.string(),
                     what,
                     "copy or make the sparse model again");
}

// A file of the model; its readers have the same functions for both formats.
class ModelFile {
 protected:
  explicit ModelFile(const Path& path) : path_(path), file_(path) {
    file_.RequireOpened("file", "copy the sparse model again");
  }

  Path path_;
  InputFile file_;
};

// Reads values in sequence and checks every count against the bytes left.
class BinaryReader : ModelFile {
 public:
  // min_bytes: of a record.
  BinaryReader(const Path& path, uint64_t min_bytes)
      : ModelFile(path), num_left_(file_.Size()) {
    num_records_ = ReadCount(min_bytes);
  }

  bool NextRecord() { return num_records_ > 0 && num_records_-- > 0; }
  void EndRecord() const {}

  template <typename T>
  T Read() {
    T value;
    ReadInto(&value, 1);
    return value;
  }

  // The name of a camera model; for those with distortion the number will do.
  std::string ReadModelName() {
    constexpr int kEquirectangular = 17;
    const auto id = Read<int32_t>();
    return id == 0                  ? "SIMPLE_PINHOLE"
           : id == 1                ? "PINHOLE"
           : id == kEquirectangular ? "EQUIRECTANGULAR"
                                    : "with number " + std::to_string(id);
  }

  std::string ReadImageName() {
    std::string name;
    for (char c = Read<char>(); c != '\0'; c = Read<char>()) {
      name.push_back(c);
    }
    return name;
  }

  // Seeks, which drops the stream's read-ahead.
  void SkipKeypoints() {
    // x, y and the point's id, which the tracks have too.
    constexpr uint64_t kKeypointBytes = 24;
    const uint64_t num_bytes = kKeypointBytes * ReadCount(kKeypointBytes);
    Take(num_bytes);
    file_.seekg(static_cast<std::streamoff>(num_bytes), std::ios::cur);
  }

  void SkipColorAndError() {
    struct ColorAndError {
      char bytes[3 + sizeof(double)];
    };
    Read<ColorAndError>();
  }

  void ReadTrack(std::vector<uint32_t>* image_ids) {
    struct Element {
      uint32_t image_id;
      uint32_t keypoint;
    };
    track_.resize(2 * ReadCount(sizeof(Element)));
    ReadInto(track_.data(), track_.size());
    for (size_t i = 0; i < track_.size(); i += 2) {
      image_ids->push_back(track_[i]);
    }
  }

 private:
  template <typename T>
  void ReadInto(T* values, uint64_t count) {
    Take(count * sizeof(T));
    file_.read(reinterpret_cast<char*>(values),
               static_cast<std::streamsize>(count * sizeof(T)));
    if (!file_) {
      throw Truncated();
    }
  }

  // Reads a number of items, each of at least min_bytes.
  uint64_t ReadCount(uint64_t min_bytes) {
    const auto count = Read<uint64_t>();
    if (count > num_left_ / min_bytes) {
      throw Truncated();
    }
    return count;
  }

  void Take(uint64_t num_bytes) {
    if (num_bytes > num_left_) {
      throw Truncated();
    }
    num_left_ -= num_bytes;
  }

  Error Truncated() const {
    return CorruptModel(path_, "the file is shorter than its content says");
  }

  uint64_t num_left_;
  uint64_t num_records_ = 0;
  std::vector<uint32_t> track_;
};

// The lines of a text file, and the words of the current line.
class TextReader : ModelFile {
 public:
  TextReader(const Path& path, uint64_t /*min_bytes*/) : ModelFile(path) {}

  // Moves to the next line that is neither blank nor a comment.
  bool NextRecord() {
    while (NextLine()) {
      if (!AtEnd()) {
        return true;
      }
    }
    return false;
  }

  // Throws if the record has more than was read.
  void EndRecord() {
    if (!AtEnd()) {
      throw Corrupt("has \"" + std::string(ReadWord()) + "\" behind its end");
    }
  }

  template <typename T>
  T Read() {
    const std::string_view word = ReadWord();
    // As COLMAP, with a sign.
    const std::optional<T> number =
        ParseNumber<T>(word.substr(word.starts_with('+') ? 1 : 0));
    if (!number) {
      throw Corrupt("has \"" + std::string(word) +
                    "\" in the place of a number");
    }
    return *number;
  }

  std::string ReadModelName() { return std::string(ReadWord()); }

  // The rest of the line, without blanks and a comment behind it.
  std::string ReadImageName() {
    if (AtEndOfLine()) {
      return "";
    }
    std::string name =
        line_.substr(position_, line_.find(" #", position_) - position_);
    while (IsBlank(name.back())) {
      name.pop_back();
    }
    return name;
  }

  // They have a line of their own, which may be blank.
  void SkipKeypoints() {
    while (NextLine() && !AtEndOfLine() && AtEnd()) {
    }
    for (int i = 0; !AtEnd(); ++i) {
      constexpr int kNumWords = 3;
      const bool is_number = ParseNumber<double>(ReadWord()).has_value();
      if (!is_number || (AtEnd() && i % kNumWords != kNumWords - 1)) {
        throw Corrupt(
            "is not the line of points of the image before it, of which each "
            "has x, y and an id; it may be empty");
      }
    }
  }

  void SkipColorAndError() {
    for (int i = 0; i < 4; ++i) {
      Read<double>();
    }
  }

  void ReadTrack(std::vector<uint32_t>* image_ids) {
    while (!AtEnd()) {
      image_ids->push_back(Read<uint32_t>());
      Read<uint32_t>();  // The keypoint's index.
    }
  }

 private:
  static bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

  // Valid until the next line.
  std::string_view ReadWord() {
    if (AtEndOfLine()) {
      throw Corrupt("ends too early");
    }
    const size_t begin = position_;
    while (position_ < line_.size() && !IsBlank(line_[position_])) {
      ++position_;
    }
    return std::string_view(line_).substr(begin, position_ - begin);
  }

  bool NextLine() {
    position_ = 0;
    line_.clear();
    return ReadLine(file_, line_number_++ == 0, &line_);
  }

  // Also before a comment.
  bool AtEnd() { return AtEndOfLine() || line_[position_] == '#'; }

  bool AtEndOfLine() {
    while (position_ < line_.size() && IsBlank(line_[position_])) {
      ++position_;
    }
    return position_ == line_.size();
  }

  Error Corrupt(const std::string& what) const {
    return CorruptModel(path_,
                        "line " + std::to_string(line_number_) + " " + what);
  }

  std::string line_;
  size_t position_ = 0;
  int line_number_ = 0;
};

// Throws Error kUnsupported for a camera model that this program cannot use.
void RequirePinhole(const Path& path, const std::string& model) {
  if (model == "PINHOLE" || model == "SIMPLE_PINHOLE") {
    return;
  }
  // image_undistorter does not undistort panoramas.
  const bool is_panorama = model == "EQUIRECTANGULAR";
  throw Error::File(ErrorCode::kUnsupported,
                    path.string(),
                    (is_panorama ? "a camera sees all directions (model "
                                 : "a camera has lens distortion (model ") +
                        model + ")",
                    is_panorama
                        ? "render perspective images from the panoramas and "
                          "reconstruct with those"
                        : "undistort first with image_undistorter");
}

void RequireValidCamera(const Path& path,
                        const std::string& name,
                        uint64_t width,
                        uint64_t height,
                        const Camera& camera) {
  constexpr uint64_t kMaxSize = uint64_t{1} << 24;
  // The least focal length relative to the size, that of a field of view of 179
  // degrees.
  constexpr double kMinFocalLength = 0.01;
  if (width < 1 || height < 1 || width > kMaxSize || height > kMaxSize) {
    throw CorruptModel(path, name + " has an impossible image size");
  }
  const double least =
      kMinFocalLength * static_cast<double>(std::max(width, height));
  if (!(camera.fx >= least && camera.fy >= least && std::isfinite(camera.fx) &&
        std::isfinite(camera.fy))) {
    throw CorruptModel(
        path,
        name +
            " has a focal length below a hundredth of the image's longer side");
  }
  if (!std::isfinite(camera.cx) || !std::isfinite(camera.cy)) {
    throw CorruptModel(path,
                       name + " has a principal point that is not a number");
  }
}

using Cameras = std::unordered_map<uint32_t, Camera>;

template <typename Reader>
Cameras ReadCameras(const Path& path) {
  // The bytes of a camera without parameters, whose number depends on the
  // model.
  Reader reader(path, 24);
  Cameras cameras;
  while (reader.NextRecord()) {
    const auto id = reader.template Read<uint32_t>();
    const std::string name = "camera " + std::to_string(id);
    const std::string model = reader.ReadModelName();
    const auto width = reader.template Read<uint64_t>();
    const auto height = reader.template Read<uint64_t>();
    RequirePinhole(path, model);
    Camera camera;
    camera.fx = reader.template Read<double>();
    camera.fy = model == "PINHOLE" ? reader.template Read<double>() : camera.fx;
    camera.cx = reader.template Read<double>();
    camera.cy = reader.template Read<double>();
    reader.EndRecord();
    RequireValidCamera(path, name, width, height, camera);
    camera.width = static_cast<int>(width);
    camera.height = static_cast<int>(height);
    if (!cameras.emplace(id, camera).second) {
      throw CorruptModel(path, name + " is there more than once");
    }
  }
  return cameras;
}

// An image or a point with its id in the files.
template <typename T>
struct WithId {
  uint64_t id = 0;
  T item;
};

template <typename T>
void SortById(const Path& path, const char* kind, std::vector<WithId<T>>* all) {
  std::ranges::sort(*all, {}, &WithId<T>::id);
  const auto twice = std::ranges::adjacent_find(*all, {}, &WithId<T>::id);
  if (twice != all->end()) {
    throw CorruptModel(path,
                       std::string(kind) + " " + std::to_string(twice->id) +
                           " is there more than once");
  }
}

// Names what is left out, if anything, by the first.
void WarnOfLeftOut(const Path& path,
                   const std::string& what,
                   const std::string& first,
                   size_t count) {
  if (count > 0) {
    Warn(path.string() + ": the " + what + " " + AndMore(first, count) +
         " is not valid; left out");
  }
}

using Images = std::vector<WithId<SparseModel::ModelImage>>;

// without_pose: gets the ids and names of the images that are left out.
template <typename Reader>
Images ReadImages(const Path& path,
                  const Cameras& cameras,
                  std::map<uint64_t, std::string>* without_pose) {
  Reader reader(path, 73);
  Images images;
  for (int index_in_file = 0; reader.NextRecord(); ++index_in_file) {
    SparseModel::ModelImage image;
    const auto id = reader.template Read<uint32_t>();
    Eigen::Quaterniond rotation;
    for (double* value :
         {&rotation.w(), &rotation.x(), &rotation.y(), &rotation.z()}) {
      *value = reader.template Read<double>();
    }
    Eigen::Vector3d translation;
    for (double& value : translation) {
      value = reader.template Read<double>();
    }
    const auto camera_id = reader.template Read<uint32_t>();
    image.name = reader.ReadImageName();
    reader.SkipKeypoints();

    const std::string text = "image " + std::to_string(id);
    if (image.name.empty() || HasControlCharacter(image.name)) {
      throw CorruptModel(path, text + " has no usable name");
    }
    const auto camera = cameras.find(camera_id);
    if (camera == cameras.end()) {
      throw CorruptModel(path,
                         text + " has camera " + std::to_string(camera_id) +
                             ", which does not exist");
    }
    const double norm = rotation.norm();
    if (!(norm > 0.0) || !std::isfinite(norm) || !translation.allFinite()) {
      without_pose->emplace(id, image.name);
      continue;
    }
    image.camera = camera->second;
    image.camera.rotation = rotation.normalized().toRotationMatrix();
    image.camera.translation = translation;
    image.index_in_file = index_in_file;
    images.push_back({id, std::move(image)});
  }
  if (!without_pose->empty()) {
    const auto& [id, name] = *without_pose->begin();
    WarnOfLeftOut(path,
                  "pose of image",
                  std::to_string(id) + " (" + name + ")",
                  without_pose->size());
  }
  if (images.empty() && !without_pose->empty()) {
    throw CorruptModel(path, "no image has a valid pose");
  }
  SortById(path, "image", &images);
  // "./a.png" and "a.png" are different names of the same maps.
  std::unordered_set<std::string> names;
  for (const auto& [id, image] : images) {
    if (!names.insert(Path(image.name).lexically_normal().string()).second) {
      throw CorruptModel(path,
                         "the name " + image.name +
                             " stands for the same file as another one");
    }
  }
  return images;
}

// Also adds the points to the images that see them.
template <typename Reader>
std::vector<Eigen::Vector3d> ReadPoints(
    const Path& path,
    const std::map<uint64_t, std::string>& without_pose,
    Images* images) {
  struct Point {
    Eigen::Vector3d position;
    // The range [track_begin, track_end) in image_ids.
    size_t track_begin;
    size_t track_end;
  };
  std::vector<WithId<Point>> points;
  std::vector<uint32_t> image_ids;
  Reader reader(path, 51);
  while (reader.NextRecord()) {
    WithId<Point>& point = points.emplace_back();
    point.id = reader.template Read<uint64_t>();
    for (double& value : point.item.position) {
      value = reader.template Read<double>();
    }
    reader.SkipColorAndError();
    point.item.track_begin = image_ids.size();
    reader.ReadTrack(&image_ids);
    point.item.track_end = image_ids.size();
  }
  SortById(path, "point", &points);
  std::unordered_map<uint64_t, SparseModel::ModelImage*> image_of_id;
  for (auto& [id, image] : *images) {
    image_of_id.emplace(id, &image);
  }
  std::vector<Eigen::Vector3d> positions;
  size_t num_left_out = 0;
  uint64_t first_left_out = 0;
  positions.reserve(points.size());
  for (const auto& [id, point] : points) {
    if (!point.position.allFinite()) {
      first_left_out = num_left_out++ == 0 ? id : first_left_out;
      continue;
    }
    for (size_t i = point.track_begin; i < point.track_end; ++i) {
      if (without_pose.contains(image_ids[i])) {
        continue;
      }
      const auto image = image_of_id.find(image_ids[i]);
      if (image == image_of_id.end()) {
        throw CorruptModel(
            path,
            "point " + std::to_string(id) + " is seen by image " +
                std::to_string(image_ids[i]) + ", which does not exist");
      }
      image->second->point_indices.push_back(
          static_cast<int>(positions.size()));
    }
    positions.push_back(point.position);
  }
  WarnOfLeftOut(
      path, "position of point", std::to_string(first_left_out), num_left_out);
  return positions;
}

template <typename Reader>
SparseModel ReadFiles(const std::array<Path, 3>& paths) {
  const Cameras cameras = ReadCameras<Reader>(paths[0]);
  std::map<uint64_t, std::string> without_pose;
  Images images = ReadImages<Reader>(paths[1], cameras, &without_pose);
  SparseModel model;
  model.points = ReadPoints<Reader>(paths[2], without_pose, &images);
  for (auto& [id, name] : without_pose) {
    model.without_pose.insert(std::move(name));
  }
  for (auto& [id, image] : images) {
    model.images.push_back(std::move(image));
  }
  model.IndexNames();
  return model;
}

}  // namespace

SparseModel ReadSparseModel(const Path& sparse_folder) {
  const std::array<Path, 3> paths = FindSparseModelFiles(sparse_folder);
  return paths[0].extension() == ".bin" ? ReadFiles<BinaryReader>(paths)
                                        : ReadFiles<TextReader>(paths);
}

}  // namespace tsar
