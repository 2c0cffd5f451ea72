// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "run/run.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace mebots::app {

enum class JunitOutcome { passed, failure, error };

/// A test case in a JUnit file, which CI systems read.
struct JunitCase {
  std::string name;
  JunitOutcome outcome = JunitOutcome::passed;
  std::string message;  ///< empty if it passed
  double time_s = 0;
  std::string out;  ///< its output; may be empty
};

/// Writes a JUnit file with one suite, named `classname`. Throws Error.
void write_junit(const std::filesystem::path& file, const std::string& classname, const std::vector<JunitCase>& cases);

/// Writes the run as one test case of a JUnit file. The test case passes if the run ended with one of the `expected`
/// outcomes, or if `expected` is empty. Another outcome, or an interrupt, is a failure. If `error` is not empty, the
/// test case has an error. `run` is null if the run could not be opened. Throws Error.
void write_junit(const std::filesystem::path& file, const master::Run* run, const std::vector<std::string>& expected,
                 const std::string& error);

}  // namespace mebots::app
