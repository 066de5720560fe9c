"""The paper's claims one by one: what it says, what was measured, and whether that agrees."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from fleet.experiments.paper.cases import BASELINE_RANGE, SEARCH_RADII, WORLDS
from fleet.experiments.paper.printed_tables import compare
from fleet.experiments.paper.resampling import Resampled
from fleet.experiments.paper.sample import TWO_SR, Sample
from fleet.experiments.paper.verdicts import (
    Band,
    Judged,
    Verdict,
    above,
    all_of,
    judge,
    same_share,
    share,
    times,
)

RANDOM, HOLE = WORLDS
NAMES = {RANDOM: "random", HOLE: "with hole"}
PRINTED = {"rfta2": "RFTA2", "rfta2ge": "RFTA2GE", "7-saap": "7-SAAP", "bfs-7": "BFS-7",
           "bfs-10": "BFS-10", "gfgf2a": "GFGF2A"}  # fmt: skip
MUCH_THE_SAME = 0.1  # numbers so near are one claim


@dataclass(frozen=True, slots=True)
class Claim:
    """One claim of the paper against what was measured."""

    where: str
    says: str
    parts: Sequence[Judged]
    odds: str = ""  # what the paper says of the same elsewhere
    whole: str = ""  # when it holds, where its parts differ in that

    @property
    def verdict(self) -> Verdict:
        """Fails with one of its parts, holds with all of them."""
        return all_of(self.parts)

    @property
    def measured(self) -> str:
        """Each part with its interval; of many, those that are least and most."""
        if self.whole:
            verdicts = [part.verdict for part in self.parts]
            told = (f"{verdicts.count(v)} {v}" for v in ("holds", "does not hold", "cannot tell"))
            return f"of {len(verdicts)}: {', '.join(told)}"
        if len(self.parts) <= 4:
            return "; ".join(map(str, self.parts))
        ordered = sorted(self.parts, key=lambda part: part.interval.value)
        return f"{ordered[0]} to {ordered[-1]} ({len(self.parts)} compared)"

    @property
    def rule(self) -> str:
        """When it holds."""
        return self.whole or "; ".join(dict.fromkeys(part.rule for part in self.parts))


def claims(sample: Sample) -> list[Claim]:
    """All claims that the campaign's runs of a reading bear on, in the order of the paper."""
    return [
        *_search(sample),
        *_radii(sample),
        *_lifetimes(sample),
        *_costs(sample),
        *_baselines(sample),
        *_balance(sample),
        _tables(sample),
    ]


def _search(sample: Sample) -> Iterator[Claim]:
    yield Claim(
        "Section 2.5",
        "GFGF1 finds the closest robot in almost 100 % of the routings",
        [
            judge(sample.closest("gfgf1", world), share(1.0), NAMES[world], percent=True)
            for world in WORLDS
        ],
    )
    yield Claim(
        "Section 2.5, Figure 8",
        "GFGF2 finds the closest robot in 55 to 90 % of the routings",
        [
            judge(
                sample.closest("gfgf2", world, search_radius=radius),
                share(0.55, 0.9), f"{radius:.0f}SR, {NAMES[world]}", percent=True,
            )
            for world in WORLDS for radius in SEARCH_RADII
        ],
    )  # fmt: skip
    ratios = [sample.messages("rfta1", w) / sample.messages("gfgf2", w) for w in WORLDS]
    yield Claim(
        "Section 5, Figures 6 and 7",
        "RFTA1 costs around 25 % more messages than GFGF2",
        [
            judge(ratio - 1.0, _surplus(0.25), NAMES[world], percent=True)
            for ratio, world in zip(ratios, WORLDS, strict=True)
        ],
    )
    gains = [sample.closest("rfta1", w) - sample.closest("gfgf2", w) for w in WORLDS]
    yield Claim(
        "Section 5, Figure 8",
        "RFTA1 finds the closest robot almost as often as GFGF2",
        [
            judge(gain, same_share(), f"{NAMES[world]}, more often by", percent=True)
            for gain, world in zip(gains, WORLDS, strict=True)
        ],
    )


def _radii(sample: Sample) -> Iterator[Claim]:
    for series in ("rfta2", "rfta2ge"):
        for other in (radius for radius in SEARCH_RADII if radius != TWO_SR):
            yield Claim(
                "Lemma 2, Figures 11 and 13",
                f"2SR is a better search radius for {PRINTED[series]} than {_radius(other)}",
                [
                    judge(
                        sample.lifetime(series, world)
                        / sample.lifetime(series, world, search_radius=other),
                        above(1.0), NAMES[world], "times as long",
                    )
                    for world in WORLDS
                ],
            )  # fmt: skip


