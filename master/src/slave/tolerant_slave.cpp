// SPDX-License-Identifier: Apache-2.0
#include "slave/tolerant_slave.hpp"

#include "base/signal_guard.hpp"
#include "mebots/state/save.hpp"
#include "model/value_kind.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <type_traits>

namespace mebots::master {
namespace {

/// The state of the slave: that of the wrapped slave or, after a failure, the time, reason and last values.
class TolerantState final : public SlaveState {
 public:
  std::unique_ptr<SlaveState> inner;  // null after a failure
  std::vector<std::byte> own;
};

}  // namespace

template <typename Work>
void TolerantSlave::attempt(Work work) {
  if (lost()) return;
  if (!running_) return work();
  try {
    work();
  } catch (const InterruptedError&) {
    throw;  // not a failure of the instance
  } catch (const Error& error) {
    loss_->at_ns = time_ns_;
    loss_->text = error.what();
    messages_->message(
        {name(), Severity::error, "",
         fmt::format("{}. The other instances continue, and its outputs keep their last values", error.what()),
         time_ns_});
  }
}

template <typename T>
std::vector<TolerantSlave::Kept<T>>& TolerantSlave::kept_of(ValueKind kind) {
  if constexpr (std::is_same_v<T, double>) return reals_;
  if constexpr (std::is_same_v<T, std::string>) return kind == ValueKind::binary ? binaries_ : strings_;
  if constexpr (std::is_same_v<T, std::int64_t>) return kind == ValueKind::boolean ? booleans_ : integers_;
}

void TolerantSlave::get(ValueKind kind, std::span<const ValueReference> references, Destination destination) {
  std::visit(
      [&]<typename T>(std::span<T> values) {
        auto& all = kept_of<T>(kind);
        auto found = std::find_if(all.begin(), all.end(), [&](const Kept<T>& kept) {
          return std::equal(kept.references.begin(), kept.references.end(), references.begin(), references.end());
        });
        if (found == all.end()) {
          all.push_back({{references.begin(), references.end()}, std::vector<T>(values.size())});
          found = all.end() - 1;
        }
        attempt([&] {
          pass_get(kind, references, destination);
          std::copy(values.begin(), values.end(), found->values.begin());
        });
        if (lost()) std::copy(found->values.begin(), found->values.end(), values.begin());
      },
      destination);
}

void TolerantSlave::set(ValueKind kind, std::span<const ValueReference> references, Source values) {
  attempt([&] { pass_set(kind, references, values); });
}

void TolerantSlave::get_output_derivatives(std::span<const ValueReference> references,
                                           std::span<const std::int32_t> orders, std::span<double> values) {
  attempt([&] { inner().get_output_derivatives(references, orders, values); });
  if (lost()) std::ranges::fill(values, 0);
}

void TolerantSlave::set_input_derivatives(std::span<const ValueReference> references,
                                          std::span<const std::int32_t> orders, std::span<const double> values) {
  attempt([&] { inner().set_input_derivatives(references, orders, values); });
}

StepResult TolerantSlave::step(std::int64_t start_ns, std::int64_t duration_ns) {
  running_ = true;
  time_ns_ = start_ns;
  StepResult result;
  attempt([&] { result = inner().step(start_ns, duration_ns); });
  time_ns_ = start_ns + duration_ns;
  return result;
}

StepResult TolerantSlave::finish_step(const std::atomic<bool>& cancel) {
  StepResult result;
  attempt([&] { result = inner().finish_step(cancel); });
  return result;
}

void TolerantSlave::terminate() {
  if (!lost()) inner().terminate();
}

std::optional<std::string> TolerantSlave::free_instance() {
  inner().free_instance();
  return std::nullopt;
}

void TolerantSlave::visit(state::Visitor& v) {
  v("at_ns", loss_->at_ns);
  v("text", loss_->text);
  v("reals", reals_);
  v("integers", integers_);
  v("booleans", booleans_);
  v("strings", strings_);
  v("binaries", binaries_);
  if (!v.restores()) return;
  // The state contains no OSMP pointers. They are null after a restore, because the failed slave cannot provide new
  // ones.
  for (const auto& triple : osmp_triples(description())) {
    for (auto& kept : integers_) {
      if (const auto places = places_of(triple, kept.references)) {
        for (const auto place : *places) kept.values.at(place) = 0;
      }
    }
  }
}

std::unique_ptr<SlaveState> TolerantSlave::save_state() {
  auto state = std::make_unique<TolerantState>();
  if (!lost()) {
    state->inner = inner().save_state();
    return state;
  }
  state->own = state::save(*this);
  return state;
}

void TolerantSlave::restore_state(const SlaveState& state) {
  running_ = true;
  const auto& tolerant = static_cast<const TolerantState&>(state);
  if (tolerant.inner != nullptr) {
    if (lost())
      throw Error(ErrorCode::fmu_lost,
                  fmt::format("instance '{}' is lost and cannot be restored: {}", name(), loss_->text));
    inner().restore_state(*tolerant.inner);
    return;
  }
  state::restore(*this, tolerant.own);
}

std::vector<std::byte> TolerantSlave::serialize(const SlaveState& state) {
  const auto& tolerant = static_cast<const TolerantState&>(state);
  state::Writer writer;
  writer.put(tolerant.inner != nullptr);
  writer.put(tolerant.inner != nullptr ? inner().serialize(*tolerant.inner) : tolerant.own);
  return writer.take();
}

std::unique_ptr<SlaveState> TolerantSlave::deserialize(std::span<const std::byte> bytes) {
  state::Reader reader(bytes);
  auto state = std::make_unique<TolerantState>();
  const auto alive = reader.get<bool>();
  std::vector<std::byte> content;
  reader.get(content);
  if (alive) {
    state->inner = inner().deserialize(content);
  } else {
    state->own = std::move(content);
  }
  return state;
}

}  // namespace mebots::master
