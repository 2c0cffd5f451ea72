// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

namespace mebots::master {

/// Compares the rows of one file with the times at which a run needs its signals.
class SignalCoverage {
 public:
  SignalCoverage(ResolvedSystem& system, std::string file) : system_(system), file_(std::move(file)) {}

  /// Throws InputError if the run needs times that the file does not have, and the description does not let the first
  /// or last values hold there.
  void check(const OverrideDescription& description, const ResolvedVariable& variable, const Signal& signal);
  /// Adds what check() found to the system's notices.
  void tell();

 private:
  struct Changes {
    std::size_t late = 0;  // jumps, and changes of held values, that take effect at the next point only
    std::size_t skipped = 0;
    std::size_t rows = 0;
    std::int64_t first_ns = 0;  // of the late ones
  };

  void check_rows(const ResolvedVariable& variable, const Signal& signal);

  ResolvedSystem& system_;
  std::string file_;
  bool starts_late_ = false;
  bool ends_early_ = false;
  std::int64_t first_ns_ = 0;
  std::int64_t last_ns_ = 0;
  std::map<std::size_t, Changes> changes_;  // by instance
};

}  // namespace mebots::master
