// SPDX-License-Identifier: Apache-2.0
// The UART's transmitter. Characters gather to a line, which the uDMA sends while the program goes on.
#pragma once

#include <stdbool.h>

void uart_start(void);
// Waits while the line before is still on its way.
void uart_put(char c);
// Sends what has gathered, and waits until it is out.
void uart_flush(void);
bool uart_sends(void);
