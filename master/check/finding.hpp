// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "platform_list.hpp"

#include <algorithm>
#include <cstddef>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

/// The findings of `mebots check` about an FMU as plain data.
namespace mebots::check {

/// An error violates the standard or breaks the FMU; a warning will affect some tools or users.
enum class Severity { error, warning };

/// The strictness of a check: each level includes the findings of the previous levels.
enum class Level {
  interoperable,  ///< problems that keep other tools from running the FMU, or that affect them
  standard,       ///< requirements of FMI
  pedantic        ///< good practice beyond FMI: rejection of illegal calls, hidden symbols, accuracy
};

/// The parts of a check, in the order of execution and display.
enum class Group { archive, description, binaries, behaviour };

struct Finding {
  Group group = Group::archive;
  Severity severity = Severity::error;
  Level level = Level::standard;  ///< the lowest level that reports it
  std::string text;               ///< the problem and its place
  std::string way_out;            ///< the remedy
};

/// An item that was checked, with its findings.
struct Check {
  Group group = Group::archive;
  Level level = Level::standard;  ///< of its findings, unless they have their own
  std::string name;               ///< a statement that holds if nothing was found: "reset equals a fresh instance"
  std::string skipped;            ///< why it was not checked; empty if it was
  std::vector<Finding> findings;
};

struct Report {
  std::string fmu;
  std::string summary;  ///< "FMI 2.0 co-simulation, 54 variables"; empty if the description cannot be read
  Level level = Level::standard;
  std::size_t hidden_findings = 0;  ///< number of findings of higher levels
  std::vector<PlatformNeeds> platforms;
  std::deque<Check> checks;  // a deque, because a check is filled in while others are added

  std::size_t count(Severity severity) const;
  bool clean() const { return count(Severity::error) == 0 && count(Severity::warning) == 0; }
};

std::string_view to_string(Severity severity);
std::string_view to_string(Group group);
std::string_view to_string(Level level);
/// Returns the names of the levels, least strict first.
std::vector<std::string> level_names();
/// Throws mebots::Error for an unknown name.
Level level_named(std::string_view name);

/// Collects findings of one check.
class Findings {
 public:
  Findings(Check& check) : check_(&check), level_(check.level) {}  // NOLINT(google-explicit-constructor)

  /// Returns a collector for the same check. Its level is `level` or the present level, whichever is higher.
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
