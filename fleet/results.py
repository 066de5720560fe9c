"""What a run comes to: one frozen record, and where its figures are from."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from math import fsum, sqrt
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from fleet.fleet import Fleet
from fleet.radio import AirCounts
from fleet.service import StreamFigures, never_served, stream_figures
from fleet.tally import Tally
from fleet.tasks import OPEN, State, TaskBook
from protocols.messages import KINDS

if TYPE_CHECKING:
    from fleet.notebook_figure import NotebookFigure

Ending = Literal[
    "rounds played",  # as many as were asked for
    "time over",  # of a stream
    "no more events",  # in a trace
    "nobody on the air",
    "nobody can drive",  # all motors broke down, or are under way
    "nobody can reach the event",
    "nobody has the energy",
    "nobody was found",  # somebody could have gone; those who talked did not find it
    "no sensor notices events",
]
"""Why a run ended."""


@dataclass(frozen=True, slots=True)
class Summary:
    """The outcome of one run. Energies in J, distances in m, times in s.

    ``wall_time`` is the only figure that differs between two runs of one scenario.
    """

    protocol: str
    motion: str
    world: str
    seed: int
    robots: int
    radio_range: float  # r [m]
    search_radius: float  # SR [m]
    ended: Ending  # why
    lifetime: int  # events served before the first that never was
    censored: bool  # there was no such event: the lifetime is that or longer
    events: int  # events that happened
    served: int  # events that a robot reached
    waiting: int  # events still open at the end
    expired: int  # events that no robot set off to by their deadline
    lost: int  # events given up; events = served + waiting + expired + lost
    lost_by_reason: dict[str, int]
    failed: int  # trips that ended short of their event
    messages: int  # transmissions; a broadcast is one
    messages_per_robot: float
    messages_by_kind: dict[str, int]
    hops_greedy: int
    hops_face: int
    energy_initial: float  # of the whole fleet
    energy_predicted: float  # Eq. (1) on the straight line from start to event, all trips
    energy_drained: float  # what the batteries lost
    energy_by_account: dict[str, float]  # what it went into; adds up to what was drained
    energy_left_mean: float  # a robot
    energy_left_min: float
    energy_left_sd: float  # over the robots (population)
    reactions_per_robot: float  # trips that arrived
    distance_per_robot: float  # straight lines from start to end, all trips
    path_per_robot: float  # driven
    closest_found: float  # share of events whose nearest robot ended the search or won
    conversations: int  # offers talked over
    conflicts: int  # auctions won by a robot that another event had taken meanwhile
    broken: int  # conversations that came to no end
    restarts: int  # searches begun anew because the packet went round in circles
    repeated: int  # frames sent again because nobody acknowledged them
    unheard: int  # transmissions that nobody heard
    beacons: int
    frames_on_air: int  # of all kinds, where robots take turns
    frames_drowned: int  # of these, by others, at somebody who would have received them
    doubts: int  # frames that were heard, though their senders could not know
    sensor_messages: int  # hops of reports through the sensor field
    breakdowns: int
    relocations: int  # trips to places that are no events
    simulated_time: float
    wall_time: float

    stream: StreamFigures | None = None  # of a stream; there are none in rounds

    def as_dict(self) -> dict[str, Any]:
        """The record as plain Python values, keys in the order above; ``stream`` if there is."""
        described = asdict(self)
        if self.stream is None:
            del described["stream"]
        return described

    def plot(self) -> NotebookFigure:
        """What the energy went into [J], and what was said: a figure, which a notebook shows."""
        from fleet.summary_figure import draw

        return draw(self)

    def _repr_html_(self) -> str:
        """The table of ``fleet run``, in a notebook."""
        from fleet.summary_lines import as_html

        return as_html(self)


class PlayedRun(NamedTuple):
    """A run that is over, as far as its summary needs it."""

    fleet: Fleet
    tally: Tally
    book: TaskBook
    ended: Ending
    time: float  # [s]
    air: AirCounts
    sensor_messages: int


def summarise(run: PlayedRun, wall_time: float, longest_wait: float, *, streamed: bool) -> Summary:
    """The record of a run that is over. An event still open counts as never served if it has
    waited for ``longest_wait`` [s].
    """
    fleet, tally, book = run.fleet, run.tally, run.book
    labels, n = fleet.labels, len(fleet.robots)
    left = [robot.battery.charge for robot in fleet.robots]
    initial = fsum(robot.battery.capacity for robot in fleet.robots)
    drained, mean = initial - fsum(left), fsum(left) / n
    by_kind: dict[str, int] = dict.fromkeys(KINDS, 0) | tally.kinds  # and a protocol's own
    messages = sum(by_kind.values())
    never = [never_served(task, run.time, longest_wait) for task in book.tasks]
    before = never.index(True) if any(never) else len(never)
    return Summary(
        protocol=labels.protocol,
        motion=labels.motion,
        world=labels.world,
        seed=labels.seed,
        robots=n,
        radio_range=fleet.topology.radio_range,
        search_radius=labels.search_radius,
        ended=run.ended,
        lifetime=sum(task.state is State.SERVED for task in book.tasks[:before]),
        censored=not any(never),
        events=len(book.tasks),
        served=tally.served,
        waiting=book.count(*OPEN),
        expired=book.count(State.EXPIRED),
        lost=book.count(State.LOST),
        lost_by_reason=book.lost_by_reason(),
        failed=tally.failed,
        messages=messages,
        messages_per_robot=messages / n,
        messages_by_kind=by_kind,
        hops_greedy=by_kind["route-greedy"],
        hops_face=by_kind["route-face"],
        energy_initial=initial,
        energy_predicted=tally.predicted,
        energy_drained=drained,
        energy_by_account=dict(tally.accounts),
        energy_left_mean=mean,
        energy_left_min=min(left),
        energy_left_sd=sqrt(fsum((charge - mean) ** 2 for charge in left) / n),
        reactions_per_robot=tally.served / n,
        distance_per_robot=tally.distance / n,
        path_per_robot=tally.path / n,
        closest_found=tally.closest / max(tally.conversations, 1),
        conversations=tally.conversations,
        conflicts=tally.conflicts,
        broken=tally.broken,
        restarts=tally.restarts,
        repeated=tally.repeated,
        unheard=tally.unheard,
        beacons=run.air.beacons,
        frames_on_air=run.air.frames,
        frames_drowned=run.air.drowned,
        doubts=run.air.doubts,
        sensor_messages=run.sensor_messages,
        breakdowns=tally.breakdowns,
        relocations=tally.relocations,
        simulated_time=run.time,
        wall_time=wall_time,
        stream=stream_figures(book, tally, n, run.time, never, drained) if streamed else None,
    )
