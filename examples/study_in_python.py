"""A study from a notebook: which protocol keeps a fleet alive longest, and how sure is that?

Run it again and it is done at once: what is in the folder is not run a second time.
"""

import sys

import fleet
from fleet.study.statistics import mean_interval, paired_difference


def main(out: str = "out/study-in-python", seeds: int = 20) -> None:
    result = fleet.sweep(
        {
            "scenario": {"motion": "straight"},
            "axes": {"protocol": ["rfta2", "gfgf2a"], "range": [2.0, 3.0]},
            "seeds": seeds,
        },
        out,
    )
    runs = result.table()  # pyarrow; result.frame() is the same for pandas
    lifetimes = {}
    for row in runs.select(["protocol", "range", "lifetime"]).to_pylist():
        lifetimes.setdefault((row["protocol"], row["range"]), []).append(row["lifetime"])

    for (protocol, radio_range), rounds in lifetimes.items():
        mean, low, high = mean_interval(rounds)
        print(
            f"{protocol:7} at {radio_range} m: {mean:5.1f} rounds, 95 % CI {low:.1f} to {high:.1f}"
        )

    for radio_range in (2.0, 3.0):  # runs of one seed are pairs: one network, the same events
        gain = paired_difference(lifetimes["rfta2", radio_range], lifetimes["gfgf2a", radio_range])
        print(
            f"at {radio_range} m rfta2 lives {gain.mean:+.1f} rounds longer,"
            f" 95 % CI {gain.low:.1f} to {gain.high:.1f}, Cohen's d {gain.effect:.2f}"
        )


if __name__ == "__main__":
    main(*sys.argv[1:2], *map(int, sys.argv[2:3]))
