// SPDX-License-Identifier: Apache-2.0
//
// Replaces the translator in builds without translation.
#include "translate/translator.hpp"

namespace mebots::soc::translate {

bool can_translate() {
  return false;
}

std::unique_ptr<Translator> make_translator(const BlockCache& /*blocks*/, const Execution& /*execution*/,
                                            const Options& /*options*/) {
  return nullptr;
}

}  // namespace mebots::soc::translate
