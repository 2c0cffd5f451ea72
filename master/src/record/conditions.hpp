// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "engine/ensemble.hpp"
#include "record/observer.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace mebots::master {

/// One variable compared with one value.
class Condition {
 public:
  /// Throws InputError for an unknown variable or a value that does not fit its type.
  Condition(const ResolvedSystem& system, Ensemble& ensemble, const ConditionDescription& description);

  bool holds() const;
  /// "world.drone.landed = true"
  const std::string& text() const { return text_; }

 private:
  const Ensemble* ensemble_;
  SignalId signal_;
  Comparison comparison_;
  double number_ = 0;  // Integers, Booleans (0 and 1) and enumerations too
  std::string string_;
  std::string text_;
};

/// Ends a run as soon as one of the conditions has held for its time.
class StopConditions final : public Observer {
 public:
  StopConditions(const ResolvedSystem& system, Ensemble& ensemble);

  std::optional<std::string> reached(const Point& point) override;
  void visit(state::Visitor& v) override;
  std::string_view state_name() const override { return "stop_conditions"; }

 private:
  struct Watch {
    Condition condition;
    std::int64_t for_ns;
    std::optional<std::int64_t> since_ns = {};  // start of the time for which it has held without a break

    void visit(state::Visitor& v) { v("since_ns", since_ns); }
  };

  TimeGrid grid_;
  std::vector<Watch> watches_;
};

/// Says what came of a run: the first outcome of the config whose conditions all hold, else "completed".
class Outcomes final : public Observer {
 public:
  Outcomes(const ResolvedSystem& system, Ensemble& ensemble);

  std::optional<std::string> reached(const Point& point) override;
  void visit(state::Visitor& v) override;
  std::string_view state_name() const override { return "outcomes"; }

  /// At the point that was reached last.
  std::string outcome() const;

 private:
  struct Watch {
    Condition condition;
    bool ever;
    bool held = false;  // at some point so far; only for `ever`

    void visit(state::Visitor& v) { v("held", held); }
  };
  struct Rule {
    std::string outcome;
    std::vector<Watch> watches;

    void visit(state::Visitor& v) { v("watches", std::span(watches)); }
  };

  std::vector<Rule> rules_;
};

}  // namespace mebots::master
