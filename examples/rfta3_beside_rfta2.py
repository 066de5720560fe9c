"""RFTA3 beside RFTA2: one network, the same events, both recorded, to be watched side by side.

    python examples/rfta3_beside_rfta2.py
    fleet view out/beside/rfta2.rrd out/beside/rfta3.rrd

In the viewer, scrub by round: what does each protocol ask, and whom does it send?
"""

import sys
from pathlib import Path

import fleet
from fleet.replay import recorder


def main(out: str = "out/beside", seed: int = 3) -> None:
    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    print("protocol  rounds  messages a round  J a round  J left a robot")
    for protocol in ("rfta2", "rfta3"):
        scenario = fleet.Scenario.of(protocol=protocol, seed=seed)
        run = fleet.run(scenario, [recorder(scenario, folder / f"{protocol}.rrd")])
        print(
            f"{protocol:8}  {run.lifetime:6}  {run.messages / run.events:16.1f}"
            f"  {run.energy_drained / run.events:9.1f}"
            f"  {run.energy_left_mean:5.1f} ± {run.energy_left_sd:.1f}"
        )
    print(f"Now: fleet view {folder / 'rfta2.rrd'} {folder / 'rfta3.rrd'}")


if __name__ == "__main__":
    main(*sys.argv[1:2])
