// SPDX-License-Identifier: Apache-2.0
#include "live_view.hpp"

#include "mebots/input_error.hpp"
#ifdef MEBOTS_HAS_live
#include "live_run.hpp"
#endif

#include <unistd.h>

namespace mebots::app {
namespace {

#ifdef MEBOTS_HAS_live
class ServedView final : public LiveView {
 public:
  ServedView(master::Run& run, const live::LiveOptions& options, bool keep) : live_(run, options), keep_(keep) {}

  const std::string& address() const { return live_.address(); }
  void run() override { live_.run(); }
  void end(Console& console) override {
    if (!keep_) return live_.linger();
    console.line("the page stays until Ctrl-C; the results are complete");
    live_.keep();
  }

 private:
  live::LiveRun live_;
  bool keep_;
};
#endif

}  // namespace

void add_live_options(CLI::App& command, LiveViewOptions& options) {
  auto* live = command
                   .add_option("--live", options.port,
                               "Serve a live view of the run on localhost:PORT (watch, pause, set unconnected inputs)")
                   ->expected(0, 1)
                   ->default_str("0")
                   ->type_name("PORT")
                   ->check(CLI::Range(0, 65535));
  command
      .add_option("--live-start", options.start,
                  "Start of the first step. browser: when a browser opens the page; now: at once. Default: browser on "
                  "a terminal, otherwise now")
      ->type_name("WHEN")
      ->check(CLI::IsMember({"browser", "now"}))
      ->needs(live);
  command
      .add_option("--live-pace", options.pace,
                  "Simulated seconds per second of wall time; default: as fast as possible")
      ->type_name("FACTOR")
      ->check(CLI::Range(1e-3, 1e6))
      ->needs(live);
  auto* keep =
      command.add_flag("--live-keep", options.keep, "Keep the page after the end until Ctrl-C; default: on a terminal");
  keep->needs(live);
  command.add_flag("--no-live-keep", options.no_keep, "End with the run, on a terminal as well")
      ->needs(live)
      ->excludes(keep);
}

std::unique_ptr<LiveView> LiveView::make(master::Run& run, const LiveViewOptions& options, Console& console) {
#ifdef MEBOTS_HAS_live
  const bool terminal = ::isatty(STDOUT_FILENO) == 1;
  const bool for_browser = options.start ? *options.start == "browser" : terminal;
  auto view = std::make_unique<ServedView>(
      run, live::LiveOptions{.port = *options.port, .for_browser = for_browser, .pace = options.pace.value_or(0)},
      options.keep || (terminal && !options.no_keep));
  console.always("live: " + view->address());
  if (for_browser) console.line("the run starts when a browser opens this page; --live-start now does not wait");
  return view;
#else
  static_cast<void>(run);
  static_cast<void>(options);
  static_cast<void>(console);
  throw InputError(ErrorCode::not_offered, "--live: this mebots was built without pages (MEBOTS_PAGES)");
#endif
}

}  // namespace mebots::app
