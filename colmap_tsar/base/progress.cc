// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause

#include "colmap_tsar/base/progress.h"

#include "colmap_tsar/base/printable.h"
#include "colmap_tsar/base/text_stream.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iomanip>
#include <iterator>
#include <numeric>
#include <utility>

namespace tsar {
namespace {

constexpr double kSecondsBetweenLines = 10.0;
constexpr double kSecondsBetweenUpdates = 0.2;

double SteadySeconds() {
  return std::chrono::duration<double>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

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

std::string ProgressText(int num_done,
                         int num_worked,
                         int num_total,
                         double seconds,
                         double later_seconds) {
  TextStream text;
  text << "[" << num_done << "/" << num_total << "]";
  if (num_worked > 0 && seconds > 0.0) {
    const double speed = num_worked / seconds;
    // Slow work is shown as seconds per image instead.
    text << " " << std::fixed << std::setprecision(1);
    if (speed >= 1.0) {
      text << speed << " images/s";
    } else {
      text << 1.0 / speed << " s per image";
    }
    if (num_done < num_total) {
      const double left = (num_total - num_done) / speed;
      text << ", " << DurationText(left) << " left";
      if (later_seconds > 0.0) {
        text << " (about " << DurationText(left + later_seconds)
             << " of all passes)";
      }
    }
  }
  return text.str();
}

Progress::Progress(std::ostream& out, bool is_terminal, Clock clock)
    : out_(out),
      is_terminal_(is_terminal),
      clock_(clock ? std::move(clock) : SteadySeconds) {}

void Progress::SetListener(Listener listener) {
  listener_ = std::move(listener);
}

void Progress::PlanPasses(std::vector<double> costs) {
  const std::lock_guard<std::mutex> lock(mutex_);
  costs_.assign(costs.begin(), costs.end());
  is_in_pass_ = false;
  past_cost_ = 0.0;
  past_seconds_ = 0.0;
}

void Progress::BeginPass(bool has_parts) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const double now = clock_();
  if (is_in_pass_ && !costs_.empty()) {
    if (was_work_) {
      // Images that were done before took no time.
      const double share =
          has_parts_ ? 1.0 : static_cast<double>(num_worked_) / num_total_;
      past_cost_ += share * costs_.front();
      past_seconds_ += now - pass_start_;
    }
    costs_.pop_front();
  }
  is_in_pass_ = true;
  has_parts_ = has_parts;
  was_work_ = false;
  pass_start_ = now;
}

void Progress::Start(int num_total, const std::string& pass) {
  const std::lock_guard<std::mutex> lock(mutex_);
  pass_ = Printable(pass);
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
  was_work_ = was_work_ || was_work;
  // Where nothing had to be done there is nothing to tell, unless it takes
  // time.
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

double Progress::LaterSeconds(double now) const {
  if (!is_in_pass_ || costs_.empty() || num_worked_ == 0) {
    return 0.0;
  }
  const double later_cost =
      std::accumulate(std::next(costs_.begin()), costs_.end(), 0.0);
  const double seconds_of_all = (now - start_) * num_total_ / num_worked_;
  if (!has_parts_) {
    // The current pass is the best measure for this scene and machine.
    return later_cost / costs_.front() * seconds_of_all;
  }
  if (past_cost_ == 0.0) {
    return 0.0;
  }
  const double seconds_per_cost = past_seconds_ / past_cost_;
  const double other_parts = costs_.front() * seconds_per_cost -
                             (start_ - pass_start_) - seconds_of_all;
  return later_cost * seconds_per_cost + std::max(0.0, other_parts);
}

void Progress::Print(double now) {
  last_print_ = now;
  const std::string text =
      (pass_.empty() ? "" : pass_ + " ") +
      ProgressText(
          num_done_, num_worked_, num_total_, now - start_, LaterSeconds(now));
  if (!is_terminal_) {
    out_ << text << std::endl;
    return;
  }
  const size_t length = std::max(text.size(), line_length_);
  out_ << "\r" << text << std::string(length - text.size(), ' ') << std::flush;
  line_length_ = text.size();
}

}  // namespace tsar
