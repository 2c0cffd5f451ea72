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

/// Values of one type that are read from, or written to, one slave in one call.
template <typename T>
struct Bank {
  std::vector<ValueReference> references;
  std::vector<const modeldesc::Variable*> variables;
  std::vector<T> values;
  std::unordered_map<const modeldesc::Variable*, std::size_t> slots;

  /// The slot of a variable, made if missing.
  std::size_t slot(const modeldesc::Variable& variable);
};

/// All values that travel in one direction between the master and one slave.
struct Banks {
  Bank<double> reals;
  Bank<std::int64_t> integers;
  Bank<std::int64_t> booleans;
  Bank<std::string> strings;
  Bank<std::string> binaries;
};

/// Where the ensemble keeps the last known value of an output.
struct SignalId {
  std::size_t instance = 0;
  ValueKind kind = ValueKind::real;
  std::size_t slot = 0;
};

/// What a connected Real input has within a step of its slave: a polynomial in the time since the step's start.
/// Addresses hold for as long as the ensemble lives.
struct InputCourse {
  const std::int64_t* start_ns = nullptr;
  const double* value = nullptr;
  std::span<const double> derivatives;  ///< of orders 1 and up; empty where the input is held
};

/// The slaves and the values that travel between them: one read and one write per slave, type and
/// communication point, on arrays laid out before the first step. Knows nothing of the order of steps.
class Ensemble {
 public:
  /// Makes the slaves, in the order of the config. `system` and `messages` must outlive the ensemble.
  Ensemble(const ResolvedSystem& system, MessageSink& messages, const SlaveOptions& options = {});

  /// Asks for a variable to be read at every communication point. Only before initialize().
  SignalId watch(const ResolvedVariable& variable);

  /// Start values, initialisation mode, initial values along the connections, and the outputs at t = 0. Throws
  /// InterruptedError between two calls.
  /// Throws InputError when a slave refuses what it was given, NotFiniteError for NaN or infinity in an initial
  /// value, Error when a loop of connections does not settle.
  void initialize(std::int64_t stop_ns);
  void terminate();
  /// Frees the instances, of which none is called any more. Returns what went wrong, one text for each that it did.
  std::vector<std::string> free_instances();

  std::size_t size() const { return members_.size(); }
  Slave& slave(std::size_t instance) { return *members_[instance].slave; }
  const std::string& name(std::size_t instance) const { return members_[instance].slave->name(); }

  /// Fetches a slave's watched and connected outputs. Throws Error for NaN or infinity in one of them;
  /// `time_ns` is the time they are valid at.
  void read_outputs(std::size_t instance, std::int64_t time_ns);
  /// Hands a slave its connected inputs, as last read from their sources; `time_ns` is the start of its step. Where
  /// the slave takes time derivatives of inputs and a source gives them, these too; a source that stands at a later
  /// time already gives the line between its last two values. Throws NotFiniteError when a conversion overflows, Error
  /// when an Integer is not an item of the Enumeration that it goes into.
  void write_inputs(std::size_t instance, std::int64_t time_ns);

  /// Valid after initialize(), for as long as the ensemble lives.
  const double& real(SignalId id) const { return members_[id.instance].outputs.reals.values[id.slot]; }
  const std::int64_t& integer(SignalId id) const {
    const auto& outputs = members_[id.instance].outputs;
    return (id.kind == ValueKind::boolean ? outputs.booleans : outputs.integers).values[id.slot];
  }
  /// The text of a String, or the bytes of a Binary.
  const std::string& string(SignalId id) const {
    const auto& outputs = members_[id.instance].outputs;
    return (id.kind == ValueKind::binary ? outputs.binaries : outputs.strings).values[id.slot];
  }

  /// What `outputs` of the slave were read at.
  const std::int64_t& outputs_time_ns(std::size_t instance) const { return members_[instance].outputs_time_ns; }
  /// What a connected Real input had in the step that was taken last.
  InputCourse course_of(const ResolvedVariable& input) const;

  /// All outputs as last read, to go back to when a step comes to nothing.
  std::vector<Banks> outputs() const;
  void bring_back(const std::vector<Banks>& outputs);

  /// An order of stepping in which the reader of a buffer comes before its owner steps on.
  const std::vector<std::size_t>& step_order() const { return step_order_; }

