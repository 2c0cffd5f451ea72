// SPDX-License-Identifier: Apache-2.0
#include "hart/hart.hpp"

#include "hart/csr_numbers.hpp"
#include "hart/observer.hpp"
#include "mebots/assert.hpp"

#include <algorithm>
#include <cstring>
#include <type_traits>
#include <utility>

namespace mebots::soc {
namespace {

FastRegion fast_region(Memory& memory, const MemoryPort& port) {
  auto& region = memory.regions()[port.region];
  return {region.base, region.size - 3, region.data.get(), region.marks.get(), port.wait_cycles, port.banks};
}

std::uint32_t loaded(std::uint32_t value, unsigned size, bool sign) {
  if (size == 1) return sign ? static_cast<std::uint32_t>(static_cast<std::int8_t>(value)) : value & 0xffU;
  if (size == 2) return sign ? static_cast<std::uint32_t>(static_cast<std::int16_t>(value)) : value & 0xffffU;
  return value;
}

}  // namespace

Hart::Hart(Memory& memory, Bus& bus, std::shared_ptr<DecodedCode> decoded)
    : memory_(memory),
      bus_(bus),
      timing_(decoded->blocks.timing()),
      decoded_(std::move(decoded)),
      cache_(decoded_->blocks) {
  execution_.hart = this;
  std::vector<MemoryPort> ports(memory.regions().size());
  for (std::size_t i = 0; i < ports.size(); ++i) ports[i].region = i;
  connect(ports);
}

void Hart::connect(std::span<const MemoryPort> ports) {
  ports_.assign(ports.begin(), ports.end());
  std::uint32_t longest_wait = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    const bool is_fast = i < ports.size() && ports[i].moved == 0;
    const auto ram = is_fast ? fast_region(memory_, ports[i]) : FastRegion{};
    // Translated code holds all of it but who else is there.
    if (ram.data != execution_.ram[i].data || ram.wait_cycles != execution_.ram[i].wait_cycles) {
      decoded_->drop_translations();
    }
    execution_.ram[i] = ram;
  }
  for (const auto& port : ports) longest_wait = std::max(longest_wait, port.wait_cycles);
  cache_.set_longest_wait(longest_wait);
}

void Hart::share_first(BankSchedule* banks) {
  ports_.front().banks = banks;
  execution_.ram[0].banks = banks;
}

const MemoryPort* Hart::port_of(std::uint32_t address, unsigned size) const {
  for (const auto& port : ports_) {
    if (memory_.regions()[port.region].holds(address - port.moved, size)) return &port;
  }
  return nullptr;
}

/// What ram_access does on the fast path.
void Hart::wait_for_ram(const Instruction* at, const MemoryPort& port, std::uint32_t address, unsigned size) {
  auto& e = execution_;
  const bool twice = crosses_word(address, size);
  e.extra_cycles += twice ? 2 * port.wait_cycles : port.wait_cycles;
  if (port.banks != nullptr) {
    e.extra_cycles += port.banks->claim(cycle_of(at), address);
    if (twice) e.extra_cycles += port.banks->claim(cycle_of(at) + 1, address + 4);
  }
  if (port.region != ports_.front().region) ++e.far_accesses;
}

void Hart::reset(std::uint32_t pc) {
  execution_.counters = {};
  execution_.far_accesses = 0;
  restart(pc);
  cache_.clear();
}

void Hart::restart(std::uint32_t pc) {
  execution_.x = {};
  execution_.pc = pc;
  execution_.loops = {};
  csrs_ = {};
  if (has_event_unit_) csrs_.mie = ~0U;
  csrs_.cycle_base = execution_.counters.cycles;
  csrs_.instret_base = execution_.counters.instructions;
  fault_ = {};
  execution_.pipeline = {};
  wake();
  interrupt_ready_ = false;
  exception_repeats_ = 0;
  drop_resume_point();
}

Stop Hart::run(std::uint64_t limit) {
  auto& e = execution_;
  if (fault_.happened) return Stop::fault;
  cache_.forget_if_stale();
  if (!stays_awake()) return Stop::sleeping;
  e.link = nullptr;
  e.jumped = false;
  return go_on(limit, false);
}

