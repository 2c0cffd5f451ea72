// SPDX-License-Identifier: Apache-2.0
#include "hart/data_path.hpp"

#include "hart/csr_numbers.hpp"
#include "hart/csrs.hpp"
#include "mebots/assert.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

namespace mebots::soc {
namespace {

FastRegion fast_region(Memory& memory, const MemoryPort& port) {
  MEBOTS_ASSERT(port.region < memory.regions().size());
  auto& region = memory.regions()[port.region];
  return {region.base, region.size - 3, region.data.get(), region.marks.get(), port.wait_cycles, port.banks};
}

std::uint32_t loaded(std::uint32_t value, unsigned size, bool sign) {
  if (size == 1) return sign ? static_cast<std::uint32_t>(static_cast<std::int8_t>(value)) : value & 0xffU;
  if (size == 2) return sign ? static_cast<std::uint32_t>(static_cast<std::int16_t>(value)) : value & 0xffffU;
  return value;
}

/// Returns the number of cycles from `cycle` to the end of the bank table. After the end, the interpreter treats all
/// banks as free and claims none. Translated code does not check its position in the table, so it must stop before the
/// last row.
std::uint64_t bank_cycles_left(const Execution& e, std::uint64_t cycle) {
  if (const auto* shared = e.ram[0].banks; shared != nullptr) return shared->cycles_left(cycle);
  MEBOTS_ASSERT(cycle >= e.counters.cycles);
  const auto passed = cycle - e.counters.cycles;  // since the start of the run, which was the first row
  return Banks::kReach - std::min(passed, Banks::kReach);
}

}  // namespace

bool DataPath::connect(std::span<const MemoryPort> ports) {
  ports_.assign(ports.begin(), ports.end());
  bool others = false;
  for (std::size_t i = 0; i < 2; ++i) {
    const bool is_fast = i < ports.size() && ports[i].moved == 0;
    const auto ram = is_fast ? fast_region(memory_, ports[i]) : FastRegion{};
    const auto& before = execution_.ram[i];
    // If harts share the second memory, translated code computes the wait of each access at run time (far_access.hpp).
    // It then contains no wait cycles of this memory as a constant.
    const bool asks = i == 1 && ram.is_shared();
    const bool asked = i == 1 && before.is_shared();
    others = others || ram.data != before.data || asks != asked || (!asks && ram.wait_cycles != before.wait_cycles);
    execution_.ram[i] = ram;
    spans_[i] = ram.span;
  }
  guard(guarded_);
  return others;
}

void DataPath::guard(bool guarded) {
  guarded_ = guarded;
  for (std::size_t i = 0; i < spans_.size(); ++i) execution_.ram[i].span = guarded ? 0 : spans_[i];
}

bool DataPath::forbids(std::uint32_t address, unsigned size, Pmp::Access access) const {
  if (!guarded_) return false;
  const auto& csrs = execution_.units->csrs;
  return !csrs.pmp().allows(address, size, access, csrs.data_mode());
}

std::uint32_t DataPath::longest_wait() const {
  std::uint32_t longest = 0;
  for (const auto& port : ports_) longest = std::max(longest, port.wait_cycles);
  return longest;
}

void DataPath::share_first(BankSchedule* banks) {
  MEBOTS_ASSERT(!ports_.empty());
  for (auto& port : ports_) {
    if (port.region == ports_.front().region) port.banks = banks;
  }
  execution_.ram[0].banks = banks;
}

const MemoryPort* DataPath::port_of(std::uint32_t address, unsigned size) const {
  for (const auto& port : ports_) {
    if (memory_.regions()[port.region].holds(address - port.moved, size)) return &port;
  }
  return nullptr;
}

/// Adds the wait cycles of an access. ram_access() does the same for the fast path.
void DataPath::wait_for_ram(const Instruction* at, const MemoryPort& port, std::uint32_t address, unsigned size) {
  MEBOTS_ASSERT(size == 1 || size == 2 || size == 4);
  MEBOTS_ASSERT(memory_.regions()[port.region].holds(address, size));
  auto& e = execution_;
  const bool twice = crosses_word(address, size);
  e.extra_cycles += twice ? 2 * port.wait_cycles : port.wait_cycles;
  if (port.banks != nullptr) {
    e.extra_cycles += port.banks->claim(e.cycle_of(at), address);
    if (twice) e.extra_cycles += port.banks->claim(e.cycle_of(at) + 1, address + 4);
  }
  if (port.region != ports_.front().region) ++e.counters.far_accesses;
}

const Instruction* DataPath::load(const Instruction* at, std::uint32_t address, unsigned size, bool sign) {
  auto& e = execution_;
  if (forbids(address, size, Pmp::Access::load)) return e.raise(at, cause::kLoadAccess, address);
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
    return execution_.leave_after(at, Leave::normal);
  }
  const bool is_word = size == 4 && address % 4 == 0;
  const auto cycle = execution_.start_of(at);
  auto reply = load_quietly(cycle, address, size);
  if (!reply.is_quiet) reply = is_word ? bus_.load(address, cycle) : bus_.load_narrow(address, cycle, size);
  reply.value = loaded(reply.value, size, sign);
  return finish_load(at, address, reply);
}