def _lifetimes(sample: Sample) -> Iterator[Claim]:
    at, longest = sample.longest("rfta2")
    yield Claim(
        "Figure 11",
        "RFTA2 at 2SR lives around 350 rounds at the longest",
        [judge(longest, times(350.0), f"at r = {0.1 * at:.2f}", "rounds")],
    )
    flat = [r for r in sample.ranges("rfta2") if r > BASELINE_RANGE]
    lives = [sample.lifetime("rfta2", radio_range=r) for r in flat]
    whole = _mean(lives)
    yield Claim(
        "Figure 11",
        "the lifetime of RFTA2 is constant for r > 0.2",
        [
            judge(life / whole, times(1.0), f"r = {0.1 * r:.2f}", "of the mean")
            for r, life in zip(flat, lives, strict=True)
        ],
    )
    at, longest = sample.longest("rfta2ge")
    hole = sample.longest("rfta2ge", HOLE)[1]
    yield Claim(
        "Figure 13",
        "RFTA2GE lives up to almost 400 rounds",
        [judge(longest, times(400.0), f"at r = {0.1 * at:.2f}", "rounds")],
    )
    yield Claim(
        "Figure 13",
        "RFTA2GE lives a little shorter with the hole",
        [judge(hole / longest, Band(0.75, 1.0, "0.75 to 1"), "", "times as long")],
    )
    shorter = sample.lifetime("gfgf2a") / sample.lifetime("gfgf2a", HOLE)
    yield from _both("Figure 16", "GFGF2A lives {} times shorter with the hole", shorter, 4.0, 2.63)
    for world, number in ((RANDOM, 2.0), (HOLE, 4.0)):
        yield Claim(
            "Figure 16",
            f"RFTA2 and RFTA2GE live almost {number:.0f} times as long as GFGF2A, {NAMES[world]}",
            [
                judge(_over(sample, series, world), times(number), PRINTED[series], "times")
                for series in ("rfta2", "rfta2ge")
            ],
        )
    ranges = sample.ranges("gfgf2a")
    most = max((_over(sample, "rfta2", w, radio_range=r) for w in WORLDS for r in ranges),
               key=lambda ratio: ratio.value)  # fmt: skip
    yield Claim(
        "Abstract",
        "RFTA2 lives up to 5 times as long as GFGF2A",
        [judge(most, times(5.0), "where it is most", "times")],
    )


def _costs(sample: Sample) -> Iterator[Claim]:
    ge = sample.messages("rfta2ge")
    yield from _both(
        "Figure 14", "RFTA2GE costs around {} messages a round", ge, 40.0, 18.2, "messages"
    )
    for world, table in ((RANDOM, (1.36, 2.78)), (HOLE, (3.44, 2.39))):
        for series, by_table in zip(("rfta2", "gfgf2a"), table, strict=True):
            ratio = sample.messages("rfta2ge", world) / sample.messages(series, world)
            yield from _both(
                f"Figure 15, {NAMES[world]}",
                f"RFTA2GE costs around {{}} times the messages of {PRINTED[series]}",
                ratio, 4.0, by_table,
            )  # fmt: skip


def _baselines(sample: Sample) -> Iterator[Claim]:
    life = {s: sample.lifetime(s, radio_range=BASELINE_RANGE) for s in PRINTED}
    cost = {s: sample.messages(s, radio_range=BASELINE_RANGE) for s in PRINTED}

    def ratios(
        kind: dict[str, Resampled], pairs: Sequence[tuple[str, str]], number: float
    ) -> list[Judged]:
        return [
            judge(kind[a] / kind[b], times(number), f"{PRINTED[a]} over {PRINTED[b]}", "times")
            for a, b in pairs
        ]

    ours = ("rfta2", "rfta2ge")
    yield Claim(
        "Figure 10",
        "RFTA2 and RFTA2GE live around 7 times as long as 7-SAAP and BFS-7",
        ratios(life, [(a, b) for a in ours for b in ("7-saap", "bfs-7")], 7.0),
    )
    yield Claim(
        "Figures 9 and 10",
        "7-SAAP costs up to 10 times the messages of RFTA2",
        ratios(cost, [("7-saap", "rfta2")], 10.0),
    )
    yield Claim(
        "Figures 9 and 10",
        "7-SAAP costs 3 times the messages of RFTA2GE",
        ratios(cost, [("7-saap", "rfta2ge")], 3.0),
    )
    yield Claim(
        "Figure 10",
        "BFS-7 lives about as long as 7-SAAP",
        ratios(life, [("bfs-7", "7-saap")], 1.0),
    )
    yield Claim(
        "Figure 10",
        "BFS-7 costs more messages than 7-SAAP",
        [judge(cost["bfs-7"] / cost["7-saap"], above(1.0), "", "times")],
    )
    yield Claim(
        "Figure 10",
        "BFS-10 lives twice as long as BFS-7",
        ratios(life, [("bfs-10", "bfs-7")], 2.0),
        "both are said to live 6 times shorter than RFTA2",
    )
    yield Claim(
        "Figure 10",
        "BFS-10 costs twice the messages of BFS-7",
        ratios(cost, [("bfs-10", "bfs-7")], 2.0),
    )
    yield Claim(
        "Section 5",
        "BFS-7 and BFS-10 live 6 times shorter than RFTA2",
        ratios(life, [("rfta2", "bfs-7"), ("rfta2", "bfs-10")], 6.0),
        "one of them is said to live twice as long as the other",
    )
    yield Claim(
        "Section 5",
        "BFS-7 and BFS-10 cost almost 30 times the messages of RFTA2",
        ratios(cost, [("bfs-7", "rfta2"), ("bfs-10", "rfta2")], 30.0),
        "one of them is said to cost twice as much as the other",
    )


