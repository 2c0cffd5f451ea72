// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "record/observer.hpp"
#include "run/summary.hpp"

#include <string_view>

namespace mebots::master {

/// Adds the list of written variables to checkpoints and saved states, so that a resumed run also lists them.
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
