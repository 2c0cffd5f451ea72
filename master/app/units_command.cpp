// SPDX-License-Identifier: Apache-2.0
#include "command.hpp"

#include "mebots/modeldesc/units.hpp"

#include <fmt/format.h>

#include <string>

namespace mebots::app {
namespace {

void print_units() {
  std::string text = fmt::format("{:<6} {:<22} {:<18} {:>24} {:>8}\n", "unit", "", "SI base", "factor", "offset");
  for (const auto& known : modeldesc::known_units()) {
    const auto& unit = known.unit;
    text += fmt::format("{:<6} {:<22} {:<18} {:>24} {:>8}\n", unit.name, known.text, modeldesc::base_unit_text(unit),
                        unit.factor, unit.offset);
  }
  text +=
      "\nvalue in SI units = factor x value + offset. Products of powers of these are units, too, in the notation of "
      "FMI:\n"
      "m/s2, kg.m2, rad/(s.V), 1/s, s-1. In a product a unit with an offset counts as a difference.\n";
  print_product(text);
}

}  // namespace

void add_units(CLI::App& app, Action& action) {
  auto* command = app.add_subcommand("units", "List the units that a description may use, with dimension and factor");
  command->footer(help_footer({"0 printed", "1 standard output is closed or full"}, {"mebots units"}));
  command->callback([&action] { action = [] { return guarded(&print_units); }; });
}

}  // namespace mebots::app
