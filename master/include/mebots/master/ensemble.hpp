// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/master/message.hpp"
#include "mebots/master/resolved_system.hpp"
#include "mebots/master/slave.hpp"
#include "mebots/master/slave_options.hpp"
#include "mebots/state/bytes.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace mebots::master {

/// How values travel: enumerations as Integers, Booleans as 0 and 1.
enum class ValueKind { real, integer, boolean, string };

ValueKind kind_of(modeldesc::Type type);

/// One bit per ValueKind.
using KindSet = std::uint8_t;
constexpr KindSet bit(ValueKind kind) {
  return static_cast<KindSet>(1U << static_cast<unsigned>(kind));
}

/// Values of one type that are read from, or written to, one slave in one call.
template <typename T>
struct Bank {
  std::vector<ValueReference> references;
  std::vector<const modeldesc::Variable*> variables;
  std::vector<T> values;

  /// The slot of a variable, made if missing.
  std::size_t slot(const modeldesc::Variable& variable);
};

/// All values that travel in one direction between the master and one slave.
struct Banks {
  Bank<double> reals;
  Bank<std::int32_t> integers;
  Bank<std::int32_t> booleans;
  Bank<std::string> strings;
};

/// Where the ensemble keeps the last known value of an output.
struct SignalId {
  std::size_t instance = 0;
  ValueKind kind = ValueKind::real;
  std::size_t slot = 0;
};

/// The slaves and the values that travel between them: one read and one write per slave, type and
/// communication point, on arrays laid out before the first step. Knows nothing of the order of steps.
class Ensemble {
 public:
  /// Makes the slaves, in the order of the config. `system` and `messages` must outlive the ensemble.
  Ensemble(const ResolvedSystem& system, MessageSink& messages, const SlaveOptions& options = {});

  /// Asks for a variable to be read at every communication point. Only before initialize().
  SignalId watch(const ResolvedVariable& variable);

  /// Start values, initialisation mode, initial values along the connections, and the outputs at t = 0.
  /// Throws InputError when a slave refuses what it was given, NotFiniteError for NaN or infinity in an initial
  /// value, Error when a loop of connections does not settle.
  void initialize(std::int64_t stop_ns);
  void terminate();

  std::size_t size() const { return members_.size(); }
  Slave& slave(std::size_t instance) { return *members_[instance].slave; }
  const std::string& name(std::size_t instance) const { return members_[instance].slave->name(); }
  std::int64_t step_ns(std::size_t instance) const { return members_[instance].step_ns; }

  /// Fetches a slave's watched and connected outputs. Throws Error for NaN or infinity in one of them;
  /// `time_ns` is the time they are valid at.
  void read_outputs(std::size_t instance, std::int64_t time_ns);
  /// Hands a slave its connected inputs, as last read from their sources.
  void write_inputs(std::size_t instance);

  /// Valid after initialize(), for as long as the ensemble lives.
  const double& real(SignalId id) const { return members_[id.instance].outputs.reals.values[id.slot]; }
  const std::int32_t& integer(SignalId id) const {
    const auto& outputs = members_[id.instance].outputs;
    return (id.kind == ValueKind::boolean ? outputs.booleans : outputs.integers).values[id.slot];
  }
  const std::string& string(SignalId id) const { return members_[id.instance].outputs.strings.values[id.slot]; }

  /// An order of stepping in which the reader of a buffer comes before its owner steps on.
  const std::vector<std::size_t>& step_order() const { return step_order_; }

  /// The last read outputs, which an instance with a longer step keeps between its steps.
  void save_values(state::Writer& writer) const;
  void restore_values(state::Reader& reader);

 private:
  /// One value on its way from an output's bank to an input's. Addresses hold from initialize() on.
  template <typename T>
  struct Copy {
    SignalId signal;
    std::size_t slot;
    const T* from = nullptr;
    T* to = nullptr;
  };

  struct Member {
    std::unique_ptr<Slave> slave;
    std::int64_t step_ns = 0;
    // Which banks hold anything: one look instead of one per bank, in the loop that runs at every point.
    KindSet output_kinds = 0;
    KindSet input_kinds = 0;
    Banks outputs;
    Banks inputs;
    std::vector<Copy<double>> real_copies;
    std::vector<Copy<std::int32_t>> integer_copies;
    std::vector<Copy<std::int32_t>> boolean_copies;
    std::vector<Copy<std::string>> string_copies;
  };

  void lay_out();
  void connect(const ResolvedConnection& connection);
  void initialize_slaves(std::int64_t stop_ns);
  void set_starts(std::size_t instance);
  void propagate_initial_values();
  bool settled(const std::vector<Banks>& before) const;
  void order_steps();
  void check_finite(const Member& member, std::int64_t time_ns) const;

  const ResolvedSystem* system_;
  std::vector<Member> members_;
  std::vector<std::size_t> step_order_;
};

/// A loop among connections and direct dependencies of initial values, as "a.y -> b.u -> b.y -> a.u -> a.y";
/// empty when there is none.
std::string initial_loop(const ResolvedSystem& system);

}  // namespace mebots::master
