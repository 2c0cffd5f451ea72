// SPDX-License-Identifier: Apache-2.0
#include "calls.hpp"

#include <cstring>
#include <locale>
#include <memory>

namespace mebots::shell {
namespace {

SavedState& saved_state(void* handle) {
  return *static_cast<SavedState*>(&checked(static_cast<SavedState*>(handle), "FMU state"));
}

/// Stores `saved` in *handle. If *handle already has a state, overwrites it.
void hand_out(SavedState saved, void*& handle) {
  if (handle == nullptr)
    handle = std::make_unique<SavedState>(std::move(saved)).release();
  else
    *static_cast<SavedState*>(handle) = std::move(saved);
}

bool prepare() noexcept {
  static_cast<void>(std::locale::classic());
  void (*const prepare_tables)() = &fmu::prepare_shared_tables;
  try {
    if (prepare_tables != nullptr) prepare_tables();
  } catch (...) {  // NOLINT(bugprone-empty-catch): the first instance builds them again and reports it
  }
  return true;
}

}  // namespace

void report(Instance& instance, Status status, const Function& function, const char* what) noexcept {
  try {
    const char* category = status == Status::fatal ? "logStatusFatal" : "logStatusError";
    instance.logger().log(status, category, fmt::format("{}: {}", function.name, what));
  } catch (...) {  // NOLINT(bugprone-empty-catch): no memory left to say so
  }
}

void prepare_library() noexcept {
  static const bool prepared = prepare();
  static_cast<void>(prepared);
}

Instance* instantiate(const Instantiation& asked, const std::function<Logger::Sink()>& sink,
                      const std::function<std::filesystem::path()>& resources) noexcept {
  const auto& definition = fmu::kDefinition;
  try {
    Logger logger(sink(), asked.logging_on, definition.log_categories);
    try {
      if (asked.instance_name.empty()) throw Error("the instance name is missing");
      const std::string_view own_token = definition.*asked.version.token;
      if (asked.token == nullptr || asked.token != own_token)
        throw Error(fmt::format(
            "the {} {} differs from this library's {}; modelDescription.xml and library are from different builds",
            asked.version.token_name, asked.token == nullptr ? "(null)" : asked.token, own_token));
      return std::make_unique<Instance>(definition, asked.version, logger, resources()).release();
    } catch (const Error& error) {
      logger.log(Status::error, "logStatusError", fmt::format("{}: {}", asked.function, error.what()));
    }
  } catch (...) {  // NOLINT(bugprone-empty-catch): no memory left to say so
  }
  return nullptr;
}

void free_instance(void* handle) noexcept {
  delete static_cast<Instance*>(handle);
}

Status get_state(void* handle, const Function& function, void** state) noexcept {
  return guarded(handle, function, [&](Instance& instance) { hand_out(instance.save(), checked(state, "FMU state")); });
}

Status set_state(void* handle, const Function& function, void* state) noexcept {
  return guarded(handle, function, [&](Instance& instance) { instance.restore(saved_state(state)); });
}

Status free_state(void* handle, const Function& function, void** state) noexcept {
  return guarded(handle, function, [&](Instance&) {
    if (state == nullptr) return;
    delete static_cast<SavedState*>(*state);
    *state = nullptr;
  });
}

Status serialized_size(void* handle, const Function& function, void* state, std::size_t* size) noexcept {
  return guarded(handle, function, [&](Instance& instance) {
    checked(size, "size") = serialize(instance.owner(), saved_state(state)).size();
  });
}

Status serialize_state(void* handle, const Function& function, void* state, void* bytes, std::size_t size) noexcept {
  return guarded(handle, function, [&](Instance& instance) {
    const auto serialized = serialize(instance.owner(), saved_state(state));
    if (size < serialized.size())
      throw Error(
          fmt::format("the state needs {} bytes, the array has {}; query its size first", serialized.size(), size));
    std::memcpy(&checked(static_cast<std::byte*>(bytes), "serializedState"), serialized.data(), serialized.size());
  });
}

Status deserialize_state(void* handle, const Function& function, const void* bytes, std::size_t size,
                         void** state) noexcept {
  return guarded(handle, function, [&](Instance& instance) {
    const auto serialized = checked_array(static_cast<const std::byte*>(bytes), size, "serializedState");
    hand_out(deserialize(instance.owner(), serialized), checked(state, "FMU state"));
  });
}

}  // namespace mebots::shell
