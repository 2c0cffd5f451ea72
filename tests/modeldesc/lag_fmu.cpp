// SPDX-License-Identifier: Apache-2.0
#include "lag_fmu.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cctype>
#include <cstdio>
#include <stdexcept>

namespace mebots::test {
namespace {

template <typename F>
void load(void* handle, F& function, const char* name) {
  function = reinterpret_cast<F>(dlsym(handle, name));
  if (function == nullptr) throw std::runtime_error(fmt::format("{} is not exported", name));
}

}  // namespace

const LagFmu& LagFmu::get() {
  static const LagFmu fmu;
  return fmu;
}

LagFmu::LagFmu() : folder_("lag f\xC3\xBCr tests") {
  modeldesc::unpack(MEBOTS_BINARY_DIR "/test_fmus/lag.fmu", folder_.path());
  description_ = modeldesc::read_xml(folder_.path() / "modelDescription.xml");
  void* handle = dlopen(binary().c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) throw std::runtime_error(dlerror());
  load(handle, library_.get_types_platform, "fmi2GetTypesPlatform");
  load(handle, library_.get_version, "fmi2GetVersion");
  load(handle, library_.set_debug_logging, "fmi2SetDebugLogging");
  load(handle, library_.instantiate, "fmi2Instantiate");
  load(handle, library_.free_instance, "fmi2FreeInstance");
  load(handle, library_.setup_experiment, "fmi2SetupExperiment");
  load(handle, library_.enter_initialization_mode, "fmi2EnterInitializationMode");
  load(handle, library_.exit_initialization_mode, "fmi2ExitInitializationMode");
  load(handle, library_.terminate, "fmi2Terminate");
  load(handle, library_.reset, "fmi2Reset");
  load(handle, library_.get_real, "fmi2GetReal");
  load(handle, library_.get_integer, "fmi2GetInteger");
  load(handle, library_.get_boolean, "fmi2GetBoolean");
  load(handle, library_.get_string, "fmi2GetString");
  load(handle, library_.set_real, "fmi2SetReal");
  load(handle, library_.set_integer, "fmi2SetInteger");
  load(handle, library_.set_boolean, "fmi2SetBoolean");
  load(handle, library_.set_string, "fmi2SetString");
  load(handle, library_.get_fmu_state, "fmi2GetFMUstate");
  load(handle, library_.set_fmu_state, "fmi2SetFMUstate");
  load(handle, library_.free_fmu_state, "fmi2FreeFMUstate");
  load(handle, library_.serialized_fmu_state_size, "fmi2SerializedFMUstateSize");
  load(handle, library_.serialize_fmu_state, "fmi2SerializeFMUstate");
  load(handle, library_.deserialize_fmu_state, "fmi2DeSerializeFMUstate");
  load(handle, library_.get_directional_derivative, "fmi2GetDirectionalDerivative");
  load(handle, library_.set_real_input_derivatives, "fmi2SetRealInputDerivatives");
  load(handle, library_.get_real_output_derivatives, "fmi2GetRealOutputDerivatives");
  load(handle, library_.do_step, "fmi2DoStep");
  load(handle, library_.cancel_step, "fmi2CancelStep");
  load(handle, library_.get_status, "fmi2GetStatus");
  load(handle, library_.get_real_status, "fmi2GetRealStatus");
  load(handle, library_.get_integer_status, "fmi2GetIntegerStatus");
  load(handle, library_.get_boolean_status, "fmi2GetBooleanStatus");
  load(handle, library_.get_string_status, "fmi2GetStringStatus");
}

std::filesystem::path LagFmu::binary() const {
  return folder_.path() / "binaries/linux64/lag.so";
}

std::string LagFmu::resource_uri() const {
  std::string uri = "file://";
  for (const char c : (folder_.path() / "resources").string()) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '/' || c == '-' || c == '_' || c == '.';
    uri += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return uri;
}

fmi2ValueReference LagFmu::reference(std::string_view name) const {
  const modeldesc::Variable* variable = description_.find(name);
  if (variable == nullptr) throw std::runtime_error(fmt::format("no variable {}", name));
  return variable->value_reference;
}

void Lag::log(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status, fmi2String category,
              fmi2String format, ...) {
  std::array<char, 2048> text{};
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text.data(), text.size(), format, arguments);
  va_end(arguments);
  static_cast<std::vector<Message>*>(environment)->push_back({instance, status, category, text.data()});
}

