# SPDX-License-Identifier: Apache-2.0
"""Formulates the answer of a study that compares designs: the best design, designs that may be as good, and the number of missions that
would separate them."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence

from mebots.exploration import front
from mebots.exploration.answers import Moments
from mebots.exploration.comparison import DECIDED, SEQUENCES, Estimate, Evidence
from mebots.exploration.figures import Units, estimate_text, percent
from mebots.exploration.study import Constraint, Objective

_MOST_ROWS = 10
_MOST_NAMED = 3
_MOST_MISSIONS = 1_000_000
"""If more missions than this are needed, the answer states that more missions would not separate the designs."""


@dataclasses.dataclass(frozen=True)
class Row:
    """A design in the ranked table. ``rank`` is None if the design violates a constraint or has no value. Designs with equal values have
    equal ranks."""

    rank: int | None
    design: int
    name: str
    missions: int
    cells: list[str]
    """The value and the interval of each objective."""
    note: str


@dataclasses.dataclass(frozen=True)
class Answer:
    """The result of a study. ``str()`` returns the text that ``mebots sweep`` prints."""

    headlines: list[str]
    titles: list[str]
    rows: list[Row]
    """Best first."""
    remarks: list[str]
    """Statements about the Pareto fronts (by means, and proven), and about the missions that would decide more."""

    def __str__(self) -> str:
        return "\n".join(self.lines())

    def lines(self, width: int | None = None) -> list[str]:
        """Returns the lines of the text. The table shows as many objectives as fit into ``width``. If not even two fit, it shows all."""
        hidden = len(self.rows) - _MOST_ROWS
        more = [f"... and {hidden} more in designs.csv"] if hidden > 0 else []
        table = table_lines(self.titles, self.rows[:_MOST_ROWS], width)
        return [*self.headlines, "", *table, *more, *([""] if self.remarks else []), *self.remarks]


def table_lines(titles: Sequence[str], rows: Sequence[Row], width: int | None = None) -> list[str]:
    """Returns an aligned table with a header. If the table is wider than ``width``, omits its last objectives and names them in a line
    below the table. If it is too wide even with two objectives, omits none."""
    for shown in range(len(titles), 1, -1):
        lines = _aligned(titles[:shown], [dataclasses.replace(row, cells=row.cells[:shown]) for row in rows])
        if width is None or max(map(len, lines)) <= width:
            break
    else:
        lines, shown = _aligned(titles, rows), len(titles)
    return [*lines, f"not shown: {', '.join(titles[shown:])}"] if shown < len(titles) else lines


def _aligned(titles: Sequence[str], rows: Sequence[Row]) -> list[str]:
    cells = [["", "design", "", "missions", *titles, ""]]
    for row in rows:
        rank = "-" if row.rank is None else str(row.rank)
        cells.append([rank, f"#{row.design}", row.name, str(row.missions), *row.cells, row.note])
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    texts = (1, 2, len(widths) - 1)  # left-aligned columns
    return [
        "  ".join(cell.ljust(width) if at in texts else cell.rjust(width) for at, (cell, width) in enumerate(zip(line, widths, strict=True))).rstrip()
        for line in cells
    ]


class Judge:
    """Ranks designs by the first objective that is minimised or maximised. Without such an objective, ranks them by the first objective
    that is a share."""

    def __init__(self, evidence: Evidence, units: Units, names: Sequence[str], status: Sequence[str]) -> None:
        self._evidence = evidence
        self._study = evidence.study
        self._units = units
        self._names = names
        self._status = status
        self._senses = [one for one in self._study.objectives if one.sense != 0]
        shares = [one for one in self._study.objectives if one.is_share]
        self._main = next(iter([*self._senses, *shares]), None)
        self._ranking = self._senses or [one for one in [self._main] if one is not None]
        self._share = next((one for one in shares if one is not self._main), None)

    def standings(self) -> Answer:
        """Ranks designs by all results so far, including results that the study has not yet evaluated. The order may be due to chance."""
        return Answer([], self._titles(), self._rows(self._evidence.so_far, lambda design: self._ended(design)), [])

    def answer(self, places: Sequence[str]) -> Answer:
        """Returns the answer. ``places`` must be the result of ``front.places``."""
        best = {one.label: self._best(one) for one in self._ranking}
        headlines = [line for one in self._study.objectives if (line := self._headline(one, best.get(one.label), places))]
        if not headlines:
            headlines = ["No design can be ranked: no objective is minimised, maximised or a share, or no mission has a value of it."]
        first = best.get(self._main.label) if self._main is not None else None
        rows = self._rows(self._evidence.shown, lambda design: self._note(design, first, places))
        remarks = [*self._front_lines(places), *self._more_lines(best)]
        return Answer(headlines, self._titles(), rows, remarks)

    def _titles(self) -> list[str]:
        return [one.label if one.percentile is None else f"{one.label} ({one.statistic})" for one in self._study.objectives]

    # Ranking of designs.

    def _rows(self, estimate: Callable[[int, Objective], Estimate], note: Callable[[int], str]) -> list[Row]:
        designs = range(len(self._evidence.counts))
        found = {design: [estimate(design, one) for one in self._study.objectives] for design in designs}
        at = None if self._main is None else self._evidence.index[self._main.label]
        key = {design: self._key(design, found[design], at) for design in designs}
        order = sorted(designs, key=lambda one: (*key[one], one))
        first = {key[design]: place for place, design in reversed(list(enumerate(order, 1)))}
        rows: list[Row] = []
        for design in order:
            cells = [estimate_text(value, one, self._units.of(one)) for value, one in zip(found[design], self._study.objectives, strict=True)]
            ranked = key[design][0] == 0
            missions = max((value.count for value, one in zip(found[design], self._study.objectives, strict=True) if one.is_share), default=0)
            missions = max(missions, self._evidence.missions_of(design), *(value.count for value in found[design]))
            rows.append(Row(first[key[design]] if ranked else None, design, self._names[design], missions, cells, note(design)))
        return rows

    def _key(self, design: int, found: Sequence[Estimate], at: int | None) -> tuple[float, ...]:
        """Returns the sorting key of a design. Designs with means that satisfy the constraints come first. They are sorted by the share of
        missions that count for the main objective, then by the main objective, then by the other objectives. Designs without a value come
        last."""
        if at is None or self._main is None or found[at].mean is None:
            return (2,)
        order = self._order(self._main, found)
        if any(not self._is_within(one, found[self._evidence.index[one.label]]) for one in self._study.constraints):
            return 1, *order
        share = self._condition(self._main)
        share_found = None if share is None else found[self._evidence.index[share.label]].mean
        return 0, -(share_found or 0.0), *order

    def _order(self, first: Objective, found: Sequence[Estimate]) -> list[float]:
        """Returns the sorting key of a design, smaller for better designs: its value of the objective ``first``, then its values of all
        other objectives that are minimised or maximised."""
        wanted = [first, *(one for one in self._senses if one is not first)]
        means = [(self._sign(one), found[self._evidence.index[one.label]].mean) for one in wanted]
        return [math.inf if mean is None else -sign * mean for sign, mean in means]

    def _condition(self, objective: Objective) -> Objective | None:
        """Returns the objective that ``objective.where`` names: ``objective`` has values only for missions that are successes of it.
        Returns None without ``where``, or if a constraint already limits the named objective."""
        if objective.where is None or any(one.label == objective.where for one in self._study.constraints):
            return None
        return self._study.objective(objective.where)

    @staticmethod
    def _sign(objective: Objective | None) -> int:
        return objective.sense or 1 if objective is not None else 1

    @staticmethod
    def _is_within(constraint: Constraint, found: Estimate) -> bool:
        if found.mean is None:
            return False
        return found.mean > constraint.bound if constraint.above else found.mean < constraint.bound

    # Headline.

    def _group(self, objective: Objective) -> list[int]:
        """Returns the designs to compare: those with means that satisfy the constraints and with the highest share of missions that count
        for the objective."""
        shown = self._evidence.shown
        designs = [
            design
            for design in range(len(self._evidence.counts))
            if shown(design, objective).mean is not None
            and all(self._is_within(one, shown(design, self._study.objective(one.label))) for one in self._study.constraints)
        ]
        share = self._condition(objective)
        if share is None or not designs:
            return designs
        shares = {design: shown(design, share).mean or 0.0 for design in designs}
        return [design for design in designs if shares[design] == max(shares.values())]

    def _best(self, objective: Objective) -> tuple[int, list[int]] | None:
        """Returns the best design and the designs that may be as good, or None if no design has a value."""
        group = self._group(objective)
        if not group:
            return None
        best = min(group, key=lambda design: (self._values(design, objective), design))
        near = [one for one in group if one != best and not self._evidence.surely_better(best, one, objective.label)]
        return best, near

    def _headline(self, objective: Objective, found: tuple[int, list[int]] | None, places: Sequence[str]) -> str:
        if found is None:
            if objective in self._senses:
                return f"No design has a value of {objective.label} and keeps all constraints."
            return ""
        best, near = found
        word = "Lowest" if self._sign(objective) < 0 else "Highest"
        statistic = "" if objective.percentile is None else f"{objective.statistic} of "
        value = estimate_text(self._evidence.shown(best, objective), objective, self._units.of(objective))
        text = f"{word} {statistic}{objective.label}{self._among(objective)}: {self._names[best]}, {value}."
        group = len(self._group(objective))
        equal = [one for one in near if self._values(one, objective) == self._values(best, objective)]
        if equal:
            text += f" {counted(len(equal), 'design')} {'has' if len(equal) == 1 else 'have'} the same value{'' if len(self._senses) < 2 else 's'}."
        if len(near) > len(equal):
            text += f" {counted(len(near) - len(equal), 'design')} cannot be separated from it."
        elif not near and group > 1:
            text += " All others are surely worse." if group > 2 else " The other one is surely worse."
        return text + self._share_of([best, *near], objective)

    def _values(self, design: int, objective: Objective) -> list[float]:
        return self._order(objective, [self._evidence.shown(design, one) for one in self._study.objectives])

    def _among(self, objective: Objective) -> str:
        group = self._group(objective)
        if len(self._evidence.counts) < 2:
            return ""
        parts = [f"{one.label} {'above' if one.above else 'below'} {one.bound:g}" for one in self._study.constraints if one.label != objective.label]
        share = self._condition(objective)
        if share is not None:
            counts = {(found.successes, found.count) for one in group if (found := self._evidence.shown(one, share))}
            shown = "in all missions" if {a for a, _ in counts} == {b for _, b in counts} else "as often as any"
            if len(counts) == 1:
                shown = "in {} of {}".format(*next(iter(counts)))
            parts.append(f"{share.label} {shown}")
        return f" among {counted(len(group), 'design')} with {' and '.join(parts)}" if parts else ""

    def _share_of(self, designs: Sequence[int], objective: Objective) -> str:
        """Returns a sentence with the lowest of the designs' lower bounds of the share of successes. Returns "" if it is below 1 %."""
        if self._share is None or objective.is_share:
            return ""
        low = min(self._evidence.shown(design, self._share).interval[0] for design in designs)
        return f" {'Its' if len(designs) == 1 else 'Their'} {self._share.label} is above {percent(math.floor(100 * low) / 100)}." if low >= 0.01 else ""

    # Notes on designs.

    def _ended(self, design: int) -> str:
        status = self._status[design]
        return "" if status in ("flying", "all flown") else status

    def _note(self, design: int, found: tuple[int, list[int]] | None, places: Sequence[str]) -> str:
        if places[design] == front.EXCLUDED:
            return "breaks a constraint"
        if found is None or self._main is None:
            return self._ended(design)
        best, near = found
        if design == best:
            return "best" if not near else "best so far"
        if design in near:
            return "not separated from the best"
        return self._ended(design) or ("worse" if self._evidence.surely_better(best, design, self._main.label) else "")

    # Lines about the Pareto front, and about the missions that would separate designs.

    def _front_lines(self, places: Sequence[str]) -> list[str]:
        if len(self._senses) < 2:
            return []
        nominal = self._evidence.leaders([design for design in range(len(places)) if places[design] != front.EXCLUDED])
        proven = [design for design in nominal if places[design] == front.ON]
        count = {place: sum(one == place for one in places) for place in (front.OFF, front.UNDECIDED)}
        undecided = f" Undecided: {counted(count[front.UNDECIDED], 'design')}." if count[front.UNDECIDED] else ""
        return [
            f"Pareto front by means: {self._listed(nominal)}.",
            f"Proven to be on it: {self._listed(proven)}. Proven to be off it: {counted(count[front.OFF], 'design')}.{undecided}",
        ]

    def _listed(self, designs: Sequence[int]) -> str:
        if not designs:
            return "none"
        named = "; ".join(f"#{design} {self._names[design]}" for design in designs[:_MOST_NAMED])
        return named + _rest(designs)

    def _more_lines(self, best: Mapping[str, tuple[int, list[int]] | None]) -> list[str]:
        lines = [line for one in self._ranking for line in self._separation(one, best[one.label])]
        for constraint in self._study.constraints:
            lines += self._open_constraint(constraint)
        return lines

    def _separation(self, objective: Objective, found: tuple[int, list[int]] | None) -> list[str]:
        """Returns lines with the number of missions that would separate the best design from designs that may be as good."""
        if found is None or not found[1] or objective.percentile is not None:
            return []
        best, near = found
        sign = self._sign(objective)
        near = sorted(near, key=lambda one: -sign * (self._evidence.shown(one, objective).mean or 0.0))
        needed = [(one, missions_to_separate(self._evidence, best, one, objective)) for one in near]
        told = [f"about {count} from {self._names[one]}" for one, count in needed if count is not None]
        never = [self._names[one] for one, count in needed if count is None]
        by = f" by {objective.label}" if len(self._senses) > 1 else ""
        lines = []
        if told:
            lines.append(f"Further missions of each design needed to separate {self._names[best]}{by}: {'; '.join(told[:_MOST_NAMED])}{_rest(told)}.")
        if never:
            lines.append(f"More missions would not prove a difference{by} for: {'; '.join(never[:_MOST_NAMED])}{_rest(never)}.")
        return lines

    def _open_constraint(self, constraint: Constraint) -> list[str]:
        objective = self._study.objective(constraint.label)
        open_ones = [design for design in range(len(self._evidence.counts)) if self._evidence.side(design, constraint) is None]
        if not open_ones:
            return []
        side = f"{constraint.label} {'above' if constraint.above else 'below'} {constraint.bound:g}"
        # Designs with the same successes need the same number of missions, which is computed once.
        distinct = {(self._evidence.shown(one, objective).mean, self._evidence.counts[one]): one for one in open_ones}
        counts = [missions_to_decide(self._evidence, one, constraint) for one in distinct.values()] if objective.is_share else []
        known = [count for count in counts if count is not None]
        needed = f": about {max(known)} more missions of each would decide" if counts and len(known) == len(counts) else ""
        return [f"Not decided for {counted(len(open_ones), 'design')}: {side}{needed}."]


