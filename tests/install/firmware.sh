# SPDX-License-Identifier: Apache-2.0
# Tests a bare-metal program from a template, alone and in the mission.
set -euo pipefail
mebots new-firmware napper --out "my napper"
cmake -S "my napper" -B build -G Ninja >configure.log
cmake --build build >build.log || { cat build.log; exit 1; }
cmake --build build --target run | tee run.log
[[ $(grep -c '^awake at' run.log) == 5 ]] || { echo "FAILED: five naps were expected"; exit 1; }
mebots demo --out flight --stop-time 0.1 --set soc.firmware="$PWD/build/firmware/napper.elf" | tee flight.log
[[ $(grep -c 'awake at' flight.log) == 5 ]] || { echo "FAILED: the mission did not run this firmware"; exit 1; }
if mebots new-firmware Napper 2>refused.log; then echo "FAILED: a name that is not a C identifier"; exit 1; fi

# Tests printf() and malloc() of picolibc, and C++ with objects that need constructors.
mkdir library
cat >library/CMakeLists.txt <<'END'
cmake_minimum_required(VERSION 3.25)
project(library LANGUAGES NONE)
find_package(mebots REQUIRED COMPONENTS firmware)
mebots_soc_board(gap8 ${MEBOTS_ROOT}/configs/boards/gap8.json)
mebots_add_firmware(ai_deck SOURCES main.cpp C_LIBRARY)
mebots_add_firmware(gap8 BOARD gap8 SOURCES main.cpp C_LIBRARY)
END
cat >library/main.cpp <<'END'
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
struct Start { double value; Start() : value(sqrt(2.0)) {} };
static Start start;
int main() {
  char* text = static_cast<char*>(malloc(64));
  sprintf(text, "root %.6f", start.value);
  printf("%s, too large: %d\n", text, strtol("99999999999", nullptr, 10) == 2147483647 && errno == ERANGE);
  exit(malloc(1 << 24) == nullptr ? 3 : 4);
}
END
cmake -S library -B library/build -G Ninja >configure.log
cmake --build library/build >build.log || { cat build.log; exit 1; }
for board in ai_deck gap8; do
  code=0
  mebots-soc run library/build/firmware/$board.elf --board $board >library.log || code=$?
  [[ $code == 3 ]] || { echo "FAILED: $board ended with $code, not 3"; exit 1; }
  grep -q '^root 1.414214, too large: 1$' library.log || { cat library.log; echo "FAILED: printf on $board"; exit 1; }
done

# Tests a program in Rust: formatted text, 64-bit division, floats, and a panic. If the compiler does not even have the
# sources of core, skips this test.
mebots new-firmware rusty --language rust
if ! cmake -S rusty -B rusty/build -G Ninja >configure.log 2>&1; then
  cat configure.log
  grep -q 'no Rust compiler with the library core' configure.log || { echo "FAILED: configuring a program in Rust"; exit 1; }
  echo "SKIPPED: firmware in Rust; install rustc and rust-src"
  exit 0
fi
cmake --build rusty/build >build.log || { cat build.log; exit 1; }
cmake --build rusty/build --target run | tee run.log
[[ $(grep -c '^awake at' run.log) == 5 ]] || { echo "FAILED: five naps were expected of the program in Rust"; exit 1; }
cat >rusty/main.rs <<'END'
#![no_std]
#![no_main]
#[macro_use]
mod chip;
fn values() -> [u64; 3] {
    let mut last = chip::now_ns() as u64;
    core::array::from_fn(|i| {
        last = last / (u64::MAX / 3) + 10 + i as u64;
        last
    })
}
#[no_mangle]
pub extern "C" fn main() -> i32 {
    let values = values();
    let index = chip::now_ns() as usize | 8;
    println!("{:?}, sum {:>5}, {:.3}", values, values.iter().sum::<u64>(), 2.0 / values[0] as f64);
    values[index] as i32
}
END
cmake --build rusty/build >build.log || { cat build.log; exit 1; }
code=0
mebots-soc run rusty/build/firmware/rusty.elf --board ai_deck >run.log || code=$?
cat run.log
grep -q '^\[10, 11, 12\], sum    33, 0.200$' run.log || { echo "FAILED: text of the program in Rust"; exit 1; }
grep -q 'main.rs:17:5' run.log || { echo "FAILED: the panic does not name its place"; exit 1; }
[[ $code == 255 ]] || { echo "FAILED: a panic ended with $code, not 255"; exit 1; }
