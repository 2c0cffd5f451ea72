// SPDX-License-Identifier: Apache-2.0
#include "devices/core/attached_part.hpp"

#include "devices/core/kinds.hpp"
#include "mebots/assert.hpp"
#include "mebots/error.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace mebots::soc {

AttachedPart::AttachedPart(const BoardDevice& entry) : entry_(entry), spent_(entry.states.size()) {
  if (!entry.part) {
    throw Error(ErrorCode::missing_key, fmt::format("board: device {} of kind {} needs the key 'part', and no address",
                                                    entry.name, entry.kind));
  }
  if (has_states()) state_ = state(entry.initial_state);
}

std::size_t AttachedPart::state(std::string_view name) const {
  const auto& found = entry_.state(name);  // throws Error for an unknown name
  return static_cast<std::size_t>(&found - entry_.states.data());
}

void AttachedPart::enter(std::size_t state, Picoseconds now) {
  MEBOTS_ASSERT(state < spent_.size() && state_ < spent_.size());
  MEBOTS_ASSERT(now >= since_, "calls come in the order of time");
  spent_[state_] += now - since_;
  since_ = now;
  state_ = state;
}

double AttachedPart::energy_j(Picoseconds now) const {
  double charge_as = entry_.part->charge_per_byte * static_cast<double>(bytes_);
  for (std::size_t i = 0; i < spent_.size(); ++i) {
    const auto time = spent_[i] + (i == state_ ? now - since_ : 0);
    charge_as += entry_.states[i].current_a * static_cast<double>(time) / kPsPerS;
  }
  return charge_as * entry_.supply_voltage_v;
}

std::string_view AttachedPart::state_name() const {
  return has_states() ? entry_.states[state_].name : std::string_view();
}

void AttachedPart::visit(state::Visitor& v) {
  v("spent", std::span(spent_));
  v("state", state_);
  v("since", since_);
  v("bytes", bytes_);
  if (state_ >= std::max<std::size_t>(1, spent_.size())) {
    throw Error(ErrorCode::state_damaged, "a saved state is damaged: part " + entry_.name + " is in no state");
  }
}

PartPort::PartPort(AttachedPart* part) : part_(part) {
  if (part_ == nullptr || !part_->has_states()) return;
  idle_ = part_->state("idle");
  active_ = part_->state("active");
}

}  // namespace mebots::soc

MEBOTS_CHIP_KIND(part, {}, [](const BoardDevice& entry, ChipHost& /*host*/) -> std::unique_ptr<Device> {
  return std::make_unique<AttachedPart>(entry);
})
