// SPDX-License-Identifier: Apache-2.0
#include "hart/observer.hpp"

#include "hart/hart.hpp"

namespace mebots::soc {
namespace {

unsigned size_of(Op op) {
  switch (op) {
    case Op::lb:
    case Op::lbu:
    case Op::p_lb_reg:
    case Op::p_lbu_reg:
    case Op::p_lb_post:
    case Op::p_lbu_post:
    case Op::p_lb_post_reg:
    case Op::p_lbu_post_reg:
    case Op::sb:
    case Op::p_sb_reg:
    case Op::p_sb_post:
    case Op::p_sb_post_reg:
      return 1;
    case Op::lh:
    case Op::lhu:
    case Op::p_lh_reg:
    case Op::p_lhu_reg:
    case Op::p_lh_post:
    case Op::p_lhu_post:
    case Op::p_lh_post_reg:
    case Op::p_lhu_post_reg:
    case Op::sh:
    case Op::p_sh_reg:
    case Op::p_sh_post:
    case Op::p_sh_post_reg:
      return 2;
    default:
      return 4;
  }
}

}  // namespace

Access access_of(const Decoded& decoded, const Hart& hart) {
  const bool store = is_store(decoded.op);
  if (!is_load(decoded.op) && !store) return {};
  auto address = hart.reg(decoded.rs1);
  if (!is_post_increment(decoded.op)) {
    const bool by_register = decoded.encoding != nullptr && has_register_offset(decoded.encoding->format);
    address += by_register ? hart.reg(store ? decoded.rs3 : decoded.rs2) : static_cast<std::uint32_t>(decoded.imm);
  }
  return {address, size_of(decoded.op), store};
}

}  // namespace mebots::soc