def _balance(sample: Sample) -> Iterator[Claim]:
    """Section 5.1 and the conclusions, beside what Tables 2 and 3 say of the same."""
    section = "Section 5.1"
    for world, text, table in ((RANDOM, 1.6, 1.44), (HOLE, 3.75, 3.04)):
        yield from _both(
            f"{section}, {NAMES[world]}", "RFTA2 lives {} times as long as GFGF2A",
            _over(sample, "rfta2", world), text, table,
        )  # fmt: skip
    for world, table in ((RANDOM, 2.04), (HOLE, 0.69)):
        cost = sample.messages("rfta2", world) / sample.messages("gfgf2a", world)
        yield from _both(
            f"{section}, {NAMES[world]}", "RFTA2 costs {} times the messages of GFGF2A",
            cost, 1.8, table,
        )  # fmt: skip
    for world, table in ((RANDOM, 0.165), (HOLE, 0.23)):
        gain = sample.lifetime("rfta2ge", world) / sample.lifetime("rfta2", world) - 1.0
        yield from _both(
            f"{section}, {NAMES[world]}", "RFTA2GE lives around {} longer than RFTA2",
            gain, 0.07, table, percent=True,
        )  # fmt: skip
    compared = (
        ("reactions_per_robot", "reactions", RANDOM, ((1.7, 1.68), (1.1, 1.16))),
        ("reactions_per_robot", "reactions", HOLE, ((9.0, 3.72), (6.0, 1.23))),
        ("distance_per_robot", "distance", RANDOM, ((3.0, 3.16), (1.2, 1.18))),
        ("distance_per_robot", "distance", HOLE, ((6.0, 6.1), (1.25, 1.25))),
    )
    for key, name, world, numbers in compared:
        for series, (text, table) in zip(("gfgf2a", "rfta2"), numbers, strict=True):
            ratio = sample.figure(key, "rfta2ge", world) / sample.figure(key, series, world)
            yield from _both(
                f"{section}, {NAMES[world]}",
                f"RFTA2GE has {{}} times the {name} of {PRINTED[series]}",
                ratio, text, table,
            )  # fmt: skip
    each = sample.lifetime("rfta2") / (sample.figure("reactions_per_robot", "rfta2") * 100.0)
    yield Claim(
        "Tables 2 and 3",
        "each round is one reaction of one of 100 robots: lifetime over 100 times the reactions",
        [judge(each, Band(0.995, 1.005, "1"), "", "")],
        "by the tables it is 1.05",
    )


def _tables(sample: Sample) -> Claim:
    cells = [cell for world in WORLDS for cell in compare(sample, world)]
    return Claim(
        "Tables 2 and 3",
        "the values printed there",
        [c.judged for c in cells if c.judged is not None and not c.impossible],
        whole="all within 0.5 pooled standard deviations",
    )


def _both(
    where: str,
    says: str,
    figure: Resampled,
    text: float,
    table: float,
    unit: str = "times",
    *,
    percent: bool = False,
) -> Iterator[Claim]:
    """A claim of the text and, where the tables say otherwise, theirs; both are judged."""

    def told(number: float) -> str:
        return f"{number:.0%}".replace("%", " %") if percent else f"{number:g}"

    def claim(number: float, odds: str = "") -> Claim:
        band = _surplus(number) if percent else times(number)
        judged = judge(figure, band, "", "" if percent else unit, percent=percent)
        return Claim(where, says.format(told(number)), [judged], odds)

    if abs(text / table - 1.0) < MUCH_THE_SAME:
        yield claim(text)
        return
    yield claim(text, f"by the tables it is {told(table)}")
    by_table = claim(table)
    yield Claim(
        f"{where}, by the tables", by_table.says, by_table.parts, f"the text says {told(text)}"
    )


def _over(sample: Sample, series: str, world: str, **more: float) -> Resampled:
    """How many times as long as GFGF2A a series lives."""
    return sample.lifetime(series, world, **more) / sample.lifetime("gfgf2a", world, **more)


def _mean(figures: Sequence[Resampled]) -> Resampled:
    total = figures[0]
    for figure in figures[1:]:
        total = total + figure
    return total / float(len(figures))


def _surplus(number: float) -> Band:
    """A surplus that the text gives as a share: a number like any other."""
    band = times(number)
    return Band(band.low, band.high, f"{band.low:.1%} to {band.high:.1%} more")


def _radius(radius: float) -> str:
    return f"{radius:.0f}SR" if radius > 1.0 else "SR"
