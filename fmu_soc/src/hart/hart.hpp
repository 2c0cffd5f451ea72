// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "hart/block_cache.hpp"
#include "hart/execution.hpp"
#include "hart/flow.hpp"
#include "hart/timing.hpp"
#include "memory/bus.hpp"
#include "memory/instruction_cache.hpp"
#include "memory/memory.hpp"
#include "translate/translator.hpp"

#include "mebots/state/visitor.hpp"

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace mebots::soc {

class Observer;
struct QuietCode;
struct Retired;

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

/// An exception, and what the core was at.
struct Exception {
  std::uint32_t cause = 0;
  std::uint32_t pc = 0;
  std::uint32_t value = 0;        // mtval
  std::uint32_t instruction = 0;  // the word at pc, 0 when it cannot be fetched
  std::uint32_t return_address = 0;
  std::uint32_t stack_pointer = 0;

  void visit(state::Visitor& v) {
    v("cause", cause);
    v("pc", pc);
    v("value", value);
    v("instruction", instruction);
    v("return_address", return_address);
    v("stack_pointer", stack_pointer);
  }
};

/// The end of a core: a trap without handler, or one that the handler itself cannot get past.
struct Fault {
  bool happened = false;
  bool double_trap = false;
  Exception last;
  Exception first;  // that it began with: the first one since a return from a handler

  void visit(state::Visitor& v) {
    v("happened", happened);
    v("double_trap", double_trap);
    v("last", last);
    v("first", first);
  }
};

/// A memory as one core reaches it.
struct MemoryPort {
  std::size_t region = 0;         // index in Memory::regions()
  std::uint32_t wait_cycles = 0;  // added to every load and store
  BankSchedule* banks = nullptr;  // who else uses it; null = nobody
  std::uint32_t moved = 0;        // where the core sees it, less its own address; if not 0, never fast
};

/// Energy of one instruction by kind [fJ], at the reference voltage.
struct InstructionEnergy {
  std::array<std::uint32_t, kOpCount> fj{};
};

/// Code as harts of one kind share it that run in the same thread and reach the same memories.
struct DecodedCode {
  /// `banks`: of the first memory, when its users may have to wait for each other; null = one user.
  DecodedCode(Memory& memory, Timing timing, const InstructionEnergy& energy, Banks* shared_banks = nullptr)
      : blocks(memory, timing, energy), banks(shared_banks) {}

  BlockCache blocks;
  Banks* banks;
  std::unique_ptr<translate::Translator> translator;  // made when the first block is hot
  const FlowMap* flow = nullptr;                      // who wants steps between functions to be noted
  std::uint64_t times_dropped = 0;                    // that translations were thrown away

  void drop_translations() {
    if (translator == nullptr) return;
    times_dropped += translator->times_dropped() + 1;
    blocks.set_listener(nullptr);
    translator.reset();
  }
  void note_flow(const FlowMap* map) {
    if (map == flow) return;
    drop_translations();
    flow = map;
  }
  /// Grows whenever code that a hart has left to go on there may be gone.
  std::uint64_t version() const {
    return blocks.generation() + times_dropped + (translator == nullptr ? 0 : translator->times_dropped());
  }
};

/// One RISC-V hardware thread: RV32IMC_Zicsr_Zifencei in machine mode, timed as RI5CY (then with Xpulp v2) or CV32E40P.
/// Straight code is decoded once into blocks; a block runs only when none of its instructions can start
/// at or after the limit, otherwise one instruction at a time is taken, with the same counts.
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
  void set_id(std::uint32_t id) { id_ = id; }
  /// Interrupts are those of GAP8's cores from the next reset on: 32 lines of an event unit, one of which is up,
  /// without mie; vectors at mtvec, whose low eight bits are 0; exceptions behind them. With it come the CSRs of the
  /// stack check, which are kept; nothing is checked. Source: RI5CY's user manual of 2018, chapters on exceptions and
  /// CSRs.
  void use_event_unit() { has_event_unit_ = true; }
  /// All lines at once.
  void set_interrupts(std::uint32_t lines);

  /// Says which memories the core reaches, and how; all others are nothing to it. The first two are the fast ones.
  void connect(std::span<const MemoryPort> ports);
  /// Who else uses the first memory from now on; null = nobody.
  void share_first(BankSchedule* banks);

  /// Instructions come through this cache from now on, which harts with the same decoded code may share. Without one,
  /// fetching never waits.
  void fetch_through(InstructionCache& cache);
  /// Active cycle c of this core is tick c + offset (modulo 2^64) of what it shares with others: cache, banks.
  void set_tick_offset(std::uint64_t offset) { execution_.host.tick_offset = offset; }

  /// With a loose limit, a block that starts before it runs to its end.
  void set_loose_limit(bool loose) {
    bound_mask_ = loose ? ~std::uint64_t{0xffffffff} : ~std::uint64_t{0};
    cache_.set_end_at_targets(!loose);
  }

  /// Instructions decoded, and translated, since construction for this hart and those that share its decoded code. What
  /// is done again counts again.
  std::uint64_t instructions_decoded() const { return cache_.decoded(); }
  std::uint64_t instructions_translated() const { return translates() ? decoded_->translator->translated() : 0; }
  /// Whether code of this hart, or of one that shares its decoded code, has been translated.
  bool translates() const { return decoded_->translator != nullptr; }
  /// Whether hot code is translated to code of the host where that is possible; at the start it is. Counts are the
  /// same with and without.
  void set_translation(bool on);

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
  /// Who comes after this one in a round; null = nobody.
  void set_next(Hart* next) { execution_.host.next = next == nullptr ? nullptr : &next->execution_; }
  /// Whether its last run stopped at the limit in translated code, where it only has to go on.
  bool has_resume_point() const { return execution_.host.resume_point != nullptr; }
  /// Something has changed: the next run begins in the interpreter.
  void drop_resume_point() { execution_.host.resume_point = nullptr; }

  /// Who watches every instruction from now on, or null. Not part of a state.
  void observe(Observer* observer);

  /// Level of an interrupt line (bit of mip).
  void set_interrupt(unsigned bit, bool level);
  bool sleeping() const { return sleeping_; }
  /// The event that an event load waits for may have come: the sleep ends, and the load asks again.
  void wake() {
    sleeping_ = false;
    waits_for_event_ = false;
  }
  /// Whether something is pending that ends a sleep: an enabled interrupt, which for an event load must also be let in
  /// (mstatus), since the load would only fall asleep again.
  bool wakes() const { return waits_for_event_ ? interrupt_ready_ : (csrs_.mip & csrs_.mie) != 0; }
  const Fault& fault() const { return fault_; }
  /// Whether no handler has returned since the last exception: fault().first is the first one since.
  bool in_exception() const { return exception_repeats_ != 0; }
  const Counters& counters() const { return execution_.counters; }
  /// Of the loads and stores: those that did not go to the first region of the memory, nor to a device.
  std::uint64_t far_accesses() const { return execution_.far_accesses; }

  std::uint32_t pc() const { return execution_.pc; }
  /// For debuggers, between instructions.
  void set_pc(std::uint32_t pc);
  /// Reads or writes a CSR as an instruction would, without its cycles; false = there is none, or not this way.
  bool csr(unsigned number, std::uint32_t& value) const { return read_csr(number, value); }
  bool set_csr(unsigned number, std::uint32_t value) { return write_csr(number, value); }
  bool interrupts_enabled() const { return csrs_.interrupts_on && csrs_.mie != 0; }
  std::uint32_t reg(unsigned index) const { return execution_.x[index]; }
  void set_reg(unsigned index, std::uint32_t value) {
    if (index != 0) execution_.x[index] = value;
  }

  void visit(state::Visitor& v);

  // For the handlers.
  /// The active cycle in which an instruction of the block in progress starts.
  std::uint64_t cycle_of(const Instruction* at) const {
    return execution_.counters.cycles + at->cycles_before + execution_.extra_cycles;
  }
  /// Likewise, as devices and counters see it: a stall for the load before comes from the instruction's start on, at
  /// the start of a block as in its middle. An instruction that is left before it has done anything has not stalled
  /// yet.
  std::uint64_t start_of(const Instruction* at) const { return cycle_of(at) - stalled_before(at); }
  const Instruction* raise(const Instruction* at, std::uint32_t cause, std::uint32_t value);
  const Instruction* slow_load(const Instruction* at, std::uint32_t address, unsigned size, bool sign);
  const Instruction* slow_store(const Instruction* at, std::uint32_t address, unsigned size, std::uint32_t value);
  const Instruction* event_load(const Instruction* at);
  const Instruction* marked_store(const Instruction* at, std::uint32_t address, unsigned size);
  /// Sets where a hardware loop ends, and goes on behind `at`, which did it.
  const Instruction* set_loop_end(const Instruction* at, unsigned loop, std::uint32_t pc);
  /// Where to note the block of a loop's next iteration, emptied when it holds that of another start.
  std::uint32_t* loop_link(const Instruction& holder, std::uint32_t start) {
    if (cache_.block(holder.link).pc != start) holder.link = 0;
    return &holder.link;
  }
  /// fence.i
  void flush_fetched();
  const Instruction* csr_access(const Instruction* at);
  const Instruction* trap_return(const Instruction* at);
  const Instruction* wait_for_interrupt(const Instruction* at);

 private:
  struct Csrs {
    std::uint32_t mie = 0;
    std::uint32_t mip = 0;
    std::uint32_t mtvec = 0;
    std::uint32_t mscratch = 0;
    std::uint32_t mepc = 0;
    std::uint32_t mcause = 0;
    std::uint32_t mtval = 0;
    std::uint32_t mcountinhibit = 0;
    bool interrupts_on = false;       // mstatus.MIE
    bool interrupts_were_on = false;  // mstatus.MPIE
    std::uint64_t cycle_base = 0;     // mcycle = counter - base; while inhibited, mcycle = base
    std::uint64_t instret_base = 0;
    std::uint32_t pcer = 0;  // RI5CY's event counters: which count
    std::uint32_t pcmr = 3;  // how they count
    std::array<std::uint64_t, 2> pccr_base{};
    std::array<std::uint32_t, 3> stack_check{};  // on or off, first address, end

    void visit(state::Visitor& v) {
      v("mie", mie);
      v("mip", mip);
      v("mtvec", mtvec);
      v("mscratch", mscratch);
      v("mepc", mepc);
      v("mcause", mcause);
      v("mtval", mtval);
      v("mcountinhibit", mcountinhibit);
      v("interrupts_on", interrupts_on);
      v("interrupts_were_on", interrupts_were_on);
      v("cycle_base", cycle_base);
      v("instret_base", instret_base);
      v("pcer", pcer);
      v("pcmr", pcmr);
      v("pccr_base", pccr_base);
      v("stack_check", stack_check);
    }
  };

  static constexpr std::uint32_t kNoPc = 1;  // no pc is odd

  const Instruction* leave_after(const Instruction* at, Leave why);
  const Instruction* leave_before(const Instruction* at, Leave why);
  const Instruction* finish_load(const Instruction* at, std::uint32_t address, const BusReply& reply);
  bool stays_awake();
  std::uint32_t following();
  std::uint32_t land();
  Stop go_on(std::uint64_t limit, bool left_translated);
  void step();
  bool run_block(std::uint32_t number, std::uint64_t limit, bool left_translated);
  void interpret(const Block& block, std::uint32_t stall, std::uint64_t limit);
  Stop leave();
  void execute(const Instruction* first, std::uint32_t extra_cycles = 0, std::uint32_t stall = 0,
               const Instruction* slow_load = nullptr);
  std::uint32_t stall_of(const Block& block) const {
    return is_load(execution_.pipeline.before.op)
               ? static_cast<std::uint32_t>(block.stalled_by >> execution_.pipeline.before.rd & 1U)
               : 0U;
  }
  bool has_loose_limit() const { return bound_mask_ != ~std::uint64_t{0}; }
  std::uint32_t stalled_before(const Instruction* at) const { return at->index == 0 ? execution_.first_stall : 0U; }
  void begin_block(std::uint32_t extra_cycles, std::uint32_t stall, const Instruction* slow_load) {
    execution_.extra_cycles = extra_cycles + stall;
    execution_.first_stall = stall;
    execution_.redirected = false;
    execution_.slow_load = slow_load;
  }
  void count_up_to(const Instruction& exit) {
    execution_.counters.instructions += exit.index;
    execution_.counters.cycles += exit.cycles_before + execution_.extra_cycles;
    execution_.counters.instruction_fj += exit.energy_before_fj;
    execution_.counters.accesses += exit.accesses_before;
  }
  void finish_block();
  const Instruction* run_until(const Instruction* at, const Instruction* stop);
  static bool is_told(const Instruction* at, const QuietCode& quiet);
  const Instruction* next_told(const Instruction* at, const Instruction* stop) const;
  Retired foresee(std::uint32_t pc) const;
  void run_block_observed(const Block& block, std::uint32_t stall, std::uint64_t limit, bool alone);
  bool run_whole_block_observed(const Block& block, std::uint32_t stall, std::uint64_t limit);
  void execute_observed(const Instruction* first, std::uint32_t extra_cycles, std::uint32_t stall,
                        const Instruction* slow_load);
  void step_observed();
  bool wants_all() const { return observer_ != nullptr && flow_ == nullptr; }
  bool may_translate(const Block& block, std::uint32_t stall) const;
  std::uint64_t make_room_for_steps(std::uint64_t cycles);
  void tell_flow();
  void make_absolute(std::span<Flow> steps) const;
  const Instruction* run_until_observed(const Instruction* at, const Instruction* stop);
  bool fetch_and_execute(const Block& block, std::uint32_t stall, std::uint64_t limit);
  void execute_fetching(const Instruction* at);
  std::uint32_t block_of(const Instruction* at) const { return cache_.known((at - at->index)->pc); }
  bool is_present(const Instruction* at) const;
  void resume_fetching(const Instruction* at, std::uint32_t wait_cycles, std::uint32_t stall,
                       const Instruction* slow_load);
  bool may_begin(const Block& block, std::uint32_t stall, std::uint64_t limit) const;
  std::uint32_t fetch(const Instruction* at, std::uint64_t cycle);
  const Instruction* next_to_fetch(const Instruction* at) const;
  bool fetch_unsettled() const {
    return fetched_ != nullptr && execution_.counters.cycles + execution_.host.tick_offset < fetched_->settled();
  }
  const translate::Entry* translated(std::uint32_t number, const Block& block);
  const translate::Entry* translate_when_hot(std::uint32_t number, const Block& block);
  void note_next(std::uint32_t block) {
    execution_.next_block = block;
    next_generation_ = cache_.generation();
  }
  /// A jump soon behind what came straight waits for that, as only its own decoding can tell.
  bool jumps_too_early(const Block& block) const {
    return execution_.pipeline.before.op != Op::end_of_block && block.early_jump;
  }
  void chain_to_here();
  bool run_translated(const translate::Entry& entry, std::uint64_t limit);
  void set_budget(std::uint64_t limit);
  bool finish_translated(const translate::Exit& exit);
  std::uint32_t following_block(std::uint32_t* link);
  void take_trap(std::uint32_t cause, std::uint32_t value);
  Exception exception_here(std::uint32_t cause, std::uint32_t value) const;
  void fail(std::uint32_t cause, std::uint32_t value, bool double_trap);
  void enter_handler(std::uint32_t cause, std::uint32_t value);
  void take_interrupt();
  std::uint32_t handler_of(std::uint32_t cause) const;
  void update_interrupts() {
    interrupt_ready_ = csrs_.interrupts_on && (csrs_.mip & csrs_.mie) != 0;
    if (interrupt_ready_) drop_resume_point();
  }
  bool read_csr(unsigned number, std::uint32_t& value) const;
  bool write_csr(unsigned number, std::uint32_t value);
  std::uint64_t read_counter(bool instret) const;
  void write_counter(bool instret, std::uint32_t value, bool high);
  void set_count_inhibit(std::uint32_t value);
  bool read_ri5cy_csr(unsigned number, std::uint32_t& value) const;
  bool write_ri5cy_csr(unsigned number, std::uint32_t value);
  bool counts_event(unsigned counter) const;
  std::uint32_t read_event_counter(unsigned counter) const;
  void write_event_counter(unsigned counter, std::uint32_t value);
  void set_event_enable(std::uint32_t pcer, std::uint32_t pcmr);
  void remember(const Instruction* exit);
  const MemoryPort* port_of(std::uint32_t address, unsigned size) const;
  void wait_for_ram(const Instruction* at, const MemoryPort& port, std::uint32_t address, unsigned size);

  Memory& memory_;
  Bus& bus_;
  Timing timing_;
  std::vector<MemoryPort> ports_;
  std::shared_ptr<DecodedCode> decoded_;
  BlockCache& cache_;  // of it
  Execution execution_;
  bool translation_on_ = true;
  Csrs csrs_;
  Fault fault_;
  std::uint32_t id_ = 0;
  bool has_event_unit_ = false;
  std::uint64_t next_generation_ = 0;  // of blocks, in which Execution::next_block is meant
  std::uint32_t cut_pc_ = kNoPc;       // behind an instruction that ran alone, or where a trap returned to
  std::uint64_t bound_mask_ = ~std::uint64_t{0};
  InstructionCache* fetched_ = nullptr;
  std::uint64_t unsettled_ = 0;  // kAbsent while lines that another core asked for may be on their way, else 0
  Observer* observer_ = nullptr;
  const FlowMap* flow_ = nullptr;  // of the observer
  std::unique_ptr<Flow[]> steps_;  // that translated code has noted; made when first wanted
  bool observer_knows_of_sleep_ = false;
  bool sleeping_ = false;
  bool waits_for_event_ = false;  // the sleep is that of an event load
  bool interrupt_ready_ = false;
  // The same exception again and again without a return from its handler means no way out.
  std::uint32_t exception_pc_ = 0;
  std::uint32_t exception_cause_ = 0;
  std::uint32_t exception_repeats_ = 0;
  std::uint64_t exception_instructions_ = 0;  // retired before the last one
};

}  // namespace mebots::soc
