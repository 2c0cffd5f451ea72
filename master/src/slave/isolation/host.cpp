// SPDX-License-Identifier: Apache-2.0
#include "fmi/call/forked_copies.hpp"
#include "mebots/input_error.hpp"
#include "message/message_hub.hpp"
#include "model/value_kind.hpp"
#include "slave/fmi/make_slave.hpp"
#include "slave/isolation/child_process.hpp"

#include "child_process.hpp"
#include "guard.hpp"
#include "host_interfaces.hpp"
#include "model/sandbox_mechanisms.hpp"
#include "protocol.hpp"
#include "sandbox.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <dlfcn.h>
#include <pthread.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <map>
#include <mutex>
#include <new>
#include <optional>
#include <span>
#include <string_view>

namespace mebots::master {
namespace {

using namespace isolation;

/// Writes the FMU's messages to shared memory, where the master can read them even if the call does not return.
class SharedLog final : public MessageSink {
 public:
  SharedLog(SharedBuffer& buffer, Control& control) : writer_(buffer), control_(&control) {}

  void message(const Message& message) override {
    const std::lock_guard lock(mutex_);  // FMUs may log from their own threads
    if (limit_.take(message.text.size() + message.category.size())) put(message);
  }
  /// Writes a notice about the dropped messages of this batch.
  void end_batch(std::string_view instance) {
    const std::lock_guard lock(mutex_);
    if (const auto notice = limit_.restart()) put({instance, Severity::warning, "notice", *notice, 0});
  }
  /// Must be called after the master has read all messages.
  void clear() {
    const std::lock_guard lock(mutex_);
    writer_.clear();
    control_->log_bytes.store(0, std::memory_order_release);
  }

 private:
  void put(const Message& message) {
    writer_.put(static_cast<std::uint8_t>(message.severity));
    writer_.put(message.time_ns);
    writer_.put(message.category);
    writer_.put(message.text);
    control_->log_bytes.store(writer_.size(), std::memory_order_release);
  }

  std::mutex mutex_;
  MessageLimit limit_{kMostLogBytes - (std::size_t{1} << 20)};  // leaves space for the notice
  SharedWriter writer_;
  Control* control_;
};

class Host {
 public:
  Host()
      : control_buffer_(kHostDescriptors[0]),
        command_buffer_(kHostDescriptors[1]),
        answer_buffer_(kHostDescriptors[2]),
        log_buffer_(kHostDescriptors[3]),
        control_(reinterpret_cast<Control*>(control_buffer_.data())),
        log_(log_buffer_, *control_),
        answers_(answer_buffer_) {}

  /// Stores the mechanisms of the sandbox that this system does not provide, and the mechanisms that may be missing. If
  /// a required mechanism is missing, Call::open fails.
  void set_refusals(std::vector<Refusal> refusals, std::vector<std::string> may_lack) {
    is_sandboxed_ = true;
    refusals_ = std::move(refusals);
    may_lack_ = std::move(may_lack);
  }

  Control& control() { return *control_; }

  /// True if the FMU's code must stay loaded until the process ends.
  bool keeps_library() const { return keeps_library_; }

  void serve() {
    constexpr std::int64_t kWaitNs = 3'600'000'000'000;
    std::uint32_t batches = 0;
    while (!closed_) {
      while (!control_->asked.wait(batches, kWaitNs)) {
      }
      ++batches;
      log_.clear();
      answers_.clear();
      do_batch();
      log_.end_batch(name_);
      control_->answer_bytes.store(answers_.size(), std::memory_order_relaxed);
      control_->answered.pass();
    }
  }

 private:
  void do_batch() {
    SharedReader commands(command_buffer_.bytes(control_->command_bytes.load(std::memory_order_relaxed)));
    while (!commands.at_end()) {
      const auto call = commands.get<Call>();
      control_->call.store(call, std::memory_order_relaxed);
      control_->calls.fetch_add(1, std::memory_order_release);
      if (!answer(call, commands)) return;  // later calls depend on this one
    }
  }

