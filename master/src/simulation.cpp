// SPDX-License-Identifier: Apache-2.0
#include "mebots/master/simulation.hpp"

#include "mebots/master/time.hpp"

#include <fmt/format.h>

namespace mebots::master {

Simulation::Simulation(const ResolvedSystem& system, MessageSink& messages, const SlaveOptions& options)
    : system_(&system),
      ensemble_(system, messages, options),
      step_ns_(system.description->step_ns),
      last_step_(system.description->stop_time_ns / step_ns_) {
  for (std::size_t i = 0; i < ensemble_.size(); ++i) multiples_.push_back(ensemble_.step_ns(i) / step_ns_);
}

void Simulation::initialize() {
  ensemble_.initialize(system_->description->stop_time_ns);
  reach_point();
}

void Simulation::reach_point() {
  const Point point{step_, time_ns()};
  std::optional<std::string> wish;
  for (auto* observer : observers_) {
    auto one_wish = observer->reached(point);
    if (one_wish && !wish) wish = std::move(one_wish);
  }
  if (wish) {
    finish(EndReason::stop_condition, *wish);
  } else if (step_ == last_step_) {
    finish(EndReason::stop_time, fmt::format("the stop time {} s was reached", to_seconds(point.time_ns)));
  }
}

void Simulation::finish(EndReason reason, std::string text) {
  ended_ = true;
  end_ = {reason, std::move(text)};
  for (auto* observer : observers_) observer->ended({step_, time_ns()});
}

bool Simulation::step() {
  if (ended_) return false;
  if (!step_slaves()) return false;
  const auto next = step_ + 1;
  for (std::size_t i = 0; i < ensemble_.size(); ++i) {
    if (begins_step(i, next)) ensemble_.read_outputs(i, next * step_ns_);
  }
  step_ = next;  // only now: a point with a value that makes no sense was not reached
  reach_point();
  return true;
}

bool Simulation::step_slaves() {
  for (std::size_t i = 0; i < ensemble_.size(); ++i) {
    if (begins_step(i, step_)) ensemble_.write_inputs(i);
  }
  std::string terminated;
  for (const auto i : ensemble_.step_order()) {
    if (!begins_step(i, step_)) continue;
    const auto result = ensemble_.slave(i).step(time_ns(), ensemble_.step_ns(i));
    if (result.done) continue;
    const auto reached_s = result.last_successful_s.value_or(to_seconds(time_ns()));
    if (!result.terminated) {
      throw SlaveError(fmt::format(
          "instance '{}' at {} s: fmi2DoStep refused a step of {} s (fmi2Discard; it came to {} s). A smaller "
          "step may help. {}",
          ensemble_.name(i), to_seconds(time_ns()), to_seconds(ensemble_.step_ns(i)), reached_s, result.messages));
    }
    if (terminated.empty()) {
      terminated = fmt::format("instance '{}' ended the simulation at {} s", ensemble_.name(i), reached_s);
    }
  }
  if (terminated.empty()) return true;
  // The others stepped too, but the last point that all reached is this one: it is the end.
  finish(EndReason::terminated, terminated);
  return false;
}

const End& Simulation::run(const std::atomic<bool>& interrupted) {
  while (!ended_) {
    if (interrupted.load(std::memory_order_relaxed)) {
      finish(EndReason::interrupted, fmt::format("interrupted at {} s", to_seconds(time_ns())));
      break;
    }
    step();
  }
  return end_;
}

SimulationState Simulation::save_state() {
  SimulationState state;
  state.step = step_;
  for (std::size_t i = 0; i < ensemble_.size(); ++i) state.slaves.push_back(ensemble_.slave(i).save_state());
  state::Writer writer;
  ensemble_.save_values(writer);
  for (auto* observer : observers_) observer->save(writer);
  state.master = writer.take();
  return state;
}

void Simulation::restore_state(const SimulationState& state) {
  if (state.slaves.size() != ensemble_.size()) {
    throw Error("a saved state belongs to another ensemble: its instances are of another number");
  }
  for (std::size_t i = 0; i < ensemble_.size(); ++i) ensemble_.slave(i).restore_state(*state.slaves[i]);
  step_ = state.step;
  ended_ = false;
  end_ = {};
  state::Reader reader(state.master);
  ensemble_.restore_values(reader);
  for (auto* observer : observers_) observer->restore(reader);
  // Addresses of buffers are no part of a state: ask for them anew.
  for (std::size_t i = 0; i < ensemble_.size(); ++i) {
    if (begins_step(i, step_)) ensemble_.read_outputs(i, time_ns());
  }
}

std::vector<std::byte> Simulation::serialize(const SimulationState& state) {
  state::Writer writer;
  writer.put(state.step);
  writer.put(state.master);
  for (std::size_t i = 0; i < ensemble_.size(); ++i) writer.put(ensemble_.slave(i).serialize(*state.slaves[i]));
  return writer.take();
}

SimulationState Simulation::deserialize(std::span<const std::byte> bytes) {
  state::Reader reader(bytes);
  SimulationState state;
  reader.get(state.step);
  reader.get(state.master);
  for (std::size_t i = 0; i < ensemble_.size(); ++i) {
    std::vector<std::byte> slave;
    reader.get(slave);
    state.slaves.push_back(ensemble_.slave(i).deserialize(slave));
  }
  if (!reader.at_end()) throw Error("a saved state belongs to another ensemble: it is longer than this one's");
  return state;
}

}  // namespace mebots::master
