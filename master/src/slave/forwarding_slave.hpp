// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "slave/slave.hpp"

#include <utility>

namespace mebots::master {

/// A slave that forwards every call to another slave. Derived classes change some of the calls.
class ForwardingSlave : public Slave {
 public:
  explicit ForwardingSlave(std::unique_ptr<Slave> inner) : inner_(std::move(inner)) {}

  const std::string& name() const override { return inner_->name(); }
  const modeldesc::ModelDescription& description() const override { return inner_->description(); }

  void setup_experiment(const Experiment& experiment) override { inner_->setup_experiment(experiment); }
  void enter_initialization() override { inner_->enter_initialization(); }
  void exit_initialization() override { inner_->exit_initialization(); }
  StepResult step(std::int64_t start_ns, std::int64_t duration_ns) override {
    return inner_->step(start_ns, duration_ns);
  }
  StepResult finish_step(const std::atomic<bool>& cancel) override { return inner_->finish_step(cancel); }
  void terminate() override { inner_->terminate(); }
  std::optional<std::string> free_instance() override { return inner_->free_instance(); }

  std::uint32_t output_derivative_order() const override { return inner_->output_derivative_order(); }
  bool takes_input_derivatives() const override { return inner_->takes_input_derivatives(); }
  std::optional<double> next_event_s() const override { return inner_->next_event_s(); }
  std::vector<std::string> notices() const override { return inner_->notices(); }
  void get_output_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                              std::span<double> values) override {
    inner_->get_output_derivatives(references, orders, values);
  }
  void set_input_derivatives(std::span<const ValueReference> references, std::span<const std::int32_t> orders,
                             std::span<const double> values) override {
    inner_->set_input_derivatives(references, orders, values);
  }

  void get_reals(std::span<const ValueReference> references, std::span<double> values) override {
    inner_->get_reals(references, values);
  }
  void get_integers(std::span<const ValueReference> references, std::span<std::int64_t> values) override {
    inner_->get_integers(references, values);
  }
  void get_booleans(std::span<const ValueReference> references, std::span<std::int64_t> values) override {
    inner_->get_booleans(references, values);
  }
  void get_strings(std::span<const ValueReference> references, std::span<std::string> values) override {
    inner_->get_strings(references, values);
  }
  void set_reals(std::span<const ValueReference> references, std::span<const double> values) override {
    inner_->set_reals(references, values);
  }
  void set_integers(std::span<const ValueReference> references, std::span<const std::int64_t> values) override {
    inner_->set_integers(references, values);
  }
  void set_booleans(std::span<const ValueReference> references, std::span<const std::int64_t> values) override {
    inner_->set_booleans(references, values);
  }
  void set_strings(std::span<const ValueReference> references, std::span<const std::string> values) override {
    inner_->set_strings(references, values);
  }
  void get_binaries(std::span<const ValueReference> references, std::span<std::string> values) override {
    inner_->get_binaries(references, values);
  }
  void set_binaries(std::span<const ValueReference> references, std::span<const std::string> values) override {
    inner_->set_binaries(references, values);
  }

  std::unique_ptr<SlaveState> save_state() override { return inner_->save_state(); }
  void restore_state(const SlaveState& state) override { inner_->restore_state(state); }
  std::vector<std::byte> serialize(const SlaveState& state) override { return inner_->serialize(state); }
  std::unique_ptr<SlaveState> deserialize(std::span<const std::byte> bytes) override {
    return inner_->deserialize(bytes);
  }

 protected:
  Slave& inner() { return *inner_; }

 private:
  std::unique_ptr<Slave> inner_;
};

}  // namespace mebots::master
