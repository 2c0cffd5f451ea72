// SPDX-License-Identifier: Apache-2.0
#include "subject.hpp"

#include "base/time.hpp"
#include "fmi/fmu.hpp"
#include "mebots/fmi2/types.hpp"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <unordered_set>

namespace mebots::check {
namespace {

using modeldesc::Causality;
using modeldesc::Type;

std::vector<fmi2ValueReference> references(const std::vector<const Variable*>& variables) {
  std::vector<fmi2ValueReference> result;
  result.reserve(variables.size());
  for (const auto* variable : variables) result.push_back(variable->value_reference);
  return result;
}

template <typename T>
std::string first_difference(const std::vector<const Variable*>& variables, const std::vector<T>& found,
                             const std::vector<T>& wanted) {
  for (std::size_t i = 0; i < variables.size(); ++i)
    if (found[i] != wanted[i]) return fmt::format("{} is {} instead of {}", variables[i]->name, found[i], wanted[i]);
  return {};
}

/// True for the log categories that FMI 2.0.4, section 2.2.4, suggests.
bool is_standard_category(std::string_view name) {
  constexpr std::string_view kNames[] = {"logEvents",           "logSingularLinearSystems",
                                         "logNonlinearSystems", "logDynamicStateSelection",
                                         "logStatusWarning",    "logStatusDiscard",
                                         "logStatusError",      "logStatusFatal",
                                         "logStatusPending",    "logAll"};
  return std::ranges::find(kNames, name) != std::end(kNames);
}

// Global, because callbacks of the C interface receive no context. A child process has only one witness.
Witness* current_witness = nullptr;

struct GivenMemory {
  std::mutex mutex;
  std::unordered_set<void*> blocks;
};

GivenMemory& given_memory() {
  static GivenMemory& all = *new GivenMemory;  // never destroyed, because an FMU may use it at process exit
  return all;
}

void* allocate(std::size_t count, std::size_t size) {
  void* const memory = std::calloc(count, size);
  auto& given = given_memory();
  const std::lock_guard lock(given.mutex);
  if (memory != nullptr) given.blocks.insert(memory);
  return memory;
}

/// Frees memory for an FMU. Does not pass foreign memory to free(), which would abort the process without naming the
/// cause.
void give_back(void* memory) {
  if (memory == nullptr) return;
  {
    auto& given = given_memory();
    const std::lock_guard lock(given.mutex);
    if (given.blocks.erase(memory) != 0) {
      std::free(memory);
      return;
    }
  }
  current_witness->error(
      "freeMemory was called with a pointer that allocateMemory did not return, or that was already freed",
      "free memory of allocateMemory once with freeMemory, and other memory with its own function");
}

}  // namespace

std::vector<std::string> Surroundings::changes() {
  auto texts = process_->put_right();
  if (const auto now = master::FloatEnvironment::now(); now != floats_) {
    texts.push_back(fmt::format("the floating-point environment of the thread changed: {} (put back)",
                                difference_text(now, floats_)));
    floats_.enter();
  }
  // Starts a new comparison. Otherwise, each later call would report again the changes that cannot be reverted.
  if (!texts.empty()) process_.emplace();
  return texts;
}

Library::Library(const Target& target, Witness& witness) : target_(&target), witness_(&witness) {
  witness.doing("loading the library");
  Surroundings surroundings;
  void* library = dlopen(target.library.c_str(), RTLD_NOW | RTLD_LOCAL);
  changes_at_load_ = surroundings.changes();
  if (library == nullptr)
    throw Error(ErrorCode::fmu_inconsistent, fmt::format("the library cannot be loaded: {}", dlerror()));
  functions_ = fmi2::find_functions(library);
  for (const auto& variable : target.model->variables) {
    if (variable.causality != Causality::output || variable.osmp) continue;
    auto& list = variable.type == Type::real      ? reals_
                 : variable.type == Type::boolean ? booleans_
                 : variable.type == Type::string  ? strings_
                                                  : integers_;
    list.push_back(&variable);
  }
}

std::string Library::resource_uri() const {
  return master::file_uri(target_->folder / "resources");
}

const std::vector<const Variable*>& Library::output_variables(Type type) const {
  if (type == Type::real) return reals_;
  if (type == Type::boolean) return booleans_;
  return type == Type::string ? strings_ : integers_;
}

std::string Library::difference(const Outputs& found, const Outputs& wanted) const {
  for (const auto& text : {first_difference(reals_, found.reals, wanted.reals),
                           first_difference(integers_, found.integers, wanted.integers),
                           first_difference(booleans_, found.booleans, wanted.booleans),
                           first_difference(strings_, found.strings, wanted.strings)})
    if (!text.empty()) return text;
  return {};
}

Instance::Instance(const Library& library, std::string name)
    : library_(&library), name_(std::move(name)), target_(*this, name_), callbacks_(target_.functions(false)) {
  callbacks_.allocateMemory = &allocate;
  callbacks_.freeMemory = &give_back;
  current_witness = &library.witness();
  doing("fmi2Instantiate");
  component_ = functions().instantiate(name_.c_str(), fmi2CoSimulation, library.target().model->guid.c_str(),
                                       library.resource_uri().c_str(), &callbacks_, fmi2False, fmi2True);
  if (component_ == nullptr) throw Refused(fmt::format("fmi2Instantiate returned no instance. {}", last_message()));
}

Instance::~Instance() {
  free();
}

void Instance::free() {
  if (component_ == nullptr) return;
  doing("fmi2FreeInstance");
  functions().free_instance(component_);
  component_ = nullptr;
}

void Instance::logged(master::LoggerCall call) {
  const std::lock_guard lock(mutex_);
  if (call.status != fmi2OK) messages_.push_back(call.text);
  if (!reported_environment_ && !call.own_environment) {
    reported_environment_ = true;
    library_->witness().error(
        "the logger was called with an environment other than that of fmi2Instantiate",
        "store componentEnvironment of fmi2Instantiate in each instance and pass it to the logger");
  }
  if (!reported_name_ && call.instance != name_) {
    reported_name_ = true;
    library_->witness().error(
        fmt::format("the logger was called with the instance name \"{}\" instead of \"{}\"",
                    call.instance.value_or("(null)"), name_),
        "pass the name given to fmi2Instantiate to the logger; copy it, because the caller's text may no longer exist");
  }
  const std::string_view name = call.category;
  const auto& known = library_->target().model->log_categories;
  if (!reported_category_ && !name.empty() && !known.empty() && !is_standard_category(name) &&
      std::ranges::find(known, name, &modeldesc::LogCategory::name) == known.end()) {
    reported_category_ = true;
    library_->witness().remark(fmt::format("a message is of category \"{}\", which LogCategories does not list", name),
                               "add the category to modelDescription.xml");
  }
}

void Instance::require(const std::string& call, fmi2Status status) const {
  if (status == fmi2OK || status == fmi2Warning) return;
  throw Refused(fmt::format("{} returned {}{}", call, fmi2::status_name(status),
                            messages_.empty() ? ", and the FMU logged nothing" : ": " + last_message()));
}

void Instance::setup(const master::Experiment& experiment) {
  doing("fmi2SetupExperiment");
  require("fmi2SetupExperiment",
          functions().setup_experiment(component_, experiment.tolerance ? fmi2True : fmi2False,
                                       experiment.tolerance.value_or(0), master::to_seconds(experiment.start_ns),
                                       experiment.stop_ns ? fmi2True : fmi2False,
                                       master::to_seconds(experiment.stop_ns.value_or(0))));
}
void Instance::enter() {
  doing("fmi2EnterInitializationMode");
  require("fmi2EnterInitializationMode", functions().enter_initialization_mode(component_));
}
void Instance::exit() {
  doing("fmi2ExitInitializationMode");
  require("fmi2ExitInitializationMode", functions().exit_initialization_mode(component_));
}
void Instance::start(const master::Experiment& experiment) {
  setup(experiment);
  enter();
  exit();
}

void Instance::step(double point_s, double step_s) {
  const auto call = fmt::format("fmi2DoStep(t = {}, h = {})", point_s, step_s);
  doing(call);
  const auto status = functions().do_step(component_, point_s, step_s, fmi2True);
  if (status == fmi2Discard && functions().get_boolean_status != nullptr) {
    fmi2Boolean over = fmi2False;
    doing("fmi2GetBooleanStatus(fmi2Terminated)");
    ended_ = functions().get_boolean_status(component_, fmi2Terminated, &over) == fmi2OK && over != fmi2False;
    if (ended_) return;
  }
  require(call, status);
}

void Instance::run(int from, int to) {
  const double h = library_->target().step_s;
  for (int k = from; k < to && !ended_; ++k) step(k * h, h);
}

void Instance::set_state(fmi2FMUstate state) {
  doing("fmi2SetFMUstate");
  require("fmi2SetFMUstate", functions().set_fmu_state(component_, state));
  ended_ = false;
}
void Instance::reset() {
  doing("fmi2Reset");
  ended_ = false;
  require("fmi2Reset", functions().reset(component_));
}
void Instance::terminate() {
  if (ended_) return;
  doing("fmi2Terminate");
  require("fmi2Terminate", functions().terminate(component_));
}

Outputs Instance::outputs() {
  Outputs result;
  const auto get = [&](Type type, auto& values, const char* call, auto function) {
    const auto& variables = library_->output_variables(type);
    values.resize(variables.size());
    if (variables.empty()) return;
    doing(call);
    require(call, function(component_, references(variables).data(), variables.size(), values.data()));
  };
  get(Type::real, result.reals, "fmi2GetReal", functions().get_real);
  get(Type::integer, result.integers, "fmi2GetInteger", functions().get_integer);
  get(Type::boolean, result.booleans, "fmi2GetBoolean", functions().get_boolean);
  std::vector<fmi2String> texts;
  get(Type::string, texts, "fmi2GetString", functions().get_string);
  for (const auto* text : texts) result.strings.emplace_back(text == nullptr ? "" : text);
  return result;
}

}  // namespace mebots::check
