// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

/// What `mebots check` found out about an FMU, as plain data.
namespace mebots::check {

/// An error breaks the standard or the FMU; a warning will trouble some tool or user.
enum class Severity { error, warning };

/// How strict a check is: each level has the findings of those before it.
enum class Level {
  interoperable,  ///< what keeps other tools from running the FMU, or it from leaving them alone
  standard,       ///< what FMI demands
  pedantic        ///< what a careful author does beyond: answers to illegal calls, hidden symbols, accuracy
};

/// The parts of a check, in the order in which they run and are shown.
enum class Group { archive, description, binaries, behaviour };

struct Finding {
  Group group = Group::archive;
  Severity severity = Severity::error;
  Level level = Level::standard;  ///< the first at which it is told
  std::string text;               ///< what is wrong and where
  std::string way_out;            ///< what to do about it
};

/// One thing that was looked at, whether or not something was found.
struct Check {
  Group group = Group::archive;
  Level level = Level::standard;  ///< of its findings, but for those that say another
  std::string name;               ///< a statement that holds when nothing was found: "reset equals a fresh instance"
  std::string skipped;            ///< why it was not looked at; empty when it was
  std::vector<Finding> findings;
};

struct Report {
  std::string fmu;
  std::string summary;  ///< "FMI 2.0 co-simulation, 54 variables"; empty when the description cannot be read
  Level level = Level::standard;
  std::size_t untold = 0;    ///< findings of higher levels
  std::deque<Check> checks;  // a deque: a check is filled in while others are added

  std::size_t count(Severity severity) const;
  bool clean() const { return count(Severity::error) == 0 && count(Severity::warning) == 0; }
};

std::string_view to_string(Severity severity);
std::string_view to_string(Group group);
std::string_view to_string(Level level);
/// The levels' names, least strict first.
std::vector<std::string> level_names();
/// Throws mebots::Error for what is none of them.
Level level_named(std::string_view name);

/// Collects the findings of one check.
class Findings {
 public:
  Findings(Check& check) : check_(&check), level_(check.level) {}  // NOLINT(google-explicit-constructor)

  /// Of the same check, at this level if it is higher.
  Findings at(Level level) const {
    Findings other = *this;
    other.level_ = std::max(level_, level);
    return other;
  }
  void error(std::string text, std::string way_out) { add(Severity::error, std::move(text), std::move(way_out)); }
  void warning(std::string text, std::string way_out) { add(Severity::warning, std::move(text), std::move(way_out)); }
  void add(Severity severity, std::string text, std::string way_out) {
    check_->findings.push_back({check_->group, severity, level_, std::move(text), std::move(way_out)});
  }
  bool any() const { return !check_->findings.empty(); }

 private:
  Check* check_;
  Level level_;
};

}  // namespace mebots::check
