// SPDX-License-Identifier: Apache-2.0
#include "fmi3_instance.hpp"

#include "plain_run.hpp"
#include "trace_number.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <memory>

namespace mebots::check {
namespace {

/// True if the functions for `type` access the variable.
bool has_type(const Fmi3Declared& variable, std::string_view type) {
  return variable.type == type || (variable.type == "Enumeration" && type == "Int64");
}

template <typename T>
std::vector<double> decoded(const std::string& bytes) {
  std::vector<double> numbers(bytes.size() / sizeof(T));
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    T value{};
    std::memcpy(&value, bytes.data() + i * sizeof(T), sizeof(T));
    numbers[i] = static_cast<double>(value);
  }
  return numbers;
}

}  // namespace

Fmi3Library::Fmi3Library(const Fmi3Target& target, Witness& witness) : target_(target), witness_(witness) {
  witness.doing("loading the library");
  handle_ = dlopen(target.library.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle_ == nullptr) throw Fmi3Refused(fmt::format("the library cannot be loaded: {}", dlerror()));
  const auto experiment = target.description->root().child("DefaultExperiment");
  const auto fixed = target.description->root().child("CoSimulation").attribute("fixedInternalStepSize");
  step_s_ = fixed ? fixed.as_double() : experiment.attribute("stepSize").as_double(kPlainStep_s);
  if (!(step_s_ > 0)) step_s_ = kPlainStep_s;
  start_s_ = experiment.attribute("startTime").as_double(0);
}

void* Fmi3Library::address(const char* name) const {
  void* const found = dlsym(handle_, name);
  if (found == nullptr) throw Fmi3Refused(fmt::format("the library lacks {}", name));
  return found;
}

Fmi3Instance::Fmi3Instance(const Fmi3Library& library, const char* name) : library_(library) {
  const auto& target = library.target();
  const std::string resources = (target.folder / "resources" / "").string();
  const char* const token = target.description->root().attribute("instantiationToken").value();
  constexpr const char* kFunction = "fmi3InstantiateCoSimulation";
  library.witness().doing(kFunction);
  handle_ = library.find<decltype(fmi3InstantiateCoSimulation)>(kFunction)(
      name, token, resources.c_str(), false, false, false, false, nullptr, 0, this, &Fmi3Instance::log, nullptr);
  if (handle_ == nullptr) throw Fmi3Refused(fmt::format("no instance was created: {}", last_message_));
}

Fmi3Instance::~Fmi3Instance() {
  library_.witness().doing("fmi3FreeInstance");
  library_.find<decltype(fmi3FreeInstance)>("fmi3FreeInstance")(handle_);
}

void Fmi3Instance::require(std::string_view name, fmi3Status status) const {
  if (status == fmi3OK || status == fmi3Warning) return;
  throw Fmi3Refused(fmt::format("{} returned {}{}{}", name, fmi3::status_name(status),
                                last_message_.empty() ? "" : ": ", last_message_));
}

void Fmi3Instance::enter_initialization() {
  MEBOTS_CALL(*this, fmi3EnterInitializationMode, false, 0.0, library_.start_s(), false, 0.0);
}

void Fmi3Instance::exit_initialization() {
  MEBOTS_CALL(*this, fmi3ExitInitializationMode);
}

void Fmi3Instance::start() {
  enter_initialization();
  exit_initialization();
}

void Fmi3Instance::run(int first, int last) {
  const double h = library_.step_s();
  for (int k = first; k < last; ++k) step(library_.start_s() + k * h, h);
}

void Fmi3Instance::step(double time_s, double step_s) {
  const double end_s = time_s + step_s;
  bool event = false;
  bool early = false;
  double reached_s = time_s;
  MEBOTS_CALL(*this, fmi3DoStep, time_s, step_s, true, &event, &ended_, &early, &reached_s);
  if (early) throw Fmi3Refused("fmi3DoStep returned early, though earlyReturnAllowed was false");
  if (!(std::abs(reached_s - end_s) <= 1e-9 * std::max(1.0, std::abs(end_s))))
    throw Fmi3Refused(fmt::format("lastSuccessfulTime is {} s after a step to {} s", reached_s, end_s));
}

