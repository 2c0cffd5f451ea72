// SPDX-License-Identifier: Apache-2.0
#include "engine/algorithm/algorithm.hpp"

#include "engine/algorithm/thread_policy.hpp"
#include "mebots/assert.hpp"

#include <algorithm>
#include <exception>
#include <map>
#include <numeric>
#include <thread>
#include <utility>

namespace mebots::master {
namespace {

/// Divides the instances into groups; each group steps on one thread. An instance that reads an OSMP buffer must step
/// before the instance that owns the buffer, so both are in the same group. The members of a continuous system or of a
/// clock group also share a group.
std::vector<std::vector<std::size_t>> groups_of(const ResolvedSystem& system, const Ensemble& ensemble) {
  std::vector<std::size_t> group(ensemble.size());
  std::iota(group.begin(), group.end(), std::size_t{0});
  const auto join = [&](std::size_t from, std::size_t to) {
    std::replace(group.begin(), group.end(), std::size_t{group[from]}, std::size_t{group[to]});
  };
  for (const auto& connection : system.connections) {
    if (connection.pointer) join(connection.from.instance, connection.to.instance);
  }
  for (const auto& continuous : system.continuous_systems) {
    for (const auto member : continuous.members) join(member, continuous.members.front());
  }
  for (const auto& clocks : system.clock_groups) {
    for (const auto member : clocks.members) join(member, clocks.members.front());
  }
  std::map<std::size_t, std::vector<std::size_t>> members;
  for (const auto i : ensemble.step_order()) members[group[i]].push_back(i);
  std::vector<std::vector<std::size_t>> groups;
  groups.reserve(members.size());
  for (auto& [name, instances] : members) groups.push_back(std::move(instances));
  return groups;
}

class Jacobi final : public Algorithm {
 public:
  explicit Jacobi(const AlgorithmContext& context)
      : slaves_(&context.slaves),
        messages_(&context.messages),
        groups_(groups_of(context.system, context.slaves.ensemble())) {
    const auto wanted = context.system.description->threads;
    const auto most = wanted == kAutomaticThreads ? std::max(1U, std::thread::hardware_concurrency()) : wanted;
    threads_ = static_cast<unsigned>(std::min<std::size_t>(most, groups_.size()));
    if (threads_ < 2) return;
    policy_ = std::make_unique<ThreadPolicy>();
    attempts_.resize(slaves_->count());
  }

  std::optional<End> step(const GridStep& span) override {
    for (std::size_t i = 0; i < slaves_->count(); ++i) slaves_->write_inputs(i, span.from);
    unfinished_.clear();
    if (policy_ && policy_->parallel()) {
      step_at_the_same_time(span);
    } else {
      for (const auto i : slaves_->ensemble().step_order()) {
        if (slaves_->begins_step(i, span.from)) take(i, slaves_->step(i, span));
      }
    }
    // All slaves have started their steps. This loop waits for pending steps, which run concurrently.
    for (auto& [i, result] : unfinished_) result = slaves_->finish(i, span, std::move(result));
    if (policy_) policy_->stepped();
    if (auto end = end_at(span.from)) return end;
    for (std::size_t i = 0; i < slaves_->count(); ++i) slaves_->read_outputs(i, span.to);
    return std::nullopt;
  }

 private:
  struct Attempt {
    StepResult result;
    std::exception_ptr error;
  };

  void take(std::size_t slave, StepResult result) {
    MEBOTS_ASSERT(slave < slaves_->count());
    if (!result.done) unfinished_.emplace_back(slave, std::move(result));
  }

  /// Returns why the run ends at t_k, or nullopt if the run continues. An interrupt takes precedence over the request
  /// of a slave.
  std::optional<End> end_at(std::int64_t k) const {
    std::optional<End> first;
    for (const auto& [i, result] : unfinished_) {
      auto end = slaves_->end_of(i, k, result);
      if (end && end->reason == EndReason::interrupted) return end;
      if (end && !first) first = std::move(end);
    }
    return first;
  }

  void step_at_the_same_time(const GridStep& span) {
    if (!pool_) pool_ = std::make_unique<StepPool>(threads_);
    messages_->hold();
    MEBOTS_ASSERT(threads_ >= 2 && !groups_.empty());
    pool_->run(groups_.size(), [this, &span](std::size_t group) {
      for (const auto i : groups_[group]) {
        if (!slaves_->begins_step(i, span.from)) continue;
        auto& attempt = attempts_[i];
        MEBOTS_ASSERT(i < attempts_.size());
        attempt.error = nullptr;
        try {
          attempt.result = slaves_->step(i, span);
        } catch (...) {
          attempt.error = std::current_exception();
          return;
        }
      }
    });
    // Releases messages and throws errors in the order of serial stepping.
    std::vector<std::string> speakers;
    std::exception_ptr first;
    for (const auto i : slaves_->ensemble().step_order()) {
      if (first || !slaves_->begins_step(i, span.from)) continue;
      speakers.push_back(slaves_->ensemble().name(i));
      first = attempts_[i].error;
      const auto& result = attempts_[i].result;
      if (!first) take(i, result);
      if (!result.done && !result.pending && !result.terminated) break;  // this slave ends the run
    }
    messages_->release(speakers);
    if (first) std::rethrow_exception(first);
  }

  SlaveSteps* slaves_;
  OrderedMessages* messages_;
  std::vector<std::vector<std::size_t>> groups_;  // the members of a group step in order on one thread
  // Results of steps that are pending, were discarded, or ended the run.
  std::vector<std::pair<std::size_t, StepResult>> unfinished_;
  // Only for parallel stepping. The pointers are null if there is only one thread.
  unsigned threads_ = 1;
  std::unique_ptr<ThreadPolicy> policy_;
  std::unique_ptr<StepPool> pool_;
  std::vector<Attempt> attempts_;  // indexed by instance
};

}  // namespace

std::unique_ptr<Algorithm> make_jacobi(const AlgorithmContext& context) {
  return std::make_unique<Jacobi>(context);
}

}  // namespace mebots::master
