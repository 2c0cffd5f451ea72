// SPDX-License-Identifier: Apache-2.0
#include "board/chip.hpp"
#include "fmu/model.hpp"
#include "fmu_soc/binding.hpp"
#include "mebots/fmu/model.hpp"

namespace mebots::soc {
namespace {

class Instance final : public fmu::Model {
 public:
  Instance(Variables& variables, const fmu::Host& host, std::int64_t start_ns, const Listeners& listeners)
      : model_(variables, host.resources(), listeners) {
    model_.start(start_ns);
  }

  void step(std::int64_t start_ns, std::int64_t duration_ns) override { model_.step(start_ns, duration_ns); }
  void visit(state::Visitor& v) override { model_.visit(v); }

 private:
  soc::Model model_;
};

}  // namespace

std::unique_ptr<fmu::Model> make_model(Variables& variables, fmu::Host& host, std::int64_t start_ns) {
  Listeners listeners;
  listeners.console = [&host](std::string_view line) { host.log(fmu::Severity::info, "console", line); };
  listeners.faults = [&host](std::string_view text) { host.log(fmu::Severity::warning, "faults", text); };
  listeners.observe = [&host](std::string_view text) { host.log(fmu::Severity::warning, "observe", text); };
  return std::make_unique<Instance>(variables, host, start_ns, listeners);
}

}  // namespace mebots::soc

void mebots::fmu::prepare_shared_tables() {
  static_cast<void>(soc::gap8());
  static_cast<void>(soc::gap8_silicon());
}

/// Declares that instances share no state. Static memory only contains tables of chips and instructions, which do not
/// change after they were built.
// NOLINTNEXTLINE(readability-identifier-naming): the name that docs/master/clean-fmus.md gives
extern "C" [[gnu::visibility("default")]] const char mebots_keeps_no_state_outside_instances = 1;
