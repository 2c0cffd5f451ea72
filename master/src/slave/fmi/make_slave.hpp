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

/// The data that are needed to create an instance.
struct InstanceRequest {
  std::string name;
  std::shared_ptr<Fmu> fmu;
  modeldesc::StructuralValues structural;   ///< values of structural parameters (FMI 3.0)
  std::vector<std::string> log_categories;  ///< categories whose ordinary messages are logged; "*" means all
  TimeGrid grid;                            ///< grid whose points are passed to the FMU as the nearest doubles
};

/// Creates an instance in this process, with the slave class for the FMU's version of FMI. `messages` must outlive the
/// instance. Throws SlaveError if the instance cannot be created.
std::unique_ptr<Slave> make_slave_here(InstanceRequest request, MessageSink& messages);

/// The two interfaces of a co-simulation instance whose events the caller handles.
struct EventParts {
  std::unique_ptr<Slave> slave;
  EventInstance* instance;  ///< points to the same object as `slave`
};

/// Creates an instance as make_slave_here() does. The FMU must be of FMI 3.0 and have an event mode.
EventParts make_event_slave_here(InstanceRequest request, MessageSink& messages);

/// The two interfaces of a model exchange instance.
struct ContinuousParts {
  std::unique_ptr<Slave> slave;
  ContinuousInstance* instance;  ///< points to the same object as `slave`
};

/// Creates an instance as make_slave_here() does. The FMU must support model exchange.
ContinuousParts make_continuous_here(InstanceRequest request, MessageSink& messages);

}  // namespace mebots::master
