// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <deque>
#include <string>
#include <string_view>
#include <vector>

/// What `mebots check` found out about an FMU, as plain data.
namespace mebots::check {

/// An error breaks the standard or the FMU; a warning will trouble some tool or user.
enum class Severity { error, warning };

/// The parts of a check, in the order in which they run and are shown.
enum class Group { archive, description, binaries, behaviour };

struct Finding {
  Group group = Group::archive;
  Severity severity = Severity::error;
  std::string text;     ///< what is wrong and where
  std::string way_out;  ///< what to do about it
};

/// One thing that was looked at, whether or not something was found.
struct Check {
  Group group = Group::archive;
  std::string name;     ///< a statement that holds when nothing was found: "reset equals a fresh instance"
  std::string skipped;  ///< why it was not looked at; empty when it was
  std::vector<Finding> findings;
};

struct Report {
  std::string fmu;
  std::string summary;       ///< "FMI 2.0 co-simulation, 54 variables"; empty when the description cannot be read
  std::deque<Check> checks;  // a deque: a check is filled in while others are added

  std::size_t count(Severity severity) const;
  bool clean() const { return count(Severity::error) == 0 && count(Severity::warning) == 0; }
};

std::string_view to_string(Severity severity);
std::string_view to_string(Group group);

/// Collects the findings of one check.
class Findings {
 public:
  Findings(Check& check) : check_(&check) {}  // NOLINT(google-explicit-constructor)

  void error(std::string text, std::string way_out) { add(Severity::error, std::move(text), std::move(way_out)); }
  void warning(std::string text, std::string way_out) { add(Severity::warning, std::move(text), std::move(way_out)); }
  void add(Severity severity, std::string text, std::string way_out) {
    check_->findings.push_back({check_->group, severity, std::move(text), std::move(way_out)});
  }
  bool any() const { return !check_->findings.empty(); }

 private:
  Check* check_;
};

}  // namespace mebots::check
