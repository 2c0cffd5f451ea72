// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mebots/state/visitor.hpp"
#include "message/message_hub.hpp"
#include "model/resolved_system.hpp"
#include "slave/slave.hpp"
#include "slave/slave_options.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

namespace mebots::master {

/// Values of one type that are read from, or written to, a slave in one call.
template <typename T>
struct Bank {
  std::vector<ValueReference> references;
  std::vector<const modeldesc::Variable*> variables;
  std::vector<T> values;
  std::unordered_map<const modeldesc::Variable*, std::size_t> slots;

  /// Returns the index of the variable in the bank. Adds the variable if it is missing.
  std::size_t slot(const modeldesc::Variable& variable);
};

/// All values that the master reads from a slave, or all values that it writes, by type.
struct Banks {
  Bank<double> reals;
  Bank<std::int64_t> integers;
  Bank<std::int64_t> booleans;
  Bank<std::string> strings;
  Bank<std::string> binaries;
};

/// Identifies an output of an instance and its place in the output banks.
struct SignalId {
  std::size_t instance = 0;
  ValueKind kind = ValueKind::real;
  std::size_t slot = 0;
};

/// The polynomial that a connected Real input follows during a step of its slave. Its argument is the time since the
/// start of the step. The pointers are valid as long as the ensemble exists.
struct InputCourse {
  const std::int64_t* start_ns = nullptr;
  const double* value = nullptr;
  /// Time derivatives of order 1 and higher. Empty if the input is constant during the step.
  std::span<const double> derivatives;
};

/// Owns the slaves and transfers values between them. At a communication point, one call per type reads a slave's
/// outputs, and one call per type writes its inputs.
class Ensemble {
 public:
  /// Creates the slaves in the order of the config. `system` and `messages` must outlive the ensemble.
  Ensemble(const ResolvedSystem& system, MessageSink& messages, const SlaveOptions& options = {});

  /// Adds a variable that is read together with the connected outputs. Must be called before initialize().
  SignalId watch(const ResolvedVariable& variable);

  /// Sets start values, enters initialisation mode, propagates initial values along the connections, and reads the
  /// outputs at the start time. Throws InterruptedError after an interrupt, InputError if a slave rejects its inputs,
  /// NotFiniteError if an initial value is NaN or infinite, and Error if the values in a loop of connections do not
  /// converge.
  void initialize(std::int64_t stop_ns);
  void terminate();
  /// Frees the instances. Slaves must not be called afterwards. Returns one error text per instance that could not be
  /// freed.
  std::vector<std::string> free_instances();

  std::size_t size() const { return members_.size(); }
  Slave& slave(std::size_t instance) { return *members_[instance].slave; }
  const std::string& name(std::size_t instance) const { return members_[instance].slave->name(); }

  /// Reads the watched and connected outputs of a slave. `time_ns` is the time of these outputs. Throws NotFiniteError
  /// if an output is NaN or infinite.
  void read_outputs(std::size_t instance, std::int64_t time_ns);
  /// Writes the latest values of the connected outputs to a slave's inputs. `time_ns` is the start of the slave's step.
  /// Also writes time derivatives if the slave accepts them and the sources provide them. If such a source has already
  /// stepped past `time_ns`, the input follows the line through the source's last two values. Throws NotFiniteError if
  /// a conversion or a sum overflows. Throws Error if an Integer is not an item of the connected Enumeration.
  void write_inputs(std::size_t instance, std::int64_t time_ns);

  /// Return the latest value of a signal. References are valid from initialize() until the ensemble is destroyed.
  const double& real(SignalId id) const { return members_[id.instance].outputs.reals.values[id.slot]; }
  const std::int64_t& integer(SignalId id) const {
    const auto& outputs = members_[id.instance].outputs;
    return (id.kind == ValueKind::boolean ? outputs.booleans : outputs.integers).values[id.slot];
  }
  /// Returns the latest text of a String or the latest bytes of a Binary.
  const std::string& string(SignalId id) const {
    const auto& outputs = members_[id.instance].outputs;
    return (id.kind == ValueKind::binary ? outputs.binaries : outputs.strings).values[id.slot];
  }

