"""Who was under way and where, moment by moment."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from fleet.motion import SAMPLE_FIELDS
from fleet.replay.columns import Index, Moment
from protocols.messages import RobotId

Poses: TypeAlias = dict[RobotId, tuple[float, ...]]
"""The latest pose of each robot under way, as :data:`fleet.motion.SAMPLE_FIELDS`."""


class Frames(NamedTuple):
    """Rows of poses: at each of k moments, those of everybody under way, by robot."""

    when: Index  # (k,)
    lengths: NDArray[np.intp]  # (k,) robots under way at each moment
    poses: NDArray[np.float64]  # (sum of lengths, 8)


def still(poses: Poses, at: Moment) -> Frames:
    """One frame: everybody where they were last seen."""
    rows = np.array([poses[robot] for robot in sorted(poses)]).reshape(-1, len(SAMPLE_FIELDS))
    return Frames(Index.of([at]), np.array([len(rows)]), rows)


def frames(samples: NDArray[np.float64], poses: Poses, at: Moment) -> Frames:
    """A frame for each time among the ``samples`` (k, 8), which are sorted by it.

    Robots have their own clocks: each keeps its latest pose until its next sample.
    Brings ``poses`` up to date.
    """
    if len(poses) == 1:
        times, lengths, rows = samples[:, 1], np.ones(len(samples), np.intp), samples
        (robot,) = poses
        poses[robot] = tuple(samples[-1].tolist())
    else:
        times, lengths, rows = _filled(samples, poses)
    return Frames(Index.drive(times, at), lengths, rows)


def joined(parts: list[Frames]) -> Frames:
    """All frames, one after another."""
    return Frames(
        Index.joined([part.when for part in parts]),
        np.concatenate([part.lengths for part in parts]),
        np.concatenate([part.poses for part in parts]),
    )


def _filled(
    samples: NDArray[np.float64], poses: Poses
) -> tuple[NDArray[np.float64], NDArray[np.intp], NDArray[np.float64]]:
    movers = np.array(sorted(poses))
    known = np.concatenate([[poses[robot] for robot in movers.tolist()], samples])
    times, row = np.unique(samples[:, 1], return_inverse=True)
    latest = np.zeros((len(times), len(movers)), np.intp)  # rows of `known`
    latest[0] = np.arange(len(movers))
    place = np.searchsorted(movers, samples[:, 0])
    latest[row, place] = len(movers) + np.arange(len(samples))
    np.maximum.accumulate(latest, axis=0, out=latest)
    for robot, pose in zip(movers.tolist(), known[latest[-1]].tolist(), strict=True):
        poses[robot] = tuple(pose)
    under_way = known[latest, 1] <= times[:, None]  # not those that set off only later
    table = known[latest[under_way]]
    lengths = under_way.sum(axis=1)
    table[:, 1] = np.repeat(times, lengths)
    return times, lengths, table
