// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "console.hpp"

#include "run/run.hpp"

#include <CLI/CLI.hpp>

#include <memory>
#include <optional>
#include <string>

namespace mebots::app {

/// The options of `mebots run` and `mebots resume` that configure the live page of a run.
struct LiveViewOptions {
  std::optional<int> port;           ///< number of the port; 0 selects any free port
  std::optional<std::string> start;  ///< "browser" or "now"; default: "browser" on a terminal
  std::optional<double> pace;        ///< simulated seconds per second
  /// True if the page stays available after the end; the default on a terminal, unless `no_keep` is set.
  bool keep = false;
  bool no_keep = false;

  bool is_on() const { return port.has_value(); }
};

void add_live_options(CLI::App& command, LiveViewOptions& options);

/// Steps a run and serves a page that shows the run in browsers.
class LiveView {
 public:
  /// Creates a view and prints the address of its page. Throws InputError if the port is in use, or if this program was
  /// built without web pages.
  static std::unique_ptr<LiveView> make(master::Run& run, const LiveViewOptions& options, Console& console);
  virtual ~LiveView() = default;

  /// Starts the run and steps it to its end.
  virtual void run() = 0;
  /// Ends the view. If the options require that the page stays available, serves it until Ctrl-C. Otherwise, serves it
  /// until all open browsers have received the last rows.
  virtual void end(Console& console) = 0;
};

}  // namespace mebots::app
