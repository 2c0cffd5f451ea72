// SPDX-License-Identifier: Apache-2.0
#include "isa/extension.hpp"

#include "hart/extensions.hpp"
#include "mebots/error.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace mebots::soc {
namespace {

std::string refusal(const std::string& text) {
  try {
    read_isa(text);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(IsaString, NamesTheOptionsOfACore) {
  EXPECT_EQ(read_isa("rv32imc"), Extensions());
  EXPECT_EQ(read_isa("rv32imc_zicsr_zifencei"), Extensions());
  EXPECT_EQ(read_isa("rv32i2p1_m2p0_c2p0_zmmul1p0"), Extensions());
  EXPECT_EQ(read_isa("RV32IMAC"), Extensions(Extension::a));
  EXPECT_EQ(read_isa("rv32imafcu"), Extensions(Extension::a).with(Extension::f).with(Extension::user));
  EXPECT_EQ(read_isa("rv32imcb"), read_isa("rv32imc_zba_zbb_zbs"));
  for (const auto* text :
       {"rv32imc_zicsr_zifencei", "rv32imafcu_zicsr_zifencei_zba_zbb_zbc_zbs", "rv32imc_zicsr_zifencei_zfinx"}) {
    EXPECT_EQ(isa_string(read_isa(text)), text);
  }
}

/// Each message names the mistake and the correction.
TEST(IsaString, RefusesByName) {
  using testing::HasSubstr;
  EXPECT_THAT(refusal("rv64imac"), HasSubstr("write rv32"));
  EXPECT_THAT(refusal("imac"), HasSubstr("must begin with rv32imc"));
  EXPECT_THAT(refusal("rv32imafdc"), HasSubstr("'d': the cores have no double precision"));
  EXPECT_THAT(refusal("rv32gc"), HasSubstr("'g': this is imafd"));
  EXPECT_THAT(refusal("rv32emc"), HasSubstr("'e': the cores have 32 registers; use i in place of e"));
  EXPECT_THAT(refusal("rv32imacsu"), HasSubstr("'su'"));
  EXPECT_THAT(refusal("rv32imac_s"), HasSubstr("no supervisor mode"));
  EXPECT_THAT(refusal("rv32imc_zdinx"), HasSubstr("'zdinx': the cores have no double precision"));
  EXPECT_THAT(refusal("rv32imc_zbkb"), HasSubstr("no core has 'zbkb'; there are a, f, u, zfinx"));
  EXPECT_THAT(refusal("rv32ic"), HasSubstr("'m' is missing"));
  EXPECT_THAT(refusal("rv32ima"), HasSubstr("'c' is missing"));
  EXPECT_THAT(refusal("rv32imfc_zfinx"), HasSubstr("zfinx and f exclude each other"));
  EXPECT_THAT(refusal("rv32im-c"), HasSubstr("'-' is not a letter"));
  EXPECT_THAT(refusal("rv32"), HasSubstr("'i' is missing"));
}

TEST(Advice, SaysHowACoreGetsTheExtension) {
  using testing::HasSubstr;
  const auto advice = advice_for_illegal(0x100527af, Extension::zba, {});  // lr.w a5, (a0)
  EXPECT_THAT(advice, HasSubstr("lr.w, of extension A"));
  EXPECT_THAT(advice, HasSubstr("--core rv32imac_zicsr_zifencei_zba without one"));
  EXPECT_THAT(advice_for_illegal(0x02c5f553, {}, {}), testing::Not(HasSubstr("--core")));         // fadd.d
  EXPECT_THAT(advice_for_illegal(0x00c5f553, Extension::f, {}), HasSubstr("mstatus.FS is Off"));  // fadd.s
}

}  // namespace
}  // namespace mebots::soc