  /// Executes a call and writes its answer. Returns false if the later calls of the batch must not be executed.
  bool answer(Call call, SharedReader& commands) {
    const auto begin = answers_.size();
    const auto put_error = [&](Answer kind, ErrorCode code, std::string_view text) {
      answers_.cut(begin);  // removes a partial answer of a failed call
      answers_.put(kind);
      answers_.put(mebots::name_of(code));
      answers_.put(text);
    };
    try {
      return dispatch(call, commands);
    } catch (const SlaveError& error) {
      put_error(Answer::slave_error, error.code(), error.what());
    } catch (const InputError& error) {
      put_error(Answer::input_error, error.code(), error.what());
    } catch (const Error& error) {
      if (error.code() != ErrorCode::system_failure) {
        put_error(Answer::error, error.code(), error.what());
      } else {
        put_error(Answer::slave_error, error.code(), in_instance(call, error.what()));
      }
    } catch (const std::exception& error) {
      put_error(Answer::slave_error, ErrorCode::fmu_failed, in_instance(call, error.what()));
    }
    return false;
  }

  std::string in_instance(Call call, const char* what) const {
    const auto version = slave_ == nullptr ? std::string() : slave_->description().fmi_version;
    return fmt::format("instance '{}': {} failed in its process: {}", name_, name_of(call, version), what);
  }

  void put_done() { answers_.put(Answer::done); }
  void put_text(const std::string& text) {
    put_done();
    answers_.put(std::string_view(text));
  }

  bool dispatch(Call call, SharedReader& commands) {
    if (continuous_ != nullptr && isolation::dispatch(*continuous_, call, commands, answers_)) return true;
    if (events_ != nullptr && isolation::dispatch(*events_, call, commands, answers_)) return true;
    if (clocks_ != nullptr && isolation::dispatch(*clocks_, call, commands, answers_)) return true;
    switch (call) {
      case Call::open:
        open(commands);
        put_done();
        answers_.put(slave_->output_derivative_order());
        answers_.put(slave_->takes_input_derivatives());
        answers_.put(continuous_ != nullptr && continuous_->has_directional_derivatives());
        put_notices();
        return true;
      case Call::setup_experiment:
        slave_->setup_experiment(commands.get<Experiment>());
        break;
      case Call::enter_initialization:
        slave_->enter_initialization();
        break;
      case Call::exit_initialization:
        slave_->exit_initialization();
        break;
      case Call::step: {
        const auto start_ns = commands.get<std::int64_t>();
        return answer_step(slave_->step(start_ns, commands.get<std::int64_t>()));
      }
      case Call::finish_step:
        return answer_step(slave_->finish_step(control_->cancel));
      case Call::terminate:
        slave_->terminate();
        if (const auto text = copies_->returned()) throw SlaveError(ErrorCode::fmu_lost, *text);
        break;
      case Call::get_reals:
        get_numbers<double>(commands, [&](auto references, auto values) { slave_->get_reals(references, values); });
        return true;
      case Call::get_integers:
        get_integers(commands);
        return true;
      case Call::get_booleans:
        get_numbers<std::int64_t>(commands,
                                  [&](auto references, auto values) { slave_->get_booleans(references, values); });
        return true;
      case Call::get_strings:
        get_texts(commands, [&](auto references, auto values) { slave_->get_strings(references, values); });
        return true;
      case Call::get_binaries:
        get_texts(commands, [&](auto references, auto values) { slave_->get_binaries(references, values); });
        return true;
      case Call::set_reals: {
        const auto references = commands.get_vector<ValueReference>();
        slave_->set_reals(references, commands.get_vector<double>());
        break;
      }
      case Call::set_integers:
        set_integers(commands);
        break;
      case Call::set_booleans: {
        const auto references = commands.get_vector<ValueReference>();
        slave_->set_booleans(references, commands.get_vector<std::int64_t>());
        break;
      }
      case Call::set_strings:
        set_texts(commands, [&](auto references, auto values) { slave_->set_strings(references, values); });
        break;
      case Call::set_binaries:
        set_texts(commands, [&](auto references, auto values) { slave_->set_binaries(references, values); });
        break;
      case Call::get_output_derivatives:
        get_output_derivatives(commands);
        return true;
      case Call::set_input_derivatives: {
        const auto references = commands.get_vector<ValueReference>();
        const auto orders = commands.get_vector<std::int32_t>();
        slave_->set_input_derivatives(references, orders, commands.get_vector<double>());
        break;
      }
      case Call::save_state:
        states_[commands.get<std::uint64_t>()] = slave_->save_state();
        break;
      case Call::restore_state:
        slave_->restore_state(*states_.at(commands.get<std::uint64_t>()));
        break;
      case Call::free_state:
        states_.erase(commands.get<std::uint64_t>());
        break;
      case Call::serialize: {
        const auto bytes = slave_->serialize(*states_.at(commands.get<std::uint64_t>()));
        put_done();
        answers_.put(std::span<const std::byte>(bytes));
        answers_.put(std::string_view(fmu_->state_elsewhere().value_or("")));
        return true;
      }
      case Call::deserialize: {
        const auto id = commands.get<std::uint64_t>();
        states_[id] = slave_->deserialize(commands.get_bytes());
        break;
      }
      case Call::close:
        put_text(close());
        return true;
      default:
        throw Error(ErrorCode::wrong_call_order, "the master sent no call of this instance");
    }
    put_done();
    return true;
  }

