// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "console.hpp"

#include "run/run.hpp"

#include <CLI/CLI.hpp>

#include <memory>
#include <optional>
#include <string>

namespace mebots::app {

/// The options of `mebots run` and `mebots resume` for the live page.
struct LiveViewOptions {
  std::optional<int> port;           ///< TCP port; 0 selects a free port
  std::optional<std::string> start;  ///< "browser" or "now"; default: "browser" on a terminal
  std::optional<double> pace;        ///< simulated seconds per second
  /// True if the page stays available after the end. On a terminal, this is the default unless `no_keep` is set.
  bool keep = false;
  bool no_keep = false;

  bool is_on() const { return port.has_value(); }
};

void add_live_options(CLI::App& command, LiveViewOptions& options);

/// Steps a run and shows it in browsers.
class LiveView {
 public:
  /// Creates a view and prints the address of its page. Throws InputError if the port is in use, or if MEbots was built
  /// without web pages.
  static std::unique_ptr<LiveView> make(master::Run& run, const LiveViewOptions& options, Console& console);
  virtual ~LiveView() = default;

  virtual void run() = 0;
  /// Ends the view. If the page stays available, serves the page until Ctrl-C. Otherwise, serves the page until open
  /// browsers have received the last rows.
  virtual void end(Console& console) = 0;
};

}  // namespace mebots::app
