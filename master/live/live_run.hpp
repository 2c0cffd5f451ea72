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

/// Thrown if the run gave no answer in time, or if it has ended.
class NoAnswer : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Passes queries from other threads to the thread that steps a run. Only that thread accesses the run. Between two
/// steps, it takes the queries and answers them.
class Mailbox {
 public:
  using Question = std::function<std::string()>;

  /// Runs `question` in the run's thread, and returns its result or throws its exception. May be called from any
  /// thread. Throws NoAnswer if no answer arrives within `patience`, and after close().
  std::string ask(Question question, std::chrono::milliseconds patience);

  /// Answers all waiting queries. Must be called from the run's thread. If there are no queries, takes only one atomic
  /// read.
  void answer_all();
  /// Waits at most `patience` for a query. After that, answers all queries as answer_all() does.
  void wait_and_answer(std::chrono::milliseconds patience);
  /// Ends all queries. In each waiting thread, ask() throws NoAnswer.
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
  int port = 0;              ///< 0: a free one
  bool for_browser = false;  ///< the first step waits until a browser has received the data
  double pace = 0;           ///< simulated seconds per second of wall time; 0: as fast as possible
};

/// Steps a run to its end while browsers on this machine view it, pause it and set its unconnected inputs.
///
/// The page is served on the loopback address. Its path contains a random token. Requests from other hosts and origins
/// are rejected. Viewing does not change the results, because it only reads recorded data. The run stores values that
/// the user sets (LiveScenario).
class LiveRun {
 public:
  /// Binds the port. `run` must not be started. The run must have a folder, keep its rows in memory
  /// (RunOptions::in_memory), and outlive this object. Throws InputError if the port is in use, and Error if mebots was
  /// built without pages.
  LiveRun(master::Run& run, const LiveOptions& options);
  ~LiveRun();
  LiveRun(const LiveRun&) = delete;
  LiveRun& operator=(const LiveRun&) = delete;

  /// Returns the address to open in a browser.
  const std::string& address() const { return address_; }
  /// Steps to the end.
  void run();
  /// After the end of the run, waits a short time until open pages have received the last rows.
  void linger();
  /// After the end of the run, serves the page until the run's interrupt flag is set.
  void keep();

  class Server;

 private:
  /// The data that a browser has already received. All numbers are zero for a new browser.
  struct Known {
    std::size_t rows = 0;
    std::size_t pictures = 0;  // of each camera
    std::size_t log = 0;       // bytes
    std::string page = {};     // identifies a page that is open; empty for other clients
  };

  void step_until_the_end();
  /// True while the run is paused, or waits for the first browser.
  bool must_wait() const;
  void set_pace(double pace);
  /// Returns the wall time until the next step is due at the requested pace.
  std::chrono::steady_clock::duration until_due() const;
  /// True if a page that is open, or another active client, has not received the end of the run yet.
  bool is_awaited(std::chrono::steady_clock::time_point end) const;
  void note_request(const std::string& page);
  /// Records that the client has been sent an answer with the end of the run. May be called from any thread.
  void note_end_sent(const std::string& page);
  std::string data(const Known& known);
  void add_constant_data(master::report::RunFolder& folder) const;
  std::string control(const std::string& order);
  std::string set(const std::string& variable, const std::string& value);

  master::Run* run_;
  std::string address_;
  std::shared_ptr<std::string> log_ = std::make_shared<std::string>();  // shared, because the run's listener may
                                                                        // outlive this object
  Mailbox mailbox_;
  bool for_browser_ = false;
  double pace_ = 0;
  double paced_from_s_ = 0;  ///< simulated time at paced_since_
  std::chrono::steady_clock::time_point paced_since_{};
  bool held_ = false;
  bool one_step_ = false;
  bool ended_ = false;
  // The state of clients that are not pages.
  std::atomic<bool> end_sent_{false};
  std::chrono::steady_clock::time_point last_look_{};
  OpenPages pages_;
  std::unique_ptr<Server> server_;
};

}  // namespace mebots::live