/// To the limit, or whatever else stops it. `left_translated`: translated code has just been left.
Stop Hart::go_on(std::uint64_t limit, bool left_translated) {
  auto& e = execution_;
  limit = std::min(limit, kAbsent);
  unsettled_ = fetch_unsettled() ? kAbsent : 0;
  for (;;) {
    if (cache_.forget_if_stale()) [[unlikely]]
      e.link = nullptr;
    if (e.leave != Leave::normal) {
      if (const auto stop = leave(); stop != Stop::limit) return stop;
    }
    std::uint32_t number = 0;
    if (e.jumped) number = land();
    if (e.counters.cycles >= limit) {
      if (left_translated && e.host.resume_point == nullptr) chain_to_here();
      return Stop::limit;
    }
    e.host.resume_point = nullptr;
    if (interrupt_ready_) {
      take_interrupt();
      if (fault_.happened) return Stop::fault;
      left_translated = false;
      continue;
    }
    if (wants_all()) [[unlikely]] {
      if (!observer_->before(*this)) return Stop::observer;
      cache_.forget_if_stale();  // a debugger may have changed code, or the pc
      number = 0;
      e.link = nullptr;
      cut_pc_ = kNoPc;
    }
    if (number == 0) number = following();
    e.link = nullptr;
    if (number != 0) [[likely]] {
      left_translated = run_block(number, limit, left_translated);
    } else {
      left_translated = false;
      observer_ != nullptr ? step_observed() : step();
    }
  }
}

/// At the start of a run: false while nothing ends the sleep.
bool Hart::stays_awake() {
  if (sleeping_) {
    if (!wakes()) return false;
    wake();
  }
  if (observer_knows_of_sleep_) [[unlikely]] {
    observer_knows_of_sleep_ = false;
    if (observer_ != nullptr) observer_->woke(*this);
  }
  return true;
}

/// The block at the pc, by the link of what led here if it knows. 0: nothing can be fetched there, or only a limit or a
/// return from a trap has led there, and no block begins there otherwise. Limits cut anywhere: blocks from all of these
/// places would fill the cache and, one after the other, get hot. With a loose limit blocks say where a core stops, so
/// they must not depend on what is decoded: a core restored from a state has decoded nothing.
inline std::uint32_t Hart::following() {
  const auto* link = execution_.link;
  const auto next = execution_.next_block;
  if (link == nullptr && next != 0 && next_generation_ == cache_.generation() &&
      cache_.block(next).pc == execution_.pc) {
    return next;
  }
  if (link != nullptr && *link != 0 && cache_.block(*link).pc == execution_.pc) return *link;
  if (link == nullptr && execution_.pc == cut_pc_ && !has_loose_limit()) return cache_.known(cut_pc_);
  return following_block(execution_.link);
}

/// The target of a jump or taken branch, which costs a cycle when it is unaligned.
inline std::uint32_t Hart::land() {
  execution_.jumped = false;
  const auto* link = execution_.link;
  const bool known = link != nullptr && *link != 0 && cache_.block(*link).pc == execution_.pc;
  const auto number = known ? *link : following_block(execution_.link);
  if (number != 0 && cache_.block(number).unaligned) execution_.counters.cycles += kUnalignedTargetExtra;
  return number;
}

/// One instruction, decoded with what the pipeline holds.
void Hart::step() {
  auto& e = execution_;
  const auto* first = cache_.single(e.pc, e.pipeline.two_before, e.pipeline.before);
  if (first == nullptr) {
    std::uint32_t word = 0;
    BlockCache::fetch(memory_, e.pc, word, e.trap_value);
    e.trap_cause = cause::kFetchAccess;
    e.leave = Leave::trap;
    return;
  }
  cut_pc_ = first[1].pc;
  execute(first, fetched_ != nullptr ? fetch(first, e.counters.cycles) : 0);
  e.link = nullptr;
}

