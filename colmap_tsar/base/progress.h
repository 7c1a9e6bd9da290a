// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>
#include <mutex>
#include <ostream>
#include <string>
#include <utility>

namespace tsar {

// Reports the progress of a loop over images: "[12/500] 3 min left", and tells
// the loop whether the user asked to stop. On a terminal it keeps one line up
// to date; elsewhere, as in a log file, it writes a line every ten seconds and
// one at the end. Can be advanced from several threads. Images that need no
// work are reported only if they take long.
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

  // Sets whether the user asked to stop, which is called often, from several
  // threads. Must be called before the work begins.
  void SetStop(std::function<bool()> should_stop) {
    should_stop_ = std::move(should_stop);
  }
  bool ShouldStop() const { return should_stop_ && should_stop_(); }
  // Throws Error kInterrupted with this message if the user asked to stop.
  void ThrowIfStopped(const std::string& message);

  // Names the part of the work to which the next passes belong, such as
  // "Stereo. "; their lines begin with it.
  void SetPart(const std::string& part);

  // pass: the prefix of the line, such as "Pass 1 of 2:"; may be empty.
  void Start(int num_total, const std::string& pass = "");
  // Counts one more image. was_work: whether it counts for the speed; false for
  // images done before.
  void Advance(bool was_work);
  // Ends the terminal's line, so that other output begins on a new one.
  void Finish();

 private:
  void Print(double now);

  std::ostream& out_;
  const bool is_terminal_;
  const Clock clock_;
  Listener listener_;
  std::function<bool()> should_stop_;
  std::mutex mutex_;
  std::string part_;
  std::string pass_;
  int num_total_ = 0;
  int num_done_ = 0;
  int num_worked_ = 0;
  double start_ = 0.0;
  double last_print_ = 0.0;
  size_t line_length_ = 0;
};

}  // namespace tsar
