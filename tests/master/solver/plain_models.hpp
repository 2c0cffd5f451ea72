// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solver/continuous_instance.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

/// Defines continuous models in C++ without FMI.
namespace mebots::master {

/// A model that consists of functions of its variables. `values` contains all Reals; the first ones are the states.
class PlainModel : public ContinuousInstance {
 public:
  using Values = std::vector<double>;

  struct Laws {
    std::size_t states = 0;
    std::size_t values = 0;  // number of all Reals
    std::size_t indicators = 0;
    std::function<void(double t, const Values& v, std::span<double> derivatives)> derivatives = {};
    std::function<void(double t, Values& v)> outputs = {};  // computes the outputs from states and inputs
    std::function<void(double t, const Values& v, std::span<double> indicators)> indicators_of = {};
    std::function<DiscreteUpdate(double t, Values& v)> update = {};
    std::function<CompletedStep(double t, Values& v)> completed = {};
  };

  PlainModel(std::string name, Laws laws, Values start)
      : laws_(std::move(laws)), name_(std::move(name)), v_(std::move(start)) {
    v_.resize(laws_.values);
  }

  const std::string& name() const override { return name_; }
  std::size_t state_count() const override { return laws_.states; }
  std::size_t indicator_count() const override { return laws_.indicators; }
  std::string state_name(std::size_t state) const override { return "x" + std::to_string(state); }

  void set_time(double time_s) override { t_ = time_s; }
  void get_states(std::span<double> states) override { std::copy_n(v_.begin(), states.size(), states.begin()); }
  Evaluation set_states(std::span<const double> states) override {
    std::ranges::copy(states, v_.begin());
    return Evaluation::ok;
  }
  Evaluation get_derivatives(std::span<double> derivatives) override {
    ++evaluations;
    laws_.derivatives(t_, v_, derivatives);
    return Evaluation::ok;
  }
  Evaluation get_indicators(std::span<double> indicators) override {
    laws_.indicators_of(t_, v_, indicators);
    return Evaluation::ok;
  }
  void get_nominals(std::span<double> nominals) override { std::ranges::fill(nominals, 1); }

  Evaluation get_outputs(std::span<const ValueReference> references, std::span<double> values) override {
    if (laws_.outputs) laws_.outputs(t_, v_);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = v_[references[i]];
    return Evaluation::ok;
  }
  Evaluation set_inputs(std::span<const ValueReference> references, std::span<const double> values) override {
    for (std::size_t i = 0; i < values.size(); ++i) v_[references[i]] = values[i];
    return Evaluation::ok;
  }

  void enter_event_mode() override { in_event_mode = true; }
  DiscreteUpdate update_discrete_states() override { return laws_.update ? laws_.update(t_, v_) : DiscreteUpdate{}; }
  void enter_continuous_time_mode() override { in_event_mode = false; }
  CompletedStep completed_step() override { return laws_.completed ? laws_.completed(t_, v_) : CompletedStep{}; }

  double value(ValueReference reference) {
    double result = 0;
    get_outputs({&reference, 1}, {&result, 1});
    return result;
  }
  double time() const { return t_; }

  bool in_event_mode = true;
  std::size_t evaluations = 0;

 protected:
  Laws laws_;

 private:
  std::string name_;
  double t_ = 0;
  Values v_;
};

}  // namespace mebots::master
