// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "run/run.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace mebots::app {

enum class JunitOutcome { passed, failure, error };

/// One test case of a JUnit file, which CI systems read.
struct JunitCase {
  std::string name;
  JunitOutcome outcome = JunitOutcome::passed;
  std::string message;  ///< unless it passed
  double time_s = 0;
  std::string out;  ///< what it printed; may be empty
};

/// Writes a JUnit file with one suite, named after `classname`. Throws Error.
void write_junit(const std::filesystem::path& file, const std::string& classname, const std::vector<JunitCase>& cases);

/// Writes the run as one test case of a JUnit file, which CI systems read. Passed when it ended with one of the
/// `expected` outcomes (any, when there are none). A failure with another outcome or when it was interrupted, an error
/// with `error` when that is not empty. `run` null = it could not be opened. Throws Error.
void write_junit(const std::filesystem::path& file, const master::Run* run, const std::vector<std::string>& expected,
                 const std::string& error);

}  // namespace mebots::app