fmi2CallbackFunctions Lag::callbacks(std::vector<Message>& messages) {
  return {&Lag::log, nullptr, nullptr, nullptr, &messages};
}

Lag::Lag(const std::string& name, bool logging_on) : callbacks_(callbacks(messages_)) {
  const LagFmu& fmu = LagFmu::get();
  component_ =
      fmu.library().instantiate(name.c_str(), fmi2CoSimulation, fmu.description().guid.c_str(),
                                fmu.resource_uri().c_str(), &callbacks_, fmi2False, logging_on ? fmi2True : fmi2False);
  if (component_ == nullptr) throw std::runtime_error(last_message());
}

Lag::~Lag() {
  LagFmu::get().library().free_instance(component_);
}

void Lag::start(double start_s) {
  const Library& library = LagFmu::get().library();
  ASSERT_EQ(library.setup_experiment(component_, fmi2False, 0, start_s, fmi2False, 0), fmi2OK) << last_message();
  ASSERT_EQ(library.enter_initialization_mode(component_), fmi2OK) << last_message();
  ASSERT_EQ(library.exit_initialization_mode(component_), fmi2OK) << last_message();
}

fmi2Status Lag::step(double point_s, double step_s) {
  return LagFmu::get().library().do_step(component_, point_s, step_s, fmi2True);
}

fmi2Status Lag::set(std::string_view name, double value) {
  const auto reference = LagFmu::get().reference(name);
  return LagFmu::get().library().set_real(component_, &reference, 1, &value);
}

fmi2Status Lag::set_integer(std::string_view name, fmi2Integer value) {
  const auto reference = LagFmu::get().reference(name);
  return LagFmu::get().library().set_integer(component_, &reference, 1, &value);
}

fmi2Status Lag::set_boolean(std::string_view name, fmi2Boolean value) {
  const auto reference = LagFmu::get().reference(name);
  return LagFmu::get().library().set_boolean(component_, &reference, 1, &value);
}

fmi2Status Lag::set_string(std::string_view name, const char* value) {
  const auto reference = LagFmu::get().reference(name);
  return LagFmu::get().library().set_string(component_, &reference, 1, &value);
}

double Lag::real(std::string_view name) {
  const auto reference = LagFmu::get().reference(name);
  double value = 0;
  EXPECT_EQ(LagFmu::get().library().get_real(component_, &reference, 1, &value), fmi2OK) << last_message();
  return value;
}

fmi2Integer Lag::integer(std::string_view name) {
  const auto reference = LagFmu::get().reference(name);
  fmi2Integer value = 0;
  EXPECT_EQ(LagFmu::get().library().get_integer(component_, &reference, 1, &value), fmi2OK) << last_message();
  return value;
}

bool Lag::boolean(std::string_view name) {
  const auto reference = LagFmu::get().reference(name);
  fmi2Boolean value = 0;
  EXPECT_EQ(LagFmu::get().library().get_boolean(component_, &reference, 1, &value), fmi2OK) << last_message();
  return value == fmi2True;
}

std::string Lag::string(std::string_view name) {
  const auto reference = LagFmu::get().reference(name);
  fmi2String value = "";
  EXPECT_EQ(LagFmu::get().library().get_string(component_, &reference, 1, &value), fmi2OK) << last_message();
  return value;
}

fmi2FMUstate Lag::save() {
  fmi2FMUstate state = nullptr;
  EXPECT_EQ(LagFmu::get().library().get_fmu_state(component_, &state), fmi2OK) << last_message();
  return state;
}

std::vector<char> Lag::serialized() {
  const Library& library = LagFmu::get().library();
  fmi2FMUstate state = save();
  std::size_t size = 0;
  EXPECT_EQ(library.serialized_fmu_state_size(component_, state, &size), fmi2OK) << last_message();
  std::vector<char> bytes(size);
  EXPECT_EQ(library.serialize_fmu_state(component_, state, bytes.data(), size), fmi2OK) << last_message();
  EXPECT_EQ(library.free_fmu_state(component_, &state), fmi2OK);
  return bytes;
}

}  // namespace mebots::test
