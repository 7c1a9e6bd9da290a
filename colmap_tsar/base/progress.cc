// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/progress.h"

#include "colmap_tsar/base/error.h"
#include "colmap_tsar/base/printable.h"
#include "colmap_tsar/base/stopwatch.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tsar {
namespace {

constexpr double kSecondsBetweenLines = 10.0;
constexpr double kSecondsBetweenUpdates = 0.2;

std::string DurationText(double seconds) {
  if (seconds < 90.0) {
    return std::to_string(std::lround(seconds)) + " s";
  }
  const long minutes = std::lround(seconds / 60.0);
  return minutes < 90 ? std::to_string(minutes) + " min"
                      : std::to_string(minutes / 60) + " h " +
                            std::to_string(minutes % 60) + " min";
}

}  // namespace

Progress::Progress(std::ostream& out, bool is_terminal, Clock clock)
    : out_(out),
      is_terminal_(is_terminal),
      clock_(clock ? std::move(clock)
                   : [watch = Stopwatch()] { return watch.Seconds(); }) {}

void Progress::SetListener(Listener listener) {
  listener_ = std::move(listener);
}

void Progress::ThrowIfStopped(const std::string& message) {
  if (ShouldStop()) {
    Finish();
    throw Error(ErrorCode::kInterrupted, message);
  }
}

void Progress::SetPart(const std::string& part) {
  const std::lock_guard<std::mutex> lock(mutex_);
  part_ = part;
}

void Progress::Start(int num_total, const std::string& pass) {
  const std::lock_guard<std::mutex> lock(mutex_);
  pass_ = part_ + Printable(pass);
  num_total_ = num_total;
  num_done_ = 0;
  num_worked_ = 0;
  line_length_ = 0;
  start_ = clock_();
  last_print_ = start_;
  if (listener_) {
    listener_(pass_, num_done_, num_total_);
  }
}

void Progress::Advance(bool was_work) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const double now = clock_();
  ++num_done_;
  num_worked_ += was_work ? 1 : 0;
  // If nothing had to be done, nothing is reported, unless it takes time.
  const bool is_due =
      (num_done_ == num_total_ && num_worked_ > 0) ||
      now - last_print_ >=
          (is_terminal_ ? kSecondsBetweenUpdates : kSecondsBetweenLines);
  if (is_due) {
    Print(now);
  }
  if (listener_) {
    listener_(pass_, num_done_, num_total_);
  }
}

void Progress::Finish() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (line_length_ > 0) {
    out_ << std::endl;
    line_length_ = 0;
  }
}

void Progress::Print(double now) {
  last_print_ = now;
  std::string text = (pass_.empty() ? "" : pass_ + " ") + "[" +
                     std::to_string(num_done_) + "/" +
                     std::to_string(num_total_) + "]";
  if (num_worked_ > 0 && num_done_ < num_total_) {
    const double seconds_per_image = (now - start_) / num_worked_;
    text += " " + DurationText((num_total_ - num_done_) * seconds_per_image) +
            " left";
  }
  if (!is_terminal_) {
    out_ << text << std::endl;
    return;
  }
  const size_t length = std::max(text.size(), line_length_);
  out_ << "\r" << text << std::string(length - text.size(), ' ') << std::flush;
  line_length_ = text.size();
}

}  // namespace tsar
