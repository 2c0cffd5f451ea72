// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmu/model.hpp"

#include <utility>

namespace mebots::fmu {

/// Connects a plain C++ model to the FMI shell (modeldesc/shell), which implements the FMI functions. The model needs
/// these members:
///
///     Own(const Parameters&, const std::filesystem::path& resources, extras...)
///     void start(const Inputs&, std::int64_t start_ns, Outputs&)
///     void step(const Inputs&, std::int64_t start_ns, std::int64_t duration_ns, Outputs&)
///     void visit(state::Visitor&)
///
/// If the model does not depend on time, it omits start_ns. `void terminate()` is optional. `Variables` is the
/// generated struct.
template <typename Own, typename Variables>
class BoundModel final : public Model {
 public:
  /// Passes `extras` to the model's constructor after the resources folder.
  template <typename... Extras>
  BoundModel(Variables& variables, const Host& host, std::int64_t start_ns, Extras&&... extras)
      : variables_(variables), model_(variables.parameters, host.resources(), std::forward<Extras>(extras)...) {
    if constexpr (requires { model_.start(variables_.inputs, start_ns, variables_.outputs); })
      model_.start(variables_.inputs, start_ns, variables_.outputs);
    else
      model_.start(variables_.inputs, variables_.outputs);
  }

  void step(std::int64_t start_ns, std::int64_t duration_ns) override {
    if constexpr (requires { model_.step(variables_.inputs, start_ns, duration_ns, variables_.outputs); })
      model_.step(variables_.inputs, start_ns, duration_ns, variables_.outputs);
    else
      model_.step(variables_.inputs, duration_ns, variables_.outputs);
  }
  void terminate() override {
    if constexpr (requires { model_.terminate(); }) model_.terminate();
  }
  void visit(state::Visitor& v) override { model_.visit(v); }

 private:
  Variables& variables_;
  Own model_;
};

}  // namespace mebots::fmu
