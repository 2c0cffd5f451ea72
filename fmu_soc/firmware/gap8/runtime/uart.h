// SPDX-License-Identifier: Apache-2.0
// The UART's transmitter. It collects characters to a line, which the uDMA sends while the program continues.
#pragma once

#include <stdbool.h>

void uart_start(void);
// Adds a character. If the previous line is still being sent, waits.
void uart_put(char c);
// Sends the collected characters, and waits until they are sent.
void uart_flush(void);
bool uart_sends(void);
