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
const LagFmu& LagFmu::get() {
  static const LagFmu fmu;
  return fmu;
}

LagFmu::LagFmu() : folder_("lag f\xC3\xBCr tests") {
  modeldesc::unpack(MEBOTS_BINARY_DIR "/test_fmus/lag.fmu", folder_.path());
  description_ = modeldesc::read_xml(folder_.path() / "modelDescription.xml");
  void* handle = dlopen(binary().c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) throw std::runtime_error(dlerror());
  library_ = fmi2::find_functions(handle);
  fmi2::for_each_function([&](const char* name, auto member, fmi2::Need need) {
    if (need != fmi2::Need::to_integrate && library_.*member() == nullptr)
      throw std::runtime_error(fmt::format("{} is not exported", name));
  });
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
