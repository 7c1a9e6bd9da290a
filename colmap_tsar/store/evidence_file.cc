// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/store/evidence_file.h"

#include "colmap_tsar/base/atomic_file.h"
#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/store/evidence_check.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <span>
#include <system_error>
#include <type_traits>
#include <utility>

namespace tsar {
namespace {

// All of it goes between memory and the file as it is. Where the size is the
// sum of the fields' sizes, there is no padding.
static_assert(std::endian::native == std::endian::little);
static_assert(sizeof(int) == 4 && sizeof(float) == 4);
static_assert(sizeof(Observation) == 16 &&
              std::is_trivially_copyable_v<Observation>);
static_assert(sizeof(RayDepth) == 12 && std::is_trivially_copyable_v<RayDepth>);
static_assert(sizeof(SuperpixelBorder) == 28 &&
              std::is_trivially_copyable_v<SuperpixelBorder>);
static_assert(sizeof(Plane) == 16 && std::is_trivially_copyable_v<Plane>);
static_assert(sizeof(Rgb) == 3 && std::is_trivially_copyable_v<Rgb>);
static_assert(sizeof(Intrinsics) == 16 &&
              std::is_trivially_copyable_v<Intrinsics>);

constexpr std::array<char, 8> kMagic = {'T', 'S', 'A', 'R', 'V', 'I', 'E', 'W'};
// To be raised with every change of what the bytes mean, fingerprints included.
constexpr uint32_t kFormatVersion = 6;

struct Header {
  std::array<char, 8> magic = kMagic;
  uint32_t version = kFormatVersion;
  uint32_t options_hash_length = 0;
  int32_t width = 0;
  int32_t height = 0;
  int32_t ratings_width = 0;
  int32_t ratings_height = 0;
  Intrinsics intrinsics;
  float error_per_depth = 0.f;
  float noise = 0.f;
  uint64_t num_superpixels = 0;
  uint64_t num_observations = 0;
  uint64_t num_confirmed = 0;
  uint64_t num_candidates = 0;
  uint64_t num_borders = 0;
  uint64_t neighbour_fingerprint = 0;
  uint64_t own_fingerprint = 0;
  // Of the header up to here and the options hash.
  uint64_t header_fingerprint = 0;
};
static_assert(sizeof(Header) == 120 && std::is_trivially_copyable_v<Header>);

uint64_t HeaderFingerprint(const Header& header,
                           const std::string& options_hash) {
  ContentHash hash;
  hash.Update(&header, offsetof(Header, header_fingerprint));
  hash.Update(options_hash.data(), options_hash.size());
  return hash.Value();
}

// A vector's or an image's elements; writable where the container is.
template <typename Container>
auto BytesOf(Container& container) {
  const std::span elements(container);
  using Element = typename decltype(elements)::element_type;
  if constexpr (std::is_const_v<Element>) {
    return std::as_bytes(elements);
  } else {
    return std::as_writable_bytes(elements);
  }
}

// The arrays in the order of the file, for writing and for reading.
template <typename Evidence>
auto NeighbourArrays(Evidence& evidence) {
  return std::array{BytesOf(evidence.superpixels),
                    BytesOf(evidence.confident_depth),
                    BytesOf(evidence.weights),
                    BytesOf(evidence.first_observation),
                    BytesOf(evidence.observations),
                    BytesOf(evidence.candidates)};
}
template <typename Evidence>
auto OwnArrays(Evidence& evidence) {
  return std::array{BytesOf(evidence.is_measured),
                    BytesOf(evidence.first_confirmed),
                    BytesOf(evidence.confirmed),
                    BytesOf(evidence.confirmed_pixels),
                    BytesOf(evidence.borders),
                    BytesOf(evidence.region_planes),
                    BytesOf(evidence.color),
                    BytesOf(evidence.ratings)};
}

Error CorruptEvidence(const std::filesystem::path& path,
                      const std::string& what) {
  return Error::File(
      ErrorCode::kCorrupt,
      path.string(),
      "not a usable evidence file: " + what,
      "delete the folder " + path.parent_path().string() + " and run again");
}

// An open file whose header is intact and agrees with the file's length.
class EvidenceReader {
 public:
  explicit EvidenceReader(const std::filesystem::path& path) : path_(path) {
    file_.Open(path);
    if (file_.IsMissing()) {
      throw Error::File(ErrorCode::kNotFound,
                        path.string(),
                        "no such file",
                        "run again without removing files meanwhile");
    }
    if (file_.IsNoFile()) {
      throw CorruptEvidence(path, file_.Reason());
    }
    num_bytes_ = file_.Size();
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

  // The next arrays of the file.
  template <size_t kCount>
  void Read(const std::array<std::span<std::byte>, kCount>& arrays,
            uint64_t fingerprint) {
    // Pieces that are still in the processor's cache when they are hashed.
    constexpr size_t kPiece = size_t{1} << 18;
    ContentHash hash;
    for (const std::span<std::byte> array : arrays) {
      for (size_t begin = 0; begin < array.size(); begin += kPiece) {
        const auto piece =
            array.subspan(begin, std::min(kPiece, array.size() - begin));
        ReadBytes(piece.data(), piece.size());
        hash.Update(piece.data(), piece.size());
      }
    }
    if (hash.Value() != fingerprint) {
      throw CorruptEvidence(path_, "its content was changed");
    }
  }

 private:
  void ReadHeader() {
    // What comes first stays the same in all versions of the format.
    constexpr size_t kNumFixed =
        offsetof(Header, version) + sizeof(header_.version);
    if (num_bytes_ < kNumFixed) {
      throw CorruptEvidence(path_, "it is not complete");
    }
    ReadBytes(&header_, kNumFixed);
    if (header_.magic != kMagic) {
      throw CorruptEvidence(path_, "it is another kind of file");
    }
    if (header_.version != kFormatVersion) {
      throw CorruptEvidence(
          path_,
          "its format is of version " + std::to_string(header_.version) +
              ", this program reads version " + std::to_string(kFormatVersion));
    }
    if (num_bytes_ < sizeof(Header)) {
      throw CorruptEvidence(path_, "it is not complete");
    }
    ReadBytes(reinterpret_cast<char*>(&header_) + kNumFixed,
              sizeof(Header) - kNumFixed);
    if (header_.options_hash_length > num_bytes_ - sizeof(Header)) {
      throw CorruptEvidence(path_, "its header was changed, or it was cut off");
    }
    options_hash_.resize(header_.options_hash_length);
    ReadBytes(options_hash_.data(), options_hash_.size());
    if (HeaderFingerprint(header_, options_hash_) !=
        header_.header_fingerprint) {
      throw CorruptEvidence(path_, "its header was changed");
    }
    if (!SizesFit()) {
      throw CorruptEvidence(path_,
                            "its " + std::to_string(num_bytes_) +
                                " bytes are not what the header says");
    }
  }

  // Takes the arrays off the file's length one by one, by division: products of
  // hostile numbers overflow.
  bool SizesFit() const {
    if (header_.width < 1 || header_.height < 1 || header_.ratings_width < 1 ||
        header_.ratings_height < 1) {
      return false;
    }
    uint64_t rest = num_bytes_ - sizeof(Header) - options_hash_.size();
    const auto take = [&rest](uint64_t count, size_t element_size) {
      if (count > rest / element_size) {
        return false;
      }
      rest -= count * element_size;
      return true;
    };
    const uint64_t num_pixels = static_cast<uint64_t>(header_.width) *
                                static_cast<uint64_t>(header_.height);
    const uint64_t num_ratings = static_cast<uint64_t>(header_.ratings_width) *
                                 static_cast<uint64_t>(header_.ratings_height);
    return take(num_pixels, sizeof(uint16_t)) &&
           take(num_pixels, sizeof(float)) &&
           take(header_.num_superpixels, sizeof(float)) &&
           take(header_.num_superpixels, sizeof(int)) && take(1, sizeof(int)) &&
           take(header_.num_observations, sizeof(Observation)) &&
           take(header_.num_candidates, sizeof(Plane)) &&
           take(header_.num_observations, sizeof(uint8_t)) &&
           take(header_.num_superpixels, sizeof(int)) && take(1, sizeof(int)) &&
           take(header_.num_confirmed, sizeof(RayDepth)) &&
           take(header_.num_superpixels, sizeof(int)) &&
           take(header_.num_borders, sizeof(SuperpixelBorder)) &&
           take(num_pixels, sizeof(uint16_t)) &&
           take(num_pixels, sizeof(Rgb)) &&
           take(num_ratings, sizeof(uint8_t)) && rest == 0;
  }

  void ReadBytes(void* target, size_t num_bytes) {
    file_.read(static_cast<char*>(target),
               static_cast<std::streamsize>(num_bytes));
    if (!file_) {
      throw CorruptEvidence(path_, "reading it failed");
    }
  }

  std::filesystem::path path_;
  uintmax_t num_bytes_ = 0;
  InputFile file_;
  Header header_;
  std::string options_hash_;
};

// Calls function(data, num_bytes) for each array but empty ones, whose null
// pointers must not get into memcpy().
template <typename Arrays, typename Function>
void ForEachArray(const Arrays& arrays, Function function) {
  for (const auto& array : arrays) {
    if (!array.empty()) {
      function(array.data(), array.size());
    }
  }
}

template <typename Arrays>
uint64_t Fingerprint(const Arrays& arrays) {
  ContentHash hash;
  ForEachArray(arrays, [&](const void* data, size_t num_bytes) {
    hash.Update(data, num_bytes);
  });
  return hash.Value();
}

}  // namespace

void WriteEvidence(const ContainedPath& path,
                   const std::string& options_hash,
                   const ViewEvidence& evidence) {
  if (const auto fault = FindEvidenceFault(evidence, EvidenceParts::kAll)) {
    throw Error::File(ErrorCode::kMismatch,
                      path.string(),
                      "what is to be written has " + *fault,
                      "this is a mistake of the program, please report it");
  }
  Header header;
  header.options_hash_length = static_cast<uint32_t>(options_hash.size());
  header.width = evidence.width;
  header.height = evidence.height;
  header.ratings_width = evidence.ratings.Width();
  header.ratings_height = evidence.ratings.Height();
  header.intrinsics = evidence.intrinsics;
  header.error_per_depth = evidence.resolution.error_per_depth;
  header.noise = evidence.noise;
  header.num_superpixels = evidence.weights.size();
  header.num_observations = evidence.observations.size();
  header.num_confirmed = evidence.confirmed.size();
  header.num_candidates = evidence.candidates.size();
  header.num_borders = evidence.borders.size();
  header.neighbour_fingerprint = Fingerprint(NeighbourArrays(evidence));
  header.own_fingerprint = Fingerprint(OwnArrays(evidence));
  header.header_fingerprint = HeaderFingerprint(header, options_hash);

  CreateFolders(path.Parent());
  AtomicFile file(path);
  const auto put = [&file](const void* data, size_t num_bytes) {
    file.Stream().write(static_cast<const char*>(data),
                        static_cast<std::streamsize>(num_bytes));
  };
  put(&header, sizeof(header));
  put(options_hash.data(), options_hash.size());
  ForEachArray(NeighbourArrays(evidence), put);
  ForEachArray(OwnArrays(evidence), put);
  file.Commit();
}

ViewEvidence ReadEvidence(const std::filesystem::path& path,
                          EvidenceParts parts) {
  EvidenceReader reader(path);
  const Header& header = reader.GetHeader();
  const int width = header.width;
  const int height = header.height;
  ViewEvidence evidence;
  evidence.width = width;
  evidence.height = height;
  evidence.intrinsics = header.intrinsics;
  evidence.resolution.error_per_depth = header.error_per_depth;
  evidence.noise = header.noise;
  evidence.superpixels = Image<uint16_t>::Uninitialized(width, height);
  evidence.confident_depth = Image<float>::Uninitialized(width, height);
  evidence.weights.resize(header.num_superpixels);
  evidence.first_observation.resize(header.num_superpixels + 1);
  evidence.observations.resize(header.num_observations);
  evidence.candidates.resize(header.num_candidates);
  reader.Read(NeighbourArrays(evidence), header.neighbour_fingerprint);
  if (parts == EvidenceParts::kAll) {
    evidence.is_measured.resize(header.num_observations);
    evidence.first_confirmed.resize(header.num_superpixels + 1);
    evidence.confirmed.resize(header.num_confirmed);
    evidence.confirmed_pixels.resize(header.num_superpixels);
    evidence.borders.resize(header.num_borders);
    evidence.region_planes = Image<uint16_t>::Uninitialized(width, height);
    evidence.color = Image<Rgb>::Uninitialized(width, height);
    evidence.ratings = Image<uint8_t>::Uninitialized(header.ratings_width,
                                                     header.ratings_height);
    reader.Read(OwnArrays(evidence), header.own_fingerprint);
  }
  if (const auto fault = FindEvidenceFault(evidence, parts)) {
    throw CorruptEvidence(path, "it has " + *fault);
  }
  return evidence;
}

std::optional<std::string> ReadEvidenceHash(const std::filesystem::path& path) {
  try {
    return EvidenceReader(path).OptionsHash();
  } catch (const Error&) {
    return std::nullopt;
  }
}

}  // namespace tsar
