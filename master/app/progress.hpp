// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "console.hpp"
#include "record/observer.hpp"
#include "run/run.hpp"

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::app {

/// Shows the progress of a run: a bar on a terminal, otherwise a line from time to time. Does not read the clock at
/// every step, because this would slow down short steps.
class Progress final : public master::Observer {
 public:
  Progress(Console& console, std::int64_t start_time_ns, std::int64_t stop_time_ns);

  std::optional<std::string> reached(const master::Point& point) override;
  void ended(const master::Point& point) override;

 private:
  using Clock = std::chrono::steady_clock;

  void look(const master::Point& point);
  void show(const master::Point& point, double elapsed_s);

  Console* console_;
  std::int64_t start_time_ns_;
  std::int64_t stop_time_ns_;
  Clock::time_point start_;
  Clock::time_point last_look_;
  Clock::time_point last_shown_;
  bool begun_ = false;
  std::int64_t start_ns_ = 0;
  std::int64_t next_look_ = 0;
  std::int64_t stride_ = 1;
  int shown_tenths_ = 0;
};

/// Returns a duration such as "1 h 02 min", "3 min 05 s" or "12 s".
std::string duration_text(double seconds);

/// Throws InputError if the run cannot end with one of the expected outcomes.
void check_expected(const master::SystemDescription& system, const std::vector<std::string>& expected);

/// Returns the reason why the run did not end as expected: an error after its end, or an outcome that is not in
/// `expected`. If `expected` is empty, every outcome is expected. Returns an empty text if the run ended as expected.
std::string why_unexpected(const master::Run& run, const std::vector<std::string>& expected);

/// Returns the text as a word of a POSIX shell, in quotes if necessary.
std::string shell_word(std::string_view text);

}  // namespace mebots::app
