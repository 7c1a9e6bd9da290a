// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/ply.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

namespace tsar {
namespace {

static_assert(std::endian::native == std::endian::little,
              "The readers of binary files copy little-endian numbers.");

enum class NumberType { kI8, kU8, kI16, kU16, kI32, kU32, kF32, kF64 };

size_t SizeOf(NumberType type) {
  static const size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<int>(type)];
}

template <typename T>
double Load(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return static_cast<double>(value);
}

double LoadNumber(const char* bytes, NumberType type) {
  switch (type) {
    case NumberType::kI8:
      return Load<int8_t>(bytes);
    case NumberType::kU8:
      return Load<uint8_t>(bytes);
    case NumberType::kI16:
      return Load<int16_t>(bytes);
    case NumberType::kU16:
      return Load<uint16_t>(bytes);
    case NumberType::kI32:
      return Load<int32_t>(bytes);
    case NumberType::kU32:
      return Load<uint32_t>(bytes);
    case NumberType::kF32:
      return Load<float>(bytes);
    case NumberType::kF64:
      return Load<double>(bytes);
  }
  return 0;
}

struct Element {
  std::string name;
  uint64_t count = 0;
  bool has_list = false;
  std::vector<std::string> names;
  std::vector<NumberType> types;

  size_t Stride() const {
    size_t stride = 0;
    for (const NumberType type : types) {
      stride += SizeOf(type);
    }
    return stride;
  }
};

class PlyFile {
 public:
  explicit PlyFile(const std::filesystem::path& path) : path_(path.string()) {
    InputFile file(path);
    if (file.IsMissing() || file.IsNoFile()) {
      Fail(ErrorCode::kNotFound, "there is no such file", "check the path");
    }
    if (!file) {
      Fail(ErrorCode::kIo,
           "the file cannot be opened (" + file.Reason() + ")",
           "check that it is a file and that you may read it");
    }
    content_.resize(file.Size());
    if (!file.read(content_.data(),
                   static_cast<std::streamsize>(content_.size()))) {
      Fail(ErrorCode::kIo, "the file cannot be read", "check its permissions");
    }
    rest_ = content_;
    ReadHeader();
  }

  PlyCloud ReadCloud(uint64_t max_num_points) {
    for (const Element& element : elements_) {
      if (element.has_list) {
        Fail(ErrorCode::kUnsupported,
             "element " + element.name + " holds a list",
             "save the points without faces or put the vertices first");
      }
      if (element.name == "vertex") {
        cloud_.num_points_read = element.count;
        num_wanted_ = std::min(element.count, max_num_points);
        is_ascii_ ? ReadAscii(element) : ReadBinary(element);
        return std::move(cloud_);
      }
      Skip(element);
    }
    Corrupt("it has no vertices");
  }

 private:
  [[noreturn]] void Fail(ErrorCode code,
                         const std::string& what,
                         const std::string& advice) const {
    throw Error::File(code, path_, what, advice);
  }
  [[noreturn]] void Corrupt(const std::string& what) const {
    Fail(ErrorCode::kCorrupt, "not a valid PLY file: " + what, "write it anew");
  }

  std::string_view NextLine() {
    const size_t end = rest_.find('\n');
    if (end == std::string_view::npos) {
      Corrupt("its header does not end");
    }
    std::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    if (line.ends_with('\r')) {
      line.remove_suffix(1);
    }
    return line;
  }

  void ReadHeader() {
    if (NextLine() != "ply") {
      Corrupt("it does not begin with 'ply'");
    }
    bool has_format = false;
    for (std::string_view line = NextLine(); line != "end_header";
         line = NextLine()) {
      std::istringstream words{std::string(line)};
      std::string keyword;
      words >> keyword;
      if (keyword == "format") {
        ReadFormat(&words);
        has_format = true;
      } else if (keyword == "element") {
        Element element;
        if (!(words >> element.name >> element.count)) {
          Corrupt("element without name or count");
        }
        elements_.push_back(element);
      } else if (keyword == "property") {
        ReadProperty(&words);
      } else if (keyword != "comment" && keyword != "obj_info") {
        Corrupt("unknown line '" + std::string(line.substr(0, 40)) +
                "' in its header");
      }
    }
    if (!has_format) {
      Corrupt("its header names no format");
    }
  }

