// SPDX-License-Identifier: Apache-2.0
#include "exchange_probes.hpp"

#include "fmi/fmu.hpp"
#include "mebots/error.hpp"
#include "message/message_hub.hpp"
#include "slave/fmi/make_slave.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace mebots::check {
namespace {

constexpr int kEulerSteps = 20;
constexpr int kEulerHalf = kEulerSteps / 2;
constexpr double kEulerStep_s = 0.01;
constexpr int kMostUpdates = 1000;
/// Larger states result from the integration method (explicit Euler), not from the FMU.
constexpr double kDiverged = 1e100;

/// A function's names in FMI 2.0 and FMI 3.0, for crash reports.
struct FunctionName {
  const char* fmi2;
  const char* fmi3;
};

struct Saved {
  std::unique_ptr<master::SlaveState> instance;
  std::vector<double> indicators;
  double next_event_s;
  bool ended;
};

/// Integrates an instance with the explicit Euler method. This is accurate enough to check for finite derivatives and
/// ending events.
class Euler {
 public:
  Euler(const std::filesystem::path& archive, const std::filesystem::path& folder, Witness& witness)
      : witness_(witness),
        fmu_(std::make_shared<master::Fmu>(archive, folder, master::FmuKind::model_exchange)),
        is_fmi3_(fmu_->description().is_fmi3()) {
    const auto& experiment = fmu_->description().default_experiment;
    step_s_ = experiment.step_size_s.value_or(kEulerStep_s);
    start_s_ = experiment.start_time_s.value_or(0);
    doing({"fmi2Instantiate", "fmi3InstantiateModelExchange"});
    parts_ = master::make_continuous_here({"fmu", fmu_, {}, {}, {}}, messages_);
    start(experiment);
  }

  void run(int first, int last) {
    for (int k = first; k < last && !ended_; ++k) step(k);
  }
  Saved saved() {
    doing({"fmi2GetFMUstate", "fmi3GetFMUState"});
    return {parts_.slave->save_state(), indicators_, next_event_s_, ended_};
  }
  void restore(const Saved& saved) {
    doing({"fmi2SetFMUstate", "fmi3SetFMUState"});
    parts_.slave->restore_state(*saved.instance);
    indicators_ = saved.indicators;
    next_event_s_ = saved.next_event_s;
    ended_ = saved.ended;
    read_states();
  }
  const std::vector<double>& states() const { return states_; }

 private:
  void doing(FunctionName name) { witness_.doing(name_of(name)); }
  const char* name_of(FunctionName name) const { return is_fmi3_ ? name.fmi3 : name.fmi2; }

  void start(const modeldesc::DefaultExperiment& experiment) {
    doing({"fmi2EnterInitializationMode", "fmi3EnterInitializationMode"});
    master::Experiment wished;
    wished.tolerance = experiment.usable_tolerance();
    wished.start_ns = std::llround(start_s_ * 1e9);
    parts_.slave->setup_experiment(wished);
    parts_.slave->enter_initialization();
    doing({"fmi2ExitInitializationMode", "fmi3ExitInitializationMode"});
    parts_.slave->exit_initialization();
    states_.resize(parts_.instance->state_count());
    derivatives_.resize(states_.size());
    indicators_.resize(parts_.instance->indicator_count());
    settle_event();
  }

  void read_states() {
    doing({"fmi2GetContinuousStates", "fmi3GetContinuousStates"});
    if (!states_.empty()) parts_.instance->get_states(states_);
  }

  void step(int k) {
    auto& instance = *parts_.instance;
    doing({"fmi2GetDerivatives", "fmi3GetContinuousStateDerivatives"});
    if (!states_.empty()) require(instance.get_derivatives(derivatives_), "the derivatives");
    for (std::size_t i = 0; i < states_.size(); ++i) {
      if (!std::isfinite(derivatives_[i])) {
        throw Error(
            fmt::format("the derivative of the state {} is {} at step {}", instance.state_name(i), derivatives_[i], k));
      }
      states_[i] += step_s_ * derivatives_[i];
      if (!(std::abs(states_[i]) < kDiverged)) ended_ = true;
    }
    if (ended_) return;
    doing({"fmi2SetTime", "fmi3SetTime"});
    const double time_s = start_s_ + (k + 1) * step_s_;
    instance.set_time(time_s);
    doing({"fmi2SetContinuousStates", "fmi3SetContinuousStates"});
    if (!states_.empty()) require(instance.set_states(states_), "its states");
    doing({"fmi2CompletedIntegratorStep", "fmi3CompletedIntegratorStep"});
    const auto completed = instance.needs_completed_step() ? instance.completed_step() : master::CompletedStep{};
    ended_ = completed.terminate;
    const bool crossed = has_crossed();
    if (ended_ || !(completed.enter_event_mode || crossed || next_event_s_ <= time_s)) return;
    doing({"fmi2EnterEventMode", "fmi3EnterEventMode"});
    instance.enter_event_mode();
    settle_event();
  }

