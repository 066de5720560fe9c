"""The auction as a tree that grows: who was called by whom, and what each bid."""

from __future__ import annotations

from math import ceil
from typing import NamedTuple

import numpy as np
import pyarrow as pa
import rerun as rr

from fleet.replay.columns import Moment, colours, column, pairs, reals, texts
from fleet.replay.journal import RecordedLine
from fleet.replay.scheme import AUCTIONEER_COLOUR, CALLED_COLOUR, TREE, WINNER_TEXT, kind_colour
from fleet.replay.sink import Sink
from fleet.replay.state import FleetState, Layer
from protocols.messages import Award, Point, RobotId

WIDTH, HEIGHT = 480.0, 150.0  # of the plane that trees are laid out on
MANY_STEPS = 32  # in which a big tree grows


class Grown(NamedTuple):
    """The tree at one moment."""

    at: Moment
    robots: list[RobotId]
    labels: list[str]
    colours: list[int]
    links: list[tuple[RobotId, RobotId]]


class AuctionTree(Layer):
    """Laid out when the conversation is over, so that nobody moves while it grows."""

    def __init__(self) -> None:
        self._rows: list[tuple[Grown, dict[RobotId, Point]]] = []

    def run_started(self, state: FleetState) -> None:
        """No auction yet."""
        self._state = state

    def event_raised(self, at: Moment, event: int, source: RobotId) -> None:
        """The table is cleared."""
        self._rows.append((Grown(at, [], [], [], []), {}))

    def awarded(self, at: Moment, event: int, award: Award) -> None:
        """Now the whole tree is known: tell how it grew."""
        conversation, auctioneer = self._state.conversations[event], award.auctioneer
        steps = grow(conversation.lines, auctioneer, at.round)
        parents = conversation.parents
        places = lay_out(parents, auctioneer, self._state)
        stride = max(1, ceil(len(steps) / MANY_STEPS))
        self._rows += [(step, places) for step in steps[::-stride][::-1]]
        costs = {robot: cost for cost, robot in award.bids}
        chosen = {award.winner: "wins"} | {robot: "is sent ahead" for robot, _ in award.moves}
        robots = [auctioneer, *(robot for robot in places if robot != auctioneer)]
        final = Grown(
            at,
            robots,
            [_label(robot, costs.get(robot), chosen.get(robot, "")) for robot in robots],
            [
                WINNER_TEXT if robot in chosen
                else AUCTIONEER_COLOUR if robot == auctioneer
                else kind_colour("bid") if robot in costs
                else CALLED_COLOUR
                for robot in robots
            ],
            [(above, robot) for robot, above in parents.items() if robot in places],
        )  # fmt: skip
        self._rows.append((final, places))

    def send(self, sink: Sink) -> None:
        """Nodes and edges."""
        if not self._rows:
            return
        steps, layouts = zip(*self._rows, strict=True)
        nodes, edges = [len(step.robots) for step in steps], [len(step.links) for step in steps]
        spots = [
            places[robot]
            for step, places in zip(steps, layouts, strict=True)
            for robot in step.robots
        ]
        ids = [f"r{robot}" for step in steps for robot in step.robots]
        links = [link for step in steps for link in step.links]
        sink.rows(
            TREE,
            [step.at for step in steps],
            column(rr.GraphNodes.descriptor_node_ids(), texts(ids), nodes),
            column(
                rr.GraphNodes.descriptor_positions(), pairs(np.array(spots).reshape(-1, 2)), nodes
            ),
            column(
                rr.GraphNodes.descriptor_labels(),
                texts([label for step in steps for label in step.labels]),
                nodes,
            ),
            column(
                rr.GraphNodes.descriptor_colors(),
                colours([colour for step in steps for colour in step.colours]),
                nodes,
            ),
            column(rr.GraphNodes.descriptor_radii(), reals(np.full(len(ids), 14.0)), nodes),
            column(
                rr.GraphEdges.descriptor_edges(),
                pa.StructArray.from_arrays(
                    [texts([f"r{a}" for a, _ in links]), texts([f"r{b}" for _, b in links])],
                    fields=[
                        pa.field("first", pa.string(), nullable=False),
                        pa.field("second", pa.string(), nullable=False),
                    ],
                ),
                edges,
            ),
        )
        self._rows = []


def grow(lines: list[RecordedLine], auctioneer: RobotId, round_: int) -> list[Grown]:
    """The tree after each call and each bid."""
    steps: list[Grown] = []
    labels, paint = {auctioneer: f"r{auctioneer}"}, {auctioneer: AUCTIONEER_COLOUR}
    links: list[tuple[RobotId, RobotId]] = []
    for line in lines:
        if line.kind == "call":
            for robot in line.heard:
                if robot not in labels:
                    labels[robot], paint[robot] = f"r{robot}", CALLED_COLOUR
                    links.append((line.sender, robot))
        elif line.kind == "bid" and line.bidder is not None:
            labels[line.bidder] = _label(line.bidder, line.cost)
            paint[line.bidder] = kind_colour("bid")
        else:
            continue
        at = Moment(line.time, round_, line.number)
        steps.append(
            Grown(at, list(labels), list(labels.values()), list(paint.values()), list(links))
        )
    return steps


def lay_out(
    parents: dict[RobotId, RobotId], auctioneer: RobotId, state: FleetState
) -> dict[RobotId, Point]:
    """A place for every robot: layers by depth, from west to east as they stand on the floor."""
    below: dict[RobotId, list[RobotId]] = {auctioneer: []}
    for robot, above in parents.items():
        below.setdefault(robot, [])
        below.setdefault(above, []).append(robot)
    roots = [robot for robot in below if robot not in parents]
    across: dict[RobotId, float] = {}
    depth: dict[RobotId, int] = {}
    leaves = 0
    # Depth first, without recursion: trees of flooded auctions are deep.
    stack = [(root, 0, False) for root in reversed(roots)]
    while stack:
        robot, layer, done = stack.pop()
        children = sorted(below[robot], key=lambda child: (state.at(child), child))
        if done or not children:
            depth[robot] = layer
            if children:
                across[robot] = sum(across[child] for child in children) / len(children)
            else:
                across[robot] = leaves + 0.5
                leaves += 1
            continue
        stack.append((robot, layer, True))
        stack.extend((child, layer + 1, False) for child in reversed(children))
    deepest = max(depth.values(), default=0)
    return {
        robot: (
            WIDTH * across[robot] / max(leaves, 1),
            HEIGHT * depth[robot] / max(deepest, 1),
        )
        for robot in below
    }


def _label(robot: RobotId, cost: float | None, chosen: str = "") -> str:
    bid = "" if cost is None else f"  {cost:.1f}"
    return f"r{robot}{bid}{chosen and f'  {chosen}'}"
