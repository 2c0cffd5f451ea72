# SPDX-License-Identifier: Apache-2.0
"""The Pareto front with what is sure of it."""

from __future__ import annotations

from mebots.exploration.comparison import Evidence

ON, OFF, UNDECIDED, EXCLUDED, NONE = "on", "off", "undecided", "excluded", ""


def places(evidence: Evidence) -> list[str]:
    """For each design: ``excluded`` (it surely breaks a constraint), ``off`` the front (another one that keeps all
    constraints surely dominates it), ``on`` it (surely feasible, and surely better than every other one in some
    objective), or ``undecided``. Noise is never ranked: two designs whose difference is not sure are both undecided."""
    designs = range(len(evidence.measures))
    if not evidence.has_front:
        return [NONE] * len(evidence.measures)
    feasible = [evidence.feasible(design) for design in designs]
    rivals = [design for design in designs if feasible[design] is not False]
    leaders = evidence.leaders([design for design in designs if feasible[design]])
    result = []
    for design in designs:
        if feasible[design] is False:
            result.append(EXCLUDED)
        elif any(evidence.dominates(leader, design) for leader in leaders if leader != design):
            result.append(OFF)
        elif feasible[design] and all(evidence.not_dominated_by(design, rival) for rival in rivals if rival != design):
            result.append(ON)
        else:
            result.append(UNDECIDED)
    return result
