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

enum class Stop : std::uint8_t {
  limit,     // the next instruction starts at or after the limit
  device,    // a device register was accessed; the device's next event may have changed
  turn,      // an access outside the RAM must wait for other cores; run the hart again after them
  sleeping,  // WFI or an event load, and no enabled interrupt is pending
  watch,     // the hart stored to a watched word, and the bus ended the run
  fault,     // the core cannot continue
  observer,  // the observer wants the run to end before the next instruction
};

/// A RISC-V hardware thread (hart): RV32IMC_Zicsr_Zifencei in machine mode, with the extensions in Timing. Cycles are
/// those of RI5CY, which also has Xpulp v2, or of CV32E40P. Code is decoded once into blocks. If all instructions of a
/// block start before the limit, the whole block runs at once. Otherwise the hart runs single instructions, with the
/// same counts.
class Hart {
 public:
  /// At first, the hart accesses all regions of the memory without waiting, and the first two regions are on the fast
  /// path. Other harts in the same thread may share the decoded code. Memory, bus and code must outlive the hart.
  Hart(Memory& memory, Bus& bus, DecodedCode& decoded, const HartSettings& settings = {});
  Hart(const Hart&) = delete;
  Hart& operator=(const Hart&) = delete;

  /// Sets all registers and counters to 0, and the next instruction to `pc`. Discards decoded code, because a program
  /// may have been loaded.
  void reset(std::uint32_t pc);
  /// Resets the hart as reset() does, but keeps the decoded code and the counters that no program can write.
  void restart(std::uint32_t pc);

  /// Sets the memories that the core can access. The first two memories are on the fast path.
  void connect(std::span<const MemoryPort> ports);
  /// Sets the banks of the core's first memory, if other cores or the DMA also use this memory; null if the core is the
  /// only user.
  void share_first(BankSchedule* banks) { data_path_.share_first(banks); }
  /// Sets the relation between this core's cycles and the ticks of the shared cache and banks: active cycle c is tick c
  /// + offset (modulo 2^64).
  void set_tick_offset(std::uint64_t offset) { execution_.host.tick_offset = offset; }

  /// Executes every instruction that starts before active cycle `limit`.
  Stop run(std::uint64_t limit);

  /// Describes how run_round_robin() ended.
  struct RoundEnd {
    Hart* broke_off = nullptr;  // hart that did not reach the limit; null = all did
    bool ran = false;           // that hart continued in the interpreter
    Stop stop = Stop::limit;    // its reason to stop
  };
  /// Runs harts in translated code, one after the other, each up to the same tick (active cycle + offset). This round
  /// begins with `first`. set_next() determines which hart follows. The round ends when a hart leaves translated code.
  /// The harts must share banks and decoded code.
  static RoundEnd run_round_robin(Hart& first, std::uint64_t limit_tick);
  /// Sets the hart that runs after this one in run_round_robin(); null if no hart follows. run() resets the next hart
  /// to null.
  void set_next(Hart* next) { execution_.set_next(next == nullptr ? nullptr : &next->execution_); }
  /// True if the last run stopped at the limit in translated code and can resume there, as the first hart of
  /// run_round_robin() must.
  bool has_resume_point() const { return translated_.has_resume_point(); }
  /// Adjusts the resume point after the table of banks has moved by `bytes` bytes to the front.
  void move_resume_point(std::uint64_t bytes) { translated_.move_resume_point(bytes); }
  /// Drops the resume point, so that the next run starts in the interpreter.
  void drop_resume_point() { execution_.drop_resume_point(); }
  /// Sets the observer called after every instruction; null removes it. Not part of a saved state.
  void observe(Observer* observer);

  /// set_interrupt() sets the level of one interrupt line (bit of mip); set_interrupts() sets all lines.
  void set_interrupt(unsigned bit, bool level) { csrs_.set_interrupt(bit, level); }
  void set_interrupts(std::uint32_t lines) { csrs_.set_interrupts(lines); }
  bool sleeping() const { return sleeping_; }
  /// Wakes a core that sleeps in an event load. The core then repeats the load.
  void wake() {
    sleeping_ = false;
    waits_for_event_ = false;
  }
  /// Returns true if an enabled interrupt is pending, which ends a sleep. During an event load, mstatus must also allow
  /// the interrupt, because the load would otherwise sleep again.
  bool wakes() const { return waits_for_event_ ? csrs_.interrupt_ready() : csrs_.pending() != 0; }
  /// True if the hart is in an endless jump to itself that no interrupt can end.
  bool spins() const;
  const Fault& fault() const { return traps_.fault(); }
  /// True if the core took an exception, and no handler has returned since that exception. fault().first is the first
  /// exception after the last return of a handler.
  bool in_exception() const { return traps_.in_exception(); }
  const Counters& counters() const { return execution_.counters; }

  std::uint32_t pc() const { return execution_.pc; }
  /// Sets the pc between two instructions. For debuggers.
  void set_pc(std::uint32_t pc);
  /// Reads or writes a CSR like an instruction, but adds no cycles. Returns false if the CSR or this access does not
  /// exist.
  bool csr(unsigned number, std::uint32_t& value) const { return csrs_.read(number, value); }
  bool set_csr(unsigned number, std::uint32_t value);
  /// Returns the program's CSR accesses whose effect differs from that on most other cores. Not part of a saved state.
  const CsrRemarks& csr_remarks() const { return csrs_.remarks(); }
  Mode mode() const { return csrs_.mode(); }
  /// Indices: x0 to x31, then the registers of F from kFirstFloat on.
  std::uint32_t reg(unsigned index) const { return execution_.x[index]; }
  void set_reg(unsigned index, std::uint32_t value) {
    if (index != 0) execution_.x[index] = value;
  }

  void visit(state::Visitor& v);

  /// Executes an instruction that has no host code, for translated code: see translate::Perform.
  [[gnu::sysv_abi]] static const std::uint8_t* perform(Execution& execution, std::uint64_t exit) noexcept;

  const DecodedCode& code() const { return decoded_; }

 private:
  bool stays_awake();
  std::uint32_t following();
  std::uint32_t land();
  std::uint32_t following_block(std::uint16_t* link);
  Stop continue_run(std::uint64_t limit, bool left_translated);
  bool run_block(std::uint32_t number, bool left_translated);
  const std::uint8_t* next_code();
  void step();
  void step_guarded();
  Stop leave();
  void entered_handler();
  void take_interrupt();

  Bus& bus_;
  DecodedCode& decoded_;
  BlockCache& blocks_;  // = decoded_.blocks
  Execution execution_;
  RunLimit limit_;
  Csrs csrs_;
  Traps traps_;
  DataPath data_path_;
  Fetch fetch_;
  HartUnits units_{csrs_, traps_, data_path_, fetch_, blocks_};
  Interpreter interpreter_;
  ObservedRun observed_;
  TranslatedRun translated_;
  bool at_access_ = false;   // the next instruction has waited for other cores: translated code cannot start with it
  Stop stop_ = Stop::limit;  // reason to stop, if Execution::leave is Leave::stopped
  bool sleeping_ = false;
  bool waits_for_event_ = false;  // true during a sleep in an event load
};

}  // namespace mebots::soc
