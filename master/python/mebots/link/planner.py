# SPDX-License-Identifier: Apache-2.0
"""The planner of the high-level commander. Converts take-off, landing, go-to, spiral and trajectory commands to a goal at each time."""

from __future__ import annotations

import enum
import math
from collections.abc import Sequence

from mebots.link.angles import sine_and_cosine, wrapped
from mebots.link.trajectories import ZERO, Ends, Goal, Path, Piece, Vector, between


class State(enum.Enum):
    IDLE = enum.auto()  # motors off
    FLYING = enum.auto()
    LANDING = enum.auto()
    DISABLED = enum.auto()


class Planner:
    """The state of the planner, and its last goal. New paths start at this goal. Without an active path, ``rest`` sets the goal to the
    drone's current state."""

    def __init__(self) -> None:
        self.state = State.IDLE
        self.last = Goal(ZERO, ZERO, ZERO, 0.0, 0.0)
        self._path: Path | None = None

    @property
    def is_active(self) -> bool:
        return self.state in (State.FLYING, State.LANDING)

    def has_finished(self, time_s: float) -> bool:
        return self._path is None or self._path.has_ended(time_s)

    def stop(self) -> None:
        self.state = State.IDLE

    def rest(self, position_m: Vector, velocity_m_per_s: Vector, yaw_rad: float) -> None:
        self.last = Goal(position_m, velocity_m_per_s, ZERO, yaw_rad, 0.0)

    def goal(self, time_s: float) -> Goal | None:
        """Returns the goal of the active path at this time, or None. Sets the state to IDLE after the end of a landing."""
        if self.state == State.LANDING and self.has_finished(time_s):
            self.state = State.IDLE
        if not self.is_active or self._path is None:
            return None
        goal = self._path.at(time_s)
        if not goal.is_finite:
            self.state = State.DISABLED
            return None
        self.last = goal
        return goal

    def take_off(self, height_m: float, yaw_rad: float, duration_s: float, time_s: float) -> bool:
        """Starts a take-off. Returns False if another path is active."""
        if self.state != State.IDLE:
            return False
        self._climb(height_m, yaw_rad, duration_s, time_s)
        self.state = State.FLYING
        return True

    def land(self, height_m: float, yaw_rad: float, duration_s: float, time_s: float) -> bool:
        """Starts a landing. Returns False if the drone is already landing."""
        if self.state == State.LANDING:
            return False
        self._climb(height_m, yaw_rad, duration_s, time_s)
        self.state = State.LANDING
        return True

    def go_to(self, to_m: Vector, yaw_rad: float, duration_s: float, time_s: float, *, relative: bool, linear: bool) -> None:
        start = self._now(time_s)
        if relative:
            to_m = (to_m[0] + start.position_m[0], to_m[1] + start.position_m[1], to_m[2] + start.position_m[2])
            yaw_rad += start.yaw_rad
        start = start._replace(yaw_rad=wrapped(start.yaw_rad))
        end = Goal(to_m, ZERO, ZERO, _nearest(yaw_rad, start.yaw_rad), 0.0)
        if linear and duration_s > 0.0:
            vx, vy, vz = ((after - before) / duration_s for before, after in zip(start.position_m, to_m, strict=True))
            yaw_rate = (end.yaw_rad - start.yaw_rad) / duration_s
            start, end = (
                one._replace(velocity_m_per_s=(vx, vy, vz), acceleration_m_per_s2=ZERO, yaw_rate_rad_per_s=yaw_rate) for one in (start, end)
            )
        self._fly(start, end, duration_s, time_s)

    def spiral(self, angle_rad: float, radii_m: tuple[float, float], ascent_m: float, duration_s: float, time_s: float, *,
               sideways: bool, clockwise: bool) -> None:  # fmt: skip
        """Starts a spiral: the drone moves by the angle about a centre, while the distance changes from the first radius to the second. The
        nose points along the circle. With ``sideways``, it points to the centre (clockwise) or away from it (counter-clockwise)."""
        angle_rad = min(max(angle_rad, -2.0 * math.pi), 2.0 * math.pi)
        first_m, last_m = max(radii_m[0], 0.0), max(radii_m[1], 0.0)
        if not duration_s > 0.0:
            return
        sense = 1.0 if clockwise else -1.0
        begin = self.last
        yaw_rad = wrapped(begin.yaw_rad)
        turn_rad_per_s = -sense * angle_rad / duration_s
        growth_m_per_s = (last_m - first_m) / duration_s
        # Angle from the drone's heading to the direction that leads from the centre of the spiral to the drone.
        lead_rad = (math.pi if clockwise else 0.0) if sideways else 0.5 * math.pi * sense
        ends = []
        for radius_m, heading_rad in ((first_m, yaw_rad), (last_m, yaw_rad - sense * angle_rad)):
            sine, cosine = sine_and_cosine(heading_rad + lead_rad)
            out, along = (cosine, sine), (-sine, cosine)
            speed = radius_m * turn_rad_per_s
            ends.append((
                [radius_m * one for one in out],
                [growth_m_per_s * o + speed * a for o, a in zip(out, along, strict=True)],
                [2.0 * growth_m_per_s * turn_rad_per_s * a - speed * turn_rad_per_s * o for o, a in zip(out, along, strict=True)],
                heading_rad,
            ))  # fmt: skip
        (from_centre, velocity, acceleration, _), (to_centre, end_velocity, end_acceleration, end_yaw_rad) = ends
        x, y, z = begin.position_m
        climb_m_per_s = ascent_m / duration_s
        start_velocity = (velocity[0], velocity[1], climb_m_per_s)
        start = Goal(begin.position_m, start_velocity, (acceleration[0], acceleration[1], 0.0), yaw_rad, turn_rad_per_s)
        end_m = (x - from_centre[0] + to_centre[0], y - from_centre[1] + to_centre[1], z + ascent_m)
        last_velocity = (end_velocity[0], end_velocity[1], climb_m_per_s)
        end = Goal(end_m, last_velocity, (end_acceleration[0], end_acceleration[1], 0.0), end_yaw_rad, turn_rad_per_s)
        self._fly(start, end, duration_s, time_s)

    def follow(self, pieces: Sequence[Piece], time_scale: float, time_s: float, *, relative: bool, turned: bool, backwards: bool) -> None:
        """Flies an uploaded trajectory. If ``relative``, it starts at the drone's position; if also ``turned``, it is rotated by the
        drone's yaw."""
        path = Path(pieces, time_s, time_scale, backwards)
        if relative:
            first = path.at(time_s)
            path.move(wrapped(self.last.yaw_rad - first.yaw_rad) if turned and first.is_finite else 0.0, self.last.position_m)
        self._path = path
        self.state = State.FLYING

    def _now(self, time_s: float) -> Goal:
        return self.goal(time_s) or self.last._replace(acceleration_m_per_s2=ZERO, yaw_rate_rad_per_s=0.0)

    def _climb(self, height_m: float, yaw_rad: float, duration_s: float, time_s: float) -> None:
        x, y, _ = self.last.position_m
        begin_rad = wrapped(self.last.yaw_rad)
        start = Goal(self.last.position_m, ZERO, ZERO, begin_rad, 0.0)
        self._fly(start, Goal((x, y, height_m), ZERO, ZERO, _nearest(yaw_rad, begin_rad), 0.0), duration_s, time_s)

    def _fly(self, start: Goal, end: Goal, duration_s: float, time_s: float) -> None:
        x, y, z = (
            between(Ends(*begin), Ends(*stop), duration_s)
            for begin, stop in zip(
                zip(start.position_m, start.velocity_m_per_s, start.acceleration_m_per_s2, strict=True),
                zip(end.position_m, end.velocity_m_per_s, end.acceleration_m_per_s2, strict=True),
                strict=True,
            )
        )
        yaw = between(Ends(start.yaw_rad, start.yaw_rate_rad_per_s), Ends(end.yaw_rad, end.yaw_rate_rad_per_s), duration_s)
        self._path = Path([Piece((x, y, z, yaw), duration_s)], time_s)
        self.state = State.FLYING


def _nearest(angle_rad: float, to_rad: float) -> float:
    """Returns the first angle plus the full turns that bring it nearest to the second angle."""
    return to_rad + wrapped(angle_rad - to_rad)