  const std::int64_t& outputs_time_ns(std::size_t instance) const { return members_[instance].outputs_time_ns; }
  /// Returns the polynomial that the connected Real input followed in the last step.
  InputCourse course_of(const ResolvedVariable& input) const;

  /// Returns a copy of all latest outputs. Pass it to bring_back() if a step is not completed.
  std::vector<Banks> outputs() const;
  void bring_back(const std::vector<Banks>& outputs);

  /// Returns the order in which the Jacobi algorithm steps the instances. An instance that reads an OSMP buffer of
  /// another instance steps before that instance.
  const std::vector<std::size_t>& step_order() const { return step_order_; }

  /// Saves or restores the latest outputs and inputs. An instance with a longer step keeps them between its steps.
  void visit(state::Visitor& v);

 private:
  /// Copies a value from an output bank to an input bank. The pointers are valid after initialize().
  template <typename T>
  struct Copy {
    SignalId signal;
    std::size_t slot;
    const T* from = nullptr;
    T* to = nullptr;
  };

  /// Computes factor * value + offset from an output and sets a Real input to the result. If `add` is true, adds the
  /// result to the input.
  struct Conversion {
    SignalId from;
    std::size_t to;
    double factor;
    double offset;
    bool add;
  };

  /// Maps an output's value to the value of an Integer, Enumeration or Boolean input.
  struct Mapping {
    Copy<std::int64_t> copy;
    ValueKind kind;  // kind of the input
    const std::vector<ValuePair>* map;
  };

  /// Copies the bytes to which three Integers point (an OSMP binary) to a Binary input.
  struct BytesOfTriple {
    std::array<SignalId, 3> parts;
    std::size_t slot;
  };

  /// Writes the address and size of a Binary to three Integer inputs (an OSMP binary). `bytes` are valid until the next
  /// step.
  struct TripleOfBytes {
    SignalId binary;
    std::array<std::size_t, 3> slots;
    std::string bytes = {};
  };

  /// Time derivatives of several variables. The derivatives of a variable are adjacent, in ascending order from 1.
  struct Derivatives {
    std::vector<ValueReference> references;
    std::vector<std::int32_t> orders;
    std::vector<double> values;
    std::unordered_map<ValueReference, std::size_t> firsts;  // index of the derivative of order 1

    /// Returns the index of the variable's first derivative. If the variable is missing, adds its derivatives of orders
    /// 1 to `most`.
    std::size_t place(ValueReference reference, std::uint32_t most);
    /// Returns the derivatives of a variable. If the variable is missing, returns an empty span.
    std::span<const double> of(ValueReference reference) const;
  };

  /// Transfers the time derivatives of orders 1 to `orders` from an output to an input.
  struct DerivativeLink {
    const ResolvedConnection* connection;
    SignalId from;
    std::size_t to;          // index among the Real inputs
    std::size_t from_first;  // index among the source's output derivatives
    std::size_t to_first;    // index among the reader's input derivatives
    std::uint32_t orders;
    bool nan_reported = false;  // true after a NaN or infinite derivative was reported
  };

  /// Checks the values of an Enumeration input that is connected to an Integer.
  struct ItemCheck {
    const ResolvedConnection* connection;
    std::size_t slot;  // index among the Integer inputs
    std::vector<std::int64_t> items;
  };

  /// Checks values of an input whose type cannot represent all values of the output's type.
  struct RangeCheck {
    const ResolvedConnection* connection;
    std::size_t slot;  // index among the Real or the Integer inputs
  };

