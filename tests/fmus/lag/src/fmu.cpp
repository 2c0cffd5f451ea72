// SPDX-License-Identifier: Apache-2.0
#include "lag.hpp"
#include "lag/binding.hpp"

#include <fmt/format.h>

namespace mebots::lag {
namespace {

class LagModel final : public fmu::Model {
 public:
  LagModel(Variables& variables, fmu::Host& host) : lag_(variables, host.resources()) {}

  void step(std::int64_t /*start_ns*/, std::int64_t duration_ns) override { lag_.step(duration_ns); }
  void visit(state::Visitor& v) override { lag_.visit(v); }
  std::string on_demand_text(std::string_view /*name*/) const override { return lag_.history_text(); }

 private:
  Lag lag_;
};

}  // namespace

std::unique_ptr<fmu::Model> make_model(Variables& variables, fmu::Host& host, std::int64_t start_ns) {
  host.log(fmu::Severity::info, "events", fmt::format("starts at {} ns", start_ns));
  return std::make_unique<LagModel>(variables, host);
}

}  // namespace mebots::lag
