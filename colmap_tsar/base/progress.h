// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#pragma once

#include <functional>
#include <mutex>
#include <ostream>
#include <string>

namespace tsar {

// How a state of work reads: "[12/500] 3.1 images/s, 2 min left". num_worked of
// the num_done images took the seconds; the others needed no work.
std::string ProgressText(int num_done,
                         int num_worked,
                         int num_total,
                         double seconds);

// Tells how far a loop over images has come. On a terminal it keeps one line up
// to date; elsewhere, as in a log file, it writes a line for each image when
// there are few and one every ten seconds when there are many. Can be advanced
// from several threads at once.
class Progress {
 public:
  // Seconds since some fixed moment.
  using Clock = std::function<double()>;

  // out must outlive this object. Without a clock, the system's is used.
  Progress(std::ostream& out, bool is_terminal, Clock clock = nullptr);

  // pass: what the line begins with, such as "Pass 1 of 2:"; may be empty.
  void Start(int num_total, const std::string& pass = "");
  // One more image is done. was_work: whether it says something about the
  // speed; false for those that had been done before.
  void Advance(bool was_work);
  // Ends the terminal's line, so that other output begins on its own.
  void Finish();

 private:
  void Print(double now);

  std::ostream& out_;
  const bool is_terminal_;
  const Clock clock_;
  std::mutex mutex_;
  std::string pass_;
  int num_total_ = 0;
  int num_done_ = 0;
  int num_worked_ = 0;
  double start_ = 0.0;
  double last_print_ = 0.0;
  size_t line_length_ = 0;
};

}  // namespace tsar