  struct Member {
    std::unique_ptr<Slave> slave;
    // Stores which banks contain values, and whether all inputs are unchanged copies of Reals. Checking these three
    // members is faster than checking each list, because the lists of all instances do not fit into the cache of the
    // processor.
    KindSet output_kinds = 0;
    KindSet input_kinds = 0;
    bool takes_reals_as_they_are = false;
    // True if derivatives of an output are transferred. Then `earlier_reals` stores the previous outputs, because the
    // slope of an output is computed from its last two values.
    bool keeps_earlier = false;
    std::int64_t outputs_time_ns = 0;
    std::int64_t inputs_time_ns = 0;  // start of the step for which `inputs` were set
    Banks outputs;
    Banks inputs;
    std::vector<Copy<double>> real_copies;
    std::vector<Copy<std::int64_t>> integer_copies;
    std::vector<Copy<std::int64_t>> flag_copies;  // copies of Booleans to Integers as 0 and 1
    std::vector<Copy<std::int64_t>> boolean_copies;
    std::vector<Copy<std::string>> string_copies;
    std::vector<Copy<std::string>> binary_copies;
    std::vector<BytesOfTriple> bytes_of_triples;
    std::vector<TripleOfBytes> triples_of_bytes;
    std::vector<Conversion> conversions;
    std::vector<Mapping> mappings;
    std::vector<DerivativeLink> derivatives;
    std::vector<double> earlier_reals;
    std::int64_t earlier_time_ns = 0;
    Derivatives output_derivatives;
    Derivatives input_derivatives;
    std::vector<ItemCheck> item_checks;
    std::vector<RangeCheck> range_checks;
    std::vector<std::size_t> outer_sizes;  // sizes of the input lists without connections inside a continuous system
    bool reported_texts = false;           // true after a text with invalid UTF-8 was reported
  };

  void lay_out();
  void connect(const ResolvedConnection& connection);
  template <typename Action>
  static void for_each_input_list(Member& member, Action action);
  void drop_inner_connections();
  static void choose_input_path(Member& member);
  void initialize_slaves(std::int64_t stop_ns);
  void set_starts(std::size_t instance);
  void link_derivatives(const ResolvedConnection& connection, SignalId from, std::size_t to);
  void check_items_of(const ResolvedConnection& connection, std::size_t slot);
  void collect_inputs(std::size_t instance);
  void connect_real(const ResolvedConnection& connection, SignalId from, std::size_t to);
  void connect_binary(const ResolvedConnection& connection);
  void convert_binaries(Member& member) const;
  void connect_mapped(const ResolvedConnection& connection, SignalId from, std::size_t to);
  void convert(Member& member) const;
  void hand_inputs(std::size_t instance);
  void check_items(const Member& member, std::int64_t time_ns) const;
  void check_ranges(const Member& member, std::int64_t time_ns) const;
  /// Clamps inputs to their ranges. Before the initial values have converged, an input may have any value.
  static void keep_in_ranges(Member& member);
  void start_on_lines(Member& member, std::int64_t time_ns) const;
  void write_derivatives(Member& member, std::int64_t time_ns);
  void read_derivatives(Member& member, std::int64_t time_ns) const;
  bool find_derivatives(DerivativeLink& link, std::int64_t time_ns, std::span<double> values);
  void hold_from_bad(DerivativeLink& link, std::int64_t time_ns, std::span<double> values);
  double line_slope(const DerivativeLink& link) const;
  double number(SignalId id) const;
  void order_steps();
  void check_finite(const Member& member, std::int64_t time_ns) const;
  void check_texts(Member& member, std::int64_t time_ns);

  friend class InitialValues;

  const ResolvedSystem* system_;
  MessageSink* messages_;
  const std::atomic<bool>* interrupted_;
  TimeGrid grid_;
  std::vector<Member> members_;
  std::vector<std::size_t> step_order_;
};

/// Returns inputs that cut all loops of connections and direct dependencies at initialisation. If these inputs are
/// constant, no loop remains.
std::vector<ResolvedVariable> torn_inputs(const ResolvedSystem& system);

/// Returns the variables of a loop at initialisation, such as "a.y -> b.u -> b.y -> a.u -> a.y". Returns an empty text
/// if there is no loop.
std::string initial_loop(const ResolvedSystem& system);

/// Creates the slaves of a system in the order of the config. Creates each slave in the process that the config
/// requires, and wraps it in the slave classes that its settings require. Throws SlaveError if an instance cannot be
/// created.
std::vector<std::unique_ptr<Slave>> make_slaves(const ResolvedSystem& system, MessageSink& messages,
                                                const SlaveOptions& options);

}  // namespace mebots::master