/// Runs a block as fits, or only its first instruction. True: translated code did, and begins no other
/// block only because no patch point leads there yet.
inline bool Hart::run_block(std::uint32_t number, std::uint64_t limit, bool left_translated) {
  auto& e = execution_;
  const auto& block = cache_.block(number);
  // What ran before can delay the first instruction if it was a load. A jump soon after it is another matter.
  const bool early_jump = jumps_too_early(block);
  const auto stall = stall_of(block);
  const auto present = cache_.is_present(block) ? 0 : kAbsent;
  const auto bound = ((std::uint64_t{block.last_start_bound} + stall) & bound_mask_) | present | unsettled_;
  const bool may_run = e.counters.cycles + bound < limit;
  if (!early_jump && may_translate(block, stall) && may_begin(block, stall, limit)) {
    // With a loose limit, a stall may reach it; translated code would not begin then.
    const auto* entry = e.counters.cycles + stall < limit ? translated(number, block) : nullptr;
    if (entry != nullptr) {
      if (left_translated) decoded_->translator->chain_last_exit(block.pc, *entry, stall != 0);
      e.counters.cycles += stall;
      return run_translated(*entry, limit);
    }
  }
  if (observer_ != nullptr) [[unlikely]] {
    run_block_observed(block, stall, limit, early_jump);
    return false;
  }
  if (early_jump || !may_run) [[unlikely]] {
    if (early_jump || bound < kAbsent || !fetch_and_execute(block, stall, limit)) step();
    unsettled_ = fetch_unsettled() ? kAbsent : 0;
  } else if (translation_on_) {
    execute(cache_.instructions(block), 0, stall);
  } else {
    interpret(block, stall, limit);
  }
  return false;
}

/// Whether translated code may begin a block: no instruction of it can start too late, whatever must be fetched for it.
/// It asks for its lines when it gets there, but for those of the first instruction where others use the cache, or
/// where a stall comes behind them.
inline bool Hart::may_begin(const Block& block, std::uint32_t stall, std::uint64_t limit) const {
  if (unsettled_ != 0) return false;
  if (block.line_count != 0 && (has_loose_limit() || stall != 0) && !cache_.begins_present(block)) return false;
  const auto bound = std::uint64_t{block.fetch_bound} + stall;
  return execution_.counters.cycles + (bound & bound_mask_) < limit;
}

/// A block, and behind it what follows by links without anything to decide.
inline void Hart::interpret(const Block& block, std::uint32_t stall, std::uint64_t limit) {
  auto& e = execution_;
  execute(cache_.instructions(block), 0, stall);
  // Only the limit and the lines are to be checked.
  while (e.link != nullptr && *e.link != 0 && e.leave == Leave::normal && !interrupt_ready_ && !cache_.is_stale()) {
    const auto& next = cache_.block(*e.link);
    if (next.pc != e.pc || !cache_.is_present(next)) return;
    if (jumps_too_early(next)) return;
    const auto cycles = e.counters.cycles + (e.jumped && next.unaligned ? kUnalignedTargetExtra : 0U);
    const auto next_stall = stall_of(next);
    if (cycles + ((std::uint64_t{next.last_start_bound} + next_stall) & bound_mask_) >= limit) return;
    e.counters.cycles = cycles;
    e.jumped = false;
    e.link = nullptr;
    execute(cache_.instructions(next), 0, next_stall);
  }
}

/// What a block was left for other than the next one. Stop::limit: the core goes on.
Stop Hart::leave() {
  auto& e = execution_;
  const auto why = std::exchange(e.leave, Leave::normal);
  switch (why) {
    case Leave::trap:
      if (e.trap_cause == cause::kBreakpoint && bus_.called_host()) {
        set_pc(e.pc + 4);
        return Stop::device;
      }
      take_trap(e.trap_cause, e.trap_value);
      return fault_.happened ? Stop::fault : Stop::limit;
    case Leave::device:
      return Stop::device;
    case Leave::stop:
      return Stop::watch;
    case Leave::turn:
      return Stop::turn;
    case Leave::event:
    case Leave::sleep:
      waits_for_event_ = why == Leave::event;
      if (!wakes()) {
        sleeping_ = true;
        if (observer_ != nullptr) observer_->slept(*this);
        observer_knows_of_sleep_ = observer_ != nullptr;
        return Stop::sleeping;
      }
      waits_for_event_ = false;
      return Stop::limit;
    case Leave::normal:
      break;
  }
  return Stop::limit;
}

