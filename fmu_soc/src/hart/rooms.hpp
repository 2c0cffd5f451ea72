// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace mebots::soc {

class BlockCache;
class Csrs;
class DataPath;
class Fetch;
class Traps;

/// The parts of a core that handlers reach beside the execution. See core.md.
struct Rooms {
  Csrs& csrs;
  Traps& traps;
  DataPath& data_path;
  Fetch& fetch;
  BlockCache& blocks;
};

}  // namespace mebots::soc