  void ReadFormat(std::istringstream* words) {
    std::string format;
    *words >> format;
    is_ascii_ = format == "ascii";
    if (!is_ascii_ && format != "binary_little_endian") {
      Fail(ErrorCode::kUnsupported,
           "PLY format '" + format.substr(0, 40) + "' cannot be read",
           "save it as ascii or binary_little_endian");
    }
  }

  void ReadProperty(std::istringstream* words) {
    static const std::map<std::string, NumberType> types = {
        {"char", NumberType::kI8},
        {"int8", NumberType::kI8},
        {"uchar", NumberType::kU8},
        {"uint8", NumberType::kU8},
        {"short", NumberType::kI16},
        {"int16", NumberType::kI16},
        {"ushort", NumberType::kU16},
        {"uint16", NumberType::kU16},
        {"int", NumberType::kI32},
        {"int32", NumberType::kI32},
        {"uint", NumberType::kU32},
        {"uint32", NumberType::kU32},
        {"float", NumberType::kF32},
        {"float32", NumberType::kF32},
        {"double", NumberType::kF64},
        {"float64", NumberType::kF64}};
    if (elements_.empty()) {
      Corrupt("a property comes before all elements");
    }
    Element& element = elements_.back();
    std::string type_name;
    std::string name;
    *words >> type_name;
    if (type_name == "list") {
      element.has_list = true;
      return;
    }
    const auto type = types.find(type_name);
    if (!(*words >> name) || type == types.end()) {
      Corrupt("a property has no name or an unknown type");
    }
    element.names.push_back(name);
    element.types.push_back(type->second);
  }

  // Throws if the rest of the file cannot hold the element's items of at least
  // this many bytes each.
  void CheckSize(const Element& element, size_t bytes_per_item) const {
    if (bytes_per_item == 0) {
      if (element.count > 0) {
        Corrupt("element " + element.name + " has no properties");
      }
    } else if (element.count > rest_.size() / bytes_per_item) {
      Corrupt("it is too short for its " + std::to_string(element.count) + " " +
              element.name + " items");
    }
  }

  void Skip(const Element& element) {
    if (is_ascii_) {
      CheckSize(element, element.types.size());
      for (uint64_t i = 0; i < element.count * element.types.size(); ++i) {
        NextNumber();
      }
    } else {
      CheckSize(element, element.Stride());
      rest_.remove_prefix(element.count * element.Stride());
    }
  }

  // The indices of x, y and z, and of red, green and blue, among the element's
  // properties; the colors are -1 unless all three are bytes.
  std::array<int, 6> FindPlaces(const Element& element) const {
    static const std::array<std::string, 6> names = {
        "x", "y", "z", "red", "green", "blue"};
    std::array<int, 6> places = {-1, -1, -1, -1, -1, -1};
    for (size_t i = 0; i < element.names.size(); ++i) {
      const auto found =
          std::find(names.begin(), names.end(), element.names[i]);
      const auto place = static_cast<size_t>(found - names.begin());
      if (place < 3 || (place < 6 && element.types[i] == NumberType::kU8)) {
        places[place] = static_cast<int>(i);
      }
    }
    if (*std::min_element(places.begin(), places.begin() + 3) < 0) {
      Corrupt("its vertices have no x, y, z");
    }
    if (*std::min_element(places.begin() + 3, places.end()) < 0) {
      std::fill(places.begin() + 3, places.end(), -1);
    }
    return places;
  }

