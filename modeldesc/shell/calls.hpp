// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "instance.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>

#include <exception>
#include <functional>
#include <span>
#include <string_view>

/// The calls that the C functions of all versions of FMI share. Each call checks that the function is legal in the
/// instance's state, and catches every exception.
namespace mebots::shell {

/// Logs a message of a function in the importing tool. Never throws, even if the tool's logger fails.
void report(Instance& instance, Status status, const Function& function, const char* what) noexcept;

template <typename Body>
Status guarded(void* handle, const Function& function, Body body) noexcept {
  if (handle == nullptr) return Status::error;
  Instance& instance = *static_cast<Instance*>(handle);
  if (instance.state() == State::fatal) return Status::fatal;
  try {
    if (!is_legal(function, instance.state()))
      throw Error(illegal_call_text(function, instance.state(), instance.version()));
    body(instance);
    return Status::ok;
  } catch (const Error& error) {
    report(instance, Status::error, function, error.what());
    return Status::error;
  } catch (const std::exception& error) {
    report(instance, Status::fatal, function, error.what());
  } catch (...) {
    report(instance, Status::fatal, function, "unknown exception");
  }
  instance.set_state(State::fatal);
  return Status::fatal;
}

template <typename T>
std::span<T> checked_array(T* data, std::size_t count, std::string_view name) {
  if (data == nullptr && count != 0) throw Error(fmt::format("the array {} is a null pointer", name));
  return {data, count};
}

template <typename T>
T& checked(T* pointer, std::string_view name) {
  if (pointer == nullptr) throw Error(fmt::format("the argument {} is a null pointer", name));
  return *pointer;
}

[[noreturn]] inline void not_offered(std::string_view flag) {
  throw Error(fmt::format("this FMU does not offer it: modelDescription.xml declares {}", flag));
}

/// Builds the data that instances share: the C++ library's facets and the FMU's own tables. Only the first call has an
/// effect. Must be called before the first instance is created, from a function that every tool calls.
void prepare_library() noexcept;

struct Instantiation {
  std::string_view function;
  const Version& version;
  std::string_view instance_name;
  const char* token;  ///< of the modelDescription.xml that the tool read; may be null
  bool logging_on;
};

/// If the instance cannot be created, sends a message and returns null. `resources` returns the resources folder or
/// throws mebots::Error.
Instance* instantiate(const Instantiation& asked, const std::function<Logger::Sink()>& sink,
                      const std::function<std::filesystem::path()>& resources) noexcept;
void free_instance(void* handle) noexcept;

Status get_state(void* handle, const Function& function, void** state) noexcept;
Status set_state(void* handle, const Function& function, void* state) noexcept;
Status free_state(void* handle, const Function& function, void** state) noexcept;
Status serialized_size(void* handle, const Function& function, void* state, std::size_t* size) noexcept;
Status serialize_state(void* handle, const Function& function, void* state, void* bytes, std::size_t size) noexcept;
Status deserialize_state(void* handle, const Function& function, const void* bytes, std::size_t size,
                         void** state) noexcept;

}  // namespace mebots::shell
