// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/time_grid.hpp"
#include "fmi/fmu.hpp"
#include "message/message_hub.hpp"
#include "slave/clocked/event_instance.hpp"
#include "slave/slave.hpp"
#include "solver/continuous_instance.hpp"

#include <memory>
#include <string>
#include <vector>

namespace mebots::master {

/// The data from which an instance is created.
struct InstanceRequest {
  std::string name;
  std::shared_ptr<Fmu> fmu;
  modeldesc::StructuralValues structural;   ///< of structural parameters (FMI 3.0)
  std::vector<std::string> log_categories;  ///< their ordinary messages are delivered, "*" for all
  TimeGrid grid;                            ///< its points are passed to the FMU as the nearest doubles
};

/// Creates an instance in this process with the slave class for the FMU's version of FMI. `messages` must outlive the
/// instance. Throws SlaveError if instantiation fails.
std::unique_ptr<Slave> make_slave_here(InstanceRequest request, MessageSink& messages);

/// Both interfaces of a co-simulation instance whose caller handles its events.
struct EventParts {
  std::unique_ptr<Slave> slave;
  EventInstance* instance;  ///< the same object
};

/// Works as make_slave_here(), for an FMI 3.0 FMU with an event mode.
EventParts make_event_slave_here(InstanceRequest request, MessageSink& messages);

/// Both interfaces of a model exchange instance.
struct ContinuousParts {
  std::unique_ptr<Slave> slave;
  ContinuousInstance* instance;  ///< the same object
};

/// Works as make_slave_here(), for a model exchange FMU.
ContinuousParts make_continuous_here(InstanceRequest request, MessageSink& messages);

}  // namespace mebots::master
