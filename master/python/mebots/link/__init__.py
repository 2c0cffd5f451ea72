# SPDX-License-Identifier: Apache-2.0
"""``mebots link``: simulated Crazyflies that answer cflib over UDP as the firmware does.

Packets, tables and limits are those of crazyflie-firmware, commit 2a18fc29 (August 2026, protocol version 12).
"""
