// SPDX-License-Identifier: Apache-2.0
#include "behaviour_check.hpp"
#include "mebots/fmi2/types.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mebots::check {
namespace {

using modeldesc::Causality;
using modeldesc::Type;
using modeldesc::Variability;

constexpr const char* kAnswerError = "check state and arguments at the start of the function, and return fmi2Error";

void ignore_message(fmi2ComponentEnvironment, fmi2String, fmi2Status, fmi2String, fmi2String, ...) {}

/// Adds a warning if the FMU accepted an illegal call.
void expect_refusal(const Library& library, const std::string& call, fmi2Status status) {
  if (status != fmi2OK && status != fmi2Warning) return;
  library.witness().warning(fmt::format("{} returned {}", call, fmi2::status_name(status)), kAnswerError);
}

fmi2ValueReference unknown_reference(const ModelDescription& model) {
  fmi2ValueReference most = 0;
  for (const auto& variable : model.variables) most = std::max(most, variable.value_reference);
  return most == std::numeric_limits<fmi2ValueReference>::max() ? most : most + 1000;
}

const Variable* find_variable(const ModelDescription& model, Type type, Causality causality, Variability variability) {
  const auto found = std::ranges::find_if(model.variables, [&](const Variable& v) {
    return v.type == type && v.causality == causality && v.variability == variability;
  });
  return found == model.variables.end() ? nullptr : &*found;
}

class Probes {
 public:
  explicit Probes(const Target& target) : model_(target.model), h_(target.step_s) {}

  std::vector<Probe> all() {
    orders();
    steps();
    references();
    states();
    arguments();
    return std::move(probes_);
  }

 private:
  using Call = std::function<fmi2Status(Instance&)>;

  /// Adds a probe. `prepare` brings the instance into a state in which `call` is illegal.
  void add(const std::string& what, std::function<void(Instance&)> prepare, Call call,
           Severity crash = Severity::error) {
    probes_.push_back({fmt::format("{} is refused", what),
                       [what, prepare = std::move(prepare), call = std::move(call)](const Library& library) {
                         Instance instance(library, "illegal");
                         prepare(instance);
                         instance.doing(what);
                         expect_refusal(library, what, call(instance));
                         // Does not free the instance, because this could fail after an error.
                         instance.forget();
                       },
                       "", crash, Level::pedantic});
  }

  void orders() {
    const double h = h_;
    const auto nothing = [](Instance&) {};
    const auto started = [](Instance& i) { i.start(); };
    const auto entered = [](Instance& i) {
      i.setup();
      i.enter();
    };
    const auto terminated = [](Instance& i) {
      i.start();
      i.terminate();
    };
    const auto step = [h](Instance& i) { return i.functions().do_step(i.component(), 0, h, fmi2True); };
    add("fmi2DoStep before initialisation", nothing, step);
    add("fmi2DoStep in initialisation mode", entered, step);
    add("fmi2DoStep after fmi2Terminate", terminated, step);
    add("fmi2ExitInitializationMode without fmi2EnterInitializationMode", nothing,
        [](Instance& i) { return i.functions().exit_initialization_mode(i.component()); });
    add("fmi2EnterInitializationMode twice", entered,
        [](Instance& i) { return i.functions().enter_initialization_mode(i.component()); });
    add("fmi2SetupExperiment after initialisation", started,
        [](Instance& i) { return i.functions().setup_experiment(i.component(), fmi2False, 0, 0, fmi2False, 0); });
    add("fmi2Terminate before initialisation", nothing,
        [](Instance& i) { return i.functions().terminate(i.component()); });
    add("fmi2Terminate twice", terminated, [](Instance& i) { return i.functions().terminate(i.component()); });
  }

  void steps() {
    const auto started = [](Instance& i) { i.start(); };
    const auto step = [&](const std::string& what, double point, double size) {
      add(what, started, [=](Instance& i) { return i.functions().do_step(i.component(), point, size, fmi2True); });
    };
    step("a step of 0 s", 0, 0);
    step("a step of negative length", 0, -h_);
    step("a step of NaN length", 0, std::nan(""));
    step("a step from another time than the instance's own", 10 * h_, h_);
  }

