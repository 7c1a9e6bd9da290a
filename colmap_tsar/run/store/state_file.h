// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/base/content_hash.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/image.h"
#include "colmap_tsar/base/input_file.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace tsar {

// Binary files in which one pass of a run stores the input of the next ones:
// arrays, little-endian and without padding. A header (magic, version, length,
// checksum) and the key, a fingerprint of all that the content was made of, are
// followed by parts, each of which ends with its checksum. The checksums detect
// damage; intact content is what the program once wrote.

// A format of state files, with the texts of its errors.
struct StateFileKind {
  std::array<char, 8> magic;
  // To be incremented with every change of the meaning of the bytes.
  uint32_t version;
  const char* name;  // "evidence file".
  const char* missing;
  const char* advice_for_missing;
};

// What comes before the elements of an array.
struct StateFileArray {
  uint64_t num_elements = 0;
  uint32_t element_size = 0;  // In bytes.
  int32_t width = 0;          // Of an image; 0: a vector or an empty image.
};

class StateFileWriter {
 public:
  // Adds a vector or an image, which must not change until Write().
  template <typename Container>
  void Add(const Container& container) {
    const std::span elements(container);
    using Element = typename decltype(elements)::value_type;
    static_assert(std::is_trivially_copyable_v<Element>);
    StateFileArray array = {elements.size(), sizeof(Element)};
    if constexpr (requires { container.Width(); }) {
      array.width = container.Width();
    }
    arrays_.push_back({array, std::as_bytes(elements), false});
  }
  // Ends a part, which has at least one array.
  void EndPart() { arrays_.back().ends_part = true; }

  // Writes the file atomically; creates the folder. The same content gives the
  // same bytes. Throws kIo.
  void Write(const ContainedPath& path,
             const StateFileKind& kind,
             const std::string& key) const;

 private:
  struct Entry {
    StateFileArray array;
    std::span<const std::byte> bytes;
    bool ends_part = false;
  };
  std::vector<Entry> arrays_;
};

// An open file with an intact header. The constructor throws Error kNotFound,
// kCorrupt, and kIo where the file may not be read; all other functions
// kCorrupt.
class StateFileReader {
 public:
  // kind must outlive the reader.
  StateFileReader(const std::filesystem::path& path, const StateFileKind& kind);

  const std::string& Key() const { return key_; }

  // Reads the next array. No memory is allocated for more than the file holds.
  template <typename T>
  void Read(std::vector<T>* vector) {
    vector->resize(ReadArray(sizeof(T)).num_elements);
    ReadBytes(std::as_writable_bytes(std::span(*vector)));
  }
  template <typename T>
  void Read(Image<T>* image) {
    const StateFileArray array = ReadArray(sizeof(T));
    *image = array.width == 0
                 ? Image<T>()
                 : Image<T>::Uninitialized(
                       array.width,
                       static_cast<int>(array.num_elements / array.width));
    ReadBytes(std::as_writable_bytes(std::span(*image)));
  }
  // Returns the checksum of the part, all of whose arrays have been read.
  uint64_t EndPart();

 private:
  void ReadHeader();
  // what: the fault, such as "its content was changed".
  Error Corrupt(const std::string& what) const;
  StateFileArray ReadArray(size_t element_size);
  void ReadBytes(std::span<std::byte> bytes);

  const std::filesystem::path path_;
  const StateFileKind& kind_;
  InputFile file_;
  std::string key_;
  std::optional<ContentHash> hash_;  // Of the part so far.
};

// The key of a file. Nothing where there is no file, or none with an intact
// header, of this kind and version and of the length that the header gives.
std::optional<std::string> ReadStateFileKey(const std::filesystem::path& path,
                                            const StateFileKind& kind);

}  // namespace tsar