  /// Frees the instance. Returns a description of the difference between the memory of the FMU's libraries now and
  /// directly after loading; an empty text if no memory has changed. Throws SlaveError if the FMU fails. The host
  /// process ends after this call, even if the call throws.
  std::string close() {
    closed_ = true;
    states_.clear();
    const auto fault = slave_ ? slave_->free_instance() : std::nullopt;
    slave_.reset();
    auto difference = fmu_ ? fmu_->difference().value_or("") : "";
    control_->call.store(Call::unload, std::memory_order_relaxed);
    fmu_.reset();
    if (fault) throw SlaveError(*fault);
    return difference;
  }

  void open(SharedReader& commands) {
    name_ = commands.get_text();
    const auto archive = commands.get_text();
    const auto folder = commands.get_text();
    keeps_library_ = commands.get_flag();
    const auto python = commands.get_text();
    add_python_path(commands.get_text());
    std::vector<std::string> categories;
    for (auto count = commands.get<std::uint64_t>(); count > 0; --count) categories.push_back(commands.get_text());
    modeldesc::StructuralValues structural;
    for (auto count = commands.get<std::uint64_t>(); count > 0; --count) {
      const auto reference = commands.get<std::uint32_t>();
      structural[reference] = commands.get<std::uint64_t>();
    }
    const auto grid = commands.get<TimeGrid>();
    const auto kind = commands.get<FmuKind>();
    const bool clocks_tick = commands.get_flag();
    check_sandbox();
    copies_.emplace();
    fmu_ = std::make_shared<Fmu>(archive, folder, kind);
    if (keeps_library_) fmu_->keep_loaded();
    if (!python.empty()) load_python(python);
    triples_ = osmp_triples(fmu_->description());
    taken_.resize(triples_.size());
    make_slave({name_, fmu_, std::move(structural), std::move(categories), grid}, kind, clocks_tick);
  }

  void make_slave(InstanceRequest request, FmuKind kind, bool clocks_tick) {
    if (kind == FmuKind::model_exchange) {
      auto parts = make_continuous_here(std::move(request), log_);
      slave_ = std::move(parts.slave);
      continuous_ = parts.instance;
      clocks_ = parts.instance->clocks();
    } else if (clocks_tick) {
      auto parts = make_event_slave_here(std::move(request), log_);
      slave_ = std::move(parts.slave);
      events_ = parts.instance;
      clocks_ = &parts.instance->clocks();
    } else {
      slave_ = make_slave_here(std::move(request), log_);
    }
  }

  /// Throws Error if the sandbox lacks a required mechanism.
  void check_sandbox() const {
    for (const auto& [mechanism, reason] : refusals_) {
      if (std::ranges::find(may_lack_, mechanism) != may_lack_.end()) continue;
      throw Error(
          ErrorCode::system_failure,
          fmt::format("instance '{}': the FMU does not run, because this system refuses a part of its sandbox: "
                      "{} ({}). To run it without this part, add \"{}\" to \"may_lack\" of the instance's \"sandbox\"",
                      name_, mechanism, reason, mechanism));
    }
  }

  /// Writes a list of notices. A 1 precedes each text, and a 0 ends the list.
  void put_notices() {
    const auto put = [this](const std::string& text) {
      answers_.put(true);
      answers_.put(std::string_view(text));
    };
    for (const auto& [mechanism, reason] : refusals_) put(fmt::format("the sandbox lacks {} ({})", mechanism, reason));
    if (is_sandboxed_ && getuid() == 0) {
      put("mebots runs as root, so the kernel does not limit the number of processes in the sandbox");
    }
    answers_.put(false);
  }

  static void add_python_path(const std::string& folder) {
    if (folder.empty()) return;
    const char* before = std::getenv("PYTHONPATH");
    const auto path = before == nullptr || *before == '\0' ? folder : fmt::format("{}:{}", before, folder);
    setenv("PYTHONPATH", path.c_str(), 1);
  }

