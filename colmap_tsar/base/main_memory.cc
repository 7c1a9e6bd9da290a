// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/main_memory.h"

#include <algorithm>
#include <fstream>
#include <string>

namespace tsar {
namespace {

int64_t MachineMemory(const std::filesystem::path& root) {
  std::ifstream file(root / "proc/meminfo");
  std::string name;
  int64_t kibibytes = 0;
  std::string unit;
  while (file >> name >> kibibytes && std::getline(file, unit)) {
    if (name == "MemTotal:") {
      return kibibytes * 1024;
    }
  }
  return INT64_MAX;
}

// The limit in a control group's file; "max" or no file means no limit.
int64_t LimitIn(const std::filesystem::path& path) {
  std::ifstream file(path);
  int64_t limit = 0;
  return file >> limit && limit > 0 ? limit : INT64_MAX;
}

// The least limit of a group and its parents. Inside a container the group's
// own folder may be missing; only that of the container at the root exists.
int64_t GroupLimit(const std::filesystem::path& hierarchy,
                   const std::string& group,
                   const char* file_name) {
  int64_t limit = LimitIn(hierarchy / file_name);
  std::filesystem::path folder = hierarchy;
  for (const std::filesystem::path& part :
       std::filesystem::path(group).relative_path()) {
    folder /= part;
    limit = std::min(limit, LimitIn(folder / file_name));
  }
  return limit;
}

}  // namespace

int64_t MainMemoryBytes(const std::filesystem::path& root) {
  int64_t bytes = MachineMemory(root);
  const std::filesystem::path groups = root / "sys/fs/cgroup";
  std::ifstream file(root / "proc/self/cgroup");
  // Lines are ID:CONTROLLERS:GROUP, in version 2 without controllers.
  for (std::string line; std::getline(file, line);) {
    const size_t first = line.find(':');
    const size_t second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) {
      continue;
    }
    const std::string controllers = line.substr(first + 1, second - first - 1);
    const std::string group = line.substr(second + 1);
    if (controllers.empty()) {
      bytes = std::min(bytes, GroupLimit(groups, group, "memory.max"));
    } else if (controllers == "memory") {
      bytes = std::min(
          bytes, GroupLimit(groups / "memory", group, "memory.limit_in_bytes"));
    }
  }
  return bytes;
}

}  // namespace tsar
