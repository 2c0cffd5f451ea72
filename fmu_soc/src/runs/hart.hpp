// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/csrs.hpp"
#include "hart/data_path.hpp"
#include "hart/execution.hpp"
#include "hart/fetch.hpp"
#include "hart/interpreter.hpp"
#include "hart/timing.hpp"
#include "hart/traps.hpp"
#include "memory/bus.hpp"
#include "memory/instruction_cache.hpp"
#include "memory/memory.hpp"
#include "runs/decoded_code.hpp"
#include "runs/observed_run.hpp"
#include "runs/translated_run.hpp"

#include "mebots/state/visitor.hpp"

#include <cstdint>
#include <span>

namespace mebots::soc {

class Observer;

/// Why `Hart::run` came back.
enum class Stop : std::uint8_t {
  limit,     // the next instruction starts at or after the limit
  device,    // a device register was touched: its schedule may have changed
  turn,      // an access outside the RAM must let others go first: run again when it may
  sleeping,  // WFI or an event load, and no enabled interrupt is pending
  watch,     // a watched word was stored and the bus said to end
  fault,     // the core cannot go on
  observer,  // the observer wants the run to end before the next instruction
};

/// One RISC-V hardware thread: RV32IMC_Zicsr_Zifencei in machine mode, timed as RI5CY (then with Xpulp v2) or CV32E40P.
/// Straight code is decoded once into blocks. A block runs only when none of its instructions can start at or after the
/// limit. Otherwise one instruction at a time is taken, with the same counts.
class Hart {
 public:
  /// Reaches all regions of the memory without waiting; the first two are the fast ones. Other harts that run in the
  /// same thread may share the decoded code. Memory, bus and code outlive it.
  Hart(Memory& memory, Bus& bus, DecodedCode& decoded, const HartSettings& settings = {});
  Hart(const Hart&) = delete;
  Hart& operator=(const Hart&) = delete;

  /// All registers 0, counters 0, and the next instruction at `pc`. What was decoded before is forgotten: a program may
  /// have been loaded.
  void reset(std::uint32_t pc);
  /// Likewise, but the counters that nothing in the core can write go on, and memory is as it was.
  void restart(std::uint32_t pc);

  /// Says which memories the core reaches, and how; all others are nothing to it. The first two are the fast ones.
  void connect(std::span<const MemoryPort> ports);
  /// Who else uses the first memory from now on; null = nobody.
  void share_first(BankSchedule* banks) { data_path_.share_first(banks); }
  /// Active cycle c of this core is tick c + offset (modulo 2^64) of what it shares with others: cache, banks.
  void set_tick_offset(std::uint64_t offset) { execution_.host.tick_offset = offset; }

  /// Executes every instruction that starts before active cycle `limit`.
  Stop run(std::uint64_t limit);

  /// How a round of harts in translated code ended.
  struct RoundEnd {
    Hart* broke_off = nullptr;  // who did not come to the limit there; null = all did
    bool ran = false;           // it went on by the interpreter
    Stop stop = Stop::limit;    // and came back so
  };
  /// A round: as `run` up to the same tick (active cycle + offset) of each hart from this one on, in translated code.
  /// It ends with the first that does not stay there. For harts that share banks and decoded code.
  static RoundEnd run_round_robin(Hart& first, std::uint64_t limit_tick);
  /// Who comes after this one in a round; null = nobody. A run by itself forgets it.
  void set_next(Hart* next) { execution_.set_next(next == nullptr ? nullptr : &next->execution_); }
  /// Whether the last run stopped at the limit in translated code, where it only has to go on: a round may begin here.
  bool has_resume_point() const { return translated_.has_resume_point(); }
  /// The rows of the banks' table stand so many bytes further to the front.
  void move_resume_point(std::uint64_t bytes) { translated_.move_resume_point(bytes); }
  /// Something has changed: the next run begins in the interpreter.
  void drop_resume_point() { execution_.drop_resume_point(); }
  /// Who watches every instruction from now on, or null. Not part of a state.
  void observe(Observer* observer);

  /// Level of an interrupt line (bit of mip), or of all.
  void set_interrupt(unsigned bit, bool level) { csrs_.set_interrupt(bit, level); }
  void set_interrupts(std::uint32_t lines) { csrs_.set_interrupts(lines); }
  bool sleeping() const { return sleeping_; }
  /// The event that an event load waits for may have come: the sleep ends, and the load asks again.
  void wake() {
    sleeping_ = false;
    waits_for_event_ = false;
  }
  /// Whether something is pending that ends a sleep. That is an enabled interrupt, which for an event load must also be
  /// let in (mstatus), since the load would only fall asleep again.
  bool wakes() const { return waits_for_event_ ? csrs_.interrupt_ready() : csrs_.pending() != 0; }
  /// Whether it can only do the same for ever: it jumps to where it is, and no interrupt is enabled.
  bool spins() const;
  const Fault& fault() const { return traps_.fault(); }
  /// Whether no handler has returned since the last exception: fault().first is the first one since.
  bool in_exception() const { return traps_.in_exception(); }
  const Counters& counters() const { return execution_.counters; }

  std::uint32_t pc() const { return execution_.pc; }
  /// For debuggers, between instructions.
  void set_pc(std::uint32_t pc);
  /// Reads or writes a CSR as an instruction would, without its cycles; false = there is none, or not this way.
  bool csr(unsigned number, std::uint32_t& value) const { return csrs_.read(number, value); }
  bool set_csr(unsigned number, std::uint32_t value) { return csrs_.write(number, value); }
  /// Accesses of the program that behave otherwise on most other cores. Not part of a state.
  const CsrRemarks& csr_remarks() const { return csrs_.remarks(); }
  std::uint32_t reg(unsigned index) const { return execution_.x[index]; }
  void set_reg(unsigned index, std::uint32_t value) {
    if (index != 0) execution_.x[index] = value;
  }

  void visit(state::Visitor& v);

  /// That it runs.
  const DecodedCode& code() const { return decoded_; }

 private:
  bool stays_awake();
  std::uint32_t following();
  std::uint32_t land();
  std::uint32_t following_block(std::uint32_t* link);
  Stop go_on(std::uint64_t limit, bool left_translated);
  bool run_block(std::uint32_t number, bool left_translated);
  void step();
  Stop leave();
  void entered_handler();
  void take_interrupt();

  Bus& bus_;
  DecodedCode& decoded_;
  BlockCache& blocks_;  // of it
  Execution execution_;
  RunLimit limit_;
  Csrs csrs_;
  Traps traps_;
  DataPath data_path_;
  Fetch fetch_;
  Rooms rooms_{csrs_, traps_, data_path_, fetch_, blocks_};
  Interpreter interpreter_;
  ObservedRun observed_;
  TranslatedRun translated_;
  bool at_access_ = false;  // the next instruction has waited for its turn: translated code would only leave before it
  bool sleeping_ = false;
  bool waits_for_event_ = false;  // the sleep is that of an event load
};

}  // namespace mebots::soc
