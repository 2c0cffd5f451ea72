// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/time_grid.hpp"
#include "fmi/fmu.hpp"
#include "message/message_hub.hpp"
#include "slave/slave.hpp"

#include <memory>
#include <string>
#include <vector>

namespace mebots::master {

/// What an instance is made from.
struct InstanceRequest {
  std::string name;
  std::shared_ptr<Fmu> fmu;
  modeldesc::StructuralValues structural;   ///< of structural parameters (FMI 3.0)
  std::vector<std::string> log_categories;  ///< whose ordinary messages are passed on, "*" for all
  TimeGrid grid;                            ///< its points are passed to the FMU as the nearest doubles
};

/// Makes an instance in this process, by the adapter of the FMU's version. `messages` must outlive it. Throws
/// SlaveError if the FMU gives no instance.
std::unique_ptr<Slave> make_slave_here(InstanceRequest request, MessageSink& messages);

}  // namespace mebots::master
