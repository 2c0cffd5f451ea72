// SPDX-License-Identifier: Apache-2.0
// The section `coupling`.
#include "reading.hpp"
#include "sections.hpp"

namespace mebots::master::config {
namespace {

double limit(const Node& node) {
  return node.number(data::Limits::positive());
}

BondDescription read_bond(const std::string& name, const Node& node, const SystemDescription& system) {
  Object object(node);
  BondDescription bond;
  bond.name = name;
  bond.place = node.place();
  object.comment("text");
  object.read("effort", bond.effort, variable_of(system));
  object.read("flow", bond.flow, variable_of(system));
  object.read_if("limit", bond.limit, &limit);
  object.finish();
  return bond;
}

}  // namespace

void read_coupling(const Node& node, SystemDescription& system) {
  Object object(node);
  CouplingDescription coupling;
  object.read_if("input_limit", coupling.input_limit, &limit);
  object.visit_if("bonds", [&](const Node& bonds) {
    for (const auto& [name, bond] : bonds.members()) {
      bond.attempt([&, &name = name, &bond = bond] { coupling.bonds.push_back(read_bond(name, bond, system)); });
    }
  });
  object.finish();
  system.coupling = std::move(coupling);
}

}  // namespace mebots::master::config
