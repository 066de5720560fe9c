"""What is counted as a run goes on."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

from fleet.motion import Accounts, Trip

STANDING, RADIO = "standing", "radio"  # what is paid by whoever is not under way, and for frames
ACCOUNTS = (*Accounts._fields, STANDING, RADIO)
"""What the energy of batteries goes into."""


@dataclass(slots=True)
class Tally:
    """Counters of one run. Energies in J, distances in m, times in s."""

    served: int = 0
    failed: int = 0  # trips
    conversations: int = 0
    closest: int = 0  # conversations that found the nearest robot
    predicted: float = 0.0
    distance: float = 0.0
    path: float = 0.0
    engaged: float = 0.0  # time that robots were promised, under way or at work, summed
    repeated: int = 0  # frames sent again because nobody acknowledged them
    unheard: int = 0  # transmissions that nobody heard
    restarts: int = 0  # searches begun anew because the packet went round in circles
    broken: int = 0  # conversations that came to no end
    conflicts: int = 0  # auctions won by a robot that another had taken meanwhile
    breakdowns: int = 0
    relocations: int = 0  # trips to places that are no events
    kinds: Counter[str] = field(default_factory=Counter)  # transmissions
    accounts: dict[str, float] = field(default_factory=lambda: dict.fromkeys(ACCOUNTS, 0.0))

    def pay_for(self, trip: Trip) -> None:
        """Book what a trip has cost, each part on its account."""
        for name, energy in trip.accounts._asdict().items():
            self.accounts[name] += energy
