// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "open_pages.hpp"
#include "report/run_folder.hpp"
#include "run/run.hpp"

#include <nlohmann/json.hpp>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>

namespace mebots::live {

/// Thrown if the run does not answer in time, or has ended.
class NoAnswer : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Passes queries from any thread to the thread that steps a run. That thread answers the queries between two steps, so
/// that only one thread accesses the run.
class Mailbox {
 public:
  using Question = std::function<std::string()>;

  /// Runs `question` on the run's thread. Returns its result or throws its exception. Thread-safe. Throws NoAnswer if
  /// there is no answer within `patience`, and after close().
  std::string ask(Question question, std::chrono::milliseconds patience);

  /// Answers all waiting queries. Must be called from the run's thread. Without queries, costs only one atomic read.
  void answer_all();
  /// Waits up to `patience` for a query, then answers all waiting queries. Must be called from the run's thread.
  void wait_and_answer(std::chrono::milliseconds patience);
  /// Discards all queries. Their ask() calls throw NoAnswer.
  void close();

 private:
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::deque<std::packaged_task<std::string()>> waiting_;
  std::atomic<bool> any_{false};
  bool closed_ = false;
};

constexpr double kFastestPace = 1e6;

struct LiveOptions {
  int port = 0;              ///< TCP port; 0: a free port
  bool for_browser = false;  ///< if true, the first step waits for a browser
  double pace = 0;           ///< simulated seconds per second of wall time; 0: no limit
};

/// Steps a run while browsers on this machine show it, pause it and set its unconnected inputs.
///
/// Serves the page on the loopback address, under a path with a random token. Rejects requests from other hosts and
/// origins. Viewing does not change results. LiveScenario stores the values that users set.
class LiveRun {
 public:
  /// Binds the port. The run must not be started, must have a results folder and the option `in_memory`, and must
  /// outlive this object. Throws InputError if the port is in use. Throws Error if MEbots was built without web pages.
  LiveRun(master::Run& run, const LiveOptions& options);
  ~LiveRun();
  LiveRun(const LiveRun&) = delete;
  LiveRun& operator=(const LiveRun&) = delete;

  const std::string& address() const { return address_; }
  void run();
  /// Waits a short time until open pages have received the last rows. Must be called after the end of the run.
  void linger();
  /// Serves the page until the run's interrupt flag is set. Must be called after the end of the run.
  void keep();

  class Server;

 private:
  /// The amount of data that a browser already has. All numbers are zero for a new browser.
  struct Known {
    std::size_t rows = 0;
    std::size_t pictures = 0;  // per camera
    std::size_t log = 0;       // in bytes
    std::string page = {};     // identifies an open page; empty for other clients
  };

  void step_until_the_end();
  /// True while the run is paused, or waits for the first browser.
  bool must_wait() const;
  void set_pace(double pace);
  /// Returns the wall time until the next step at the requested pace.
  std::chrono::steady_clock::duration until_due() const;
  /// True if an open page or another active client has not yet received the end of the run.
  bool is_awaited(std::chrono::steady_clock::time_point end) const;
  void note_request(const std::string& page);
  /// Records that a client was sent the end of the run. Thread-safe.
  void note_end_sent(const std::string& page);
  std::string data(const Known& known);
  void add_constant_data(master::report::RunFolder& folder) const;
  std::string control(const std::string& order);
  std::string set(const std::string& variable, const std::string& value);

  master::Run* run_;
  std::string address_;
  std::shared_ptr<std::string> log_ = std::make_shared<std::string>();  // shared with the run's listener, which may
                                                                        // outlive this object
  Mailbox mailbox_;
  bool for_browser_ = false;
  double pace_ = 0;
  double paced_from_s_ = 0;  ///< simulated time at paced_since_
  std::chrono::steady_clock::time_point paced_since_{};
  bool held_ = false;
  bool one_step_ = false;
  bool ended_ = false;
  // For clients that are not pages: whether one of them received the end of the run, and the time of their last
  // request.
  std::atomic<bool> end_sent_{false};
  std::chrono::steady_clock::time_point last_look_{};
  OpenPages pages_;
  std::unique_ptr<Server> server_;
};

}  // namespace mebots::live
