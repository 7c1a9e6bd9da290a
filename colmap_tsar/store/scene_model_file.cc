// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/store/scene_model_file.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/store/scene_model_check.h"
#include "colmap_tsar/store/scene_model_layout.h"
#include "colmap_tsar/workspace/map_paths.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

namespace tsar {
namespace {

static_assert(std::endian::native == std::endian::little);
static_assert(sizeof(int) == 4 && sizeof(double) == 8);

constexpr std::array<char, 8> kMagic = {'T', 'S', 'A', 'R', 'P', 'L', 'A', 'N'};
// To be raised with every change of what the bytes mean, fingerprints included.
constexpr uint32_t kFormatVersion = 2;

struct Header {
  std::array<char, 8> magic = kMagic;
  uint32_t version = kFormatVersion;
  uint32_t options_hash_length = 0;
  uint64_t num_planes = 0;
  uint64_t num_frames = 0;
  uint64_t num_views = 0;
  uint64_t num_labels = 0;  // Of all views together.
  uint64_t planes_fingerprint = 0;
  uint64_t labels_fingerprint = 0;
  // Of the header up to here and the options hash.
  uint64_t header_fingerprint = 0;
};
static_assert(sizeof(Header) == 72 && std::is_trivially_copyable_v<Header>);

template <typename Arrays>
uint64_t Fingerprint(Arrays& arrays) {
  ContentHash hash;
  arrays.ForEach([&](const auto& array) {
    if (!array.empty()) {
      hash.Update(array.data(), array.size() * sizeof(array[0]));
    }
  });
  return hash.Value();
}

uint64_t HeaderFingerprint(const Header& header,
                           const std::string& options_hash) {
  ContentHash hash;
  hash.Update(&header, offsetof(Header, header_fingerprint));
  hash.Update(options_hash.data(), options_hash.size());
  return hash.Value();
}

Error CorruptModel(const std::filesystem::path& path, const std::string& what) {
  return Error::File(ErrorCode::kCorrupt,
                     path.string(),
                     "not a usable file of planes: " + what,
                     "delete it and run tsar_refine again");
}

// An open file whose header is intact and agrees with the file's length.
class SceneModelReader {
 public:
  explicit SceneModelReader(const std::filesystem::path& path)
      : path_(path), file_(path) {
    if (file_.IsMissing()) {
      throw Error::File(ErrorCode::kNotFound,
                        path.string(),
                        "there are no planes of the scene",
                        "run tsar_refine on this workspace first");
    }
    if (file_.IsNoFile()) {
      throw CorruptModel(path, file_.Reason());
    }
    if (!file_) {
      throw Error::File(ErrorCode::kIo,
                        path.string(),
                        "the file cannot be opened (" + file_.Reason() + ")",
                        "check that you may read it");
    }
    ReadHeader();
  }

  const Header& GetHeader() const { return header_; }
  const std::string& OptionsHash() const { return options_hash_; }

  // The next arrays of the file, which have their sizes already.
  template <typename Arrays>
  void Read(uint64_t fingerprint, Arrays* arrays) {
    arrays->ForEach([&](auto& array) {
      ReadBytes(array.data(), array.size() * sizeof(array[0]));
    });
    if (Fingerprint(*arrays) != fingerprint) {
      throw CorruptModel(path_, "its content was changed");
    }
  }

 private:
  void ReadHeader() {
    // What comes first stays the same in all versions of the format.
    constexpr size_t kNumFixed =
        offsetof(Header, version) + sizeof(header_.version);
    if (file_.Size() < kNumFixed) {
      throw CorruptModel(path_, "it is not complete");
    }
    ReadBytes(&header_, kNumFixed);
    if (header_.magic != kMagic) {
      throw CorruptModel(path_, "it is another kind of file");
    }
    if (header_.version != kFormatVersion) {
      throw CorruptModel(
          path_,
          "its format is of version " + std::to_string(header_.version) +
              ", this program reads version " + std::to_string(kFormatVersion));
    }
    if (file_.Size() < sizeof(Header)) {
      throw CorruptModel(path_, "it is not complete");
    }
    ReadBytes(reinterpret_cast<char*>(&header_) + kNumFixed,
              sizeof(Header) - kNumFixed);
    if (header_.options_hash_length > file_.Size() - sizeof(Header)) {
      throw CorruptModel(path_, "its header was changed, or it was cut off");
    }
    options_hash_.resize(header_.options_hash_length);
    ReadBytes(options_hash_.data(), options_hash_.size());
    if (HeaderFingerprint(header_, options_hash_) !=
        header_.header_fingerprint) {
      throw CorruptModel(path_, "its header was changed");
    }
    if (!SizesFit()) {
      throw CorruptModel(path_,
                         "its " + std::to_string(file_.Size()) +
                             " bytes are not what the header says");
    }
  }

