"""What can be asked: every transmission, trip and task as a row of plain columns.

Events are numbered as they are shown, from 1, and so are rounds and transmissions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import inf, nan
from typing import Any, NamedTuple

import pyarrow as pa
import rerun as rr

from fleet.replay.columns import Moment, column, own
from fleet.replay.journal import RELOCATED, RecordedLine, TripEnd
from fleet.replay.scheme import TASKS, TRANSCRIPT, TRIPS
from fleet.replay.sink import Sink
from fleet.replay.state import FleetState, Layer
from fleet.replay.table_schemas import IDS, NOBODY, SCHEMAS
from protocols.messages import Award, RobotId


class TaskRow(NamedTuple):
    """How far a task has come."""

    at: Moment
    offers: int = 0
    taken: float = nan  # [s]
    reached: float = nan  # [s]
    robot: RobotId = NOBODY
    cost: float = nan


class TableRows(Layer):
    """Rows as things happen; that of a task when it is over, or the run is."""

    def __init__(self) -> None:
        self._rows: dict[str, list[tuple[Moment, tuple[Any, ...]]]] = {name: [] for name in SCHEMAS}
        self._open: dict[int, TaskRow] = {}

    def run_started(self, state: FleetState) -> None:
        """Nothing to tell."""
        self._state = state
        self._metric = state.scene.metric

    def transmitted(self, at: Moment, line: RecordedLine) -> None:
        """A transmission."""
        row = (
            line.number,
            line.time,
            line.event + 1,
            line.kind,
            line.sender,
            NOBODY if line.receiver is None else line.receiver,
            list(line.heard),
            NOBODY if line.bidder is None else line.bidder,
            nan if line.cost is None else line.cost,
            "" if line.cost is None else self._metric,
            line.attempts,
        )
        self._rows[TRANSCRIPT].append((at, row))

    def event_occurred(self, at: Moment, event: int) -> None:
        """A task."""
        self._open[event] = TaskRow(at)

    def event_raised(self, at: Moment, event: int, source: RobotId) -> None:
        """It is offered."""
        task = self._open[event]
        self._open[event] = task._replace(offers=task.offers + 1)

    def awarded(self, at: Moment, event: int, award: Award) -> None:
        """It is taken."""
        if award.winner is not None:
            cost = next((bid.cost for bid in award.bids if bid.robot == award.winner), nan)
            self._open[event] = self._open[event]._replace(robot=award.winner, cost=cost)

    def departed(self, at: Moment, robot: RobotId) -> None:
        """Somebody sets off to it."""
        way = self._state.under_way[robot]
        if not way.errand:
            self._open[way.event] = self._open[way.event]._replace(taken=at.time)

    def trip_ended(self, at: Moment, event: int, trip: TripEnd) -> None:
        """A trip."""
        state, believed = self._state, nan
        conversation = state.conversations.get(event)
        if conversation is not None and trip.robot in conversation.beliefs:
            believed = conversation.beliefs[trip.robot].cost
        if trip.outcome == RELOCATED:
            believed = nan  # what was asked for was another place
        elif trip.outcome == "arrived":
            self._open[event] = self._open[event]._replace(reached=trip.ended)
        row = (
            event + 1, trip.robot, trip.outcome, trip.departed, trip.ended, *trip.origin,
            *trip.site, *trip.end, trip.path, trip.planned, trip.waited, trip.energy,
            state.foreseen(trip.origin, trip.site), believed, float(state.energies[trip.robot]),
        )  # fmt: skip
        self._rows[TRIPS].append((at, row))

    def event_closed(self, at: Moment, event: int, outcome: str) -> None:
        """A task is over."""
        self._close(at, event, outcome)

    def run_ended(self, at: Moment, summary: Mapping[str, Any] | None) -> None:
        """Tasks that are still open."""
        for event in list(self._open):
            self._close(at, event, "open")

    def send(self, sink: Sink) -> None:
        """All of them."""
        for path, schema in SCHEMAS.items():
            rows, self._rows[path] = self._rows[path], []
            if rows:
                when, values = zip(*rows, strict=True)
                cells = zip(schema.items(), zip(*values, strict=True), strict=True)
                table = path.rpartition("/")[2]
                sink.rows(path, when, *(_column(table, *named, each) for named, each in cells))

    def _close(self, at: Moment, event: int, outcome: str) -> None:
        row, task = self._open.pop(event), self._state.tasks[event]
        late = row.taken - task.raised > task.deadline or outcome == "expired"
        values = (
            event + 1, *task.site, *task.position, task.raised, row.offers, row.taken, row.reached,
            nan if outcome == "open" else at.time, outcome, row.robot, row.cost,
            "" if row.robot == NOBODY else self._metric,
            nan if task.deadline == inf else task.deadline, late,
        )  # fmt: skip
        self._rows[TASKS].append((at, values))


def _column(table: str, name: str, kind: pa.DataType, cells: Sequence[Any]) -> rr.ComponentColumn:
    """One column: a value in each row, or any number of them."""
    if kind is IDS:
        flat = pa.array([one for cell in cells for one in cell], pa.int32())
        return column(own(table, name), flat, [len(cell) for cell in cells])
    return column(own(table, name), pa.array(cells, kind, from_pandas=True))  # NaN: nothing
