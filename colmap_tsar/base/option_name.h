// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>
#include <string>

namespace tsar {

// The name of the option with this key (the name of a member such as "device")
// in messages: "device" if a program calls the library, "--TsarStereo.device"
// on the command line.
std::string OptionName(const std::string& key);

// Sets the function that OptionName() calls, for a command line; if empty, keys
// are unchanged. Must not be called while other threads work.
void SetOptionNamer(std::function<std::string(const std::string&)> new_namer);

}  // namespace tsar