  // Whether this point is in the evenly spaced sample.
  bool IsWanted(uint64_t index) const {
    const double step = static_cast<double>(cloud_.num_points_read) /
                        static_cast<double>(num_wanted_);
    const auto next = static_cast<double>(cloud_.points.size());
    return cloud_.points.size() < num_wanted_ &&
           index >= static_cast<uint64_t>(next * step);
  }

  void AddPoint(const std::array<double, 6>& values, bool has_color) {
    cloud_.points.emplace_back(values[0], values[1], values[2]);
    if (has_color) {
      // A text may hold anything; NaN becomes 0.
      const auto byte = [](double value) {
        return static_cast<uint8_t>(value > 0.0 ? std::min(value, 255.0) : 0.0);
      };
      cloud_.colors.push_back(
          {byte(values[3]), byte(values[4]), byte(values[5])});
    }
  }

  void CheckFinite(const Eigen::Vector3d& point, size_t index) const {
    if (!point.allFinite()) {
      Corrupt("vertex " + std::to_string(index) + " is not finite");
    }
  }

  double NextNumber() {
    const size_t start = rest_.find_first_not_of(" \t\r\n");
    rest_.remove_prefix(start == std::string_view::npos ? rest_.size() : start);
    double value = 0;
    const char* end = rest_.data() + rest_.size();
    const auto result = std::from_chars(rest_.data(), end, value);
    if (result.ec != std::errc()) {
      Corrupt("a number is missing or cannot be read");
    }
    rest_.remove_prefix(static_cast<size_t>(result.ptr - rest_.data()));
    return value;
  }

  void ReadAscii(const Element& element) {
    const std::array<int, 6> places = FindPlaces(element);
    // A number takes at least one digit.
    CheckSize(element, element.types.size());
    Reserve(places);
    std::vector<double> values(element.types.size());
    for (uint64_t i = 0; i < element.count; ++i) {
      for (double& value : values) {
        value = NextNumber();
      }
      Take(i, places, [&](int place) {
        return values[static_cast<size_t>(place)];
      });
    }
  }

  void ReadBinary(const Element& element) {
    const std::array<int, 6> places = FindPlaces(element);
    const size_t stride = element.Stride();
    CheckSize(element, stride);
    Reserve(places);
    std::vector<size_t> offsets = {0};
    for (const NumberType type : element.types) {
      offsets.push_back(offsets.back() + SizeOf(type));
    }
    for (uint64_t i = 0; i < element.count; ++i) {
      const char* vertex = rest_.data() + i * stride;
      Take(i, places, [&](int place) {
        const auto index = static_cast<size_t>(place);
        return LoadNumber(vertex + offsets[index], element.types[index]);
      });
    }
  }

  void Reserve(const std::array<int, 6>& places) {
    cloud_.points.reserve(num_wanted_);
    cloud_.colors.reserve(places[3] >= 0 ? num_wanted_ : 0);
  }

  // Checks point `index` and adds it if it is in the sample. value: returns the
  // property at an index.
  template <typename Value>
  void Take(uint64_t index,
            const std::array<int, 6>& places,
            const Value& value) {
    std::array<double, 6> values = {};
    for (size_t k = 0; k < 6; ++k) {
      values[k] = places[k] >= 0 ? value(places[k]) : 0.0;
    }
    CheckFinite({values[0], values[1], values[2]}, index);
    if (IsWanted(index)) {
      AddPoint(values, places[3] >= 0);
    }
  }

  uint64_t num_wanted_ = 0;
  PlyCloud cloud_;
  std::string path_;
  std::string content_;
  std::string_view rest_;
  bool is_ascii_ = false;
  std::vector<Element> elements_;
};

}  // namespace

std::vector<Eigen::Vector3d> ReadPlyPoints(const std::filesystem::path& path) {
  return ReadPlyCloud(path, std::numeric_limits<uint64_t>::max()).points;
}

PlyCloud ReadPlyCloud(const std::filesystem::path& path,
                      uint64_t max_num_points) {
  return PlyFile(path).ReadCloud(max_num_points);
}

}  // namespace tsar
