// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/shared_options.h"

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/base/printable.h"
#include "colmap_tsar/run/store/input_folders.h"

#include <algorithm>
#include <iostream>
#include <system_error>

namespace tsar {
namespace {

constexpr size_t kMaxListed = 20;

void PrintList(const std::string& title,
               const std::vector<std::filesystem::path>& paths) {
  if (paths.empty()) {
    return;
  }
  std::cout << title << "\n";
  for (size_t i = 0; i < std::min(paths.size(), kMaxListed); ++i) {
    std::cout << "  " << Printable(paths[i].string()) << "\n";
  }
  if (paths.size() > kMaxListed) {
    std::cout << "  and " << paths.size() - kMaxListed << " more\n";
  }
}

// "a.bin and 2 more"; at least one.
std::string FirstAndNumber(const std::vector<std::filesystem::path>& paths) {
  return paths.front().string() +
         (paths.size() == 1
              ? std::string()
              : " and " + std::to_string(paths.size() - 1) + " more");
}

}  // namespace

DeviceOptions DeviceArguments::Parse() const {
  DeviceOptions parsed = options;
  parsed.choice = ParseDeviceChoice(device);
  parsed.gpu_indices = ParseGpuIndices(gpu_index);
  parsed.Check();
  return parsed;
}

void AddDeviceArguments(const std::string& group,
                        DeviceArguments* arguments,
                        OptionSet* options) {
  options->AddChoice(group + "device",
                     &arguments->device,
                     {"auto", "cuda", "cpu"},
                     "Where to compute; auto: on a GPU where there is one.");
  options->Add(group + "gpu_index",
               &arguments->gpu_index,
               "The GPUs to use, such as 0,1; -1: all.");
  options->Add(group + "cache_size",
               &arguments->options.cache_size,
               "Main memory for the images at work, in gigabytes; at most four "
               "fifths of the machine's count.",
               {0.001, 1e6});
  AddNumThreads(
      group + "num_threads", &arguments->options.num_threads, options);
}

void AddNumThreads(const std::string& name,
                   int* value,
                   OptionSet* options,
                   const std::string& remark) {
  options->Add(name,
               value,
               "Number of CPU threads; -1: one for each core." + remark,
               {-1, 4096});
}

void AddMapType(const std::string& name,
                std::string* value,
                const std::string& description,
                OptionSet* options) {
  options->AddChoice(
      name,
      value,
      {ToString(MapType::kGeometric), ToString(MapType::kPhotometric)},
      description);
}

void AddMaskPath(std::filesystem::path* value,
                 const std::string& effect,
                 OptionSet* options) {
  options->Add("mask_path",
               value,
               "The folder with masks of the undistorted images, named as for "
               "COLMAP: a.jpg.png for a.jpg. " +
                   effect);
}

std::optional<MapType> ParseMapType(const std::string& value) {
  if (value.empty()) {
    return std::nullopt;
  }
  return value == ToString(MapType::kPhotometric) ? MapType::kPhotometric
                                                  : MapType::kGeometric;
}

void ReportRestored(const RestoreResult& result) {
  PrintList(
      "Left these maps as they are, which were written since; the originals "
      "before them are now in stereo/tsar/superseded:",
      result.kept);
  PrintList("What had to make room is now here, and is never touched again:",
            result.superseded);
  PrintList("Left these refined maps, whose originals are gone:", result.lost);
  if (!result.lost.empty()) {
    std::cout << std::flush;
    throw Error(ErrorCode::kMismatch,
                FirstAndNumber(result.lost) +
                    ": this map has been refined, and its original is gone; "
                    "run patch_match_stereo again for this image");
  }
}

void RequireWritableOutput(const std::filesystem::path& workspace_path,
                           const std::filesystem::path& output_path,
                           const std::string& kind,
                           bool overwrite,
                           const std::string& option_key) {
  const std::string option = OptionName(option_key);
  RequireOutsideInputs(workspace_path, output_path, option);
  std::error_code error;
  const std::filesystem::path folder = UserPath(output_path).Root();
  if (!std::filesystem::is_directory(folder, error)) {
    throw Error::File(ErrorCode::kNotFound,
                      folder.string(),
                      "no such folder to write the " + kind + " into",
                      "make it, or choose another " + option);
  }
  if (!std::filesystem::exists(
          std::filesystem::symlink_status(output_path, error))) {
    return;
  }
  if (!std::filesystem::is_regular_file(output_path, error)) {
    throw Error::File(ErrorCode::kUnsupported,
                      output_path.string(),
                      "is there already and is no " + kind,
                      "choose another " + option);
  }
  if (!overwrite) {
    throw Error::File(ErrorCode::kUnsupported,
                      output_path.string(),
                      "is there already",
                      "give " + OptionName("overwrite") +
                          " 1 to replace it, or choose another " + option);
  }
}

}  // namespace tsar