  /// True if an event indicator changed sign since the last call.
  bool has_crossed() {
    if (indicators_.empty()) return false;
    const auto before = indicators_;
    doing({"fmi2GetEventIndicators", "fmi3GetEventIndicators"});
    require(parts_.instance->get_indicators(indicators_), "the event indicators");
    return !std::ranges::equal(before, indicators_, [](double a, double b) { return (a > 0) == (b > 0); });
  }

  void settle_event() {
    constexpr FunctionName kUpdate = {"fmi2NewDiscreteStates", "fmi3UpdateDiscreteStates"};
    bool again = true;
    for (int i = 0; again; ++i) {
      if (i == kMostUpdates) {
        throw Error(fmt::format("{} requests another update after {} updates", name_of(kUpdate), kMostUpdates));
      }
      doing(kUpdate);
      const auto update = parts_.instance->update_discrete_states();
      again = update.needs_another;
      next_event_s_ = update.next_event_s.value_or(HUGE_VAL);
      ended_ = update.terminate;
      if (ended_) return;
    }
    doing({"fmi2EnterContinuousTimeMode", "fmi3EnterContinuousTimeMode"});
    parts_.instance->enter_continuous_time_mode();
    read_states();
    has_crossed();
  }

  static void require(master::Evaluation evaluation, const char* what) {
    if (evaluation != master::Evaluation::ok) throw Error(fmt::format("the FMU discards the call for {}", what));
  }

  Witness& witness_;
  std::shared_ptr<master::Fmu> fmu_;
  bool is_fmi3_;
  master::MessageHub messages_;
  master::ContinuousParts parts_ = {};
  double step_s_ = 0;
  double start_s_ = 0;
  std::vector<double> states_;
  std::vector<double> derivatives_;
  std::vector<double> indicators_;
  double next_event_s_ = HUGE_VAL;
  bool ended_ = false;
};

void check_restored_run(Euler& euler, Witness& witness) {
  euler.run(0, kEulerHalf);
  const auto half = euler.saved();
  euler.run(kEulerHalf, kEulerSteps);
  const auto wanted = euler.states();
  euler.restore(half);
  euler.run(kEulerHalf, kEulerSteps);
  if (euler.states() == wanted) return;
  witness.error("after a restored state, the continuous states have other bits",
                "save all that derivatives and events depend on");
}

}  // namespace

std::vector<ChildProbe> exchange_probes(const std::filesystem::path& archive, const std::filesystem::path& folder,
                                        const modeldesc::ModelDescription& model) {
  const auto probe = [&](const char* name, std::string skipped, void (*work)(Euler&, Witness&), bool is_plain) {
    const auto run = [archive, folder, work](Witness& witness) {
      try {
        Euler euler(archive, folder, witness);
        work(euler, witness);
      } catch (const Error& error) {
        witness.error(error.what(), "see the messages that the FMU logged");
      }
    };
    return ChildProbe{name, std::move(skipped), run, is_plain};
  };
  const std::string no_solver = model.model_exchange ? "" : "the FMU does not offer model exchange";
  const bool has_states = model.model_exchange && model.model_exchange->can_get_and_set_fmu_state;
  return {probe(
              "derivatives are finite, and events end", no_solver,
              [](Euler& euler, Witness& /*witness*/) { euler.run(0, kEulerSteps); }, true),
          probe("a saved state of model exchange restores",
                !no_solver.empty() || has_states ? no_solver : "the FMU does not offer to save its state",
                &check_restored_run, false)};
}

}  // namespace mebots::check
