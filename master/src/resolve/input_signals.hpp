// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "model/resolved_system.hpp"

namespace mebots::master {

/// Reads the files of signals that a system names under `inputs` and in its scenario, each once. Fills `inputs` and
/// `scenario_signals`. Notices say which units were converted, where values are held outside a file's rows, and which
/// changes fall between communication points. Throws InputError for files, columns, units and values that do not fit,
/// and for inputs that have another source. Comes after the connections.
void resolve_signals(ResolvedSystem& system);

}  // namespace mebots::master
