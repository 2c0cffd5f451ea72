// SPDX-License-Identifier: Apache-2.0
#include "slave/fmi/make_slave.hpp"

#include "slave/fmi/fmi1_slave.hpp"
#include "slave/fmi/fmi2_model_exchange.hpp"
#include "slave/fmi/fmi2_slave.hpp"
#include "slave/fmi/fmi3_model_exchange.hpp"
#include "slave/fmi/fmi3_slave.hpp"

#include <utility>

namespace mebots::master {

std::unique_ptr<Slave> make_slave_here(InstanceRequest request, MessageSink& messages) {
  auto& [name, fmu, structural, log_categories, grid] = request;
  if (fmu->description().is_fmi1())
    return std::make_unique<Fmi1Slave>(std::move(name), fmu, std::move(log_categories), messages, grid);
  if (!fmu->description().is_fmi3()) {
    return std::make_unique<Fmi2Slave>(std::move(name), fmu, std::move(log_categories), messages, grid);
  }
  auto model = fmu->model(structural);
  return std::make_unique<Fmi3Slave>(std::move(name), fmu, std::move(model), structural, std::move(log_categories),
                                     messages, grid);
}

EventParts make_event_slave_here(InstanceRequest request, MessageSink& messages) {
  auto& [name, fmu, structural, log_categories, grid] = request;
  auto model = fmu->model(structural);
  auto slave = std::make_unique<Fmi3Slave>(std::move(name), fmu, std::move(model), structural,
                                           std::move(log_categories), messages, grid, EventHandler::group);
  auto* const instance = slave.get();
  return {std::move(slave), instance};
}

ContinuousParts make_continuous_here(InstanceRequest request, MessageSink& messages) {
  const auto parts_of = [](auto slave) {
    auto* const instance = slave.get();
    return ContinuousParts{std::move(slave), instance};
  };
  auto& [name, fmu, structural, log_categories, grid] = request;
  if (!fmu->description().is_fmi3()) {
    return parts_of(
        std::make_unique<Fmi2ModelExchange>(std::move(name), fmu, std::move(log_categories), messages, grid));
  }
  auto model = fmu->model(structural);
  return parts_of(std::make_unique<Fmi3ModelExchange>(std::move(name), fmu, std::move(model), structural,
                                                      std::move(log_categories), messages, grid));
}

}  // namespace mebots::master
