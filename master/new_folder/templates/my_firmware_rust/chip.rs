// SPDX-License-Identifier: Apache-2.0
//! Console, timer and end of the program: the functions of the firmware's runtime in C
//! (fmu_soc/firmware/runtime/console.h, runtime/exit.h, drivers/timer.h). Only for the fabric controller.
#![allow(dead_code)]

use core::fmt;
use core::panic::PanicInfo;

pub const NS_PER_US: i64 = 1_000;
pub const NS_PER_MS: i64 = 1_000_000;
/// Exit code after a panic. It is that of an exception without a handler, too.
pub const EXIT_EXCEPTION: i32 = 255;

extern "C" {
    fn print(format: *const u8, ...);
    fn firmware_exit(code: i32) -> !;
    fn timer_init();
    fn timer_now_ns() -> i64;
    fn timer_sleep_until(time_ns: i64);
}

/// Text output, for `write!`.
pub struct Console;

impl fmt::Write for Console {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            unsafe { print(b"%c\0".as_ptr(), u32::from(byte)) };
        }
        Ok(())
    }
}

#[macro_export]
macro_rules! println {
    ($($part:tt)*) => {{
        use core::fmt::Write;
        let _ = writeln!($crate::chip::Console, $($part)*);
    }};
}

/// Attaches the timer's interrupt. Call once, before the other functions of the timer.
pub fn start_timer() {
    unsafe { timer_init() }
}

/// Returns the time since reset [ns].
pub fn now_ns() -> i64 {
    unsafe { timer_now_ns() }
}

/// Sleeps until a time since reset [ns].
pub fn sleep_until(time_ns: i64) {
    unsafe { timer_sleep_until(time_ns) }
}

/// Ends the program.
pub fn exit(code: i32) -> ! {
    unsafe { firmware_exit(code) }
}

#[panic_handler]
fn panic(info: &PanicInfo) -> ! {
    println!("{}", info);
    exit(EXIT_EXCEPTION)
}
