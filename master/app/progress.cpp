// SPDX-License-Identifier: Apache-2.0
#include "progress.hpp"

#include "base/time.hpp"
#include "mebots/input_error.hpp"
#include "mebots/nearest_names.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

namespace mebots::app {
namespace {

using master::to_seconds;

constexpr double kLookEveryS = 0.1;  // time between two updates of the bar
constexpr double kLineEveryS = 5.0;  // maximum time between plain lines in a long run
// Minimum time between two plain lines. Without this limit, each tenth of a short run would print a line.
constexpr double kLineSoonestS = 1.0;
constexpr std::size_t kWidestBar = 40;
constexpr std::size_t kNarrowestBar = 5;
constexpr std::int64_t kLongestStride = 1 << 16;

}  // namespace

std::string duration_text(double seconds) {
  const auto whole = static_cast<std::int64_t>(std::ceil(std::min(seconds, 1e9)));
  if (whole >= 3600) return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
  if (whole >= 60) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} s", whole);
}

Progress::Progress(Console& console, std::int64_t start_time_ns, std::int64_t stop_time_ns)
    : console_(&console),
      start_time_ns_(start_time_ns),
      stop_time_ns_(stop_time_ns),
      start_(Clock::now()),
      last_look_(start_),
      last_shown_(start_) {}

std::optional<std::string> Progress::reached(const master::Point& point) {
  if (!begun_) {  // the start, or the first step after a checkpoint
    begun_ = true;
    start_ = last_look_ = last_shown_ = Clock::now();
    start_ns_ = point.time_ns;
    next_look_ = point.step + 1;
  } else if (point.step >= next_look_) {
    look(point);
  }
  return std::nullopt;
}

void Progress::look(const master::Point& point) {
  const auto now = Clock::now();
  const double since_look_s = std::chrono::duration<double>(now - last_look_).count();
  // Adapts the number of steps between two reads of the clock, so that it is read about every kLookEveryS seconds.
  if (since_look_s < kLookEveryS / 2) stride_ = std::min(stride_ * 2, kLongestStride);
  if (since_look_s > kLookEveryS * 2) stride_ = std::max<std::int64_t>(stride_ / 2, 1);
  last_look_ = now;
  next_look_ = point.step + stride_;

  const double since_shown_s = std::chrono::duration<double>(now - last_shown_).count();
  const auto tenths = static_cast<int>(10 * (point.time_ns - start_time_ns_) / (stop_time_ns_ - start_time_ns_));
  const bool due = console_->is_terminal()
                       ? since_shown_s >= kLookEveryS
                       : since_shown_s >= kLineEveryS || (tenths > shown_tenths_ && since_shown_s >= kLineSoonestS);
  if (!due) return;
  last_shown_ = now;
  shown_tenths_ = tenths;
  show(point, std::chrono::duration<double>(now - start_).count());
}

void Progress::show(const master::Point& point, double elapsed_s) {
  const double done =
      static_cast<double>(point.time_ns - start_time_ns_) / static_cast<double>(stop_time_ns_ - start_time_ns_);
  const double factor = to_seconds(point.time_ns - start_ns_) / elapsed_s;
  const auto text = fmt::format("{:3.0f} %  {:.3f} of {} s  {:.3g} x real time  {} left", std::floor(done * 100),
                                to_seconds(point.time_ns), to_seconds(stop_time_ns_), factor,
                                duration_text(to_seconds(stop_time_ns_ - point.time_ns) / factor));
  if (!console_->is_terminal()) {
    console_->line(text);
    return;
  }
  // A line must not wrap, because a wrapped line cannot be redrawn. The bar takes the space next to the text. If this
  // space is too small, truncates the text.
  const auto width = Console::width() - 1;
  const auto room = width > text.size() + 3 ? width - text.size() - 3 : 0;
  if (room < kNarrowestBar) {
    console_->redraw(text.substr(0, width));
    return;
  }
  const auto bar = std::min(room, kWidestBar);
  const auto filled = static_cast<std::size_t>(done * static_cast<double>(bar));
  console_->redraw(fmt::format("[{}{}] {}", std::string(filled, '#'), std::string(bar - filled, '.'), text));
}

void Progress::ended(const master::Point& /*point*/) {
  console_->redraw("");
}

std::string why_unexpected(const master::Run& run, const std::vector<std::string>& expected) {
  const auto outcome = run.outcome();
  if (!run.report().faults.empty())
    return fmt::format("error after the end of the run: {}", run.report().faults.front());
  if (expected.empty() || std::ranges::find(expected, outcome) != expected.end()) return "";
  return fmt::format("the outcome is '{}', and {} was expected", outcome, fmt::join(expected, " or "));
}

void check_expected(const master::SystemDescription& system, const std::vector<std::string>& expected) {
  std::vector<std::string> known = {"completed", "interrupted", "failed"};
  for (const auto& outcome : system.outcomes) known.push_back(outcome.outcome);
  for (const auto& wanted : expected) {
    if (std::ranges::find(known, wanted) != known.end()) continue;
    throw InputError(ErrorCode::unknown_name, fmt::format("--expect: this run cannot have the outcome '{}'. {}", wanted,
                                                          suggest(wanted, known)));
  }
}

std::string shell_word(std::string_view text) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("/._-+=:,@%").find(c) != std::string_view::npos;
  };
  if (!text.empty() && std::ranges::all_of(text, plain)) return std::string(text);
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? "'\\''" : std::string(1, c);
  return word + "'";
}

}  // namespace mebots::app
