// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/io/ply.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <iterator>
#include <limits>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

namespace tsar {
namespace {

static_assert(std::endian::native == std::endian::little,
              "The readers of binary files copy little-endian numbers.");

template <typename T>
double Load(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(T));
  return static_cast<double>(value);
}

struct NumberType {
  std::string_view name;
  std::string_view name_with_size;  // In newer files.
  size_t size;
  double (*load)(const char* bytes);
};

constexpr NumberType kNumberTypes[] = {
    {"char", "int8", sizeof(int8_t), &Load<int8_t>},
    {"uchar", "uint8", sizeof(uint8_t), &Load<uint8_t>},
    {"short", "int16", sizeof(int16_t), &Load<int16_t>},
    {"ushort", "uint16", sizeof(uint16_t), &Load<uint16_t>},
    {"int", "int32", sizeof(int32_t), &Load<int32_t>},
    {"uint", "uint32", sizeof(uint32_t), &Load<uint32_t>},
    {"float", "float32", sizeof(float), &Load<float>},
    {"double", "float64", sizeof(double), &Load<double>}};
constexpr const NumberType* kByte = &kNumberTypes[1];

struct Element {
  std::string name;
  uint64_t count = 0;
  bool has_list = false;
  std::vector<std::string> names;
  std::vector<const NumberType*> types;

  size_t Stride() const {
    size_t stride = 0;
    for (const NumberType* type : types) {
      stride += type->size;
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
    const NumberType* type = std::find_if(
        std::begin(kNumberTypes),
        std::end(kNumberTypes),
        [&](const NumberType& known) {
          return type_name == known.name || type_name == known.name_with_size;
        });
    if (!(*words >> name) || type == std::end(kNumberTypes)) {
      Corrupt("a property has no name or an unknown type");
    }
    element.names.push_back(name);
    element.types.push_back(type);
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
  std::array<int, 6> FindProperties(const Element& element) const {
    static const std::array<std::string, 6> names = {
        "x", "y", "z", "red", "green", "blue"};
    std::array<int, 6> indices = {-1, -1, -1, -1, -1, -1};
    for (size_t i = 0; i < element.names.size(); ++i) {
      const auto found =
          std::find(names.begin(), names.end(), element.names[i]);
      const auto position = static_cast<size_t>(found - names.begin());
      if (position < 3 || (position < 6 && element.types[i] == kByte)) {
        indices[position] = static_cast<int>(i);
      }
    }
    if (*std::min_element(indices.begin(), indices.begin() + 3) < 0) {
      Corrupt("its vertices have no x, y, z");
    }
    if (*std::min_element(indices.begin() + 3, indices.end()) < 0) {
      std::fill(indices.begin() + 3, indices.end(), -1);
    }
    return indices;
  }

  // Whether this point is in the evenly spaced sample.
  bool IsWanted(uint64_t index) const {
    const double step = static_cast<double>(cloud_.num_points_read) /
                        static_cast<double>(num_wanted_);
    const auto next = static_cast<double>(cloud_.points.size());
    return cloud_.points.size() < num_wanted_ &&
           index >= static_cast<uint64_t>(next * step);
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
    const std::array<int, 6> indices = FindProperties(element);
    // A number takes at least one digit.
    CheckSize(element, element.types.size());
    Reserve(indices);
    std::vector<double> values(element.types.size());
    for (uint64_t i = 0; i < element.count; ++i) {
      for (double& value : values) {
        value = NextNumber();
      }
      Take(i, indices, [&](int property) { return values[property]; });
    }
  }

  void ReadBinary(const Element& element) {
    const std::array<int, 6> indices = FindProperties(element);
    const size_t stride = element.Stride();
    CheckSize(element, stride);
    Reserve(indices);
    std::vector<size_t> offsets = {0};
    for (const NumberType* type : element.types) {
      offsets.push_back(offsets.back() + type->size);
    }
    for (uint64_t i = 0; i < element.count; ++i) {
      const char* vertex = rest_.data() + i * stride;
      Take(i, indices, [&](int property) {
        const auto index = static_cast<size_t>(property);
        return element.types[index]->load(vertex + offsets[index]);
      });
    }
  }

  void Reserve(const std::array<int, 6>& indices) {
    cloud_.points.reserve(num_wanted_);
    cloud_.colors.reserve(indices[3] >= 0 ? num_wanted_ : 0);
  }

  // Checks point `index` and adds it if it is in the sample. value: returns the
  // property at an index.
  template <typename Value>
  void Take(uint64_t index,
            const std::array<int, 6>& indices,
            const Value& value) {
    std::array<double, 6> values = {};
    for (size_t k = 0; k < 6; ++k) {
      values[k] = indices[k] >= 0 ? value(indices[k]) : 0.0;
    }
    if (!std::all_of(values.begin(), values.begin() + 3, [](double value) {
          return std::isfinite(value);
        })) {
      Corrupt("vertex " + std::to_string(index) + " is not finite");
    }
    if (!IsWanted(index)) {
      return;
    }
    cloud_.points.emplace_back(values[0], values[1], values[2]);
    if (indices[3] >= 0) {
      // A text may hold anything; NaN becomes 0.
      const auto byte = [](double value) {
        return static_cast<uint8_t>(value > 0.0 ? std::min(value, 255.0) : 0.0);
      };
      cloud_.colors.push_back(
          {byte(values[3]), byte(values[4]), byte(values[5])});
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