  /// Loads the Python interpreter with RTLD_GLOBAL, because the FMU and Python modules search the whole process for its
  /// functions.
  static void load_python(const std::string& library) {
    if (dlopen(library.c_str(), RTLD_NOW | RTLD_GLOBAL) != nullptr) return;
    throw InputError(ErrorCode::fmu_inconsistent,
                     fmt::format("the FMU needs a Python interpreter, and its library cannot be loaded: {}. Set "
                                 "MEBOTS_PYTHON to another Python",
                                 dlerror()));
  }

  /// Writes the result of a step. Returns false if the step is not complete, which ends the batch.
  bool answer_step(const StepResult& result) {
    put_done();
    answers_.put(result.done);
    answers_.put(result.pending);
    answers_.put(result.cancelled);
    answers_.put(result.terminated);
    answers_.put_optional(result.last_successful_s);
    answers_.put(std::string_view(result.messages));
    return result.done;
  }

  template <typename T, typename Get>
  void get_numbers(SharedReader& commands, Get get) {
    const auto references = commands.get_vector<ValueReference>();
    std::vector<T> values(references.size());
    get(std::span<const ValueReference>(references), std::span<T>(values));
    put_done();
    answers_.put(std::span<const T>(values));
  }

  /// Writes Integers, followed by the bytes of each OSMP binary whose three Integers are in `references`.
  void get_integers(SharedReader& commands) {
    const auto references = commands.get_vector<ValueReference>();
    std::vector<std::int64_t> values(references.size());
    slave_->get_integers(references, values);
    put_done();
    answers_.put(std::span<const std::int64_t>(values));
    for (const auto& triple : triples_) {
      const auto places = places_of(triple, references);
      if (!places) continue;
      const auto part = [&](std::size_t i) { return static_cast<std::int32_t>(values[(*places)[i]]); };
      answers_.put(fmu::BinaryRef{part(0), part(1), part(2)}.bytes());
    }
  }

  void get_output_derivatives(SharedReader& commands) {
    const auto references = commands.get_vector<ValueReference>();
    const auto orders = commands.get_vector<std::int32_t>();
    std::vector<double> values(references.size());
    slave_->get_output_derivatives(references, orders, values);
    put_done();
    answers_.put(std::span<const double>(values));
  }

  template <typename Get>
  void get_texts(SharedReader& commands, Get get) {
    const auto references = commands.get_vector<ValueReference>();
    std::vector<std::string> values(references.size());
    get(std::span<const ValueReference>(references), std::span(values));
    put_done();
    for (const auto& value : values) answers_.put(std::string_view(value));
  }

  void set_integers(SharedReader& commands) {
    const auto references = commands.get_vector<ValueReference>();
    auto values = commands.get_vector<std::int64_t>();
    for (std::size_t i = 0; i < triples_.size(); ++i) {
      const auto places = places_of(triples_[i], references);
      if (!places) continue;
      taken_[i] = commands.get_vector<std::uint8_t>();
      const auto reference = taken_[i].empty() ? fmu::BinaryRef{} : fmu::BinaryRef::to(taken_[i]);
      values.at((*places)[0]) = reference.base_lo;
      values.at((*places)[1]) = reference.base_hi;
      values.at((*places)[2]) = reference.size;
    }
    slave_->set_integers(references, values);
  }

  template <typename Set>
  void set_texts(SharedReader& commands, Set set) {
    const auto references = commands.get_vector<ValueReference>();
    std::vector<std::string> values;
    for (std::size_t i = 0; i < references.size(); ++i) values.push_back(commands.get_text());
    set(std::span<const ValueReference>(references), std::span<const std::string>(values));
  }

