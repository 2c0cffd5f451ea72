// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace mebots::app {

/// For commands that are written in Python: this program becomes the interpreter that runs `main()` of `module`
/// ("mebots.exploration.command") with these words. `command` names in errors what the user asked for ("mebots sweep").
/// Does not return but by an exception: InputError where the package or an interpreter is missing.
void become_python(const std::string& command, const std::string& module, const std::vector<std::string>& words);

}  // namespace mebots::app
