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

/// The values of one type that are read from a slave, or written to it, in one call.
template <typename T>
struct Bank {
  std::vector<ValueReference> references;
  std::vector<const modeldesc::Variable*> variables;
  std::vector<T> values;
  std::unordered_map<const modeldesc::Variable*, std::size_t> slots;

  /// Returns the index of a variable in the bank. Adds the variable if necessary.
  std::size_t slot(const modeldesc::Variable& variable);
};

/// All values that are transferred in one direction between the master and a slave.
struct Banks {
  Bank<double> reals;
  Bank<std::int64_t> integers;
  Bank<std::int64_t> booleans;
  Bank<std::string> strings;
  Bank<std::string> binaries;
};

/// Identifies the last known value of an output.
struct SignalId {
  std::size_t instance = 0;
  ValueKind kind = ValueKind::real;
  std::size_t slot = 0;
};

/// The value of a connected Real input within a step of its slave: a polynomial in the time since the step's start. The
/// pointers are valid as long as the ensemble exists.
struct InputCourse {
  const std::int64_t* start_ns = nullptr;
  const double* value = nullptr;
  std::span<const double> derivatives;  ///< of orders 1 and up; empty if the input is held
};

/// The slaves and the values that are transferred between them. At a communication point, the master reads and writes
/// each slave with one call per type. The arrays for these calls are created before the first step, and do not depend
/// on the order of steps.
class Ensemble {
 public:
  /// Creates the slaves in the order of the config. `system` and `messages` must outlive the ensemble.
  Ensemble(const ResolvedSystem& system, MessageSink& messages, const SlaveOptions& options = {});

  /// Registers a variable to be read at every communication point. Must be called before initialize().
  SignalId watch(const ResolvedVariable& variable);

  /// Sets start values, enters initialisation mode, propagates initial values along the connections, and reads the
  /// outputs at t = 0. After an interrupt, throws InterruptedError between two calls. Throws InputError if a slave
  /// rejects its inputs, NotFiniteError for NaN or infinity in an initial value, Error if a loop of connections does
  /// not converge.
  void initialize(std::int64_t stop_ns);
  void terminate();
  /// Frees the instances. No call of an instance may follow. Returns an error text for each instance that failed.
  std::vector<std::string> free_instances();

  std::size_t size() const { return members_.size(); }
  Slave& slave(std::size_t instance) { return *members_[instance].slave; }
  const std::string& name(std::size_t instance) const { return members_[instance].slave->name(); }

  /// Reads a slave's watched and connected outputs. Throws Error if an output is NaN or infinite. `time_ns` is the time
  /// of the outputs.
  void read_outputs(std::size_t instance, std::int64_t time_ns);
  /// Sets a slave's connected inputs to the values last read from their sources. `time_ns` is the start of the slave's
  /// step. If the slave accepts time derivatives of inputs and a source provides them, also sets derivatives. If a
  /// source is already at a later time, the input follows the line between the source's last two values. Throws
  /// NotFiniteError if a conversion overflows. Throws Error if an Integer is not an item of the Enumeration to which it
  /// is connected.
  void write_inputs(std::size_t instance, std::int64_t time_ns);

  /// These functions return the last read value of a signal. The references are valid from initialize() until the
  /// ensemble is destroyed.
  const double& real(SignalId id) const { return members_[id.instance].outputs.reals.values[id.slot]; }
  const std::int64_t& integer(SignalId id) const {
    const auto& outputs = members_[id.instance].outputs;
    return (id.kind == ValueKind::boolean ? outputs.booleans : outputs.integers).values[id.slot];
  }
  /// Returns the text of a String, or the bytes of a Binary.
  const std::string& string(SignalId id) const {
    const auto& outputs = members_[id.instance].outputs;
    return (id.kind == ValueKind::binary ? outputs.binaries : outputs.strings).values[id.slot];
  }

  /// Returns the time of the last read outputs of a slave.
  const std::int64_t& outputs_time_ns(std::size_t instance) const { return members_[instance].outputs_time_ns; }
  /// Returns the polynomial that a connected Real input followed in the last step.
  InputCourse course_of(const ResolvedVariable& input) const;

  /// Returns all last read outputs. If a step is not completed, bring_back() restores them.
  std::vector<Banks> outputs() const;
  void bring_back(const std::vector<Banks>& outputs);

  /// Returns an order of steps in which the reader of a buffer precedes its owner.
  const std::vector<std::size_t>& step_order() const { return step_order_; }

  /// Visits the outputs that were read last. An instance with a longer step keeps its outputs between its steps.
  void visit(state::Visitor& v);

