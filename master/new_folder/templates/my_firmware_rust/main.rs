// SPDX-License-Identifier: Apache-2.0
//! Prints the time, sleeps in between, and ends with exit code 0.
#![no_std]
#![no_main]

#[macro_use]
mod chip;

const NAPS: i64 = 5;

#[no_mangle]
pub extern "C" fn main() -> i32 {
    chip::start_timer();
    for nap in 1..=NAPS {
        chip::sleep_until(nap * 10 * chip::NS_PER_MS);
        println!("awake at {} us", chip::now_ns() / chip::NS_PER_US);
    }
    0
}