def _rest(items: Sequence[object]) -> str:
    """Returns the end of a list that names only its first items."""
    return f"; and {len(items) - _MOST_NAMED} more" if len(items) > _MOST_NAMED else ""


def missions_to_separate(evidence: Evidence, best: int, other: int, objective: Objective) -> int | None:
    """Returns the number of further missions of both designs that would prove which is better, if their differences stay the same. Returns
    None if the best design is not better so far, or by too little."""
    differences = evidence.differences(best, other, objective)
    count = len(differences)
    if objective.is_share:
        wins, decided = sum(one > 0 for one in differences), sum(one != 0 for one in differences)

        def is_sure(factor: float) -> bool:
            return evidence.share_bound(round(factor * wins), round(factor * decided)) > 0.5

        leads = 2 * wins > decided
    else:
        moments = Moments().add(differences)

        def is_sure(factor: float) -> bool:
            many = round(factor * count)
            return evidence.mean_bound(Moments(many, moments.mean, moments.deviation**2 * (many - 1))) > 0

        leads = count > 1 and moments.mean > 0
    return _more_missions(count, is_sure) if leads else None


def missions_to_decide(evidence: Evidence, design: int, constraint: Constraint) -> int | None:
    """Returns the number of further missions that would decide whether a share satisfies a bound, if the share stays the same. Returns None
    if this number is too large."""
    found = evidence.shown(design, evidence.study.objective(constraint.label))
    if found.successes is None or found.count == 0:
        return None
    successes, count, error = found.successes, found.count, evidence.design_error
    interval = (SEQUENCES if evidence.study.looks else DECIDED).share

    def is_sure(factor: float) -> bool:
        low, high = interval(round(factor * successes), round(factor * count), error)
        return low > constraint.bound or high < constraint.bound

    return _more_missions(count, is_sure)


def _more_missions(count: int, is_sure: Callable[[float], bool]) -> int | None:
    """Returns how many missions must be added to ``count`` until ``is_sure(factor)`` is true, rounded up to two digits. ``factor`` is the
    new number of missions divided by ``count``. Returns None if the new number would exceed ``_MOST_MISSIONS``."""
    factor = 1.0
    while not is_sure(factor):
        factor *= 1.1
        if factor * count > _MOST_MISSIONS:
            return None
    more = max(1, math.ceil((factor - 1) * count))
    step = 10 ** max(0, len(str(more)) - 2)
    return math.ceil(more / step) * step


def counted(count: int, what: str) -> str:
    return f"{count} {what}" if count == 1 else f"{count} {what}s"
