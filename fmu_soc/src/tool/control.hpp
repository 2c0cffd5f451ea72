// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "observe/session.hpp"
#include "soc/soc.hpp"
#include "tool/console.hpp"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <deque>
#include <functional>
#include <span>
#include <string>
#include <string_view>

namespace mebots::soc::tool {

/// Console of a program that a test controls. Input arrives in simulated time, so that a run does not depend on the
/// host's time.
class ControlledConsole final : public Console {
 public:
  void write(std::span<const char> bytes) override { printed_.append(bytes.data(), bytes.size()); }
  void send(std::string_view bytes) { input_.insert(input_.end(), bytes.begin(), bytes.end()); }
  /// Removes and returns the next input byte. See ConsolePort::read_console().
  int read_byte();
  /// If the test has sent no input, returns -EAGAIN. A call cannot wait for input, because it takes no simulated time.
  long read(std::span<char> into) override;
  const std::string& printed() const { return printed_; }

 private:
  std::string printed_;
  std::deque<char> input_;
};

/// Controls a program by commands from standard input. A command is a JSON object on one line, and its reply is one
/// line on standard output. docs/chip/testing.md lists the commands. The Python module mebots.testing sends them.
class Control {
 public:
  /// `report` must return the report of the run up to now, as JSON. `host_code` must return the exit code of a program
  /// that has ended by tohost. All arguments must outlive this object.
  Control(Soc& soc, observe::Session& session, ControlledConsole& console, std::function<std::string()> report,
          std::function<int()> host_code)
      : soc_(soc), session_(session), console_(console), report_(std::move(report)), host_code_(std::move(host_code)) {}

  /// Reads and executes commands until the input ends.
  void serve();

 private:
  using Json = nlohmann::ordered_json;

  std::string answer(const std::string& line);
  Json obey(const Json& command);
  Json run(const Json& command);
  Json read(const Json& command) const;
  Json get(const std::string& name) const;
  Json set(const std::string& name, double value);
  Json state() const;
  std::uint32_t address_of(const Json& place) const;

  Soc& soc_;
  observe::Session& session_;
  ControlledConsole& console_;
  std::function<std::string()> report_;
  std::function<int()> host_code_;
  std::size_t told_ = 0;  // number of console bytes that earlier replies contained
};

}  // namespace mebots::soc::tool
