// SPDX-License-Identifier: Apache-2.0
#include "plain_run.hpp"

#include "fmi/fmu.hpp"
#include "mebots/error.hpp"
#include "message/message_hub.hpp"
#include "slave/fmi/make_slave.hpp"

#include <fmt/format.h>

#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

namespace mebots::check {
namespace {

/// Reads all scalar Real outputs without Clocks. Throws SlaveError if an output is NaN or infinite.
void read_finite_outputs(master::Slave& slave) {
  for (const auto& variable : slave.description().variables) {
    const bool is_number = variable.type == modeldesc::Type::real && variable.fmi3->dimensions.empty();
    const bool is_readable = variable.causality == modeldesc::Causality::output && variable.fmi3->clocks.empty();
    if (!is_number || !is_readable) continue;
    double value = 0;
    slave.get_reals({&variable.value_reference, 1}, {&value, 1});
    if (!std::isfinite(value)) throw master::NotFiniteError(fmt::format("{} is {}", variable.name, value));
  }
}

void step_plainly(master::Slave& slave, std::int64_t start_ns, std::int64_t duration_ns) {
  static constexpr std::atomic<bool> kNotCancelled{false};
  auto result = slave.step(start_ns, duration_ns);
  if (result.pending) result = slave.finish_step(kNotCancelled);
  if (!result.done) throw master::SlaveError(fmt::format("its step did not end. {}", result.messages));
  read_finite_outputs(slave);
}

}  // namespace

void run_plainly(const std::filesystem::path& archive, const std::filesystem::path& folder, int instances,
                 double step_s, Witness& witness) {
  witness.doing("a plain run");
  try {
    const auto step_ns = std::llround(step_s * 1e9);
    const auto fmu = std::make_shared<master::Fmu>(archive, folder, master::FmuKind::co_simulation);
    master::MessageHub messages;
    std::vector<std::unique_ptr<master::Slave>> slaves;
    for (int i = 0; i < instances; ++i)
      slaves.push_back(master::make_slave_here({fmt::format("fmu{}", i + 1), fmu, {}, {}, {}}, messages));
    for (const auto& slave : slaves) {
      slave->setup_experiment({});
      slave->enter_initialization();
      slave->exit_initialization();
      read_finite_outputs(*slave);
    }
    for (int k = 0; k < kPlainSteps; ++k)
      for (const auto& slave : slaves) step_plainly(*slave, k * step_ns, step_ns);
    for (const auto& slave : slaves) slave->terminate();
  } catch (const Error& error) {
    witness.error(error.what(), "correct what the message names");
  }
}

}  // namespace mebots::check
