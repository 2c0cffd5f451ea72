// SPDX-License-Identifier: Apache-2.0
#pragma once

#ifdef __cplusplus
extern "C" {
#endif
/// Returns the number of its calls in this process.
__attribute__((visibility("default"))) int leftover_count(void);
#ifdef __cplusplus
}
#endif