std::string Fmi3Instance::read(const Fmi3Declared& variable) {
  const auto count = variable.elements;
  const fmi3ValueReference* const reference = &variable.reference;
  std::string bytes;
#define MEBOTS_READ(name, ctype)                                                \
  if (has_type(variable, #name)) {                                              \
    std::vector<std::byte> values(count * sizeof(ctype));                       \
    auto* const typed = reinterpret_cast<ctype*>(values.data());                \
    MEBOTS_CALL(*this, fmi3Get##name, reference, std::size_t{1}, typed, count); \
    return {reinterpret_cast<const char*>(values.data()), values.size()};       \
  }
  MEBOTS_FMI3_EACH_NUMBER_TYPE(MEBOTS_READ)
#undef MEBOTS_READ
  if (variable.type == "String") {
    std::vector<fmi3String> values(count, nullptr);
    MEBOTS_CALL(*this, fmi3GetString, reference, std::size_t{1}, values.data(), count);
    for (const fmi3String value : values) bytes += value == nullptr ? std::string("\x01") : std::string(value) + '\0';
  } else if (variable.type == "Binary") {
    std::vector<fmi3Binary> values(count, nullptr);
    std::vector<std::size_t> sizes(count, 0);
    MEBOTS_CALL(*this, fmi3GetBinary, reference, std::size_t{1}, sizes.data(), values.data(), count);
    for (std::size_t i = 0; i < count; ++i)
      bytes += std::to_string(sizes[i]) + ':' + std::string(reinterpret_cast<const char*>(values[i]), sizes[i]);
  }
  return bytes;
}

void Fmi3Instance::set_numbers(const Fmi3Declared& variable, std::span<const double> values) {
  if (values.size() != variable.elements)
    throw Fmi3Refused(
        fmt::format("the trace has {} values for {}, which has {}", values.size(), variable.name, variable.elements));
  const auto subject = fmt::format("{} {}", variable.type, variable.name);
#define MEBOTS_WRITE(name, ctype)                                                                              \
  if (has_type(variable, #name)) {                                                                             \
    using Value = ctype;                                                                                       \
    const auto typed = std::make_unique<Value[]>(values.size());                                               \
    for (std::size_t i = 0; i < values.size(); ++i) typed[i] = converted<Value>(values[i], subject);           \
    return MEBOTS_CALL(*this, fmi3Set##name, &variable.reference, std::size_t{1}, typed.get(), values.size()); \
  }
  MEBOTS_FMI3_EACH_NUMBER_TYPE(MEBOTS_WRITE)
#undef MEBOTS_WRITE
}

std::vector<double> Fmi3Instance::get_numbers(const Fmi3Declared& variable) {
  const auto bytes = read(variable);
#define MEBOTS_CONVERT(name, ctype) \
  if (has_type(variable, #name)) return decoded<ctype>(bytes);
  MEBOTS_FMI3_EACH_NUMBER_TYPE(MEBOTS_CONVERT)
#undef MEBOTS_CONVERT
  return {};
}

Fmi3Values Fmi3Instance::outputs() {
  Fmi3Values values;
  for (const auto& variable : library_.target().description->variables()) {
    const bool is_clocked = variable.type == "Clock" || variable.node.attribute("clocks");
    if (variable.causality == "output" && !is_clocked) values.push_back({&variable, read(variable)});
  }
  return values;
}

std::string Fmi3Instance::serialized() {
  fmi3FMUState state = nullptr;
  MEBOTS_CALL(*this, fmi3GetFMUState, &state);
  std::size_t size = 0;
  MEBOTS_CALL(*this, fmi3SerializedFMUStateSize, state, &size);
  std::string bytes(size, '\0');
  MEBOTS_CALL(*this, fmi3SerializeFMUState, state, reinterpret_cast<fmi3Byte*>(bytes.data()), size);
  MEBOTS_CALL(*this, fmi3FreeFMUState, &state);
  return bytes;
}

void Fmi3Instance::restore(const std::string& bytes) {
  fmi3FMUState state = nullptr;
  MEBOTS_CALL(*this, fmi3DeserializeFMUState, reinterpret_cast<const fmi3Byte*>(bytes.data()), bytes.size(), &state);
  MEBOTS_CALL(*this, fmi3SetFMUState, state);
  MEBOTS_CALL(*this, fmi3FreeFMUState, &state);
}

void Fmi3Instance::reset() {
  MEBOTS_CALL(*this, fmi3Reset);
}

void Fmi3Instance::terminate() {
  MEBOTS_CALL(*this, fmi3Terminate);
}

void Fmi3Instance::log(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String /*category*/,
                       fmi3String message) {
  if (environment == nullptr || message == nullptr || status == fmi3OK) return;
  static_cast<Fmi3Instance*>(environment)->last_message_ = message;
}

}  // namespace mebots::check