 private:
  /// Copies a value from an output's bank to an input's bank. The pointers are valid from initialize() on.
  template <typename T>
  struct Copy {
    SignalId signal;
    std::size_t slot;
    const T* from = nullptr;
    T* to = nullptr;
  };

  /// Converts an output to a Real input. The input is set to factor * value + offset, or this term is added to the
  /// input.
  struct Conversion {
    SignalId from;
    std::size_t to;
    double factor;
    double offset;
    bool add;
  };

  /// An Integer, Enumeration or Boolean input whose values are mapped.
  struct Mapping {
    Copy<std::int64_t> copy;
    ValueKind kind;  // of the input
    const std::vector<ValuePair>* map;
  };

  /// A connection from an OSMP binary to a Binary input.
  struct BytesOfTriple {
    std::array<SignalId, 3> parts;
    std::size_t slot;
  };

  /// A connection from a Binary to the three Integer inputs of an OSMP binary. `bytes` are valid until the next step.
  struct TripleOfBytes {
    SignalId binary;
    std::array<std::size_t, 3> slots;
    std::string bytes = {};
  };

  /// Time derivatives of several variables. The derivatives of one variable are adjacent and have the orders 1, 2 and
  /// so on.
  struct Derivatives {
    std::vector<ValueReference> references;
    std::vector<std::int32_t> orders;
    std::vector<double> values;
    std::unordered_map<ValueReference, std::size_t> firsts;  // the place of order 1

    /// Returns the index of a variable's first derivative. If the variable has no derivatives yet, adds those up to
    /// order `most`.
    std::size_t place(ValueReference reference, std::uint32_t most);
    /// Returns a variable's derivatives; empty if the variable has none.
    std::span<const double> of(ValueReference reference) const;
  };

  /// A connection over which time derivatives of orders 1 to `orders` are transferred.
  struct DerivativeLink {
    const ResolvedConnection* connection;
    SignalId from;
    std::size_t to;          // slot among the Real inputs
    std::size_t from_first;  // place among the source's output derivatives
    std::size_t to_first;    // place among the reader's input derivatives
    std::uint32_t orders;
    bool nan_reported = false;  // a derivative that is not a number was reported
  };

  /// An Enumeration input that receives an Integer.
  struct ItemCheck {
    const ResolvedConnection* connection;
    std::size_t slot;  // among the Integer inputs
    std::vector<std::int64_t> items;
  };

  /// An input whose type may lack some values of the output's type.
  struct RangeCheck {
    const ResolvedConnection* connection;
    std::size_t slot;  // among the Real or the Integer inputs
  };

  struct Member {
    std::unique_ptr<Slave> slave;
    // Summaries that show which banks are not empty, and whether all inputs are unchanged copies of Reals. One check of
    // these members replaces a check of each list. This is faster at every communication point, because the cache
    // cannot contain the lists of all instances.
    KindSet output_kinds = 0;
    KindSet input_kinds = 0;
    bool takes_reals_as_they_are = false;
    bool keeps_earlier = false;        // derivatives are transferred, so the previous values are kept: two known ends
                                       // define a line
    std::int64_t outputs_time_ns = 0;  // time of `outputs`
    std::int64_t inputs_time_ns = 0;   // start of the step for which `inputs` were set
    Banks outputs;
    Banks inputs;
    std::vector<Copy<double>> real_copies;
    std::vector<Copy<std::int64_t>> integer_copies;
    std::vector<Copy<std::int64_t>> flag_copies;  // Booleans to Integers, as 0 and 1
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
    Derivatives output_derivatives;  // read with the outputs, so that the order of instances has no effect
    Derivatives input_derivatives;
    std::vector<ItemCheck> item_checks;
    std::vector<RangeCheck> range_checks;
    std::vector<std::size_t> outer_sizes;  // of the lists of inputs, without inner connections
    bool reported_texts = false;           // a text that is not UTF-8 was reported
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
  /// Limits inputs to their ranges. Before the initial values have converged, an input may have any value.
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

/// Returns connected inputs such that each loop of connections and direct dependencies at initialisation contains at
/// least one of them. If these inputs are constant, no loop remains.
std::vector<ResolvedVariable> torn_inputs(const ResolvedSystem& system);

/// Returns a loop of connections and direct dependencies at initialisation, such as "a.y -> b.u -> b.y -> a.u -> a.y";
/// empty if there is none.
std::string initial_loop(const ResolvedSystem& system);

/// Instantiates the slaves of a system in the order of the config, each in the process, and wrapped in the slave
/// classes, that the config requires. Throws SlaveError if an instantiation fails.
std::vector<std::unique_ptr<Slave>> make_slaves(const ResolvedSystem& system, MessageSink& messages,
                                                const SlaveOptions& options);

}  // namespace mebots::master
