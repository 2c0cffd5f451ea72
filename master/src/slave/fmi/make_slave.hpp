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

struct InstanceRequest {
  std::string name;
  std::shared_ptr<Fmu> fmu;
  modeldesc::StructuralValues structural;   ///< values of structural parameters (FMI 3.0)
  std::vector<std::string> log_categories;  ///< categories whose ordinary messages are logged; "*" selects all
  TimeGrid grid;                            ///< communication points; the FMU receives the nearest doubles
};

/// Creates an instance in this process. Throws SlaveError if this fails. `messages` must outlive the instance.
std::unique_ptr<Slave> make_slave_here(InstanceRequest request, MessageSink& messages);

/// A co-simulation instance whose events the caller handles.
struct EventParts {
  std::unique_ptr<Slave> slave;
  EventInstance* instance;  ///< the same object as `slave`
};

/// Creates an instance like make_slave_here(). The FMU must be of FMI 3.0 and have an event mode.
EventParts make_event_slave_here(InstanceRequest request, MessageSink& messages);

struct ContinuousParts {
  std::unique_ptr<Slave> slave;
  ContinuousInstance* instance;  ///< the same object as `slave`
};

/// Creates an instance like make_slave_here(). The FMU must support model exchange.
ContinuousParts make_continuous_here(InstanceRequest request, MessageSink& messages);

}  // namespace mebots::master
