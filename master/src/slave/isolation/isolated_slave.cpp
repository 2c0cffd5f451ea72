// SPDX-License-Identifier: Apache-2.0
#include "isolated_slave.hpp"

#include "base/signal_guard.hpp"
#include "base/time.hpp"
#include "fmi/call/callbacks.hpp"
#include "fmi/fmu.hpp"
#include "mebots/assert.hpp"
#include "mebots/input_error.hpp"
#include "message/message_text.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <limits>
#include <utility>

namespace mebots::master::isolation {

/// A state that the host process stores.
class IsolatedState final : public SlaveState {
 public:
  IsolatedState(IsolatedSlave& slave, std::uint64_t id) : slave_(&slave), id_(id) {}
  ~IsolatedState() override { slave_->free_state(id_); }
  IsolatedState(const IsolatedState&) = delete;
  IsolatedState& operator=(const IsolatedState&) = delete;

  std::uint64_t id() const { return id_; }

 private:
  IsolatedSlave* slave_;
  std::uint64_t id_;
};

namespace {

/// The interval in nanoseconds at which a waiting master checks the host process.
constexpr std::int64_t kLookNs = 20'000'000;
/// The time in seconds that a call may still take after an interrupt.
constexpr double kInterruptGraceS = 0.1;
/// The time in seconds that an FMU may take to free its instance.
constexpr double kGraceS = 3;

std::uint64_t id_of(const SlaveState& state) {
  return static_cast<const IsolatedState&>(state).id();
}

}  // namespace

IsolatedSlave::IsolatedSlave(const ResolvedInstance& instance, MessageSink& messages,
                             const std::atomic<bool>* interrupted, const TimeGrid& grid)
    : instance_(&instance),
      name_(instance.description->name),
      messages_(&messages),
      interrupted_(interrupted),
      control_buffer_("mebots-control"),
      command_buffer_("mebots-commands"),
      answer_buffer_("mebots-answers"),
      log_buffer_("mebots-log", kMostLogBytes),
      control_(new (control_buffer_.data()) Control),
      commands_(command_buffer_),
      triples_(osmp_triples(*instance.model)),
      binaries_(triples_.size()) {
  process_ =
      std::make_unique<ChildProcess>(find_fmu_host(), host_arguments(),
                                     std::array<int, 4>{control_buffer_.descriptor(), command_buffer_.descriptor(),
                                                        answer_buffer_.descriptor(), log_buffer_.descriptor()});
  // The sizes of these buffers no longer change. The master does not need their descriptors any more.
  control_buffer_.close_descriptor();
  log_buffer_.close_descriptor();
  open(grid);
}

/// Returns the name of the current or last call of the host process.
const char* IsolatedSlave::call_name() const {
  return name_of(control_->call.load(), instance_->model->fmi_version);
}

std::vector<std::string> IsolatedSlave::host_arguments() const {
  std::vector<std::string> words{fmt::format("{}", getpid()), fmt::format("{}", memory_bytes())};
  if (instance_->fmu->runs_under_wine()) words.emplace_back("--limit-data");
  if (!instance_->isolation.sandboxed()) return words;
  const auto add = [&](const char* option, const std::string& value) { words.insert(words.end(), {option, value}); };
  add("--sandbox", instance_->fmu->folder().string());
  for (const auto& path : instance_->isolation.sandbox.reads) add("--reads", path);
  for (const auto& mechanism : instance_->isolation.sandbox.may_lack) add("--may-lack", mechanism);
  const auto& interpreter = instance_->interpreter;
  if (!interpreter.library.empty()) add("--reads", std::filesystem::path(interpreter.library).parent_path().string());
  if (!interpreter.python_path.empty()) add("--reads", interpreter.python_path);
  return words;
}

std::uint64_t IsolatedSlave::memory_bytes() const {
  const auto bytes = instance_->isolation.memory_bytes.value_or(IsolationDescription::kDefaultMemoryBytes);
  return bytes == IsolationDescription::kNoMemoryLimit ? std::numeric_limits<std::uint64_t>::max() : bytes;
}

IsolatedSlave::~IsolatedSlave() {
  try {
    IsolatedSlave::free_instance();
  } catch (...) {  // NOLINT(bugprone-empty-catch): the process goes in any case
  }
}

std::optional<std::string> IsolatedSlave::free_instance() {
  if (std::exchange(freed_, true) || !lost_.empty()) return std::nullopt;
  commands_.clear();  // drops values that no call will read
  pending_ = 0;
  put(Call::close);
  control_->command_bytes.store(commands_.size(), std::memory_order_relaxed);
  control_->asked.pass();
  return report_end();
}

std::optional<std::string> IsolatedSlave::report_end() {
  const auto grace_s = std::max(kGraceS, instance_->isolation.deadline_s.value_or(0));
  const auto end = process_->ended_within(grace_s);
  std::string problem;
  if (!end) {
    problem = fmt::format("{} did not return within {} s; its process was ended", call_name(), grace_s);
  } else if (const bool answered = control_->answered.value() != batches_;
             !answered || end_in_sandbox(*end).by_signal) {
    problem = fault_text(*end);
  }
  try {
    take_messages();
  } catch (const Error& error) {
    if (problem.empty()) problem = error.what();
  }
  if (problem.empty()) return end ? failure_of_close() : std::nullopt;
  messages_->message({name_, Severity::error, "notice", problem, time_ns_});
  return fmt::format("instance '{}': {}", name_, problem);
}

/// Returns the error that occurred when the host freed the instance; nullopt if none occurred. The host has already
/// logged the error. If the memory of the FMU's libraries has changed, stores the host's description of the change in
/// the Fmu.
std::optional<std::string> IsolatedSlave::failure_of_close() {
  try {
    auto reader = answers();
    check(reader);
    if (auto difference = reader.get_text(); !difference.empty())
      instance_->fmu->set_difference_elsewhere(std::move(difference));
  } catch (const Error& error) {
    return error.what();
  }
  return std::nullopt;
}

void IsolatedSlave::open(const TimeGrid& grid) {
  put(Call::open);
  commands_.put(std::string_view(name_));
  commands_.put(std::string_view(instance_->fmu->archive().native()));
  commands_.put(std::string_view(instance_->fmu->folder().native()));
  commands_.put(instance_->interpreter.embedded);
  commands_.put(std::string_view(instance_->interpreter.library));
  commands_.put(std::string_view(instance_->interpreter.python_path));
  commands_.put(static_cast<std::uint64_t>(instance_->log_categories.size()));
  for (const auto& category : instance_->log_categories) commands_.put(std::string_view(category));
  commands_.put(static_cast<std::uint64_t>(instance_->structural.size()));
  for (const auto& [reference, value] : instance_->structural) {
    commands_.put(reference);
    commands_.put(value);
  }
  commands_.put(grid);
  commands_.put(instance_->kind);
  commands_.put(instance_->clocks_tick);
  hand_over(1, [this](SharedReader& answers) {
    check(answers);
    output_derivative_order_ = answers.get<std::uint32_t>();
    takes_input_derivatives_ = answers.get_flag();
    provides_directional_derivatives_ = answers.get_flag();
    while (answers.get_flag()) notices_.push_back(valid_utf8(answers.get_text()));
  });
}

void IsolatedSlave::put_references(Call call, std::span<const ValueReference> references) {
  put(call);
  commands_.put(references);
}

void IsolatedSlave::hand_over(std::size_t open_answers, const std::function<void(SharedReader&)>& take) {
  if (!lost_.empty()) throw SlaveError(ErrorCode::fmu_lost, lost_);
  const auto calls = pending_ + 1;
  MEBOTS_ASSERT(open_answers <= calls, "an answer belongs to a call");
  control_->command_bytes.store(commands_.size(), std::memory_order_relaxed);
  control_->asked.pass();
  wait(calls);
  ++batches_;
  commands_.clear();
  pending_ = 0;
  try {
    take_messages();
    auto reader = answers();
    for (auto left = calls - open_answers; left > 0; --left) check(reader);
    if (take) take(reader);
  } catch (const DamagedMemory& damage) {
    process_->kill();
    lost(ErrorCode::fmu_lost, fmt::format("{}, after {}; its process was ended", damage.what(), call_name()));
  }
}

SharedReader IsolatedSlave::answers() {
  const auto size = control_->answer_bytes.load(std::memory_order_relaxed);
  if (size > memory_bytes()) {
    throw DamagedMemory(fmt::format("an answer of {} bytes is larger than its memory_limit_mb allows", size));
  }
  return SharedReader(answer_buffer_.bytes(size));
}

/// Waits until the host has executed the calls. The deadline starts again at each call.
void IsolatedSlave::wait(std::size_t calls_left) {
  using Clock = std::chrono::steady_clock;
  const auto& isolation = instance_->isolation;
  auto since = Clock::now();
  std::optional<Clock::time_point> interrupted_at;
  auto calls = control_->calls.load(std::memory_order_acquire);
  auto look_ns = kLookNs;
  if (isolation.deadline_s)
    look_ns = std::clamp<std::int64_t>(static_cast<std::int64_t>(*isolation.deadline_s * 1e9 / 4), 1'000'000, kLookNs);
  while (!control_->answered.wait(batches_, look_ns)) {
    if (const auto end = process_->ended()) {
      if (control_->answered.value() != batches_) return;  // the host has answered before its end
      lost(ErrorCode::fmu_lost, fault_text(*end));
    }
    if (cancel_ != nullptr && cancel_->load(std::memory_order_relaxed)) control_->cancel = true;
    const auto now = Clock::now();
    if (const auto count = control_->calls.load(std::memory_order_acquire); count != calls && calls_left > 0) {
      calls = count;
      --calls_left;
      since = now;
    }
    const double waited_s = std::chrono::duration<double>(now - since).count();
    if (isolation.deadline_s && waited_s > *isolation.deadline_s) {
      process_->kill();
      lost(ErrorCode::fmu_timeout, fmt::format("{} did not return within its deadline of {} s; its process was ended",
                                               call_name(), *isolation.deadline_s));
    }
    if (interrupted_ != nullptr && interrupted_->load(std::memory_order_relaxed)) {
      if (!interrupted_at) interrupted_at = now;
      if (std::chrono::duration<double>(now - *interrupted_at).count() > kInterruptGraceS) {
        process_->kill();
        lost_ = fmt::format(
            "instance '{}' at {} s: {} did not return within {} s after the interrupt; its process "
            "was ended",
            name_, to_seconds(time_ns_), call_name(), kInterruptGraceS);
        throw InterruptedError(lost_);
      }
    }
  }
}

/// Returns how the program in the sandbox ended. If a signal ended the program, the exit code of bubblewrap is 128 plus
/// the number of the signal; otherwise, it is the exit code of the program.
ProcessEnd IsolatedSlave::end_in_sandbox(ProcessEnd end) const {
  constexpr int kSignalled = 128;
  if (!instance_->isolation.sandboxed() || end.by_signal || end.number <= kSignalled) return end;
  return {true, end.number - kSignalled, end.peak_memory_kb};
}

std::string IsolatedSlave::fault_text(const ProcessEnd& seen) const {
  const auto end = end_in_sandbox(seen);
  const auto call = call_name();
  std::string text;
  if (!end.by_signal) {
    text = fmt::format("its process ended itself with exit code {} in {}", end.number, call);
  } else if (control_->fault_on_stack.load() != 0) {
    text = fmt::format("its process was ended by {} in {}: its stack overflowed", signal_text(end.number), call);
  } else {
    text = fmt::format("its process was ended by {} in {}", signal_text(end.number), call);
    if (control_->fault_seen.load() != 0) text += fmt::format(", at address {:#x}", control_->fault_address.load());
  }
  const auto limit = memory_bytes();
  constexpr std::uint64_t kMebi = 1 << 20;
  const auto peak = static_cast<std::uint64_t>(end.peak_memory_kb) * 1024;
  if (peak > limit / 2) {
    text += fmt::format("; it had used {} MiB of memory, and memory_limit_mb allows {}", peak / kMebi, limit / kMebi);
  }
  return text;
}

void IsolatedSlave::lost(ErrorCode code, const std::string& how) {
  try {
    take_messages();
  } catch (const Error&) {  // NOLINT(bugprone-empty-catch): what it said is lost too
  }
  lost_ = fmt::format("instance '{}' at {} s: {}", name_, to_seconds(time_ns_), how);
  throw SlaveError(code, lost_);
}

void IsolatedSlave::check(SharedReader& answers) {
  const auto kind = answers.get<Answer>();
  if (kind == Answer::done) return;
  const auto code = error_code_of(answers.get_text()).value_or(ErrorCode::unspecified);
  const auto text = answers.get_text();
  if (kind == Answer::slave_error) throw SlaveError(code, text);
  if (kind == Answer::input_error) throw InputError(code, text);
  throw Error(code, text);
}

void IsolatedSlave::take_messages() {
  const auto size = control_->log_bytes.exchange(0, std::memory_order_acq_rel);
  if (size > kMostLogBytes) throw DamagedMemory(fmt::format("it claims {} bytes of messages", size));
  SharedReader log(log_buffer_.bytes(size));
  while (!log.at_end()) {
    const auto severity = static_cast<Severity>(log.get<std::uint8_t>());
    const auto time_ns = log.get<std::int64_t>();
    const auto category = valid_utf8(log.get_text());
    const auto text = valid_utf8(log.get_text());
    messages_->message({name_, severity, category, text, time_ns});
  }
}

void IsolatedSlave::setup_experiment(const Experiment& experiment) {
  time_ns_ = experiment.start_ns;
  put(Call::setup_experiment);
  commands_.put(experiment);
  hand_over();
}

void IsolatedSlave::enter_initialization() {
  put(Call::enter_initialization);
  hand_over();
}

void IsolatedSlave::exit_initialization() {
  put(Call::exit_initialization);
  hand_over();
}

void IsolatedSlave::terminate() {
  put(Call::terminate);
  hand_over();
}

StepResult IsolatedSlave::step(std::int64_t start_ns, std::int64_t duration_ns) {
  MEBOTS_ASSERT(duration_ns > 0);
  time_ns_ = start_ns;
  step_end_ns_ = start_ns + duration_ns;
  control_->cancel.store(false, std::memory_order_relaxed);
  put(Call::step);
  commands_.put(start_ns);
  commands_.put(duration_ns);
  return hand_over_step();
}

/// Waits for the end of a pending step. An interrupt or the deadline can end the wait.
StepResult IsolatedSlave::finish_step(const std::atomic<bool>& cancel) {
  cancel_ = &cancel;
  put(Call::finish_step);
  try {
    auto result = hand_over_step();
    cancel_ = nullptr;
    return result;
  } catch (...) {
    cancel_ = nullptr;
    throw;
  }
}

/// Sends a step and the reads that were requested after the previous step.
StepResult IsolatedSlave::hand_over_step() {
  std::erase_if(reads_, [](const Read& read) { return !read.used; });
  for (const auto& read : reads_) put_read(read.call, read.references, read.orders);
  pending_ += reads_.size();
  StepResult result;
  hand_over(reads_.size() + 1, [&](SharedReader& answers) {
    check(answers);
    result.done = answers.get_flag();
    result.pending = answers.get_flag();
    result.cancelled = answers.get_flag();
    result.terminated = answers.get_flag();
    result.last_successful_s = answers.get_optional();
    result.messages = answers.get_text();
    if (result.pending) return;  // finish_step() sends the reads again
    if (!result.done) return forget_reads();
    time_ns_ = step_end_ns_;
    turn_ ^= 1;
    take_reads(answers);
  });
  return result;
}

/// Stores the answers of the reads that were sent with the step.
void IsolatedSlave::take_reads(SharedReader& answers) {
  for (auto read = reads_.begin(); read != reads_.end(); ++read) {
    read->used = false;
    read->fresh = true;
    read->failure = nullptr;
    try {
      check(answers);
      take(*read, answers);
    } catch (const DamagedMemory&) {
      throw;
    } catch (const Error&) {
      read->failure = std::current_exception();  // rethrown when the values are read
      reads_.erase(read + 1, reads_.end());      // the host has executed no call after the failure
      return;
    }
  }
}

void IsolatedSlave::take(Read& read, SharedReader& answers) {
  const auto count = read.references.size();
  switch (read.call) {
    case Call::get_reals:
    case Call::get_output_derivatives:
      read.reals.resize(count);
      answers.get(std::span(read.reals));
      return;
    case Call::get_strings:
    case Call::get_binaries:
      read.strings.resize(count);
      for (auto& text : read.strings) text = answers.get_text();
      return;
    default:
      read.integers.resize(count);
      answers.get(std::span(read.integers));
  }
  if (read.call == Call::get_integers) take_binaries(read, answers);
}

void IsolatedSlave::take_binaries(Read& read, SharedReader& answers) {
  for (std::size_t i = 0; i < triples_.size(); ++i) {
    const auto places = places_of(triples_[i], read.references);
    if (!places) continue;
    const auto bytes = answers.get_bytes();
    auto& kept = binaries_[i][turn_];
    const auto* first = reinterpret_cast<const std::uint8_t*>(bytes.data());
    kept.assign(first, first + bytes.size());
    const auto reference = kept.empty() ? fmu::BinaryRef{} : fmu::BinaryRef::to(kept);
    read.integers[(*places)[0]] = reference.base_lo;
    read.integers[(*places)[1]] = reference.base_hi;
    if (!kept.empty()) read.integers[(*places)[2]] = reference.size;
  }
}

void IsolatedSlave::forget_reads() {
  for (auto& read : reads_) read.fresh = false;
}

void IsolatedSlave::put_read(Call call, std::span<const ValueReference> references,
                             std::span<const std::int32_t> orders) {
  put_references(call, references);
  if (call == Call::get_output_derivatives) commands_.put(orders);
}

IsolatedSlave::Read& IsolatedSlave::read(Call call, std::span<const ValueReference> references,
                                         std::span<const std::int32_t> orders) {
  const auto found = std::find_if(reads_.begin(), reads_.end(), [&](const Read& other) {
    return other.call == call && std::ranges::equal(other.references, references) &&
           std::ranges::equal(other.orders, orders);
  });
  if (found != reads_.end() && found->fresh && pending_ == 0) {
    found->used = true;
    if (found->failure) std::rethrow_exception(found->failure);
    return *found;
  }
  put_read(call, references, orders);
  Read answer;
  answer.call = call;
  answer.references.assign(references.begin(), references.end());
  hand_over(1, [&](SharedReader& answers) {
    check(answers);
    take(answer, answers);
  });
  auto& asked = found != reads_.end() ? *found : reads_.emplace_back();
  asked = std::move(answer);
  asked.orders.assign(orders.begin(), orders.end());
  asked.used = true;
  asked.fresh = false;  // the next identical read is sent, because values may change without a step
  return asked;
}

void IsolatedSlave::get_reals(std::span<const ValueReference> references, std::span<double> values) {
  std::ranges::copy(read(Call::get_reals, references).reals, values.begin());
}

void IsolatedSlave::get_integers(std::span<const ValueReference> references, std::span<std::int64_t> values) {
  std::ranges::copy(read(Call::get_integers, references).integers, values.begin());
}

void IsolatedSlave::get_booleans(std::span<const ValueReference> references, std::span<std::int64_t> values) {
  std::ranges::transform(read(Call::get_booleans, references).integers, values.begin(),
                         // A faulty process may send numbers other than 0 and 1.
                         [](std::int64_t value) { return value == 0 ? 0 : 1; });
}

void IsolatedSlave::get_strings(std::span<const ValueReference> references, std::span<std::string> values) {
  std::ranges::copy(read(Call::get_strings, references).strings, values.begin());
}

void IsolatedSlave::get_binaries(std::span<const ValueReference> references, std::span<std::string> values) {
  std::ranges::copy(read(Call::get_binaries, references).strings, values.begin());
}

void IsolatedSlave::set_reals(std::span<const ValueReference> references, std::span<const double> values) {
  defer(Call::set_reals, references, values);
}

void IsolatedSlave::set_integers(std::span<const ValueReference> references, std::span<const std::int64_t> values) {
  forget_reads();
  put_references(Call::set_integers, references);
  commands_.put(values);
  for (const auto& triple : triples_) {
    const auto places = places_of(triple, references);
    if (!places) continue;
    const auto part = [&](std::size_t place) { return static_cast<std::int32_t>(values[(*places)[place]]); };
    const auto bytes = fmu::BinaryRef{part(0), part(1), part(2)}.bytes();
    if (!is_readable(bytes)) {
      throw SlaveError(
          fmt::format("instance '{}' at {} s: its binary input (value reference {}) is the address {} "
                      "of {} bytes, which cannot be read",
                      name_, to_seconds(time_ns_), triple.references[0], fmt::ptr(bytes.data()), bytes.size()));
    }
    commands_.put(bytes);
  }
  ++pending_;
}

void IsolatedSlave::set_booleans(std::span<const ValueReference> references, std::span<const std::int64_t> values) {
  defer(Call::set_booleans, references, values);
}

void IsolatedSlave::set_strings(std::span<const ValueReference> references, std::span<const std::string> values) {
  put_texts(Call::set_strings, references, values);
}

void IsolatedSlave::set_binaries(std::span<const ValueReference> references, std::span<const std::string> values) {
  put_texts(Call::set_binaries, references, values);
}

void IsolatedSlave::put_texts(Call call, std::span<const ValueReference> references,
                              std::span<const std::string> values) {
  forget_reads();
  put_references(call, references);
  for (const auto& value : values) commands_.put(std::string_view(value));
  ++pending_;
}

void IsolatedSlave::get_output_derivatives(std::span<const ValueReference> references,
                                           std::span<const std::int32_t> orders, std::span<double> values) {
  std::ranges::copy(read(Call::get_output_derivatives, references, orders).reals, values.begin());
}

void IsolatedSlave::set_input_derivatives(std::span<const ValueReference> references,
                                          std::span<const std::int32_t> orders, std::span<const double> values) {
  defer(Call::set_input_derivatives, references, orders, values);
}

std::unique_ptr<SlaveState> IsolatedSlave::save_state() {
  const auto id = states_++;
  put(Call::save_state);
  commands_.put(id);
  hand_over();
  return std::make_unique<IsolatedState>(*this, id);
}

void IsolatedSlave::restore_state(const SlaveState& state) {
  forget_reads();
  put(Call::restore_state);
  commands_.put(id_of(state));
  hand_over();
}

std::vector<std::byte> IsolatedSlave::serialize(const SlaveState& state) {
  put(Call::serialize);
  commands_.put(id_of(state));
  std::vector<std::byte> bytes;
  std::string elsewhere;
  hand_over(1, [&](SharedReader& answers) {
    check(answers);
    bytes = answers.get_vector<std::byte>();
    elsewhere = answers.get_text();
  });
  if (!elsewhere.empty()) instance_->fmu->set_difference_elsewhere(std::move(elsewhere));
  return bytes;
}

std::unique_ptr<SlaveState> IsolatedSlave::deserialize(std::span<const std::byte> bytes) {
  const auto id = states_++;
  put(Call::deserialize);
  commands_.put(id);
  commands_.put(bytes);
  hand_over();
  return std::make_unique<IsolatedState>(*this, id);
}

void IsolatedSlave::free_state(std::uint64_t id) noexcept {
  try {
    put(Call::free_state);
    commands_.put(id);
    ++pending_;
  } catch (const Error&) {  // NOLINT(bugprone-empty-catch): it goes with the process
  }
}

}  // namespace mebots::master::isolation
