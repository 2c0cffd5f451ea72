// SPDX-License-Identifier: Apache-2.0
#include "walk.hpp"
#include "walk/binding.hpp"

namespace mebots::walk {
namespace {

class WalkModel final : public fmu::Model {
 public:
  explicit WalkModel(Variables& variables) : walk_(variables) {}

  void step(std::int64_t /*start_ns*/, std::int64_t /*duration_ns*/) override { walk_.step(); }
  void visit(state::Visitor& v) override { walk_.visit(v); }

 private:
  Walk walk_;
};

}  // namespace

std::unique_ptr<fmu::Model> make_model(Variables& variables, fmu::Host& /*host*/, std::int64_t /*start_ns*/) {
  return std::make_unique<WalkModel>(variables);
}

}  // namespace mebots::walk
