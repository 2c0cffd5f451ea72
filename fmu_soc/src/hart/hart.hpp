// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/csrs.hpp"
#include "hart/data_path.hpp"
#include "hart/decoded_code.hpp"
#include "hart/execution.hpp"
#include "hart/fetch.hpp"
#include "hart/interpreter.hpp"
#include "hart/observed_run.hpp"
#include "hart/rooms.hpp"
#include "hart/run_limit.hpp"
#include "hart/timing.hpp"
#include "hart/translated_run.hpp"
#include "hart/traps.hpp"
#include "memory/bus.hpp"
#include "memory/instruction_cache.hpp"
#include "memory/memory.hpp"

#include "mebots/state/visitor.hpp"

#include <cstdint>
#include <memory>
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
/// Straight code is decoded once into blocks. A block runs only when none of its instructions can start
/// at or after the limit. Otherwise one instruction at a time is taken, with the same counts.
class Hart {
 public:
  /// Reaches all regions of the memory without waiting; the first two are the fast ones.
  Hart(Memory& memory, Bus& bus, Timing timing, const InstructionEnergy& energy)
      : Hart(memory, bus, std::make_shared<DecodedCode>(memory, timing, energy)) {}
  /// Shares decoded code with other harts of the same kind that run in the same thread.
  Hart(Memory& memory, Bus& bus, std::shared_ptr<DecodedCode> decoded);
  Hart(const Hart&) = delete;
  Hart& operator=(const Hart&) = delete;

  /// All registers 0, counters 0, and the next instruction at `pc`. What was decoded before is forgotten: a program may
  /// have been loaded.
  void reset(std::uint32_t pc);
  /// Likewise, but the counters that nothing in the core can write go on, and memory is as it was.
  void restart(std::uint32_t pc);
  /// What mhartid reads; 0 unless set.
  void set_id(std::uint32_t id) { csrs_.set_id(id); }
  /// Interrupts are those of GAP8's cores from the next reset on: 32 lines of an event unit, one of which is up,
  /// without mie; vectors at mtvec, whose low eight bits are 0; exceptions behind them. With it come the CSRs of the
  /// stack check, which are kept; nothing is checked. Source: RI5CY's user manual of 2018, chapters on exceptions and
  /// CSRs.
  void use_event_unit() { csrs_.use_event_unit(); }
  /// All lines at once.
  void set_interrupts(std::uint32_t lines) { csrs_.set_interrupts(lines); }

  /// Says which memories the core reaches, and how; all others are nothing to it. The first two are the fast ones.
  void connect(std::span<const MemoryPort> ports);
  /// Who else uses the first memory from now on; null = nobody.
  void share_first(BankSchedule* banks) { data_path_.share_first(banks); }

  /// Instructions come through this cache from now on, which harts with the same decoded code may share. Without one,
  /// fetching never waits.
  void fetch_through(InstructionCache& cache);
  /// All lines of it are absent from now on.
  void flush_fetched() { fetch_.flush(); }
  /// Active cycle c of this core is tick c + offset (modulo 2^64) of what it shares with others: cache, banks.
  void set_tick_offset(std::uint64_t offset) { execution_.host.tick_offset = offset; }

  /// With a loose limit, a block that starts before it runs to its end.
  void set_loose_limit(bool loose) {
    limit_.set_loose(loose);
    cache_.set_end_at_targets(!loose);
    data_path_.run_on_over_code(loose);
  }

  /// Instructions decoded, and translated, since construction for this hart and those that share its decoded code. What
  /// is done again counts again.
  std::uint64_t instructions_decoded() const { return cache_.decoded(); }
  std::uint64_t instructions_translated() const { return translates() ? decoded_->translator->translated() : 0; }
  /// Whether code of this hart, or of one that shares its decoded code, has been translated.
  bool translates() const { return decoded_->translator != nullptr; }
  /// Whether hot code is translated to code of the host where that is possible; at the start it is. Counts are the
  /// same with and without.
  void set_translation(bool on) { translated_.set_on(on); }