const Instruction* DataPath::event_load(const Instruction* at) {
  MEBOTS_ASSERT(at->op == Op::p_elw);
  auto& e = execution_;
  const auto address = e.x[at->rs1] + static_cast<std::uint32_t>(at->imm);
  if (address % 4 != 0 || port_of(address, 4) != nullptr) return load(at, address, 4, true);
  const auto reply = bus_.load_event(address, execution_.start_of(at));
  if (reply.kind == BusReply::Kind::blocked) return execution_.leave_before(at, Leave::event);
  return finish_load(at, address, reply);
}

const Instruction* DataPath::finish_load(const Instruction* at, std::uint32_t address, const BusReply& reply) {
  MEBOTS_ASSERT(is_load(at->op));
  auto& e = execution_;
  if (reply.kind == BusReply::Kind::later) return execution_.leave_before(at, Leave::turn);
  if (reply.kind != BusReply::Kind::done) return execution_.raise(at, cause::kLoadAccess, address);
  e.x[at->rd] = reply.value;
  e.extra_cycles += reply.wait_cycles;
  ++e.counters.device_accesses;
  return execution_.leave_after(at, reply.is_quiet ? Leave::normal : Leave::device);
}

BusReply DataPath::load_quietly(std::uint64_t cycle, std::uint32_t address, unsigned size) noexcept {
  const bool tries = !finishes_block_ && address % size == 0;
  return tries ? bus_.load_quietly(address, cycle, size) : BusReply{};
}

const Instruction* DataPath::store(const Instruction* at, std::uint32_t address, unsigned size, std::uint32_t value) {
  auto& e = execution_;
  if (forbids(address, size, Pmp::Access::store)) return e.raise(at, cause::kStoreAccess, address);
  if (const auto* port = port_of(address, size); port != nullptr) {
    auto& region = memory_.regions()[port->region];
    const auto place = address - port->moved;
    wait_for_ram(at, *port, place, size);
    std::memcpy(region.data.get() + (place - region.base), &value, size);
    if (crosses_word(address, size)) e.extra_cycles += kMisalignedExtra;
    const auto* next = stored_over_mark(at, place, size);
    return next == nullptr ? nullptr : execution_.leave_after(at, Leave::normal);
  }
  const bool is_word = size == 4 && address % 4 == 0;
  const auto reply = is_word ? bus_.store(address, execution_.start_of(at), value)
                             : bus_.store_narrow(address, execution_.start_of(at), value, size);
  if (reply.kind == BusReply::Kind::later) return execution_.leave_before(at, Leave::turn);
  if (reply.kind != BusReply::Kind::done) return execution_.raise(at, cause::kStoreAccess, address);
  e.extra_cycles += reply.wait_cycles;
  ++e.counters.device_accesses;
  return execution_.leave_after(at, Leave::device);
}