/// The block at the pc, noted in the link of the instruction that led here when there is one.
std::uint32_t Hart::following_block(std::uint32_t* link) {
  const auto generation = cache_.generation();
  const auto number = cache_.find(execution_.pc);
  if (link != nullptr && cache_.generation() == generation) *link = number;
  return number;
}

/// Code for a block, once it is hot.
inline const translate::Entry* Hart::translated(std::uint32_t number, const Block& block) {
  auto& translator = decoded_->translator;
  if (translator != nullptr) [[likely]] {
    if (const auto* entry = translator->find(number); entry != nullptr) return entry;
  }
  return translate_when_hot(number, block);
}

void Hart::execute(const Instruction* first, std::uint32_t extra_cycles, std::uint32_t stall,
                   const Instruction* slow_load) {
  begin_block(extra_cycles, stall, slow_load);
  for (const auto* at = first; at != nullptr;) at = at->run(execution_, at);
  finish_block();
}

/// Adds up what a block has done until it was left.
void Hart::finish_block() {
  count_up_to(*execution_.exit);
  if (execution_.redirected) {
    execution_.pipeline = {};
  } else {
    remember(execution_.exit);
  }
}

/// A debugger moves the pc: what the pipeline held is gone.
void Hart::set_pc(std::uint32_t pc) {
  execution_.pc = pc & ~1U;
  execution_.link = nullptr;
  execution_.jumped = false;
  execution_.pipeline = {};
  drop_resume_point();
}

/// Notes the last two instructions of a block that was left straight on, before `exit`.
void Hart::remember(const Instruction* exit) {
  const auto previous = [this](const Instruction& instruction) {
    return executed(instruction, execution_.slow_load == &instruction);
  };
  if (exit->index == 0) return;
  execution_.pipeline.two_before = exit->index >= 2 ? previous(exit[-2]) : execution_.pipeline.before;
  execution_.pipeline.before = previous(exit[-1]);
}

void Hart::set_interrupt(unsigned bit, bool level) {
  const auto mask = 1U << bit;
  csrs_.mip = level ? csrs_.mip | mask : csrs_.mip & ~mask;
  update_interrupts();
}

const Instruction* Hart::leave_after(const Instruction* at, Leave why) {
  auto& e = execution_;
  e.pc = at[1].pc;
  e.exit = at + 1;
  if (at[1].op == Op::loop_end) at[1].run(e, at + 1);
  e.link = nullptr;
  e.leave = why;
  return nullptr;
}

const Instruction* Hart::leave_before(const Instruction* at, Leave why) {
  auto& e = execution_;
  e.extra_cycles -= stalled_before(at);
  e.pc = at->pc;
  e.exit = at;
  e.link = nullptr;
  e.leave = why;
  return nullptr;
}

const Instruction* Hart::slow_load(const Instruction* at, std::uint32_t address, unsigned size, bool sign) {
  auto& e = execution_;
  std::uint32_t value = 0;
  if (const auto* port = port_of(address, size); port != nullptr) {
    const auto& region = memory_.regions()[port->region];
    const auto place = address - port->moved;
    wait_for_ram(at, *port, place, size);
    std::memcpy(&value, region.data.get() + (place - region.base), size);
    e.x[at->rd] = loaded(value, size, sign);
    if (crosses_word(address, size)) {
      e.extra_cycles += kMisalignedExtra;
      e.slow_load = at;
    }
    return leave_after(at, Leave::normal);
  }
  if (size != 4 || address % 4 != 0) return raise(at, cause::kLoadAccess, address);
  return finish_load(at, address, bus_.load(address, start_of(at)));
}