  SharedBuffer control_buffer_;
  SharedBuffer command_buffer_;
  SharedBuffer answer_buffer_;
  SharedBuffer log_buffer_;
  Control* control_;
  SharedLog log_;
  SharedWriter answers_;
  std::vector<OsmpTriple> triples_;
  std::vector<std::vector<std::uint8_t>> taken_;  // bytes of binary inputs, indexed like triples_
  std::string name_;
  bool is_sandboxed_ = false;
  std::vector<Refusal> refusals_;
  std::vector<std::string> may_lack_;
  std::optional<ForkedCopies> copies_;  // must be created after the keeper was forked
  std::shared_ptr<Fmu> fmu_;
  std::unique_ptr<Slave> slave_;
  ContinuousInstance* continuous_ = nullptr;  // interface of a model exchange instance; otherwise null
  EventInstance* events_ = nullptr;           // interface of an instance with clocks; otherwise null
  ClockInstance* clocks_ = nullptr;           // clocks of continuous_ or events_
  std::map<std::uint64_t, std::unique_ptr<SlaveState>> states_;
  bool closed_ = false;
  bool keeps_library_ = false;
};

template <typename T>
T number(const char* text) {
  T value{};
  const std::string_view digits = text;
  if (std::from_chars(digits.data(), digits.data() + digits.size(), value).ec != std::errc{}) {
    throw Error(ErrorCode::syntax_error, "a number is expected");
  }
  return value;
}

/// The command line of a host process (see run_fmu_host()).
struct Arguments {
  explicit Arguments(std::span<char* const> words) : program(words[0]), rest(words.begin() + 1, words.end()) {
    master = number<pid_t>(next("the master's process"));
    memory_bytes = number<std::uint64_t>(next("a memory limit"));
    while (at_ < rest.size()) read_option();
  }

  bool is_sandboxed() const { return !sandbox.folder.empty(); }
  /// Returns the arguments to start this program again inside the namespaces.
  std::vector<std::string> inside() const {
    auto words = rest;
    words.emplace_back("--inside");
    return words;
  }

  std::string program;
  std::vector<std::string> rest;
  pid_t master = 0;
  std::uint64_t memory_bytes = 0;
  Sandbox sandbox;
  std::vector<std::string> may_lack;
  bool is_inside = false;
  LimitedMemory limited = LimitedMemory::address_space;

 private:
  const char* next(const char* what) {
    if (at_ == rest.size()) throw Error(ErrorCode::syntax_error, fmt::format("{} is missing", what));
    return rest[at_++].c_str();
  }
  void read_option() {
    const std::string option = next("an option");
    if (option == "--inside") {
      is_inside = true;
    } else if (option == "--limit-data") {
      limited = LimitedMemory::data;
    } else if (option == "--sandbox") {
      sandbox.folder = next("a folder");
    } else if (option == "--reads") {
      sandbox.reads.emplace_back(next("a path"));
    } else if (option == "--may-lack") {
      may_lack.emplace_back(next("a mechanism"));
    } else {
      throw Error(ErrorCode::syntax_error, fmt::format("unknown option {}", option));
    }
  }

  std::size_t at_ = 0;
};

std::string own_path() {
  return std::filesystem::read_symlink("/proc/self/exe").string();
}

/// Prepares this process for the FMU: creates the sandbox, or limits the process.
void confine(const Arguments& arguments, Host& host, std::vector<Refusal> refusals) {
  if (!arguments.is_sandboxed()) {
    guard(arguments.memory_bytes, arguments.limited, host.control());
    protect_other_processes();
    return;
  }
  auto more = restrict_process(arguments.sandbox, arguments.is_inside);
  refusals.insert(refusals.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  guard(arguments.memory_bytes, arguments.limited, host.control());
  if (auto problem = allow_simulation_calls(arguments.is_inside)) refusals.push_back({kSeccomp, *std::move(problem)});
  host.set_refusals(std::move(refusals), arguments.may_lack);
}

}  // namespace

int run_fmu_host(int argument_count, char** words) {
  if (argument_count == 2 && std::string_view(words[1]) == "--version") {
    std::puts("mebots-fmu-host " MEBOTS_VERSION);
    return 0;
  }
  if (argument_count < 3) {
    std::fputs("mebots-fmu-host: mebots starts this program to run one FMU; use `mebots run --isolate`\n", stderr);
    return 2;
  }
  try {
    const Arguments arguments(std::span<char* const>(words, static_cast<std::size_t>(argument_count)));
    std::vector<Refusal> refusals;
    if (!arguments.is_inside) fork_kept(arguments.master);
    if (arguments.is_sandboxed() && !arguments.is_inside)
      refusals.push_back(enter_namespaces(arguments.sandbox, own_path(), arguments.inside()));
    Host host;
    confine(arguments, host, std::move(refusals));
    pthread_setcancelstate(PTHREAD_CANCEL_DISABLE, nullptr);  // the FMU must not cancel the thread that calls it
    host.serve();
    if (!host.keeps_library()) return 0;
    std::fflush(nullptr);
    _exit(0);  // runs no destructors, for example of an interpreter
  } catch (const std::exception& error) {
    std::fprintf(stderr, "mebots-fmu-host: %s\n", error.what());
    return 1;
  }
}

}  // namespace mebots::master