std::uint8_t* DataPath::atomic_word(const Instruction* at, std::uint32_t address, bool only_loads) {
  auto& e = execution_;
  if (address % 4 != 0) {
    e.raise(at, only_loads ? cause::kLoadMisaligned : cause::kStoreMisaligned, address);
    return nullptr;
  }
  const auto* port = port_of(address, 4);
  const bool forbidden = (at->op != Op::sc_w && forbids(address, 4, Pmp::Access::load)) ||
                         (!only_loads && forbids(address, 4, Pmp::Access::store));
  if (port == nullptr || forbidden) {
    e.raise(at, only_loads ? cause::kLoadAccess : cause::kStoreAccess, address);
    return nullptr;
  }
  const auto place = address - port->moved;
  wait_for_ram(at, *port, place, 4);
  const auto& region = memory_.regions()[port->region];
  return region.data.get() + (place - region.base);
}

/// Ends an atomic operation that has stored its value. Leaves the block after the instruction, and returns null.
const Instruction* DataPath::stored_atomic(const Instruction* at, std::uint32_t address) {
  const auto place = address - port_of(address, 4)->moved;
  const auto* next = memory_.marked(place, 4, 0xff) ? stored_over_mark(at, place, 4) : at + 1;
  return next == nullptr ? nullptr : execution_.leave_after(at, Leave::normal);
}

const Instruction* DataPath::load_reserved(const Instruction* at, std::uint32_t address) {
  const auto* bytes = atomic_word(at, address, true);
  if (bytes == nullptr) return nullptr;
  auto& e = execution_;
  e.reservation = {true, address, 0};
  std::memcpy(&e.reservation.value, bytes, 4);
  e.x[at->rd] = e.reservation.value;
  return at + 1;
}

const Instruction* DataPath::store_conditional(const Instruction* at, std::uint32_t address, std::uint32_t value) {
  auto* bytes = atomic_word(at, address, false);
  if (bytes == nullptr) return nullptr;
  auto& e = execution_;
  const auto reserved = std::exchange(e.reservation, {});
  std::uint32_t word = 0;
  std::memcpy(&word, bytes, 4);
  const bool fails = !reserved.valid || reserved.address != address || reserved.value != word;
  e.x[at->rd] = fails ? 1 : 0;
  if (fails) return at + 1;
  std::memcpy(bytes, &value, 4);
  return stored_atomic(at, address);
}

const Instruction* DataPath::amo(const Instruction* at, std::uint32_t address, std::uint32_t value,
                                 std::uint32_t (*combine)(std::uint32_t word, std::uint32_t value)) {
  auto* bytes = atomic_word(at, address, false);
  if (bytes == nullptr) return nullptr;
  std::uint32_t word = 0;
  std::memcpy(&word, bytes, 4);
  const auto result = combine(word, value);
  std::memcpy(bytes, &result, 4);
  execution_.x[at->rd] = word;
  return stored_atomic(at, address);
}

const Instruction* DataPath::stored_over_mark(const Instruction* at, std::uint32_t address, unsigned size) {
  MEBOTS_ASSERT(is_store(at->op) || is_atomic(at->op));
  memory_.changed(address, size);
  if (memory_.marked(address, size, Region::kWatch) && bus_.watched(address))
    return execution_.leave_after(at, Leave::stop);
  // If blocks may run past the limit (loose limit), the block continues to its end with its old code. If it ended here
  // instead, the instruction at which the core stops would depend on whether the stored code was decoded before.
  return finishes_block_ ? at + 1 : execution_.leave_after(at, Leave::normal);
}

std::uint64_t wait_for_far(Execution& execution, std::uint64_t cycle, std::uint32_t offset) noexcept {
  const auto& far = execution.ram[1];
  MEBOTS_ASSERT(far.is_shared() && offset < far.span);
  const auto address = far.base + offset;
  const std::uint64_t wait = far.wait_cycles + far.banks->wait(cycle + far.wait_cycles, address);
  if (wait + Banks::kLongestBlock > bank_cycles_left(execution, cycle))
    return kOutsideBanks;  // the rest of the block must fit, too
  far.banks->claim(cycle + wait, address);
  ++execution.counters.far_accesses;
  return wait;
}

}  // namespace mebots::soc
