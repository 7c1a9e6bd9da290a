// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include "colmap_tsar/base/progress.h"

#include <functional>
#include <string>

#include <pybind11/pybind11.h>

namespace tsar {

// What of a run is told to Python, and to whom.
struct PythonListeners {
  // Takes the text that Progress writes; None: nobody.
  pybind11::object write;
  // Whether that goes to a terminal.
  bool is_terminal = false;
  // Takes the name of a pass, how many of its images are done, and how many it
  // has; None: nobody.
  pybind11::object step;
};

// (write, is_terminal, step), as colmap_tsar/_progress.py makes them.
PythonListeners ToPythonListeners(const pybind11::tuple& listeners);

// The work is done on another thread, without the GIL. This one sleeps, also
// without it, and wakes to serve Python: it runs the handlers of signals and
// calls the listeners. What these raise has the work end in order, as its
// Progress then tells it, and is raised once it has. What the work throws is
// thrown here.
//
// name: of the work, for the steps of a pass without a name.
void WorkWhileServingPython(const std::string& name,
                            const PythonListeners& listeners,
                            const std::function<void(Progress&)>& work);

// Warnings go to standard error, as those of the program; into none of the maps
// where that is closed.
void PrepareStreams();

}  // namespace tsar
