// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/fmi2/library.hpp"
#include "mebots/modeldesc/archive.hpp"
#include "mebots/modeldesc/xml.hpp"

#include <cstdarg>
#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

/// These classes use the test FMU "lag" as an importing tool does: they unpack it, load it with dlopen, and call its C
/// functions.
namespace mebots::test {

using Library = fmi2::Functions;

/// The FMU lag. It is unpacked once per process, into a folder with a space and an umlaut in its name.
class LagFmu {
 public:
  static const LagFmu& get();

  const Library& library() const { return library_; }
  const modeldesc::ModelDescription& description() const { return description_; }
  std::filesystem::path binary() const;
  /// Returns the path of `resources/` as a file: URI with percent-encoding.
  std::string resource_uri() const;
  fmi2ValueReference reference(std::string_view name) const;

 private:
  LagFmu();

  modeldesc::TemporaryFolder folder_;
  modeldesc::ModelDescription description_;
  Library library_{};
};

inline const Library& library() {
  return LagFmu::get().library();
}

struct Message {
  std::string instance;
  fmi2Status status;
  std::string category;
  std::string text;
};

/// Owns an instance of the FMU lag, and records its logged messages.
class Lag {
 public:
  explicit Lag(const std::string& name = "lag", bool logging_on = false);
  ~Lag();
  Lag(const Lag&) = delete;
  Lag& operator=(const Lag&) = delete;

  fmi2Component component() const { return component_; }
  const std::vector<Message>& messages() const { return messages_; }
  /// Returns the text of the last message. If there was no message, returns an empty text.
  std::string last_message() const { return messages_.empty() ? "" : messages_.back().text; }

  /// Calls the functions from the set-up of the experiment to the end of initialisation.
  void start(double start_s = 0);
  fmi2Status step(double point_s, double step_s);

  fmi2Status set(std::string_view name, double value);
  fmi2Status set_integer(std::string_view name, fmi2Integer value);
  fmi2Status set_boolean(std::string_view name, fmi2Boolean value);
  fmi2Status set_string(std::string_view name, const char* value);
  double real(std::string_view name);
  fmi2Integer integer(std::string_view name);
  bool boolean(std::string_view name);
  std::string string(std::string_view name);

  fmi2FMUstate save();
  std::vector<char> serialized();

  static void log(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status, fmi2String category,
                  fmi2String format, ...);
  /// Returns callbacks that append each logged message to `messages`.
  static fmi2CallbackFunctions callbacks(std::vector<Message>& messages);

 private:
  std::vector<Message> messages_;
  fmi2CallbackFunctions callbacks_;
  fmi2Component component_;
};

}  // namespace mebots::test
