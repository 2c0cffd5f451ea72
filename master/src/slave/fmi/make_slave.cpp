// SPDX-License-Identifier: Apache-2.0
#include "slave/fmi/make_slave.hpp"

#include "slave/fmi/fmi2_slave.hpp"
#include "slave/fmi/fmi3_slave.hpp"

#include <utility>

namespace mebots::master {

std::unique_ptr<Slave> make_slave_here(InstanceRequest request, MessageSink& messages) {
  auto& [name, fmu, structural, log_categories, grid] = request;
  if (!fmu->description().is_fmi3()) {
    return std::make_unique<Fmi2Slave>(std::move(name), fmu, std::move(log_categories), messages, grid);
  }
  auto model = fmu->model(structural);
  return std::make_unique<Fmi3Slave>(std::move(name), fmu, std::move(model), structural, std::move(log_categories),
                                     messages, grid);
}

}  // namespace mebots::master
