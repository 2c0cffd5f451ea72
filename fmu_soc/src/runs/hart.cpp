// SPDX-License-Identifier: Apache-2.0
#include "runs/hart.hpp"

#include "hart/csr_numbers.hpp"
#include "isa/encoding.hpp"
#include "mebots/assert.hpp"

#include <exception>
#include <utility>
#include <vector>

namespace mebots::soc {

Hart::Hart(Memory& memory, Bus& bus, DecodedCode& decoded, const HartSettings& settings)
    : bus_(bus),
      decoded_(decoded),
      blocks_(decoded.blocks),
      limit_(decoded.loose_limit),
      csrs_(execution_, blocks_, settings),
      traps_(execution_, csrs_, blocks_),
      data_path_(execution_, memory, bus, decoded.loose_limit),
      fetch_(execution_, decoded.instruction_cache),
      interpreter_(execution_, memory, blocks_, fetch_, limit_),
      observed_(*this, execution_, decoded, interpreter_, limit_),
      translated_(execution_, decoded, interpreter_, fetch_, observed_, limit_) {
  execution_.units = &units_;
  execution_.hart = this;
  std::vector<MemoryPort> ports(memory.regions().size());
  for (std::size_t i = 0; i < ports.size(); ++i) ports[i].region = i;
  connect(ports);
}

void Hart::connect(std::span<const MemoryPort> ports) {
  // Translated code contains properties of the fast memories as constants. connect() returns true if one has changed.
  if (data_path_.connect(ports)) decoded_.drop_translations();
  blocks_.set_longest_wait(data_path_.longest_wait());
}

void Hart::observe(Observer* observer) {
  observed_.observe(observer, sleeping_);
  drop_resume_point();
}

void Hart::reset(std::uint32_t pc) {
  execution_.counters = {};
  execution_.events = {};
  restart(pc);
  observed_.restored(false);
  blocks_.clear();
}

void Hart::restart(std::uint32_t pc) {
  execution_.x = {};
  execution_.pc = pc;
  execution_.loops = {};
  csrs_.restart();
  observed_.count_events(csrs_.counts_events());
  traps_.restart();
  execution_.pipeline = {};
  wake();
  drop_resume_point();
}

Stop Hart::run(std::uint64_t limit) {
  auto& e = execution_;
  if (traps_.fault().happened) return Stop::fault;
  blocks_.forget_if_stale();
  if (!stays_awake()) return Stop::sleeping;
  e.link = nullptr;
  e.jumped = false;
  return continue_run(limit, false);
}

/// Runs until the limit is reached, or until there is another reason to stop. `left_translated` is true if the last
/// block ran in translated code.
Stop Hart::continue_run(std::uint64_t limit, bool left_translated) {
  auto& e = execution_;
  limit_.set_end(limit);
  if (!limit_.is_loose()) e.host.serves_calls = bus_.serves_environment_calls();
  for (;;) {
    if (blocks_.forget_if_stale()) [[unlikely]]
      e.link = nullptr;
    if (e.leave != Leave::normal) {
      if (const auto stop = leave(); stop != Stop::limit) return stop;
    }
    std::uint32_t number = 0;
    if (e.jumped) number = land();
    if (limit_.reached_at(e.counters.cycles)) {
      if (left_translated && !translated_.has_resume_point()) translated_.chain_to_here();
      return Stop::limit;
    }
    drop_resume_point();
    if (csrs_.interrupt_ready()) {
      take_interrupt();
      if (traps_.fault().happened) return Stop::fault;
      left_translated = false;
      continue;
    }
    if (observed_.wants_all()) [[unlikely]] {
      if (!observed_.continues()) return Stop::observer;
      blocks_.forget_if_stale();  // a debugger may have changed code, or the pc
      number = 0;
      e.link = nullptr;
      e.cut_pc = kNoPc;
    }
    if (csrs_.is_guarded()) [[unlikely]] {
      left_translated = false;
      e.link = nullptr;
      step_guarded();
      continue;
    }
    if (number == 0) number = following();
    e.link = nullptr;
    if (number != 0) [[likely]] {
      left_translated = run_block(number, left_translated);
    } else {
      left_translated = false;
      step();
    }
  }
}

/// Wakes a sleeping hart if an interrupt ends its sleep. Returns false if the hart stays asleep.
bool Hart::stays_awake() {
  if (sleeping_) {
    if (!wakes()) return false;
    wake();
  }
  observed_.woke();
  return true;
}

/// Returns the block at the pc. If the link of the last instruction (the number of the block that followed it before)
/// still leads to this block, uses the link. Returns 0 if the pc cannot be fetched.
///
/// If blocks may run past the limit (loose limit), always decodes a block that is not decoded yet. Without this rule,
/// the instruction at which a core stops would depend on what was decoded earlier.
///
/// If blocks must not run past the limit, decodes no block at Execution::cut_pc, for example after a limit or a return
/// from an interrupt, and may return 0. Such a pc may be any instruction, and blocks at all of them would fill the
/// cache.
inline std::uint32_t Hart::following() {
  const auto* link = execution_.link;
  if (link == nullptr) {
    if (const auto next = translated_.next_block(); next != 0) return next;
  }
  if (link != nullptr && *link != 0 && blocks_.block(*link).pc == execution_.pc) return *link;
  if (link == nullptr && execution_.pc == execution_.cut_pc && !limit_.is_loose())
    return blocks_.known(execution_.cut_pc);
  return following_block(execution_.link);
}

/// Returns the block at the target of a jump or taken branch. If the target is unaligned, counts one more cycle.
inline std::uint32_t Hart::land() {
  execution_.jumped = false;
  const auto* link = execution_.link;
  const bool known = link != nullptr && *link != 0 && blocks_.block(*link).pc == execution_.pc;
  const auto number = known ? *link : following_block(execution_.link);
  if (number != 0 && blocks_.block(number).unaligned) execution_.counters.cycles += kUnalignedTargetExtra;
  return number;
}

/// Runs a block as far as the limit allows, or only its first instruction. Returns true if translated code ran and
/// stopped only because its exit does not lead to the code of the next block yet.
inline bool Hart::run_block(std::uint32_t number, bool left_translated) {
  const auto& before = execution_.pipeline.before;
  const auto& block = blocks_.block(number);
  MEBOTS_ASSERT(block.valid() && block.pc == execution_.pc);
  // A load before the block may delay the block's first instruction. The last two instructions before the block may
  // delay a jump that is the block's first or second instruction.
  const bool delays_jump = blocks_.delays_jump(block, execution_.pipeline.two_before, before);
  const auto stall = block.stall_after(before);
  const bool at_access = std::exchange(at_access_, false);
  if (!delays_jump && !at_access) {
    if (const auto* entry = translated_.entry(number, block, stall); entry != nullptr) {
      if (left_translated) translated_.chain(block, *entry, stall);
      return translated_.run(*entry, stall);
    }
  }
  if (observed_.is_on()) [[unlikely]] {
    observed_.run_block(block, stall, delays_jump);
    return false;
  }
  const bool runs = !delays_jump && (translated_.is_on() ? interpreter_.run(block, stall)
                                                         : interpreter_.run_linked(block, stall, csrs_));
  if (!runs) delays_jump ? interpreter_.step() : interpreter_.run_to_limit(block, stall);
  return false;
}

const std::uint8_t* Hart::perform(Execution& execution, std::uint64_t exit) noexcept {
  MEBOTS_ASSERT(execution.hart != nullptr);
  auto& hart = *execution.hart;
  try {
    hart.translated_.finish_inside(exit);
    return hart.next_code();
  } catch (...) {  // an exception cannot pass through translated code
    hart.translated_.keep_error(std::current_exception());
    return nullptr;
  }
}

/// Does the same as continue_run() between two blocks, if the next block has code. Returns that code. In all other
/// cases, returns null, so that continue_run() handles the rest.
const std::uint8_t* Hart::next_code() {
  auto& e = execution_;
  if (blocks_.is_stale()) return nullptr;
  if (e.leave == Leave::trap) {
    stop_ = leave();
    if (stop_ != Stop::limit) e.leave = Leave::stopped;
  }
  if (e.leave != Leave::normal) return nullptr;
  std::uint32_t number = 0;
  if (e.jumped) number = land();
  if (limit_.reached_at(e.counters.cycles) || csrs_.interrupt_ready() || csrs_.is_guarded()) return nullptr;
  if (number == 0) number = following();
  if (number == 0) return nullptr;
  const auto& block = blocks_.block(number);
  if (blocks_.delays_jump(block, e.pipeline.two_before, e.pipeline.before)) return nullptr;
  const auto* code = translated_.begin(number, block, block.stall_after(e.pipeline.before));
  if (code != nullptr) e.link = nullptr;
  return code;
}

/// Runs one instruction at a pc where no block begins.
void Hart::step() {
  if (observed_.is_on()) {
    observed_.step();
  } else if (!interpreter_.resume_to_limit()) {
    interpreter_.step();
  }
}

/// Runs one instruction if the privilege mode may fetch it.
void Hart::step_guarded() {
  auto& e = execution_;
  const auto may_fetch = [this](std::uint32_t address) {
    return csrs_.pmp().allows(address, 2, Pmp::Access::fetch, csrs_.mode());
  };
  const auto word = blocks_.word_at(e.pc);
  const bool first = may_fetch(e.pc);
  if (first && (!word || is_compressed(*word) || may_fetch(e.pc + 2))) {
    observed_.is_on() ? observed_.step() : interpreter_.step();
    return;
  }
  e.trap_cause = cause::kFetchAccess;
  e.trap_value = first ? e.pc + 2 : e.pc;
  e.leave = Leave::trap;
}

/// Handles the reason for which execution left a block. Returns the reason why the run stops, or Stop::limit if the
/// core continues.
Stop Hart::leave() {
  auto& e = execution_;
  const auto why = std::exchange(e.leave, Leave::normal);
  MEBOTS_ASSERT(!sleeping_, "a core that sleeps runs nothing that it could leave");
  switch (why) {
    case Leave::trap:
      if (bus_.called_host(e.trap_cause)) {
        set_pc(e.pc + 4);
        return Stop::device;
      }
      if (traps_.take_exception()) entered_handler();
      // The link of the ecall then leads to the handler's block, so that translated code can jump there.
      if (e.trap_cause == cause::kMachineEcall) e.link = &e.exit->link;
      return traps_.fault().happened ? Stop::fault : Stop::limit;
    case Leave::device:
      return Stop::device;
    case Leave::stop:
      return Stop::watch;
    case Leave::turn:
      at_access_ = true;
      return Stop::turn;
    case Leave::counting:
      observed_.count_events(csrs_.counts_events());
      return Stop::limit;
    case Leave::event:
    case Leave::sleep:
      waits_for_event_ = why == Leave::event;
      if (!wakes()) {
        sleeping_ = true;
        observed_.slept();
        return Stop::sleeping;
      }
      waits_for_event_ = false;
      return Stop::limit;
    case Leave::stopped:
      return stop_;
    case Leave::normal:
      break;
  }
  return Stop::limit;
}

bool Hart::spins() const {
  if (sleeping_ || csrs_.interrupts_enabled()) return false;
  const auto word = blocks_.word_at(execution_.pc);
  if (!word) return false;
  const auto here = decode(*word);
  if (here.op == Op::jal) return here.imm == 0 && here.rd == 0;
  return is_branch(here.op) && here.imm == 0 && here.rs1 == here.rs2 &&
         (here.op == Op::beq || here.op == Op::bge || here.op == Op::bgeu);
}

/// Returns the block at the pc. If `link` is not null, stores the block's number there for the next execution of the
/// last instruction.
std::uint32_t Hart::following_block(std::uint16_t* link) {
  const auto generation = blocks_.generation();
  const auto number = blocks_.find(execution_.pc);
  MEBOTS_ASSERT(number == 0 || blocks_.block(number).pc == execution_.pc);
  if (link != nullptr && blocks_.generation() == generation) *link = static_cast<std::uint16_t>(number);
  return number;
}

/// Clears the pipeline, because a debugger moves the pc.
void Hart::set_pc(std::uint32_t pc) {
  execution_.pc = pc & ~1U;
  execution_.link = nullptr;
  execution_.jumped = false;
  execution_.pipeline = {};
  drop_resume_point();
}

/// Completes Traps::enter_handler(). The pc must be at the handler.
void Hart::entered_handler() {
  observed_.trapped(csrs_.last_trap());
  execution_.counters.cycles += kTrapEntryCycles;
}

bool Hart::set_csr(unsigned number, std::uint32_t value) {
  const bool exists = csrs_.write(number, value);
  observed_.count_events(csrs_.counts_events());
  drop_resume_point();
  return exists;
}

void Hart::take_interrupt() {
  const auto number = traps_.next_interrupt();
  if (traps_.enter_handler(cause::kInterrupt | number, 0)) entered_handler();
  if (csrs_.has_gap8_interrupts()) bus_.interrupt_taken(number);
}

void Hart::visit(state::Visitor& v) {
  MEBOTS_ASSERT(execution_.x[0] == 0, "writes to x0 go to the last one");
  auto registers = execution_.x;
  registers.back() = 0;  // scratch register for writes to x0
  v("x", std::span(registers).first<kFirstFloat>());
  v("f", std::span(registers).subspan<kFirstFloat, kRegisters - kFirstFloat>());
  v("frm", execution_.rounding);
  v("fflags", execution_.float_flags);
  v("reservation", execution_.reservation);
  v("pc", execution_.pc);
  v("loops", execution_.loops);
  v("csr", csrs_);
  v("counters", execution_.counters);
  v("events", execution_.events);
  v("traps", traps_);
  v("pipeline", execution_.pipeline);
  v("sleeping", sleeping_);
  v("waits_for_event", waits_for_event_);
  if (!v.restores()) return;
  execution_.x = registers;
  execution_.cut_pc = kNoPc;
  observed_.restored(sleeping_);
  observed_.count_events(csrs_.counts_events());
  drop_resume_point();
  blocks_.clear();
  for (const auto& loop : execution_.loops)
    blocks_.end_block_at(loop.end);  // the hart may be restored without its memory
}

Hart::RoundEnd Hart::run_round_robin(Hart& first, std::uint64_t limit_tick) {
  const auto [exit, execution] = first.translated_.run_round(limit_tick);
  if (first.decoded_.flow != nullptr) {
    for (auto* e = &first.execution_; e != nullptr; e = e->host.next) e->hart->translated_.report_flow();
  }
  if (execution == nullptr) return {};
  MEBOTS_ASSERT(execution->hart != nullptr);
  auto& hart = *execution->hart;
  if (exit == nullptr) return {&hart};
  const bool begins = hart.translated_.finish(*exit);
  return {&hart, true, hart.continue_run(limit_tick - hart.execution_.host.tick_offset, begins)};
}

}  // namespace mebots::soc
