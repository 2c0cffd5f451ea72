// SPDX-License-Identifier: Apache-2.0
#include "resolve/signal_coverage.hpp"

#include "base/time.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace mebots::master {

void SignalCoverage::check(const OverrideDescription& description, const ResolvedVariable& variable,
                           const Signal& signal) {
  const auto& system = *system_.description;
  const auto& times = signal.times();
  first_ns_ = times.ns(0);
  last_ns_ = times.ns(times.size() - 1);
  const auto from_ns = std::max(system.start_time_ns, description.from_ns);
  // A signal of an input is needed until the start of the FMU's last step. A signal that replaces an output is needed
  // until the end of the run.
  const bool is_output = variable.variable->causality == modeldesc::Causality::output;
  const auto steps = system_.instances[variable.instance].description->steps;
  const auto grid = system.grid();
  const auto last_ns = grid.time_ns(grid.point_at(system.stop_time_ns) - (is_output ? 0 : steps));
  const auto until_ns = description.until_ns ? std::min(*description.until_ns, last_ns) : last_ns;
  const bool late = from_ns < first_ns_;
  const bool early = until_ns > last_ns_;
  const auto refuse = [&](const std::string& what, std::string_view key) {
    throw InputError(
        ErrorCode::invalid_value,
        fmt::format("{}: {}: {}. Let the file cover the run, or remove \"{}\": \"error\" so that the value "
                    "is held",
                    description.place, file_, what, key));
  };
  if (late && description.file->covers_start) {
    refuse(fmt::format("the first row is at {} s, and '{}' needs a value at {} s", to_seconds(first_ns_),
                       system_.text(variable), to_seconds(from_ns)),
           "before");
  }
  if (early && description.file->covers_end) {
    refuse(fmt::format("the last row is at {} s, and '{}' needs a value at {} s", to_seconds(last_ns_),
                       system_.text(variable), to_seconds(until_ns)),
           "after");
  }
  starts_late_ |= late;
  ends_early_ |= early;
  check_rows(variable, signal);
}

void SignalCoverage::check_rows(const ResolvedVariable& variable, const Signal& signal) {
  const auto& system = *system_.description;
  const auto grid = system.grid();
  const auto steps = system_.instances[variable.instance].description->steps;
  const auto& times = signal.times();
  Changes changes;
  for (std::size_t row = 1; row < times.size(); ++row) {
    const auto time_ns = times.ns(row);
    if (time_ns <= system.start_time_ns || time_ns >= system.stop_time_ns) continue;
    ++changes.rows;
    const auto point = grid.point_at(time_ns);
    if (point % steps == 0 && grid.time_ns(point) == time_ns) continue;
    const bool jump = times.ns(row - 1) == time_ns;
    if (signal.linear() ? jump : signal.differ(row - 1, row)) {
      if (changes.late++ == 0) changes.first_ns = time_ns;
    } else if (grid.point_at(times.ns(row - 1)) / steps == point / steps) {
      ++changes.skipped;  // both rows are between the same two communication points
    }
  }
  auto& most = changes_[variable.instance];
  if (changes.late + changes.skipped > most.late + most.skipped) most = changes;
}

void SignalCoverage::add_notices() {
  auto& notices = system_.notices;
  if (starts_late_) {
    notices.push_back(
        fmt::format("{}: the first row is at {} s; before it, the first values hold", file_, to_seconds(first_ns_)));
  }
  if (ends_early_) {
    notices.push_back(
        fmt::format("{}: the last row is at {} s; after it, the last values hold", file_, to_seconds(last_ns_)));
  }
  for (const auto& [instance, changes] : changes_) {
    const auto& description = *system_.instances[instance].description;
    const auto points = fmt::format("between the communication points of '{}' (every {} s)", description.name,
                                    time_text(system_.description->step_of(description)));
    if (changes.late > 0) {
      notices.push_back(
          fmt::format("{}: {} jumps or changes of held values are {}, the first at {} s; each takes effect "
                      "at the next point",
                      file_, changes.late, points, to_seconds(changes.first_ns)));
    }
    if (changes.skipped > 0) {
      notices.push_back(
          fmt::format("{}: {} of {} rows are skipped, because several rows are {}. Use a smaller step to include them",
                      file_, changes.skipped, changes.rows, points));
    }
  }
}

}  // namespace mebots::master
