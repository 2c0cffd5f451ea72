// SPDX-License-Identifier: Apache-2.0
#include "run/simulation.hpp"

#include "base/signal_guard.hpp"
#include "base/time.hpp"
#include "mebots/assert.hpp"
#include "mebots/state/layout.hpp"
#include "mebots/state/save.hpp"

#include <fmt/format.h>

namespace mebots::master {
namespace {

const std::atomic<bool>* flag_of(const SlaveOptions& options) {
  return options.interrupted != nullptr ? options.interrupted : &kNeverInterrupted;
}

}  // namespace

Simulation::Simulation(const ResolvedSystem& system, MessageSink& messages, const SlaveOptions& options)
    : interrupted_(flag_of(options)),
      messages_(messages),
      ensemble_(system, messages_, options),
      slaves_(system, ensemble_, *interrupted_),
      algorithm_(make_algorithm({system, slaves_, messages_})),
      grid_(system.description->grid()),
      stop_ns_(system.description->stop_time_ns) {
  if (system.step_control) control_ = std::make_unique<StepControl>(system, slaves_, options.overrides);
}

Simulation::~Simulation() = default;

void Simulation::initialize() {
  ensemble_.initialize(stop_ns_);
  reach_point();
}

void Simulation::resume(std::span<const std::byte> bytes) {
  ensemble_.initialize(stop_ns_);
  restore_state(deserialize(bytes));
}

void Simulation::reach_point() {
  MEBOTS_ASSERT(!ended_ && step_ >= 0);
  const Point point{step_, time_ns()};
  std::optional<std::string> wish;
  for (auto* observer : observers_) {
    auto one_wish = observer->reached(point);
    if (one_wish && !wish) wish = std::move(one_wish);
  }
  if (wish) {
    finish({EndReason::stop_condition, *wish});
  } else if (point.time_ns >= stop_ns_) {
    finish({EndReason::stop_time, fmt::format("the stop time {} s was reached", grid_.time_s(point.time_ns))});
  } else {
    for (auto* observer : observers_) observer->continues(point);
  }
}

void Simulation::finish(End end) {
  MEBOTS_ASSERT(!ended_, "a run ends once");
  ended_ = true;
  end_ = std::move(end);
  for (auto* observer : observers_) observer->ended({step_, time_ns()});
}

bool Simulation::step() {
  if (ended_) return false;
  std::int64_t reached = step_ + 1;
  std::optional<End> end;
  try {
    stop_if_interrupted(*interrupted_);
    end = control_ ? control_->step(*algorithm_, step_, reached) : algorithm_->step({step_, reached});
  } catch (const InterruptedError& error) {
    end = interrupted_at(time_ns());
    if (*error.what() != '\0') end->text += fmt::format("; {}", error.what());
  }
  if (end) {
    finish(std::move(*end));
    return false;
  }
  step_ = reached;  // set after the outputs were read, because a point with a NaN or infinite output is not reached
  reach_point();
  return true;
}

const End& Simulation::run() {
  while (step()) {
  }
  return end_;
}

SimulationState Simulation::save_state() {
  SimulationState state;
  state.step = step_;
  for (std::size_t i = 0; i < ensemble_.size(); ++i) state.slaves.push_back(ensemble_.slave(i).save_state());
  state.master = state::save(*this);
  state.layout = state::layout_of(*this);
  return state;
}

void Simulation::visit(state::Visitor& v) {
  v("ensemble", ensemble_);
  if (control_) v("step_control", *control_);
  for (auto* observer : observers_) {
    if (!observer->state_name().empty()) v(observer->state_name(), *observer);
  }
}

void Simulation::restore_state(const SimulationState& state) {
  if (state.slaves.size() != ensemble_.size()) {
    throw Error(ErrorCode::state_of_other_fmu,
                "a saved state belongs to another system: it has another number of instances");
  }
  if (state.layout != state::layout_of(*this)) {
    throw Error(
        ErrorCode::state_of_other_build,
        "a saved state contains other values than this run, or was written by another version of mebots; run the "
        "config again");
  }
  for (std::size_t i = 0; i < ensemble_.size(); ++i) ensemble_.slave(i).restore_state(*state.slaves[i]);
  step_ = state.step;
  ended_ = false;
  end_ = {};
  state::restore(*this, state.master);
  // Saved states contain no addresses of OSMP buffers, so outputs are read again.
  for (std::size_t i = 0; i < ensemble_.size(); ++i) slaves_.read_outputs(i, step_);
}

std::vector<std::byte> Simulation::serialize(const SimulationState& state) {
  MEBOTS_ASSERT(state.slaves.size() == ensemble_.size(), "the state is one of this simulation");
  state::Writer writer;
  writer.put(state.step);
  writer.put(state.layout);
  writer.put(state.master);
  for (std::size_t i = 0; i < ensemble_.size(); ++i) writer.put(ensemble_.slave(i).serialize(*state.slaves[i]));
  return writer.take();
}

SimulationState Simulation::deserialize(std::span<const std::byte> bytes) {
  state::Reader reader(bytes);
  SimulationState state;
  reader.get(state.step);
  reader.get(state.layout);
  reader.get(state.master);
  for (std::size_t i = 0; i < ensemble_.size(); ++i) {
    std::vector<std::byte> slave;
    reader.get(slave);
    state.slaves.push_back(ensemble_.slave(i).deserialize(slave));
  }
  if (!reader.at_end())
    throw Error(ErrorCode::state_of_other_fmu,
                "a saved state belongs to another system: it is longer than the state of this one");
  return state;
}

}  // namespace mebots::master
