// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "platform_list.hpp"

#include <algorithm>
#include <cstddef>
#include <deque>
#include <string>
#include <string_view>
#include <vector>

namespace mebots::check {

/// An error violates the standard or makes the FMU unusable. A warning is a problem for some tools or users.
enum class Severity { error, warning };

/// The strictness of a check. Each level includes the previous levels.
enum class Level {
  interoperable,  ///< problems for other tools that run the FMU
  standard,       ///< requirements of FMI
  pedantic        ///< good practice beyond FMI: rejection of illegal calls, hidden symbols, accuracy
};

/// The parts of a check, in their order.
enum class Group { archive, description, binaries, behaviour };

struct Finding {
  Group group = Group::archive;
  Severity severity = Severity::error;
  Level level = Level::standard;  ///< lowest level that reports the finding
  std::string text;               ///< problem and its place
  std::string way_out;            ///< remedy
};

/// A checked property of an FMU with its findings.
struct Check {
  Group group = Group::archive;
  Level level = Level::standard;  ///< minimum level of all findings
  std::string name;     ///< the property, such as "reset equals a fresh instance"; true if there are no findings
  std::string skipped;  ///< reason why the property was not checked; empty if it was checked
  std::vector<Finding> findings;
};

struct Report {
  std::string fmu;
  std::string summary;  ///< such as "FMI 2.0 co-simulation, 54 variables"; empty if the description cannot be read
  Level level = Level::standard;
  std::size_t hidden_findings = 0;  ///< number of findings above `level`
  std::vector<PlatformNeeds> platforms;
  std::deque<Check> checks;  // a deque, because adding checks must not move earlier ones

  std::size_t count(Severity severity) const;
  bool clean() const { return count(Severity::error) == 0 && count(Severity::warning) == 0; }
};

std::string_view to_string(Severity severity);
std::string_view to_string(Group group);
std::string_view to_string(Level level);
/// Returns the names of the levels, the least strict first.
std::vector<std::string> level_names();
/// Returns the level with this name. Throws Error if the name is unknown.
Level level_named(std::string_view name);

class Findings {
 public:
  Findings(Check& check) : check_(&check), level_(check.level) {}  // NOLINT(google-explicit-constructor)

  /// Returns a Findings object for the same check with a minimum level.
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
