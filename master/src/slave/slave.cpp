// SPDX-License-Identifier: Apache-2.0
#include "slave/slave.hpp"

#include <fmt/format.h>

namespace mebots::master {

StepResult Slave::finish_step(const std::atomic<bool>& /*cancel*/) {
  throw Error(ErrorCode::wrong_call_order, fmt::format("instance '{}': no step is pending", name()));
}

void Slave::get_output_derivatives(std::span<const ValueReference> /*references*/,
                                   std::span<const std::int32_t> /*orders*/, std::span<double> /*values*/) {
  throw Error(ErrorCode::not_offered, fmt::format("instance '{}': its FMU provides no derivatives of outputs", name()));
}

void Slave::set_input_derivatives(std::span<const ValueReference> /*references*/,
                                  std::span<const std::int32_t> /*orders*/, std::span<const double> /*values*/) {
  throw Error(ErrorCode::not_offered, fmt::format("instance '{}': its FMU does not use derivatives of inputs", name()));
}

void Slave::get_binaries(std::span<const ValueReference> /*references*/, std::span<std::string> /*values*/) {
  throw Error(ErrorCode::not_offered, fmt::format("instance '{}': its FMU has no variables of type Binary", name()));
}

void Slave::set_binaries(std::span<const ValueReference> /*references*/, std::span<const std::string> /*values*/) {
  throw Error(ErrorCode::not_offered, fmt::format("instance '{}': its FMU has no variables of type Binary", name()));
}

}  // namespace mebots::master
