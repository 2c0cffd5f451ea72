// SPDX-License-Identifier: Apache-2.0
#include "slave/fmi/fmu_states.hpp"

#include "base/time.hpp"
#include "mebots/state/bytes.hpp"

#include <fmt/format.h>

#include <new>

namespace mebots::master {

/// The FMU's handle of a state, and the time of the state for messages.
template <typename Functions>
class FmuStates<Functions>::State final : public SlaveState {
 public:
  State(FmuStates& owner, std::int64_t message_time_ns) : time_ns(message_time_ns), owner_(&owner) { ++owner_->kept_; }
  ~State() override {
    --owner_->kept_;
    if (handle != nullptr) owner_->free_state(&handle);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  void* handle = nullptr;
  std::int64_t time_ns;

 private:
  FmuStates* owner_;
};

template <typename Functions>
void FmuStates<Functions>::free_state(void** state) noexcept {
  if (functions_->free_fmu_state == nullptr || !calls_->usable()) return;
  try {
    calls_->call(names_->free, functions_->free_fmu_state, state);
  } catch (const SlaveError& error) {
    calls_->messages().message({calls_->name(), Severity::error, "notice", error.what(), calls_->time_ns()});
  }
}

template <typename Functions>
void FmuStates<Functions>::require_saving() const {
  if (can_save_ && functions_->get_fmu_state != nullptr && functions_->set_fmu_state != nullptr &&
      functions_->free_fmu_state != nullptr) {
    return;
  }
  throw Error(ErrorCode::not_offered, fmt::format("instance '{}': its FMU cannot save its state ({} is false)",
                                                  calls_->name(), names_->can_save));
}

template <typename Functions>
void FmuStates<Functions>::require_serialization(bool is_there) const {
  if (can_serialize_ && is_there) return;
  throw Error(ErrorCode::not_offered, fmt::format("instance '{}': its FMU cannot serialise its state ({} is false)",
                                                  calls_->name(), names_->can_serialize));
}

template <typename Functions>
std::unique_ptr<SlaveState> FmuStates<Functions>::save() {
  require_saving();
  auto state = std::make_unique<State>(*this, calls_->time_ns());
  calls_->require(names_->get, functions_->get_fmu_state, &state->handle);
  return state;
}

template <typename Functions>
void FmuStates<Functions>::restore(const SlaveState& state) {
  const auto& saved = static_cast<const State&>(state);
  if (saved.time_ns < promised_ns_) {
    throw Error(
        ErrorCode::wrong_call_order,
        fmt::format("instance '{}': its state of {} s cannot be restored: at {} s no state was kept, so the "
                    "master set noSetFMUStatePriorToCurrentPoint, after which no earlier state may be set. Keep a "
                    "state for as long as the run may go back",
                    calls_->name(), to_seconds(saved.time_ns), to_seconds(promised_ns_)));
  }
  calls_->require(names_->set, functions_->set_fmu_state, saved.handle);
  calls_->set_time_ns(saved.time_ns);
}

template <typename Functions>
std::vector<std::byte> FmuStates<Functions>::buffer(std::size_t size) {
  constexpr std::size_t kLargestState = std::size_t{4} << 30;
  try {
    if (size > kLargestState) throw std::bad_alloc();
    return std::vector<std::byte>(size);
  } catch (const std::bad_alloc&) {
    calls_->fail(names_->size, fmt::format("reports a state of {} bytes, for which there is no memory", size));
  }
}

template <typename Functions>
std::vector<std::byte> FmuStates<Functions>::serialize(const SlaveState& state) {
  require_serialization(functions_->serialize_fmu_state != nullptr && functions_->serialized_fmu_state_size != nullptr);
  const auto& saved = static_cast<const State&>(state);
  std::size_t size = 0;
  calls_->require(names_->size, functions_->serialized_fmu_state_size, saved.handle, &size);
  auto bytes = buffer(size);
  using Byte = typename Functions::Byte;
  calls_->require(names_->serialize, functions_->serialize_fmu_state, saved.handle,
                  reinterpret_cast<Byte*>(bytes.data()), size);
  state::Writer writer;
  writer.put(saved.time_ns);
  writer.put(bytes);
  return writer.take();
}

template <typename Functions>
std::unique_ptr<SlaveState> FmuStates<Functions>::deserialize(std::span<const std::byte> bytes) {
  require_serialization(functions_->deserialize_fmu_state != nullptr);
  state::Reader reader(bytes);
  auto state = std::make_unique<State>(*this, reader.get<std::int64_t>());
  std::vector<std::byte> own;
  reader.get(own);
  using Byte = typename Functions::Byte;
  calls_->require(names_->deserialize, functions_->deserialize_fmu_state, reinterpret_cast<const Byte*>(own.data()),
                  own.size(), &state->handle);
  return state;
}

template class FmuStates<fmi2::Functions>;
template class FmuStates<fmi3::Functions>;

}  // namespace mebots::master
