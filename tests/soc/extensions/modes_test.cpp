// SPDX-License-Identifier: Apache-2.0
// Tests U mode and physical memory protection. Expected behaviour: The RISC-V Instruction Set Manual, volume II
// (20240411), sections 3.1 and 3.7.
#include "hart/csr_numbers.hpp"
#include "hart/pmp.hpp"
#include "machine.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <tuple>
#include <vector>

namespace mebots::soc::test {
namespace {

constexpr unsigned kCause = 10;  // a0
constexpr unsigned kValue = 11;  // a1
constexpr unsigned kEpc = 12;    // a2
constexpr unsigned kStatus = 13;

/// Runs `machine_mode`, then `user_mode` in U mode. The first trap ends the program: a0 = mcause, a1 = mtval, a2 =
/// mepc - user, a3 = mstatus.
std::unique_ptr<Machine> trap_of(const std::string& machine_mode, const std::string& user_mode) {
  const auto text = fmt::format(R"(
    _start:
    la t0, handler
    csrw mtvec, t0
    {}
    la t0, user
    csrw mepc, t0
    li t0, 0x1800
    csrc mstatus, t0
    mret
    .balign 4
    handler:
    csrr a0, mcause
    csrr a1, mtval
    csrr a2, mepc
    csrr a3, mstatus
    la t0, user
    sub a2, a2, t0
    {}
    .balign 4096
    user:
    {}
    ecall
    .balign 4096
    .globl data
    data: .word 0x11223344, 0x55667788, 0, 0
  )",
                                machine_mode, kEnd, user_mode);
  auto machine = std::make_unique<Machine>(
      Elf::parse(assemble_file(text, 0x80000000, "-march=rv32imac_zicsr"), "test program"),
      MachineSettings{.options = Extensions(Extension::user).with(Extension::a), .pmp_entries = 16});
  machine->run(100'000);
  EXPECT_EQ(machine->word("tohost"), 1U) << user_mode;
  return machine;
}

/// Gives U mode all rights.
constexpr auto kOpen = "li t0, -1\n csrw pmpaddr0, t0\n li t0, 0x1f\n csrw pmpcfg0, t0\n";

TEST(UserMode, CallsMachineMode) {
  const auto machine = trap_of(kOpen, "nop");
  EXPECT_EQ(machine->reg(kCause), cause::kUserEcall);
  EXPECT_EQ(machine->reg(kEpc), 4U - 2U) << "c.nop before it";
  EXPECT_EQ(machine->reg(kStatus) & 0x1800U, 0U) << "MPP = U";
}

TEST(UserMode, HasNoInstructionsAndRegistersOfMachineMode) {
  const auto cause_of = [](const std::string& before, const std::string& instruction) {
    return trap_of(std::string(kOpen) + before, instruction)->reg(kCause);
  };
  for (const auto* instruction : {"mret", "csrr a0, mstatus", "csrw mscratch, zero", "csrr a0, mhartid"}) {
    EXPECT_EQ(cause_of("", instruction), cause::kIllegalInstruction) << instruction;
  }
  EXPECT_EQ(cause_of("", "csrr a0, cycle"), cause::kIllegalInstruction);
  EXPECT_EQ(cause_of("csrwi mcounteren, 1", "csrr a0, cycle"), cause::kUserEcall);
  EXPECT_EQ(cause_of("csrwi mcounteren, 1", "csrr a0, instret"), cause::kIllegalInstruction);
  EXPECT_EQ(cause_of("li t0, 1 << 21\n csrs mstatus, t0", "wfi"), cause::kIllegalInstruction) << "TW";
}

TEST(UserMode, IsInterruptedWhateverMieSays) {
  Machine machine(
      Elf::parse(assemble_file(fmt::format("_start: la t0, handler\n csrw mtvec, t0\n {}\n li t0, 0x80\n"
                                           " csrw mie, t0\n la t0, user\n csrw mepc, t0\n csrw mstatus, x0\n"
                                           " mret\n user: j user\n .balign 4\n handler: csrr a0, mcause\n{}",
                                           kOpen, kEnd),
                               0x80000000, "-march=rv32imc_zicsr"),
                 "test program"),
      MachineSettings{.options = Extension::user, .pmp_entries = 16});
  machine.run(1000);
  EXPECT_EQ(machine.hart().mode(), Mode::user);
  machine.hart().set_interrupt(7, true);
  machine.run(2000);
  EXPECT_EQ(machine.reg(kCause), 0x80000007U);
  EXPECT_EQ(machine.hart().mode(), Mode::machine);
}

TEST(Pmp, ForbidsAllInUserModeWithoutAnEntry) {
  const auto machine = trap_of("", "nop");
  EXPECT_EQ(machine->reg(kCause), cause::kFetchAccess);
  EXPECT_EQ(machine->reg(kEpc), 0U);
}

/// PMP entry 1 has `configuration` and covers `data`. Entry 2 gives U mode all rights elsewhere. The code `address`
/// sets pmpaddr1.
std::string guarded_data(unsigned configuration, const std::string& address) {
  return fmt::format(
      "li t0, -1\n csrw pmpaddr2, t0\n la t1, data\n srli t1, t1, 2\n {}\n li t0, 0x1f{:02x}00\n"
      " csrw pmpcfg0, t0\n",
      address, configuration);
}

TEST(Pmp, ChecksReadsWritesAndRanges) {
  const std::string word = "csrw pmpaddr1, t1\n";                                        // range of 4 bytes (data)
  const std::string eight = "csrw pmpaddr1, t1\n";                                       // NAPOT range of 8 bytes
  const std::string range = "csrw pmpaddr0, t1\n addi t1, t1, 2\n csrw pmpaddr1, t1\n";  // TOR range of 8 bytes
  struct Case {
    unsigned configuration;
    std::string address;
    std::string access;
    unsigned expected;
  };
  const auto ecall = cause::kUserEcall;
  const std::vector<Case> cases{
      {0x10, word, "lw a0, 0(t2)", cause::kLoadAccess},
      {0x10, word, "lw a0, 4(t2)", ecall},
      {0x11, word, "lw a0, 0(t2)", ecall},
      {0x11, word, "sw a0, 0(t2)", cause::kStoreAccess},
      {0x13, word, "sw a0, 0(t2)", ecall},
      {0x11, word, "lw a0, 2(t2)", cause::kLoadAccess},
      {0x18, eight, "lh a0, 6(t2)", cause::kLoadAccess},
      {0x18, eight, "lw a0, 8(t2)", ecall},
      {0x08, range, "lb a0, 7(t2)", cause::kLoadAccess},
      {0x08, range, "lb a0, 8(t2)", ecall},
      {0x08, range, "lb a0, -1(t2)", ecall},
      {0x12, word, "sw a0, 0(t2)", cause::kStoreAccess},
      {0x11, word, "lr.w a0, (t2)", ecall},
      {0x11, word, "amoadd.w a0, a0, (t2)", cause::kStoreAccess},
      {0x11, word, "jr t2", cause::kFetchAccess},
  };
  for (const auto& [configuration, address, access, expected] : cases) {
    const auto machine = trap_of(guarded_data(configuration, address), "la t2, data\n" + access);
    EXPECT_EQ(machine->reg(kCause), expected) << access << fmt::format(" with {:x}", configuration);
  }
}

TEST(Pmp, BindsMachineModeOnlyWhereLocked) {
  const auto access = "la t2, data\n sw zero, 0(t2)\n lw t3, 4(t2)\n";
  const std::string address = "csrw pmpaddr1, t1\n";
  EXPECT_EQ(trap_of(guarded_data(0x10, address) + access, "")->reg(kCause), cause::kUserEcall);
  const auto locked = trap_of(guarded_data(0x91, address) + access, "");
  EXPECT_EQ(locked->reg(kCause), cause::kStoreAccess);
  EXPECT_EQ(locked->reg(kStatus) & 0x1800U, 0x1800U) << "from machine mode";
  // With MPRV, machine mode loads and stores with the rights of the mode in MPP.
  const auto as_user = "li t0, 0x1800\n csrc mstatus, t0\n li t0, 0x20000\n csrs mstatus, t0\n";
  EXPECT_EQ(trap_of(guarded_data(0x10, address) + as_user + access, "")->reg(kCause), cause::kStoreAccess);
}

TEST(Pmp, KeepsWhatIsLocked) {
  Pmp pmp(8);
  pmp.set_address(2, 0x1000);
  pmp.set_address(3, 0x2000);
  pmp.set_configurations(0, 0x89000000);  // entry 3 is a locked range that begins at the address of entry 2
  pmp.set_address(2, 1);
  pmp.set_address(3, 1);
  pmp.set_configurations(0, 0);
  EXPECT_EQ(std::tuple(pmp.address(2), pmp.address(3), pmp.configurations(0)),
            std::tuple(0x1000U, 0x2000U, 0x89000000U));
  pmp.set_address(8, 5);
  EXPECT_EQ(pmp.address(8), 0U) << "there are eight entries";
  EXPECT_TRUE(pmp.allows(0x4000, 4, Pmp::Access::load, Mode::machine));
  EXPECT_FALSE(pmp.allows(0x4000, 4, Pmp::Access::store, Mode::machine));
  EXPECT_FALSE(pmp.allows(0x3ffe, 4, Pmp::Access::load, Mode::machine)) << "partly in the range";
  EXPECT_FALSE(pmp.allows_all(Mode::machine));
  pmp.restart();
  EXPECT_TRUE(pmp.allows_all(Mode::machine));
  EXPECT_FALSE(pmp.allows_all(Mode::user));
}

}  // namespace
}  // namespace mebots::soc::test
