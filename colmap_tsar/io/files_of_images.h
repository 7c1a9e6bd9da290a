// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace tsar {

// Throws Error kBadOption if a folder of other content is that of the images.
// content: the expected content, such as "masks"; option: the option that names
// the folder.
void RequireNoImageFolder(const std::filesystem::path& folder,
                          const std::filesystem::path& images,
                          const std::string& content,
                          const std::string& option);

// The naming scheme of one kind of files in a folder.
struct ImageFileNames {
  std::string noun;  // A noun such as "mask", whose plural ends in s.
  // Finds the file of an image; empty if there is none.
  std::function<std::filesystem::path(const std::filesystem::path& folder,
                                      const std::string& image)>
      find;
  // The possible names of an image's file, for messages.
  std::function<std::string(const std::string& image)> describe;
};

// The files of these images; empty for images without one. option: the option
// that names the folder. Throws Error kNotFound if there is no such folder or
// it holds no file of any of them.
std::vector<std::filesystem::path> FindFilesOfImages(
    const std::filesystem::path& folder,
    const std::vector<std::string>& image_names,
    const ImageFileNames& names,
    const std::string& option);

}  // namespace tsar
