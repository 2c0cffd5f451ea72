// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/master/fmu.hpp"
#include "mebots/master/message.hpp"
#include "mebots/master/slave.hpp"

#include <deque>
#include <mutex>
#include <string>
#include <vector>

namespace mebots::master {

/// A slave that runs inside this process: calls go straight into the FMU's shared library.
class FmuSlave final : public Slave {
 public:
  /// Instantiates. `log_categories` are the categories whose ordinary messages (fmi2OK) go to `messages`,
  /// "*" for all; warnings and errors always go there. `messages` must outlive the slave.
  FmuSlave(std::string name, std::shared_ptr<Fmu> fmu, std::vector<std::string> log_categories, MessageSink& messages);
  ~FmuSlave() override;
  FmuSlave(const FmuSlave&) = delete;
  FmuSlave& operator=(const FmuSlave&) = delete;

  const std::string& name() const override { return name_; }
  const modeldesc::ModelDescription& description() const override { return fmu_->description(); }

  void setup_experiment(std::int64_t start_ns, std::int64_t stop_ns) override;
  void enter_initialization() override;
  void exit_initialization() override;
  StepResult step(std::int64_t start_ns, std::int64_t duration_ns) override;
  void terminate() override;

  void get_reals(std::span<const ValueReference> references, std::span<double> values) override;
  void get_integers(std::span<const ValueReference> references, std::span<std::int32_t> values) override;
  void get_booleans(std::span<const ValueReference> references, std::span<std::int32_t> values) override;
  void get_strings(std::span<const ValueReference> references, std::span<std::string> values) override;
  void set_reals(std::span<const ValueReference> references, std::span<const double> values) override;
  void set_integers(std::span<const ValueReference> references, std::span<const std::int32_t> values) override;
  void set_booleans(std::span<const ValueReference> references, std::span<const std::int32_t> values) override;
  void set_strings(std::span<const ValueReference> references, std::span<const std::string> values) override;

  std::unique_ptr<SlaveState> save_state() override;
  void restore_state(const SlaveState& state) override;
  std::vector<std::byte> serialize(const SlaveState& state) override;
  std::unique_ptr<SlaveState> deserialize(std::span<const std::byte> bytes) override;

 private:
  struct Fmi;  // what needs FMI's C types

  void choose_categories();
  void logged(int status, std::string_view category, std::string text);
  std::string with_names(std::string_view text) const;
  void check(int status, const char* function);
  void deliver_held();
  std::string said() const;
  [[noreturn]] void fail(const char* function, std::string_view what);

  std::string name_;
  std::shared_ptr<Fmu> fmu_;
  std::vector<std::string> log_categories_;
  MessageSink* sink_;
  const Fmi2Functions* functions_;
  std::unique_ptr<Fmi> fmi_;

  std::int64_t time_ns_ = 0;
  bool unusable_ = false;  // after fmi2Fatal no call is allowed, not even freeing
  std::vector<const char*> texts_;

  // The FMU may log from threads of its own.
  std::mutex log_mutex_;
  // Errors are held until the call is over: a call that fails carries them in its exception.
  struct Held {
    std::string category;
    std::string text;
  };
  std::vector<Held> held_;
  std::deque<std::string> last_words_;
};

}  // namespace mebots::master
