// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "face.hpp"
#include "legal.hpp"
#include "logger.hpp"
#include "mebots/fmi2/types.hpp"
#include "saved_state.hpp"
#include "values.hpp"

#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace mebots::shell {

/// An instance of the FMU. Every method throws mebots::Error for errors that the caller can correct. If a method
/// throws, it changes nothing, except where its comment states otherwise.
class Instance final : public Host {
 public:
  Instance(const Definition& definition, const Version& version, Logger logger, std::filesystem::path resources);

  void enter_configuration();
  void exit_configuration();

  void setup_experiment(double start_s, std::optional<double> stop_s);
  void enter_initialization();
  /// Leaves initialization mode. An error in the model's parameters sets the state to `error`.
  void exit_initialization();
  void terminate();
  void reset();

  using References = std::span<const fmi2ValueReference>;
  void get(References references, std::span<fmi2Real> values);
  void get(References references, std::span<fmi2Integer> values);
  void get_booleans(References references, std::span<fmi2Boolean> values);
  /// The texts stay valid until the next call.
  void get(References references, std::span<fmi2String> values);
  void set(References references, std::span<const fmi2Real> values);
  void set(References references, std::span<const fmi2Integer> values);
  void set_booleans(References references, std::span<const fmi2Boolean> values);
  void set(References references, std::span<const fmi2String> values);

  /// Returns the bytes of the Binary that begins in this row. The bytes are valid until the next call.
  std::span<const std::uint8_t> get_binary(fmi2ValueReference reference);
  /// Stores a copy of `bytes`.
  void set_binary(fmi2ValueReference reference, std::span<const std::uint8_t> bytes);

  /// Returns the number of elements of the FMI 3.0 variable that begins in this row. A variable size depends on the
  /// current value of the structural parameter.
  std::size_t elements_of(const Variable& variable) const;

  /// Advances from point_s by step_s. Checks the arguments first. If the model throws, the state becomes `error`.
  void do_step(double point_s, double step_s);
  double time_s() const;
  Status last_step_status() const { return last_step_status_; }

  SavedState save();
  /// Restores a state. If a check of `saved` fails, changes nothing. If a later error occurs, the state becomes
  /// `error`.
  void restore(const SavedState& saved);

  State state() const { return state_; }
  void set_state(State state) { state_ = state; }
  Logger& logger() { return logger_; }
  const Definition& definition() const { return definition_; }
  const Version& version() const { return version_; }
  Owner owner() const { return {definition_.model_identifier, version_.token_name, definition_.*version_.token}; }

  const std::filesystem::path& resources() const override;
  void log(Severity severity, std::string_view category, std::string_view message) override;

 private:
  template <typename T, typename Read>
  void get_values(References references, std::span<T> values, Type type, Read read);
  template <typename T, typename Check, typename Write>
  void set_values(References references, std::span<const T> values, Type type, Check check, Write write);
  void check_may_set(const Variable& variable) const;
  /// In initialization mode, creates the model from the current values, so that outputs exist.
  void bring_model_up_to_date();
  std::vector<std::byte> values(Causality causality);
  /// Creates a model and stores its messages in place of sending them. Errors are sent at once.
  std::unique_ptr<Model> make_model(void* variables, std::int64_t start_ns);
  void take(std::unique_ptr<Model> model);
  /// Sends the stored messages once, at the end of initialisation, even if the model was created several times.
  void deliver_held_messages();

  const Definition& definition_;
  const Version& version_;
  Logger logger_;
  std::filesystem::path resources_;
  State state_ = State::instantiated;
  bool experiment_is_set_ = false;
  std::int64_t start_ns_ = 0;
  std::int64_t time_ns_ = 0;
  std::optional<std::int64_t> stop_ns_;
  Status last_step_status_ = Status::ok;
  std::deque<std::string> texts_made_;  // on-demand texts of the last fmi2GetString; a deque keeps addresses
  Binaries binaries_;                   // of inputs
  std::shared_ptr<void> variables_;     // outlives the model
  std::unique_ptr<Model> model_;
  std::uint64_t layout_ = 0;    // of the model's visited state
  bool model_is_stale_ = true;  // parameters or inputs were set after the model was created

  struct HeldMessage {
    Severity severity;
    std::string category;
    std::string text;
  };
  std::vector<HeldMessage> held_;
  bool holds_messages_ = false;
};

/// Converts a path from the importing tool, which is UTF-8 on every system.
std::filesystem::path path_of_text(std::string_view utf8);

/// Returns the folder of a `file:` URI (RFC 8089). Decodes percent-encoded bytes. Throws mebots::Error.
std::filesystem::path path_of_file_uri(std::string_view uri);

}  // namespace mebots::shell
