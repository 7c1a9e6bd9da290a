// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/io/sparse_model_files.h"

#include <bit>
#include <iterator>
#include <system_error>
#include <vector>

namespace tsar {
namespace {

static_assert(std::endian::native == std::endian::little,
              "the files are little-endian and read as they are");

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
    return Error::File(ErrorCode::kCorrupt,
                       path_.string(),
                       "the file is shorter than its content says",
                       "copy or make the sparse model again");
  }

  std::filesystem::path path_;
  InputFile file_;
  uint64_t num_left_ = 0;
};

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

void ReadCameras(SparseModelFiles* files) {
  BinaryReader reader(files->cameras_path);
  // The bytes of a camera without parameters, whose number depends on the
  // model.
  const uint64_t count = reader.ReadCount(24);
  for (uint64_t i = 0; i < count; ++i) {
    const uint32_t id = reader.Read<uint32_t>();
    ReadCamera(id, CameraModelName(reader.Read<int32_t>()), &reader, files);
  }
}

void ReadImages(SparseModelFiles* files) {
  BinaryReader reader(files->images_path);
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

void ReadPoints(SparseModelFiles* files) {
  struct TrackElement {
    uint32_t image_id;
    uint32_t keypoint;
  };
  struct ColorAndError {
    char bytes[3 + sizeof(double)];
  };
  BinaryReader reader(files->points_path);
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

}  // namespace

void ReadSparseModelBinary(SparseModelFiles* files) {
  ReadCameras(files);
  ReadImages(files);
  ReadPoints(files);
}

}  // namespace tsar