  void references() {
    const auto started = [](Instance& i) { i.start(); };
    const auto nothing = [](Instance&) {};
    const auto unknown = unknown_reference(*model_);
    const auto both = [&](const char* type, auto get, auto set, auto value) {
      using Value = decltype(value);
      add(fmt::format("fmi2Get{} of an unknown value reference", type), started, [=](Instance& i) {
        Value place = value;
        return (i.functions().*get)(i.component(), &unknown, 1, &place);
      });
      add(fmt::format("fmi2Set{} of an unknown value reference", type), nothing,
          [=](Instance& i) { return (i.functions().*set)(i.component(), &unknown, 1, &value); });
    };
    using F = fmi2::Functions;
    both("Real", &F::get_real, &F::set_real, fmi2Real{0});
    both("Integer", &F::get_integer, &F::set_integer, fmi2Integer{0});
    both("Boolean", &F::get_boolean, &F::set_boolean, fmi2Boolean{0});
    both("String", &F::get_string, &F::set_string, fmi2String{""});
    if (const auto* parameter = find_variable(*model_, Type::real, Causality::parameter, Variability::fixed)) {
      const auto reference = parameter->value_reference;
      const auto* start = std::get_if<double>(&parameter->start);
      add(fmt::format("setting the fixed parameter {} after initialisation", parameter->name), started,
          [reference, value = start == nullptr ? 0.0 : *start](Instance& i) {
            return i.functions().set_real(i.component(), &reference, 1, &value);
          });
    }
    for (const auto variability : {Variability::continuous, Variability::discrete}) {
      const auto* output = find_variable(*model_, Type::real, Causality::output, variability);
      if (output == nullptr) continue;
      add(fmt::format("setting the output {} after initialisation", output->name), started,
          [reference = output->value_reference](Instance& i) {
            const fmi2Real value = 0;
            return i.functions().set_real(i.component(), &reference, 1, &value);
          });
      break;
    }
  }

  void states() {
    const auto& flags = *model_->co_simulation;
    const auto started = [](Instance& i) { i.start(); };
    if (flags.can_get_and_set_fmu_state) {
      add("fmi2SetFMUstate of a null state", started,
          [](Instance& i) { return i.functions().set_fmu_state(i.component(), nullptr); });
      add("fmi2GetFMUstate into a null pointer", started,
          [](Instance& i) { return i.functions().get_fmu_state(i.component(), nullptr); });
    }
    if (flags.can_serialize_fmu_state) {
      add("fmi2DeSerializeFMUstate of bytes that are not a state", started, [](Instance& i) {
        const std::vector<fmi2Byte> bytes(64, 'x');
        fmi2FMUstate state = nullptr;
        return i.functions().deserialize_fmu_state(i.component(), bytes.data(), bytes.size(), &state);
      });
      add("fmi2SerializeFMUstate into too few bytes", started, [](Instance& i) {
        fmi2FMUstate state = nullptr;
        i.require("fmi2GetFMUstate", i.functions().get_fmu_state(i.component(), &state));
        fmi2Byte byte = 0;
        return i.functions().serialize_fmu_state(i.component(), state, &byte, 1);
      });
    }
  }

  void arguments() {
    const auto started = [](Instance& i) { i.start(); };
    add("fmi2GetReal with null arrays", started,
        [](Instance& i) { return i.functions().get_real(i.component(), nullptr, 1, nullptr); });
    add(
        "fmi2SetReal with null arrays", [](Instance&) {},
        [](Instance& i) { return i.functions().set_real(i.component(), nullptr, 1, nullptr); });
    // The standard does not define null instances. An error would help a tool that passes null by mistake.
    const double h = h_;
    add(
        "fmi2DoStep of a null instance", started,
        [h](Instance& i) { return i.functions().do_step(nullptr, 0, h, fmi2True); }, Severity::warning);
    instantiations();
  }

  void instantiations() {
    const auto add_instantiation = [&](const std::string& what, Level level, auto call) {
      probes_.push_back({fmt::format("{} is refused", what),
                         [what, call](const Library& library) {
                           library.witness().doing(what);
                           fmi2CallbackFunctions callbacks{};
                           callbacks.logger = &ignore_message;
                           callbacks.allocateMemory = &std::calloc;
                           callbacks.freeMemory = &std::free;
                           const std::string guid = library.target().model->guid;
                           if (call(library, callbacks, guid) != nullptr)
                             library.witness().warning(fmt::format("{} returned an instance", what),
                                                       "compare the arguments, and return a null pointer");
                         },
                         "", Severity::error, level});
    };
    add_instantiation("fmi2Instantiate with another GUID", Level::standard,
                      [](const Library& l, const auto& callbacks, const std::string&) {
                        return l.functions().instantiate("other", fmi2CoSimulation, "{this is not the GUID}",
                                                         l.resource_uri().c_str(), &callbacks, fmi2False, fmi2False);
                      });
    add_instantiation("fmi2Instantiate without a GUID", Level::pedantic,
                      [](const Library& l, const auto& callbacks, const std::string&) {
                        return l.functions().instantiate("none", fmi2CoSimulation, nullptr, l.resource_uri().c_str(),
                                                         &callbacks, fmi2False, fmi2False);
                      });
    if (!model_->model_exchange)
      add_instantiation("fmi2Instantiate for model exchange, which the description does not offer", Level::pedantic,
                        [](const Library& l, const auto& callbacks, const std::string& guid) {
                          return l.functions().instantiate("exchange", fmi2ModelExchange, guid.c_str(),
                                                           l.resource_uri().c_str(), &callbacks, fmi2False, fmi2False);
                        });
  }

  const ModelDescription* model_;
  double h_;
  std::vector<Probe> probes_;
};

}  // namespace

std::vector<Probe> illegal_call_probes(const Target& target) {
  return Probes(target).all();
}

}  // namespace mebots::check