const Instruction* Hart::event_load(const Instruction* at) {
  auto& e = execution_;
  const auto address = e.x[at->rs1] + static_cast<std::uint32_t>(at->imm);
  if (address % 4 != 0 || port_of(address, 4) != nullptr) return slow_load(at, address, 4, true);
  const auto reply = bus_.load_event(address, start_of(at));
  if (reply.kind == BusReply::Kind::blocked) return leave_before(at, Leave::event);
  return finish_load(at, address, reply);
}

const Instruction* Hart::finish_load(const Instruction* at, std::uint32_t address, const BusReply& reply) {
  auto& e = execution_;
  if (reply.kind == BusReply::Kind::later) return leave_before(at, Leave::turn);
  if (reply.kind != BusReply::Kind::done) return raise(at, cause::kLoadAccess, address);
  e.x[at->rd] = reply.value;
  e.extra_cycles += reply.wait_cycles;
  ++e.counters.device_accesses;
  return leave_after(at, Leave::device);
}

const Instruction* Hart::slow_store(const Instruction* at, std::uint32_t address, unsigned size, std::uint32_t value) {
  auto& e = execution_;
  if (const auto* port = port_of(address, size); port != nullptr) {
    auto& region = memory_.regions()[port->region];
    const auto place = address - port->moved;
    wait_for_ram(at, *port, place, size);
    std::memcpy(region.data.get() + (place - region.base), &value, size);
    if (crosses_word(address, size)) e.extra_cycles += kMisalignedExtra;
    const auto* next = marked_store(at, place, size);
    return next == nullptr ? nullptr : leave_after(at, Leave::normal);
  }
  const bool is_word = size == 4 && address % 4 == 0;
  const auto reply =
      is_word ? bus_.store(address, start_of(at), value) : bus_.store_narrow(address, start_of(at), value, size);
  if (reply.kind == BusReply::Kind::later) return leave_before(at, Leave::turn);
  if (reply.kind != BusReply::Kind::done) return raise(at, cause::kStoreAccess, address);
  e.extra_cycles += reply.wait_cycles;
  ++e.counters.device_accesses;
  return leave_after(at, Leave::device);
}

const Instruction* Hart::marked_store(const Instruction* at, std::uint32_t address, unsigned size) {
  memory_.changed(address, size);
  if (memory_.marked(address, size, Region::kWatch) && bus_.watched(address)) return leave_after(at, Leave::stop);
  // With a loose limit the block runs to its end as it was at its start, and is forgotten then: where a core stops must
  // not depend on what has been decoded.
  return has_loose_limit() ? at + 1 : leave_after(at, Leave::normal);
}

const Instruction* Hart::set_loop_end(const Instruction* at, unsigned loop, std::uint32_t pc) {
  execution_.loops[loop].end = pc;
  return cache_.end_block_at(pc) ? leave_after(at, Leave::normal) : at + 1;
}

const Instruction* Hart::wait_for_interrupt(const Instruction* at) {
  return leave_after(at, Leave::sleep);
}

void Hart::visit(state::Visitor& v) {
  MEBOTS_ASSERT(execution_.x[0] == 0, "writes to x0 go to the last one");
  auto registers = execution_.x;
  registers.back() = 0;  // what was written to x0 is nothing
  v("x", std::span(registers).first<32>());
  v("pc", execution_.pc);
  v("loops", execution_.loops);
  v("far_accesses", execution_.far_accesses);
  v("csr", csrs_);
  v("counters", execution_.counters);
  v("fault", fault_);
  v("pipeline", execution_.pipeline);
  v("sleeping", sleeping_);
  v("waits_for_event", waits_for_event_);
  v("interrupt_ready", interrupt_ready_);
  v("exception_pc", exception_pc_);
  v("exception_cause", exception_cause_);
  v("exception_repeats", exception_repeats_);
  v("exception_instructions", exception_instructions_);
  if (!v.restores()) return;
  execution_.x = registers;
  cut_pc_ = kNoPc;
  observer_knows_of_sleep_ = observer_ != nullptr && sleeping_;
  drop_resume_point();
  cache_.clear();
  for (const auto& loop : execution_.loops) cache_.end_block_at(loop.end);  // for a hart restored without its memory
}

}  // namespace mebots::soc
