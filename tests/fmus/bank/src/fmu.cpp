// SPDX-License-Identifier: Apache-2.0
#include "bank.hpp"
#include "bank/binding.hpp"

namespace mebots::bank {
namespace {

/// Binds the model. The model needs no resources, so the importing tool need not pass their path.
class BankModel final : public fmu::Model {
 public:
  explicit BankModel(Variables& variables) : variables_(variables), bank_(variables.parameters) {
    bank_.start(variables.inputs, variables.outputs);
  }

  void step(std::int64_t /*start_ns*/, std::int64_t duration_ns) override {
    bank_.step(variables_.inputs, duration_ns, variables_.outputs);
  }
  void visit(state::Visitor& v) override { bank_.visit(v); }

 private:
  Variables& variables_;
  Bank bank_;
};

}  // namespace

std::unique_ptr<fmu::Model> make_model(Variables& variables, fmu::Host& /*host*/, std::int64_t /*start_ns*/) {
  return std::make_unique<BankModel>(variables);
}

}  // namespace mebots::bank
