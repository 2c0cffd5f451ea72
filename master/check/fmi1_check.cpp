// SPDX-License-Identifier: Apache-2.0
#include "fmi1_check.hpp"

#include "mebots/fmi1/library.hpp"
#include "mebots/modeldesc/elf_library.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <set>
#include <variant>

namespace mebots::check {

using modeldesc::Causality;
using modeldesc::ModelDescription;
using modeldesc::Variability;

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

}  // namespace mebots::check
