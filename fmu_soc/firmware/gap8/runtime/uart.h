// SPDX-License-Identifier: Apache-2.0
// Transmits text by UART. Collects the characters of a line. The uDMA sends the line while the program continues.
#pragma once

#include <stdbool.h>

void uart_start(void);
// Adds a character to the line. If the previous line is still being sent, waits for its end.
void uart_put(char c);
// Sends the collected characters, and waits until they are sent.
void uart_flush(void);
bool uart_sends(void);
