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

// How a state of work reads: "[12/500] 3.1 images/s, 2 min left". num_worked of
// the num_done images took the seconds; the others needed no work. Where more
// work is expected after these images, it goes on: "(about 6 min of all
// passes)"; later_seconds: what that takes.
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
  // Seconds since some fixed moment.
  using Clock = std::function<double()>;

  // The pass, how many of its images are done, and how many it has.
  using Listener =
      std::function<void(const std::string& pass, int num_done, int num_total)>;

  // out must outlive this object. Without a clock, the system's is used.
  Progress(std::ostream& out, bool is_terminal, Clock clock = nullptr);

  // Has the listener told of each start and of each image, one at a time, by
  // the thread that reports it. To be called before the work begins.
  void SetListener(Listener listener);

  // For a run of several passes, so that the time left of all can be told.
  // costs: about what each pass takes, relative to the others.
  void PlanPasses(std::vector<double> costs);
  // The next of the planned passes begins. has_parts: whether Start is called
  // for parts of it that nobody has planned.
  void BeginPass(bool has_parts = false);

  // pass: what the line begins with, such as "Pass 1 of 2:"; may be empty.
  void Start(int num_total, const std::string& pass = "");
  // One more image is done. was_work: whether it says something about the
  // speed; false for those that had been done before.
  void Advance(bool was_work);
  // Ends the terminal's line, so that other output begins on its own.
  void Finish();

 private:
  void Print(double now);
  // What the run is expected to take after the images of the last Start.
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

  // The passes that are to come, the one at work first.
  std::deque<double> costs_;
  bool is_in_pass_ = false;
  bool has_parts_ = false;
  bool was_work_ = false;  // In this pass.
  double pass_start_ = 0.0;
  // Of the passes that are done and had something to do.
  double past_cost_ = 0.0;
  double past_seconds_ = 0.0;
};

}  // namespace tsar
