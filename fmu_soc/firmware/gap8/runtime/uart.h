// SPDX-License-Identifier: Apache-2.0
// Transmits text by UART, line by line. The uDMA sends a line while the program continues.
#pragma once

#include <stdbool.h>

void uart_start(void);
// Adds a character to the line. Waits while the previous line is being sent.
void uart_put(char c);
// Sends the unfinished line, and waits until all characters are sent.
void uart_flush(void);
bool uart_sends(void);
