// SPDX-License-Identifier: Apache-2.0
#include "hart/observer.hpp"

#include "hart/hart.hpp"

namespace mebots::soc {
Access access_of(const Decoded& decoded, const Hart& hart) {
  const bool store = is_store(decoded.op);
  if (!is_load(decoded.op) && !store) return {};
  auto address = hart.reg(decoded.rs1);
  if (!is_post_increment(decoded.op)) {
    const bool by_register = has_step_register(traits_of(decoded.op).mode);
    address += by_register ? hart.reg(store ? decoded.rs3 : decoded.rs2) : static_cast<std::uint32_t>(decoded.imm);
  }
  return {address, traits_of(decoded.op).size, store};
}

}  // namespace mebots::soc