  /// Shows the last read outputs, which an instance with a longer step keeps between its steps.
  void visit(state::Visitor& v);

 private:
  /// A value that an input takes as it is, from an output's bank to an input's. Addresses hold from initialize() on.
  template <typename T>
  struct Copy {
    SignalId signal;
    std::size_t slot;
    const T* from = nullptr;
    T* to = nullptr;
  };

  /// A Real input that takes factor * value + offset, or adds that to what it has.
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

  /// A Binary input that takes the bytes of an OSMP binary.
  struct BytesOfTriple {
    std::array<SignalId, 3> parts;
    std::size_t slot;
  };

  /// The three Integer inputs of an OSMP binary that take a Binary. `bytes` live until the next step.
  struct TripleOfBytes {
    SignalId binary;
    std::array<std::size_t, 3> slots;
    std::string bytes = {};
  };

  /// Time derivatives of several variables. Those of one variable are adjacent, of orders 1 and up.
  struct Derivatives {
    std::vector<ValueReference> references;
    std::vector<std::int32_t> orders;
    std::vector<double> values;
    std::unordered_map<ValueReference, std::size_t> firsts;  // the place of order 1

    /// Returns the place of a variable's first derivative. Adds derivatives up to order `most` if it has none.
    std::size_t place(ValueReference reference, std::uint32_t most);
    /// Returns a variable's derivatives; empty if it has none.
    std::span<const double> of(ValueReference reference) const;
  };

  /// Time derivatives that go from one output to one input, of orders 1 to `orders`.
  struct DerivativeLink {
    const ResolvedConnection* connection;
    SignalId from;
    std::size_t to;          // slot among the Real inputs
    std::size_t from_first;  // place among the source's output derivatives
    std::size_t to_first;    // place among the reader's input derivatives
    std::uint32_t orders;
    bool told = false;  // that a derivative is not a number
  };

  /// An Enumeration input that takes an Integer.
  struct ItemCheck {
    const ResolvedConnection* connection;
    std::size_t slot;  // among the Integer inputs
    std::vector<std::int64_t> items;
  };

  /// An input whose type may lack values of the output's.
  struct RangeCheck {
    const ResolvedConnection* connection;
    std::size_t slot;  // among the Real or the Integer inputs
  };

  struct Member {
    std::unique_ptr<Slave> slave;
    // Which banks hold anything, and whether inputs are copies of Reals and nothing else. One look instead of one per
    // list, in the loop that runs at every point over more instances than a cache holds.
    KindSet output_kinds = 0;
    KindSet input_kinds = 0;
    bool takes_reals_as_they_are = false;
    bool keeps_earlier = false;        // derivatives go out; what was read before is kept: two known ends make a line
    std::int64_t outputs_time_ns = 0;  // what `outputs` was read at
    std::int64_t inputs_time_ns = 0;   // start of the step that `inputs` were handed for
    Banks outputs;
    Banks inputs;
    std::vector<Copy<double>> real_copies;
    std::vector<Copy<std::int64_t>> integer_copies;
    std::vector<Copy<std::int64_t>> flag_copies;  // Booleans into Integers, as 0 and 1
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
    Derivatives output_derivatives;  // read with the outputs, so that the order of instances is nothing to them
    Derivatives input_derivatives;
    std::vector<ItemCheck> item_checks;
    std::vector<RangeCheck> range_checks;
    std::vector<std::size_t> outer_sizes;  // of the lists of inputs, without inner connections
    bool reported_texts = false;           // a text that is not UTF-8 has had its notice
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
  /// Sets inputs out of their range to its end: before initial values have settled, they may be anywhere.
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

/// Inputs of connections that, held fast, leave no loop among connections and direct dependencies of initial
/// values; one or more per loop.
std::vector<ResolvedVariable> torn_inputs(const ResolvedSystem& system);

/// A loop among connections and direct dependencies of initial values, as "a.y -> b.u -> b.y -> a.u -> a.y";
/// empty when there is none.
std::string initial_loop(const ResolvedSystem& system);

/// Instantiates the slaves of a system, in the order of the config, each where and with what the config asks for.
/// Throws SlaveError when an FMU gives no instance.
std::vector<std::unique_ptr<Slave>> make_slaves(const ResolvedSystem& system, MessageSink& messages,
                                                const SlaveOptions& options);

}  // namespace mebots::master
