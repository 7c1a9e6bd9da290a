// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/import/formats/dmb.h"

namespace tsar {

FloatMap ParseDmb(std::span<const uint8_t> bytes, const std::string& name) {
  ByteReader reader(bytes, name);
  const auto type = reader.Read<int32_t>();
  FloatMap map;
  map.height = reader.Read<int32_t>();
  map.width = reader.Read<int32_t>();
  map.channels = reader.Read<int32_t>();
  if (type != 1) {
    throw reader.Corrupt("not a .dmb of floats: its type is " +
                         std::to_string(type) + ", not 1");
  }
  map.values.resize(RequireExactLength(
      reader, map.width, map.height, map.channels, sizeof(float)));
  reader.ReadAll<float>(map.values);
  return map;
}

}  // namespace tsar
