// SPDX-License-Identifier: Apache-2.0
#include "fmi1_check.hpp"

#include "fmi/fmu.hpp"
#include "mebots/fmi1/library.hpp"
#include "mebots/modeldesc/elf_library.hpp"
#include "message/message_hub.hpp"
#include "slave/fmi/fmi1_slave.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <variant>

namespace mebots::check {
namespace {

using modeldesc::Causality;
using modeldesc::ModelDescription;
using modeldesc::Variability;

constexpr std::int64_t kPlainStep_ns = 10'000'000;
constexpr int kPlainSteps = 20;

/// Reads all outputs. Throws SlaveError if one of them is not finite.
void read_finite_outputs(master::Slave& slave) {
  for (const auto& variable : slave.description().variables) {
    if (variable.causality != Causality::output || variable.type != modeldesc::Type::real) continue;
    double value = 0;
    slave.get_reals({&variable.value_reference, 1}, {&value, 1});
    if (!std::isfinite(value)) throw master::NotFiniteError(fmt::format("{} is {}", variable.name, value));
  }
}

void step_plainly(master::Slave& slave, std::int64_t start_ns) {
  static constexpr std::atomic<bool> kNotCancelled{false};
  auto result = slave.step(start_ns, kPlainStep_ns);
  if (result.pending) result = slave.finish_step(kNotCancelled);
  if (!result.done) throw master::SlaveError(fmt::format("fmiDoStep did not finish its step. {}", result.messages));
  read_finite_outputs(slave);
}

}  // namespace

void check_fmi1_variables(const ModelDescription& model, Findings findings) {
  for (const auto& fault : model.structure_faults)
    findings.error("modelDescription.xml, " + fault, "give each variable its own name, and name existing inputs");
  for (const auto& variable : model.variables) {
    const bool has_start = !std::holds_alternative<std::monostate>(variable.start);
    if (!has_start && (variable.causality == Causality::input || variable.variability == Variability::constant))
      findings.at(Level::pedantic)
          .warning(fmt::format("\"{}\" has no start value, although it is {}", variable.name,
                               variable.causality == Causality::input ? "an input" : "a constant"),
                   "set start");
  }
}

void check_fmi1_symbols(const ModelDescription& model, const std::filesystem::path& library, Findings findings) {
  const auto exports = modeldesc::read_elf_library(library).exports();
  const std::set<std::string> names(exports.begin(), exports.end());
  const auto prefix = model.co_simulation->model_identifier + "_";
  std::vector<std::string> missing;
  fmi1::for_each_function([&](const char* name, auto, fmi1::Need) {
    if (!names.contains(prefix + name)) missing.push_back(prefix + name);
  });
  if (missing.empty()) return;
  findings.error(
      fmt::format("{} lacks {}", library.filename().string(), fmt::join(missing, ", ")),
      "export them with default visibility and C linkage; a function that the FMU does not offer returns fmiError");
}

void run_fmi1_plainly(const std::filesystem::path& archive, const std::filesystem::path& folder, int instances,
                      Witness& witness) {
  witness.doing("a plain run");
  try {
    const auto fmu = std::make_shared<master::Fmu>(archive, folder);
    master::MessageHub messages;
    std::vector<std::unique_ptr<master::Fmi1Slave>> slaves;
    for (int i = 0; i < instances; ++i)
      slaves.push_back(
          std::make_unique<master::Fmi1Slave>(fmt::format("fmu{}", i + 1), fmu, std::vector<std::string>{}, messages));
    for (const auto& slave : slaves) {
      slave->setup_experiment({});
      slave->enter_initialization();
      slave->exit_initialization();
      read_finite_outputs(*slave);
    }
    for (int k = 0; k < kPlainSteps; ++k)
      for (const auto& slave : slaves) step_plainly(*slave, k * kPlainStep_ns);
    for (const auto& slave : slaves) slave->terminate();
  } catch (const Error& error) {
    witness.error(error.what(), "correct what the message names");
  }
}

}  // namespace mebots::check
