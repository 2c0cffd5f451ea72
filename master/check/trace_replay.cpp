// SPDX-License-Identifier: Apache-2.0
#include "behaviour_check.hpp"
#include "trace_number.hpp"

#include <fmt/format.h>

namespace mebots::check {
namespace {

using modeldesc::Type;

double only(const Variable& variable, std::span<const double> values) {
  if (values.size() == 1) return values.front();
  throw Refused(fmt::format("the trace has {} values for {}, which is no array", values.size(), variable.name));
}

void set(Instance& instance, const Variable& variable, double value) {
  const auto reference = variable.value_reference;
  const auto& f = instance.functions();
  const auto call = fmt::format("setting {} = {}", variable.name, value);
  instance.doing(call);
  switch (variable.type) {
    case Type::real:
      instance.require(call, f.set_real(instance.component(), &reference, 1, &value));
      break;
    case Type::boolean: {
      const fmi2Boolean truth = converted<bool>(value, "Boolean " + variable.name);
      instance.require(call, f.set_boolean(instance.component(), &reference, 1, &truth));
      break;
    }
    default: {
      const auto whole = converted<fmi2Integer>(value, "Integer " + variable.name);
      instance.require(call, f.set_integer(instance.component(), &reference, 1, &whole));
    }
  }
}

double get(Instance& instance, const Variable& variable) {
  const auto& f = instance.functions();
  const auto call = fmt::format("getting {}", variable.name);
  instance.doing(call);
  if (variable.type == Type::real) {
    fmi2Real value = 0;
    instance.require(call, f.get_real(instance.component(), &variable.value_reference, 1, &value));
    return value;
  }
  fmi2Integer value = 0;
  const auto function = variable.type == Type::boolean ? f.get_boolean : f.get_integer;
  instance.require(call, function(instance.component(), &variable.value_reference, 1, &value));
  return value;
}

bool is_number(const ModelDescription& model, const std::string& name) {
  const auto* const variable = model.find(name);
  return variable != nullptr && variable->type != Type::string;
}

}  // namespace

TraceScope scope_of(const std::optional<TraceFiles>& files, const ModelDescription& model) {
  if (files && !files->of_many_versions) return {};
  return trace_scope(files, [&](const std::string& name) { return is_number(model, name); });
}

void replay(const Library& library, const TraceFiles& files) {
  const auto& model = *library.target().model;
  const auto is_number_of_model = [&](const std::string& name) { return is_number(model, name); };
  const auto outputs = read_trace(files.outputs, files.of_many_versions, is_number_of_model);
  const auto inputs = read_inputs(files, is_number_of_model);
  Instance instance(library, "replay");
  instance.setup();
  const bool reached =
      replay(library.witness(), files, inputs, outputs,
             {.enter_initialization = [&] { instance.enter(); },
              .exit_initialization = [&] { instance.exit(); },
              .set =
                  [&](const std::string& name, std::span<const double> values) {
                    const auto& variable = *model.find(name);
                    set(instance, variable, only(variable, values));
                  },
              .get = [&](const std::string& name) { return Trace::Cell{get(instance, *model.find(name))}; },
              .step = [&](double time_s, double step_s) { instance.step(time_s, step_s); },
              .ended = [&] { return instance.ended(); },
              .is_real = [&](const std::string& name) { return model.find(name)->type == Type::real; }});
  if (reached) instance.terminate();
}

}  // namespace mebots::check
