// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <string>

#include "manual/program_description.h"

namespace tsar {

// Scripts by which a shell completes the program's commands, their options, the
// choices of an option, and files and folders.
std::string BashCompletion(const ProgramDescription& program);
std::string ZshCompletion(const ProgramDescription& program);
std::string FishCompletion(const ProgramDescription& program);

// The first sentence of a text, without its full stop.
std::string FirstSentence(const std::string& text);

// The texts with this between them.
std::string Join(const std::vector<std::string>& texts,
                 const std::string& separator);

}  // namespace tsar
