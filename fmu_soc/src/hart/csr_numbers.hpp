// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Numbers of the control and status registers. Source: The RISC-V Instruction Set Manual, volume II, table 2.
namespace mebots::soc::csr {

inline constexpr unsigned kMstatus = 0x300;
inline constexpr unsigned kMisa = 0x301;
inline constexpr unsigned kMie = 0x304;
inline constexpr unsigned kMtvec = 0x305;
inline constexpr unsigned kMcountinhibit = 0x320;
inline constexpr unsigned kMhpmevent3 = 0x323;
inline constexpr unsigned kMscratch = 0x340;
inline constexpr unsigned kMepc = 0x341;
inline constexpr unsigned kMcause = 0x342;
inline constexpr unsigned kMtval = 0x343;
inline constexpr unsigned kMip = 0x344;
inline constexpr unsigned kMcycle = 0xb00;
inline constexpr unsigned kMinstret = 0xb02;
inline constexpr unsigned kMhpmcounter3 = 0xb03;
inline constexpr unsigned kMcycleh = 0xb80;
inline constexpr unsigned kMinstreth = 0xb82;
inline constexpr unsigned kMhpmcounter3h = 0xb83;
inline constexpr unsigned kCycle = 0xc00;
inline constexpr unsigned kInstret = 0xc02;
inline constexpr unsigned kHpmcounter3 = 0xc03;
inline constexpr unsigned kCycleh = 0xc80;
inline constexpr unsigned kInstreth = 0xc82;
inline constexpr unsigned kHpmcounter3h = 0xc83;
inline constexpr unsigned kMvendorid = 0xf11;
inline constexpr unsigned kMarchid = 0xf12;
inline constexpr unsigned kMimpid = 0xf13;
inline constexpr unsigned kMhartid = 0xf14;

// Of RI5CY. Source: RI5CY user manual 4.45, chapters "Control and status registers" and "Performance counters".
inline constexpr unsigned kPccr = 0x780;     // event counters 0 to 30; 0 = cycles, 1 = instructions
inline constexpr unsigned kPccrAll = 0x79f;  // writes them all
inline constexpr unsigned kPcer = 0x7a0;     // which of them count
inline constexpr unsigned kPcmr = 0x7a1;     // bit 0: any count at all; bit 1: they stop at their highest value
inline constexpr unsigned kLoopStart0 = 0x7b0;
inline constexpr unsigned kLoopEnd0 = 0x7b1;
inline constexpr unsigned kLoopCount0 = 0x7b2;
inline constexpr unsigned kLoopStart1 = 0x7b4;
inline constexpr unsigned kLoopEnd1 = 0x7b5;
inline constexpr unsigned kLoopCount1 = 0x7b6;
inline constexpr unsigned kPrivilege = 0xc10;
inline constexpr unsigned kUhartid = 0x014;
inline constexpr unsigned kStackCheck = 0x7d0;  // on or off, then first address and end

}  // namespace mebots::soc::csr

/// Values of mcause. Source: The same manual, table 3.6.
namespace mebots::soc::cause {

inline constexpr unsigned kFetchAccess = 1;
inline constexpr unsigned kIllegalInstruction = 2;
inline constexpr unsigned kBreakpoint = 3;
inline constexpr unsigned kLoadAccess = 5;
inline constexpr unsigned kStoreAccess = 7;
inline constexpr unsigned kMachineEcall = 11;
inline constexpr unsigned kInterrupt = 0x80000000U;

}  // namespace mebots::soc::cause
