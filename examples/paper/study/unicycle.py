# SPDX-License-Identifier: Apache-2.0
"""Simulates a perfect network in the hard scenario: a unicycle follows the expert's command and the policy.

Separates the effects of the network, of the fading of the expert's command near the gate, and of the yaw-rate scale. There is no
contact and no noise. The speed follows its set-point with a time constant.
"""

import math

from experiments import ADAPTIVE_SPEED, HARD_SPEEDS
from missions import KM_H, scene, scenario

SPEED_LAG_S = 0.6          # lag of the stabiliser, read from the flights
POLICY_STEP = 0.05 * KM_H  # step in fmu_soc/firmware/app/policy.c
WINDOW = 10
# The command fades while the apparent edge of the frame grows from FULL_EDGE to NO_EDGE, relative to half the picture's width
# (dataset/expert.cpp).
FULL_EDGE, NO_EDGE = 1.05, 2.1


def fly(speed_km_h, adaptive, fades):
    """Returns the lateral offset at the gate's plane [m], positive = left, and the time from the start of the cruise to this
    plane [s]."""
    place = scenario("hard")
    gate = scene(place["world.scene.name"])["gates"][0]
    tangent = math.tan(place["world.camera.field_of_view"] / 2)
    scale, period = place["soc.mission.yaw_rate_scale"], place["soc.mission.frame_period"]
    cruise = speed_km_h * KM_H
    x, y, yaw, speed, wanted, time = 0.0, 0.0, 0.0, 0.0, cruise, 0.0
    outputs = []
    while x < gate["position"][0] and time < 600:
        dx, dy = gate["position"][0] - x, gate["position"][1] - y
        ahead, left = dx * math.cos(yaw) + dy * math.sin(yaw), dy * math.cos(yaw) - dx * math.sin(yaw)
        output = max(-1.0, min(1.0, left / max(ahead, 0.05) / tangent))
        if fades:
            near = dx * tangent / gate["outer"]
            output *= max(0.0, min(1.0, (near - 1 / NO_EDGE) / (1 / FULL_EDGE - 1 / NO_EDGE)))
        outputs = [*outputs[1 - WINDOW:], output]
        if adaptive:
            wanted = cruise if abs(sum(outputs) / len(outputs)) <= 0.3 else max(0.0, wanted - POLICY_STEP)
        speed += (wanted - speed) * period / SPEED_LAG_S
        yaw += scale * output * period
        x += speed * math.cos(yaw) * period
        y += speed * math.sin(yaw) * period
        time += period
    return y - gate["position"][1], time


def main():
    print("| speed | the expert's command, fading | never fading |\n|---|---|---|")
    for name, speed, adaptive in [*((f"{s} km/h", s, False) for s in HARD_SPEEDS), ("adaptive", ADAPTIVE_SPEED, True)]:
        cells = (f"{100 * lateral:+.1f} cm, {time:.0f} s" for lateral, time in
                 (fly(speed, adaptive, fades) for fades in (True, False)))
        print(f"| {name} | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
