// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "python/serve_python.h"

#include "colmap_tsar/base/start_thread.h"
#include "colmap_tsar/base/warning.h"
#include "colmap_tsar/cli/process_setup.h"

#include <atomic>
#include <chrono>
#include <exception>
#include <future>
#include <mutex>
#include <ostream>
#include <sstream>
#include <thread>
#include <utility>
#include <vector>

#include "python/bindings.h"

namespace py = pybind11;

namespace tsar {
namespace {

// How long a Ctrl-C may wait to be seen, and progress to be shown.
constexpr std::chrono::milliseconds kPollInterval(50);

// Keeps what several threads write to a stream, up to the last flush, until the
// one that may call Python fetches it.
class TextQueue : public std::stringbuf {
 public:
  std::string Take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::exchange(flushed_, "");
  }

 protected:
  int sync() override {
    const std::lock_guard<std::mutex> lock(mutex_);
    flushed_ += str();
    str("");
    return 0;
  }

 private:
  std::mutex mutex_;
  std::string flushed_;
};

// The same for steps.
class StepQueue {
 public:
  struct Step {
    std::string pass;
    int num_done = 0;
    int num_total = 0;
  };

  void Add(Step step) {
    const std::lock_guard<std::mutex> lock(mutex_);
    steps_.push_back(std::move(step));
  }

  std::vector<Step> Take() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return std::exchange(steps_, {});
  }

 private:
  std::mutex mutex_;
  std::vector<Step> steps_;
};

// "Pass 1 of 3" of "Pass 1 of 3:".
std::string NameOfPass(const std::string& pass, const std::string& work) {
  return pass.empty() ? work : pass.substr(0, pass.find_last_not_of(':') + 1);
}

// Runs the handlers of signals that came in, and tells what there is to tell.
// Both may raise.
void ServePython(const std::string& name,
                 const PythonListeners& listeners,
                 TextQueue* text,
                 StepQueue* steps) {
  if (PyErr_CheckSignals() != 0) {
    throw py::error_already_set();
  }
  const std::string lines = text->Take();
  if (!lines.empty() && !listeners.write.is_none()) {
    listeners.write(lines);
  }
  for (const StepQueue::Step& step : steps->Take()) {
    listeners.step(
        ToText(NameOfPass(step.pass, name)), step.num_done, step.num_total);
  }
}

}  // namespace

PythonListeners ToPythonListeners(const py::tuple& listeners) {
  return {listeners[0], listeners[1].cast<bool>(), listeners[2]};
}

void WorkWhileServingPython(const std::string& name,
                            const PythonListeners& listeners,
                            const std::function<void(Progress&)>& work) {
  PrepareStreams();
  TextQueue text;
  StepQueue steps;
  std::ostream out(&text);
  Progress progress(out, listeners.is_terminal);
  if (!listeners.step.is_none()) {
    progress.SetListener([&](const std::string& pass, int done, int total) {
      steps.Add({pass, done, total});
    });
  }
  std::atomic<bool> should_stop = false;
  progress.SetStop([&] { return should_stop.load(); });
  std::packaged_task<void()> task([&] { work(progress); });
  std::future<void> end = task.get_future();
  const std::jthread thread = StartThread(std::move(task));
  std::exception_ptr raised;
  const PythonListeners nobody{py::none(), false, py::none()};
  for (bool is_done = false; !is_done;) {
    {
      const py::gil_scoped_release release;
      is_done = end.wait_for(kPollInterval) == std::future_status::ready;
    }
    try {
      if (raised) {
        steps.Take();
      }
      ServePython(name, raised ? nobody : listeners, &text, &steps);
    } catch (...) {
      // A second Ctrl-C neither hurries the work, which cannot be left alone,
      // nor stays behind for what the caller does next.
      raised = std::current_exception();
      should_stop = true;
    }
  }
  if (raised) {
    std::rethrow_exception(raised);
  }
  end.get();
}

void PrepareStreams() {
  OpenClosedStandardStreams();
  PrepareWarnings("colmap_tsar");
}

}  // namespace tsar
