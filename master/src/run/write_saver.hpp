// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "record/observer.hpp"
#include "run/summary.hpp"

#include <string_view>

namespace mebots::master {

/// Stores the list of written variables in checkpoints and saved states, so that a run that continues from there lists
/// them, too.
class WriteSaver final : public Observer {
 public:
  explicit WriteSaver(RunReport& report) : report_(&report) {}

  void visit(state::Visitor& v) override {
    v("listed", report_->writes);
    v("further", report_->further_writes);
  }
  std::string_view state_name() const override { return "writes"; }

 private:
  RunReport* report_;
};

}  // namespace mebots::master
