"""Holding a protocol of the user's to its word for a whole run.

What it raises, that it never says anything more, and that it breaks one of
:mod:`protocols.rules`, is one sentence with the file and the line.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from pathlib import Path
from typing import Any

from fleet.scenario.errors import BadInput, bad, shown
from fleet.scenario.plugins import what, where_in
from fleet.scenario.watchdog import Stuck, Watch
from protocols.messages import Award, Conversation, Event, Heard, ProtocolFunction, RobotId, View
from protocols.rules import BrokenRule, Conduct, ReadOnlyRobot, all_knowing, plainly_allowed


def begun(words: object, called: str) -> Conversation:
    """The conversation that a protocol has begun.

    Raises:
        BadInput: it is none.
    """
    if isinstance(words, Generator):
        return words
    said = f"{shown(called)} returns {described(words)}; expected a generator of transmissions"
    raise bad("protocol", said)


def described(value: object) -> str:
    """A value that was not expected, by its type."""
    return "nothing" if value is None else f"{type(value).__name__} {shown(value, 40)}"


class Guard:
    """A protocol of the user's for a whole run; ``folders`` hold the user's code."""

    def __init__(self, protocol: ProtocolFunction, called: str, folders: Sequence[Path]) -> None:
        self._protocol = protocol
        self._called = called
        self._folders = folders
        self._watch = Watch(folders[0])
        self.all_knowing = all_knowing(protocol)
        self._view: View = ()
        self._seen: list[ReadOnlyRobot] = []

    def __call__(self, view: View, event: Event, source: RobotId) -> Conversation:
        """One conversation."""
        conduct = self._conduct(view, source)
        told, fleet, watch = conduct.told, self._seen, self._watch
        heard: Heard = ()
        words: Any = None
        watch.begin()
        try:
            watch.steps += 1
            watch.inside = True
            words = begun(self._protocol(conduct.view, event, source), self._called)
            said = next(words)
            while True:
                if not plainly_allowed(said, told):
                    conduct.check(said)
                watch.inside = False
                if watch.struck:
                    watch.settle()
                heard = yield said
                for robot in heard:
                    told[robot] = fleet[robot]
                watch.steps += 1
                watch.inside = True
                said = words.send(heard)
        except StopIteration as end:
            return _ended(conduct, words, end.value, self._called)
        except (BadInput, GeneratorExit):
            raise
        except BrokenRule as broken:
            raise self._broken(_thrown(words, broken)) from broken
        except (Exception, SystemExit, Stuck) as error:
            if (failed := self._failed(error)) is None:
                raise
            raise failed from error
        finally:
            watch.inside = False
            watch.settle()

    def _conduct(self, view: View, source: RobotId) -> Conduct:
        if view is not self._view:  # the rehearsal's robots, then the run's
            self._view, self._seen = view, [ReadOnlyRobot(robot) for robot in view]
        return Conduct(self._seen, source, knows_all=self.all_knowing)

    def _failed(self, error: BaseException) -> BadInput | None:
        """The sentence about what the user's code raised; None: none of its lines had a part."""
        where = self._where(error)
        if not where:
            return None
        return bad("protocol", f"{shown(self._called)} fails{where}: {what(error)}")

    def _broken(self, broken: BrokenRule) -> BadInput:
        said = f"{shown(self._called)} breaks a rule{self._where(broken)}: {broken}"
        return bad("protocol", said)

    def _where(self, error: BaseException) -> str:
        """The line of the user's that an error came through, if there is one."""
        return next(filter(None, (where_in(error, folder) for folder in self._folders)), "")


def _ended(conduct: Conduct, words: Any, award: Award, called: str) -> Award:
    """The award, if a conversation may end with it."""
    try:
        conduct.check_award(award)
    except BrokenRule as broken:
        said = f"{shown(called)} breaks a rule{_end_of(words)}: {broken}"
        raise bad("protocol", said) from broken
    return award


def _end_of(words: Any) -> str:
    """Where a conversation is that has ended, as `` at the end of mine, in line 7 of x.py``."""
    code = words.gi_code
    file = Path(code.co_filename).name
    return f" at the end of {code.co_name}, in line {code.co_firstlineno} of {file}"


def _thrown(words: Any, broken: BrokenRule) -> BrokenRule:
    """The same, raised in the line of the protocol that broke the rule by what it said."""
    try:
        words.throw(broken)
    except BrokenRule as raised:
        return raised
    except BaseException:  # noqa: BLE001  # what it makes of that does not matter any more
        return broken
    return broken
