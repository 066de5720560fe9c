"""Where two recorded runs part, and how they differ from there on."""

from __future__ import annotations

from typing import Any, NamedTuple

from fleet.replay import scheme
from fleet.replay.readback import Recording

MOST_ROWS = 20  # events that are listed
UNLIKE = ("key", "version")  # of what is kept of a run, no part of its scenario

Row = dict[str, Any]


class Parting(NamedTuple):
    """Two runs, event by event."""

    names: tuple[str, str]
    settings: dict[str, tuple[Any, Any]]  # of their scenarios that differ
    events: tuple[int, int]  # that each has
    said: int | None  # the first event about which something else is said; None: none
    parted: int | None  # the first that comes to another end, or that only one has
    ends: list[tuple[int, str, str]]  # of events that both have: the different ends
    energy: tuple[float, float]  # [J] of all trips from there on
    messages: tuple[int, int]  # from there on

    def as_dict(self) -> dict[str, Any]:
        """Plain values, by name."""
        return self._asdict()

    def markdown(self) -> str:
        """In words."""
        return "\n\n".join(
            part for part in (self._parted(), self._settings(), self._ends()) if part
        )

    def _parted(self) -> str:
        one, other = (f"`{name}`" for name in self.names)
        if self.parted is None:
            words = (
                f"## They never part\n\nAll {self.events[0]} events of {one} and {other} end alike."
            )
        else:
            energy, messages = self.energy, self.messages
            words = (
                f"## They part at event {self.parted}\n\n{one} and {other} are alike before it."
                f" From there on trips take **{energy[0]:.1f} J** and **{energy[1]:.1f} J**,"
                f" a difference of {energy[1] - energy[0]:+.1f} J; **{messages[0]}** and"
                f" **{messages[1]}** messages are sent, a difference of"
                f" {messages[1] - messages[0]:+d}. They have {self.events[0]} and"
                f" {self.events[1]} events."
            )
        if self.said is not None and self.said != self.parted:
            words += f" Something else is said from event {self.said} on."
        return words

    def _settings(self) -> str:
        if not self.settings:
            return ""
        rows = [f"| {name} | {one} | {two} |" for name, (one, two) in self.settings.items()]
        return "\n".join([self._head("scenario"), *rows])

    def _ends(self) -> str:
        if not self.ends:
            return ""
        rows = [f"| {event} | {one} | {two} |" for event, one, two in self.ends[:MOST_ROWS]]
        if len(self.ends) > MOST_ROWS:
            rows.append(f"| and {len(self.ends) - MOST_ROWS} more | | |")
        return "\n".join([self._head("event"), *rows])

    def _head(self, what: str) -> str:
        return f"| {what} | {self.names[0]} | {self.names[1]} |\n|---|---|---|"


def parting(one: Recording, other: Recording) -> Parting:
    """Compare two runs, of the same events or not."""
    tasks = [_by_event(run.table(scheme.TASKS).to_pylist()) for run in (one, other)]
    talks = [_talks(run) for run in (one, other)]
    every = sorted(tasks[0].keys() | tasks[1].keys())
    said = next((e for e in every if talks[0].get(e) != talks[1].get(e)), None)
    ended = [[_end(of.get(e)) for of in tasks] for e in every]
    apart = [e for e, (a, b) in zip(every, ended, strict=True) if a != b]
    shared = [e for e in apart if e in tasks[0] and e in tasks[1]]
    parted = apart[0] if apart else None
    since = every[-1] + 1 if every and parted is None else (parted or 0)
    return Parting(
        (one.path.stem, other.path.stem),
        differing(one, other),
        (len(tasks[0]), len(tasks[1])),
        said,
        parted,
        [(e, _told(tasks[0][e]), _told(tasks[1][e])) for e in shared],
        (_energy(one, since), _energy(other, since)),
        (_count(talks[0], since), _count(talks[1], since)),
    )


def differing(one: Recording, other: Recording) -> dict[str, tuple[Any, Any]]:
    """What of two scenarios is not the same; None: it is not set."""
    first, second = (run.properties.get("run", {}) for run in (one, other))
    return {
        name: (first.get(name), second.get(name))
        for name in sorted({*first, *second} - {*UNLIKE})
        if first.get(name) != second.get(name)
    }


def _by_event(tasks: list[Row]) -> dict[int, Row]:
    return {task["event"]: task for task in tasks}


def _talks(run: Recording) -> dict[int, list[tuple[Any, ...]]]:
    """What was said about each event, and who heard it."""
    talks: dict[int, list[tuple[Any, ...]]] = {}
    for line in run.table(scheme.TRANSCRIPT).to_pylist():
        said = line["kind"], line["sender"], line["receiver"], line["heard"], line["cost"]
        talks.setdefault(line["event"], []).append(said)
    return talks


def _end(task: Row | None) -> tuple[Any, ...] | None:
    if task is None:
        return None
    return task["x"], task["y"], task["robot"], task["outcome"], task["offers"]


def _told(task: Row) -> str:
    who = "nobody" if task["robot"] < 0 else f"r{task['robot']}"
    cost = "" if task["cost"] is None else f", bid {task['cost']:.2f}"
    return f"{who}{cost}, {task['outcome']}"


def _energy(run: Recording, since: int) -> float:
    """What trips to an event and all later ones took [J]."""
    trips = run.table(scheme.TRIPS).to_pylist()
    return sum(float(trip["energy"]) for trip in trips if trip["event"] >= since)


def _count(talks: dict[int, list[tuple[Any, ...]]], since: int) -> int:
    """Messages about an event and all later ones."""
    return sum(len(lines) for event, lines in talks.items() if event >= since)
