// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

// What a stage computes, as numbers in host memory that can be compared.

#include "colmap_tsar/base/plane.h"
#include "colmap_tsar/device/buffer.h"
#include "colmap_tsar/matching/gray_pair.h"
#include "colmap_tsar/scene/evidence/label_view.h"

#include <cstdint>
#include <string>
#include <vector>

namespace tsar {

class StageResult {
 public:
  // Elements of num_components numbers each; one is different when any of its
  // numbers is.
  struct Channel {
    std::string name;
    size_t num_components = 1;
    std::vector<double> values;
  };

  template <typename T>
  void Add(const std::string& name, const DeviceImage<T>& image) {
    const Image<T> host = image.ToHost();
    Add(name, std::vector<T>(host.begin(), host.end()));
  }
  template <typename T>
  void Add(const std::string& name, const Buffer<T>& buffer) {
    Add(name, buffer.ToHost());
  }
  template <typename T>
  void Add(const std::string& name, const std::vector<T>& values) {
    Channel channel{name, 1, {}};
    for (const T& value : values) {
      const size_t size = channel.values.size();
      Append(value, &channel.values);
      channel.num_components = channel.values.size() - size;
    }
    channels_.push_back(std::move(channel));
  }

  const std::vector<Channel>& Channels() const { return channels_; }

 private:
  template <typename T>
  static void Append(const T& value, std::vector<double>* values) {
    values->push_back(static_cast<double>(value));
  }
  static void Append(const Vec3f& value, std::vector<double>* values) {
    values->insert(values->end(), {value.x, value.y, value.z});
  }
  static void Append(const GrayPair& value, std::vector<double>* values) {
    values->push_back(value.word);
  }
  static void Append(const LabelQuality& value, std::vector<double>* values) {
    values->insert(values->end(),
                   {value.strength.Value(),
                    value.confirmed.Value(),
                    value.uncertainty.Value(),
                    value.margin.Value()});
  }
  static void Append(const Plane& value, std::vector<double>* values) {
    Append(value.normal, values);
    Append(value.offset, values);
  }

  std::vector<Channel> channels_;
};

// In which channels two results are not the same to the last bit, one line for
// each; empty where they are the same.
std::string FindDifferences(const StageResult& a, const StageResult& b);

}  // namespace tsar