  /// Executes every instruction that starts before active cycle `limit`.
  Stop run(std::uint64_t limit);

  /// How a round of harts in translated code ended.
  struct RoundEnd {
    Hart* broke_off = nullptr;  // who did not come to the limit there; null = all did
    bool ran = false;           // it went on by the interpreter
    Stop stop = Stop::limit;    // and came back so
  };
  /// A round: as `run` up to the same tick (active cycle + offset) of each hart from this one on, in translated code.
  /// It ends with the first that does not stay there. For harts that share banks and decoded
  /// code.
  static RoundEnd run_round_robin(Hart& first, std::uint64_t limit_tick);
  /// Who watches every instruction from now on, or null. Not part of a state.
  void observe(Observer* observer);

  /// Level of an interrupt line (bit of mip).
  void set_interrupt(unsigned bit, bool level) { csrs_.set_interrupt(bit, level); }
  bool sleeping() const { return sleeping_; }
  /// The event that an event load waits for may have come: the sleep ends, and the load asks again.
  void wake() {
    sleeping_ = false;
    waits_for_event_ = false;
  }
  /// Whether something is pending that ends a sleep. That is an enabled interrupt, which for an event load must also be
  /// let in (mstatus), since the load would only fall asleep again.
  bool wakes() const { return waits_for_event_ ? csrs_.interrupt_ready() : csrs_.pending() != 0; }
  const Fault& fault() const { return traps_.fault(); }
  /// Whether no handler has returned since the last exception: fault().first is the first one since.
  bool in_exception() const { return traps_.in_exception(); }
  const Counters& counters() const { return execution_.counters; }
  /// Of the loads and stores: those that did not go to the first region of the memory, nor to a device.
  std::uint64_t far_accesses() const { return execution_.far_accesses; }

  std::uint32_t pc() const { return execution_.pc; }
  /// For debuggers, between instructions.
  void set_pc(std::uint32_t pc);
  /// Reads or writes a CSR as an instruction would, without its cycles; false = there is none, or not this way.
  bool csr(unsigned number, std::uint32_t& value) const { return csrs_.read(number, value); }
  bool set_csr(unsigned number, std::uint32_t value) { return csrs_.write(number, value); }
  bool interrupts_enabled() const { return csrs_.interrupts_enabled(); }
  std::uint32_t reg(unsigned index) const { return execution_.x[index]; }
  void set_reg(unsigned index, std::uint32_t value) {
    if (index != 0) execution_.x[index] = value;
  }

  void visit(state::Visitor& v);

  /// How it runs translated code, for who runs several harts in rounds.
  TranslatedRun& translated() { return translated_; }
  const TranslatedRun& translated() const { return translated_; }

 private:
  bool stays_awake();
  std::uint32_t following();
  std::uint32_t land();
  std::uint32_t following_block(std::uint32_t* link);
  Stop go_on(std::uint64_t limit, bool left_translated);
  bool run_block(std::uint32_t number, bool left_translated);
  Stop leave();
  void entered_handler();
  void take_interrupt();

  Memory& memory_;
  Bus& bus_;
  std::shared_ptr<DecodedCode> decoded_;
  BlockCache& cache_;  // of it
  Execution execution_;
  RunLimit limit_;
  Csrs csrs_;
  Traps traps_;
  DataPath data_path_;
  Fetch fetch_;
  Rooms rooms_{csrs_, traps_, data_path_, fetch_, cache_};
  Interpreter interpreter_;
  ObservedRun observed_;
  TranslatedRun translated_;
  bool at_access_ = false;  // the next instruction has waited for its turn: translated code would only leave before it
  bool sleeping_ = false;
  bool waits_for_event_ = false;  // the sleep is that of an event load
};

}  // namespace mebots::soc
