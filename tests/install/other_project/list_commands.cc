// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include <iostream>

#include <colmap_tsar/cli/commands.h>

#if __cplusplus >= 201703L
#error "the commands are to be had from C++14"
#endif

int main() {
  for (const tsar::Command& command : tsar::Commands()) {
    std::cout << command.name << "\n";
  }
  return 0;
}
