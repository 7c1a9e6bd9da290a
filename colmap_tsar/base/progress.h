// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <deque>
#include <functional>
#include <mutex>
#include <ostream>
#include <string>
#include <vector>

namespace tsar {

// The text of a state of progress: "[12/500] 3.1 images/s, 2 min left".
// num_worked of the num_done images took the seconds; the others needed no
// work. later_seconds: the expected time after these images; if above 0,
// "(about 6 min of all passes)" is appended.
std::string ProgressText(int num_done,
                         int num_worked,
                         int num_total,
                         double seconds,
                         double later_seconds = 0.0);

// Tells how far a loop over images has come. On a terminal it keeps one line up
// to date; elsewhere, as in a log file, it writes a line every ten seconds and
// one at the end. Can be advanced from several threads at once. Of images that
// need no work it tells only what takes time.
class Progress {
 public:
  // A clock in seconds since a fixed moment.
  using Clock = std::function<double()>;

  // A callback with the pass, the number of its images done, and their total.
  using Listener =
      std::function<void(const std::string& pass, int num_done, int num_total)>;

  // out must outlive this object. clock: null for the system's.
  Progress(std::ostream& out, bool is_terminal, Clock clock = nullptr);

  // Sets a listener that is called at each start and for each image, one call
  // at a time, by the reporting thread. Must be called before the work begins.
  void SetListener(Listener listener);

  // Announces the passes of a run, so that the time left of all is estimated.
  // costs: the relative durations of the passes.
  void PlanPasses(std::vector<double> costs);
  // Begins the next planned pass. has_parts: whether Start is called for
  // several unplanned parts of it.
  void BeginPass(bool has_parts = false);

  // pass: the prefix of the line, such as "Pass 1 of 2:"; may be empty.
  void Start(int num_total, const std::string& pass = "");
  // Counts one more image. was_work: whether it counts for the speed; false for
  // images done before.
  void Advance(bool was_work);
  // Ends the terminal's line, so that other output begins on a new one.
  void Finish();

 private:
  void Print(double now);
  // The expected time of the run after the images of the last Start.
  double LaterSeconds(double now) const;

  std::ostream& out_;
  const bool is_terminal_;
  const Clock clock_;
  Listener listener_;
  std::mutex mutex_;
  std::string pass_;
  int num_total_ = 0;
  int num_done_ = 0;
  int num_worked_ = 0;
  double start_ = 0.0;
  double last_print_ = 0.0;
  size_t line_length_ = 0;

  // The costs of the current and the remaining passes.
  std::deque<double> costs_;
  bool is_in_pass_ = false;
  bool has_parts_ = false;
  bool was_work_ = false;  // Whether this pass had any work.
  double pass_start_ = 0.0;
  // Sums over the finished passes that had work.
  double past_cost_ = 0.0;
  double past_seconds_ = 0.0;
};

}  // namespace tsar
