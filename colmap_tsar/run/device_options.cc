// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/run/device_options.h"

#include "colmap_tsar/base/enum_names.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/parse_number.h"
#include "colmap_tsar/base/text_stream.h"

#include <algorithm>
#include <array>
#include <utility>

namespace tsar {
namespace {

constexpr std::array kChoiceNames = {
    std::pair(DeviceChoice::kAuto, "auto"),
    std::pair(DeviceChoice::kCuda, "cuda"),
    std::pair(DeviceChoice::kCpu, "cpu"),
};

Error Refused(const std::string& what) {
  return Error(ErrorCode::kBadOption,
               OptionName("gpu_index") + ": " + what +
                   "; give -1 for every GPU, or numbers from 0 on such as 0,1");
}

void CheckGpuIndices(const std::vector<int>& indices) {
  for (auto index = indices.begin(); index != indices.end(); ++index) {
    if (*index < 0) {
      throw Refused("there is no GPU " + std::to_string(*index));
    }
    if (std::find(indices.begin(), index, *index) != index) {
      throw Refused("GPU " + std::to_string(*index) + " is named twice");
    }
  }
}

}  // namespace

std::string ToString(DeviceChoice choice) {
  return EnumName(kChoiceNames, choice);
}

std::vector<int> ParseGpuIndices(const std::string& text) {
  if (text == "-1") {
    return {};
  }
  const auto indices = ParseNumbers<int>(text);
  if (!indices) {
    throw Refused("'" + text + "' is not a list of GPUs");
  }
  CheckGpuIndices(*indices);
  return *indices;
}

std::string GpuIndicesText(const std::vector<int>& gpu_indices) {
  TextStream text;
  for (const int index : gpu_indices) {
    text << (text.str().empty() ? "" : ",") << index;
  }
  return gpu_indices.empty() ? "-1" : text.str();
}

void DeviceOptions::Check() const {
  CheckGpuIndices(gpu_indices);
  if (num_threads != -1 && num_threads <= 0) {
    throw Error(
        ErrorCode::kBadOption,
        OptionName("num_threads") + ": give at least 1, or -1 for all cores");
  }
  if (!(cache_size > 0.0 && cache_size <= 1e6)) {
    throw Error(
        ErrorCode::kBadOption,
        OptionName("cache_size") + ": give a positive number of gigabytes");
  }
}

}  // namespace tsar
