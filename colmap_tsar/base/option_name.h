// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>
#include <string>

namespace tsar {

// What the option with this key, the name of a member such as "device", is
// called by whoever reads the messages: "device" where a program calls the
// library, "--TsarStereo.device" where somebody typed tsar_stereo.
std::string OptionName(const std::string& key);

// Has OptionName() ask this function, for a command line; an empty one: keys as
// they are. Not while other threads work.
void SetOptionNamer(std::function<std::string(const std::string&)> namer);

}  // namespace tsar
