// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "console.hpp"

#include "run/run.hpp"

#include <CLI/CLI.hpp>

#include <memory>
#include <optional>
#include <string>

namespace mebots::app {

/// The options of `mebots run` and `mebots resume` for a page that shows the run.
struct LiveViewOptions {
  std::optional<int> port;           ///< 0: any free one
  std::optional<std::string> start;  ///< "browser" or "now"; default: "browser" on a terminal
  std::optional<double> pace;        ///< simulated seconds per second
  bool keep = false;                 ///< the page remains after the end, as on a terminal without `no_keep`
  bool no_keep = false;

  bool is_on() const { return port.has_value(); }
};

void add_live_options(CLI::App& command, LiveViewOptions& options);

/// Steps a run while browsers may show it.
class LiveView {
 public:
  /// Prints the address of the page. Throws InputError if the port is in use, or if this program was built without
  /// pages.
  static std::unique_ptr<LiveView> make(master::Run& run, const LiveViewOptions& options, Console& console);
  virtual ~LiveView() = default;

  /// Starts the run and steps it to its end.
  virtual void run() = 0;
  /// Ends the view. If the options require that the page remains, serves it until Ctrl-C. Otherwise serves it until
  /// browsers have received the last rows.
  virtual void end(Console& console) = 0;
};

}  // namespace mebots::app
