// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace tsar {

// Throws Error, kBadOption, where a folder of something else is that of the
// images. content: what it should hold, such as "masks"; option: what names the
// folder.
void RequireNoImageFolder(const std::filesystem::path& folder,
                          const std::filesystem::path& images,
                          const std::string& content,
                          const std::string& option);

// How a folder names its files of one kind.
struct ImageFileNames {
  std::string noun;  // Such as "mask"; its plural ends in s.
  // The file of an image that is there; empty where there is none.
  std::function<std::filesystem::path(const std::filesystem::path& folder,
                                      const std::string& image)>
      find;
  // What may be the name of an image's file, for messages.
  std::function<std::string(const std::string& image)> describe;
};

// The files of these images; empty for those without one. option: what the
// folder was given with. Throws Error kNotFound where there is no such folder,
// or it holds none for any of them.
std::vector<std::filesystem::path> FindFilesOfImages(
    const std::filesystem::path& folder,
    const std::vector<std::string>& image_names,
    const ImageFileNames& names,
    const std::string& option);

}  // namespace tsar
