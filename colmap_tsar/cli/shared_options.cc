// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/cli/shared_options.h"

#include "colmap_tsar/base/contained_path.h"
#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/input_file.h"
#include "colmap_tsar/base/option_name.h"
#include "colmap_tsar/run/store/input_folders.h"

#include <system_error>
#include <vector>

namespace tsar {
void AddDeviceOptions(const std::string& group,
                      DeviceOptions* devices,
                      OptionSet* options) {
  options->AddEnum<DeviceChoice>(
      group + "device",
      &devices->choice,
      {DeviceChoice::kAuto, DeviceChoice::kCuda, DeviceChoice::kCpu},
      "Where to compute; auto: on a GPU where there is one.");
  std::vector<int>* const gpus = &devices->gpu_indices;
  options->Add(group + "gpu_index",
               TextTarget{[gpus] { return GpuIndicesText(*gpus); },
                          [gpus](const std::string& text) {
                            *gpus = ParseGpuIndices(text);
                          }},
               "The GPUs to use, such as 0,1; -1: all.");
  options->Add(group + "cache_size",
               &devices->cache_size,
               "Main memory for the images at work, in gigabytes; at most four "
               "fifths of the machine's count.",
               {0.001, 1e6});
  AddNumThreads(group + "num_threads", &devices->num_threads, options);
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

void AddMaskPath(std::filesystem::path* value,
                 const std::string& effect,
                 OptionSet* options) {
  options->Add("mask_path",
               value,
               "The folder with masks of the undistorted images, named as for "
               "COLMAP: a.jpg.png for a.jpg. " +
                   effect);
}

void RequireWritableOutput(const std::filesystem::path& workspace_path,
                           const std::filesystem::path& output_path,
                           const std::string& kind,
                           const IsOfKind& is_of_kind,
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
  InputFile file(output_path);
  std::string begin(1000, '\0');
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<size_t>(file.gcount()));
  if (!file.Reason().empty() || !(begin.empty() || is_of_kind(begin))) {
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
