// SPDX-License-Identifier: Apache-2.0
#include "run/simulation.hpp"

#include "base/time.hpp"

#include "algorithm/step_in_parts.hpp"
#include "algorithm/step_pool.hpp"
#include "algorithm/thread_policy.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <thread>

namespace mebots::master {
namespace {

const std::atomic<bool> kNeverInterrupted{false};

}  // namespace

Simulation::Simulation(const ResolvedSystem& system, MessageSink& messages, const SlaveOptions& options)
    : system_(&system),
      messages_(messages),
      ensemble_(system, messages_, options),
      step_ns_(system.description->step_ns),
      last_step_(system.description->stop_time_ns / step_ns_),
      order_(system.order),
      interrupted_(&kNeverInterrupted) {
  for (std::size_t i = 0; i < ensemble_.size(); ++i) multiples_.push_back(ensemble_.step_ns(i) / step_ns_);
  group_slaves();
}

Simulation::~Simulation() = default;

void Simulation::group_slaves() {
  // The reader of a buffer must be done before its owner steps on: they stay on one thread, in their order.
  std::vector<std::size_t> group(ensemble_.size());
  std::iota(group.begin(), group.end(), std::size_t{0});
  for (const auto& connection : system_->connections) {
    if (!connection.pointer) continue;
    const auto from = group[connection.from.instance];
    std::replace(group.begin(), group.end(), from, group[connection.to.instance]);
  }
  std::map<std::size_t, std::vector<std::size_t>> members;
  for (const auto i : ensemble_.step_order()) members[group[i]].push_back(i);
  for (auto& [name, instances] : members) groups_.push_back(std::move(instances));

  const auto threads = system_->description->threads;
  const auto wanted = threads == kAutomaticThreads ? std::max(1U, std::thread::hardware_concurrency()) : threads;
  if (std::min<std::size_t>(wanted, groups_.size()) < 2) return;
  policy_ = std::make_unique<ThreadPolicy>();
  threads_ = static_cast<unsigned>(std::min<std::size_t>(wanted, groups_.size()));
  attempts_.resize(ensemble_.size());
}

void Simulation::initialize() {
  ensemble_.initialize(system_->description->stop_time_ns);
  reach_point();
}

void Simulation::resume(std::span<const std::byte> bytes) {
  ensemble_.initialize(system_->description->stop_time_ns);
  restore_state(deserialize(bytes));
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
  ++step_;  // only now: a point with a value that makes no sense was not reached
  reach_point();
  return true;
}

bool Simulation::step_slaves() {
  return order_.empty() ? step_jacobi() : step_gauss_seidel();
}

void Simulation::read_outputs_at(std::int64_t step, std::size_t instance) {
  if (begins_step(instance, step)) ensemble_.read_outputs(instance, step * step_ns_);
}

StepResult Simulation::step_slave(std::size_t instance) {
  auto& slave = ensemble_.slave(instance);
  const auto duration_ns = ensemble_.step_ns(instance);
  if (system_->instances[instance].description->divide_discarded) {
    return step_in_parts(slave, time_ns(), duration_ns, *interrupted_);
  }
  return slave.step(time_ns(), duration_ns);
}

StepResult Simulation::finish_slave(std::size_t instance, StepResult result) {
  if (result.pending) result = ensemble_.slave(instance).finish_step(*interrupted_);
  if (result.done || result.terminated || result.cancelled) return result;
  throw SlaveError(fmt::format(
      "instance '{}' at {} s: fmi2DoStep refused a step of {} s (fmi2Discard; it came to {} s). Take a smaller step, "
      "or set \"on_discard\": \"divide\" for the instance. {}",
      ensemble_.name(instance), to_seconds(time_ns()), to_seconds(ensemble_.step_ns(instance)),
      result.last_successful_s.value_or(to_seconds(time_ns())), result.messages));
}

bool Simulation::step_jacobi() {
  for (std::size_t i = 0; i < ensemble_.size(); ++i) {
    if (begins_step(i, step_)) ensemble_.write_inputs(i, time_ns());
  }
  // Those that are not done at once: slaves that step on their own time do so side by side, all started before any is
  // waited for.
  results_.clear();
  const auto take = [&](std::size_t i, StepResult result) {
    if (!result.done) results_.emplace_back(i, std::move(result));
  };
  if (policy_ && policy_->parallel()) {
    step_in_parallel();
    for (const auto i : ensemble_.step_order()) {
      if (begins_step(i, step_)) take(i, attempts_[i].result);
    }
  } else {
    for (const auto i : ensemble_.step_order()) {
      if (begins_step(i, step_)) take(i, step_slave(i));
    }
  }
  for (auto& [i, result] : results_) result = finish_slave(i, std::move(result));
  if (policy_) policy_->stepped();
  if (ended_by_slave()) return false;
  for (std::size_t i = 0; i < ensemble_.size(); ++i) read_outputs_at(step_ + 1, i);
  return true;
}

bool Simulation::step_gauss_seidel() {
  const auto before = ensemble_.outputs();
  for (const auto i : order_) {
    if (begins_step(i, step_)) {
      ensemble_.write_inputs(i, time_ns());
      results_.clear();
      const auto& result = results_.emplace_back(i, finish_slave(i, step_slave(i))).second;
      if (result.terminated || result.cancelled) ensemble_.bring_back(before);  // to the last point that all reached
      if (ended_by_slave()) return false;
    }
    read_outputs_at(step_ + 1, i);
  }
  return true;
}

bool Simulation::ended_by_slave() {
  for (const auto& [i, result] : results_) {
    if (result.cancelled) {
      finish(EndReason::interrupted, fmt::format("interrupted at {} s", to_seconds(time_ns())));
      return true;
    }
  }
  for (const auto& [i, result] : results_) {
    if (!result.terminated) continue;
    // Others may have stepped on, but the last point that all reached is this one: it is the end.
    finish(EndReason::terminated, fmt::format("instance '{}' ended the simulation at {} s", ensemble_.name(i),
                                              result.last_successful_s.value_or(to_seconds(time_ns()))));
    return true;
  }
  return false;
}

void Simulation::step_in_parallel() {
  if (!pool_) pool_ = std::make_unique<StepPool>(threads_);  // not before it is needed
  messages_.hold();
  pool_->run(groups_.size(), [this](std::size_t group) {
    for (const auto i : groups_[group]) {
      if (!begins_step(i, step_)) continue;
      auto& attempt = attempts_[i];
      attempt.error = nullptr;
      try {
        attempt.result = step_slave(i);
      } catch (...) {
        attempt.error = std::current_exception();
        return;
      }
    }
  });
  // Messages and errors as they would have come one after the other.
  std::vector<std::string> speakers;
  std::exception_ptr first;
  for (const auto i : ensemble_.step_order()) {
    if (first || !begins_step(i, step_)) continue;
    speakers.push_back(ensemble_.name(i));
    first = attempts_[i].error;
    const auto& result = attempts_[i].result;
    if (!result.done && !result.pending && !result.terminated) break;  // the run ends with it
  }
  messages_.release(speakers);
  if (first) std::rethrow_exception(first);
}

const End& Simulation::run(const std::atomic<bool>& interrupted) {
  interrupted_ = &interrupted;
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