  // Takes the arrays off the file's length one by one, by division: products of
  // hostile numbers overflow.
  bool SizesFit() const {
    uint64_t rest = file_.Size() - sizeof(Header) - options_hash_.size();
    const auto take = [&rest](uint64_t count, size_t element_size) {
      if (count > rest / element_size) {
        return false;
      }
      rest -= count * element_size;
      return true;
    };
    return take(header_.num_planes, sizeof(StoredPlane)) &&
           take(header_.num_frames, sizeof(StoredFrame)) &&
           take(header_.num_views, sizeof(StoredView)) &&
           take(header_.num_labels, sizeof(int32_t)) &&
           take(header_.num_labels, sizeof(LabelEvidence)) &&
           take(header_.num_labels, sizeof(LabelQuality)) && rest == 0;
  }

  void ReadBytes(void* target, size_t num_bytes) {
    file_.read(static_cast<char*>(target),
               static_cast<std::streamsize>(num_bytes));
    if (!file_) {
      throw CorruptModel(path_, "reading it failed");
    }
  }

  std::filesystem::path path_;
  InputFile file_;
  Header header_;
  std::string options_hash_;
};

}  // namespace

ContainedPath GetSceneModelPath(const std::filesystem::path& root) {
  return GetTsarFolder(root) / "planes.bin";
}

void WriteSceneModel(const ContainedPath& path,
                     const std::string& options_hash,
                     const SceneModel& model,
                     SceneModelParts parts) {
  if (const auto fault = FindSceneModelFault(model)) {
    throw Error::File(ErrorCode::kMismatch,
                      path.string(),
                      "what is to be written has " + *fault,
                      "this is a mistake of the program, please report it");
  }
  PlaneArrays planes = ToPlaneArrays(model);
  LabelArrays labels =
      parts == SceneModelParts::kAll ? ToLabelArrays(model) : LabelArrays();
  Header header;
  header.options_hash_length = static_cast<uint32_t>(options_hash.size());
  header.num_planes = planes.planes.size();
  header.num_frames = planes.frames.size();
  header.num_views = labels.views.size();
  header.num_labels = labels.planes.size();
  header.planes_fingerprint = Fingerprint(planes);
  header.labels_fingerprint = Fingerprint(labels);
  header.header_fingerprint = HeaderFingerprint(header, options_hash);

  CreateFolders(path.Parent());
  AtomicFile file(path);
  const auto put = [&file](const void* data, size_t num_bytes) {
    file.Stream().write(static_cast<const char*>(data),
                        static_cast<std::streamsize>(num_bytes));
  };
  const auto put_array = [&](const auto& array) {
    put(array.data(), array.size() * sizeof(array[0]));
  };
  put(&header, sizeof(header));
  put(options_hash.data(), options_hash.size());
  planes.ForEach(put_array);
  labels.ForEach(put_array);
  file.Commit();
}

SceneModel ReadSceneModel(const std::filesystem::path& path,
                          SceneModelParts parts) {
  SceneModelReader reader(path);
  const Header& header = reader.GetHeader();
  PlaneArrays planes;
  planes.planes.resize(header.num_planes);
  planes.frames.resize(header.num_frames);
  reader.Read(header.planes_fingerprint, &planes);
  SceneModel model = FromPlaneArrays(planes);
  if (parts == SceneModelParts::kAll) {
    LabelArrays labels;
    labels.views.resize(header.num_views);
    labels.planes.resize(header.num_labels);
    labels.evidence.resize(header.num_labels);
    labels.qualities.resize(header.num_labels);
    reader.Read(header.labels_fingerprint, &labels);
    auto views = FromLabelArrays(labels);
    if (!views) {
      throw CorruptModel(path, "it has labels that are not those of its views");
    }
    model.views = std::move(*views);
  }
  if (const auto fault = FindSceneModelFault(model)) {
    throw CorruptModel(path, "it has " + *fault);
  }
  return model;
}

std::optional<std::string> ReadSceneModelHash(
    const std::filesystem::path& path) {
  try {
    return SceneModelReader(path).OptionsHash();
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace tsar
