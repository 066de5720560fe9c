"""Whether grounds differ: what a metre takes on each, run by run."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from fleet.logs.judging import Judgement
from fleet.logs.sentences import per_metre_by_run
from fleet.study.statistics import CONFIDENCE

_SURE = 1.0 - CONFIDENCE


def slopes_sentence(judgements: Sequence[Judgement]) -> str:
    """What a metre takes on each ground, and which grounds differ.

    Welch's t test between runs, for each pair of grounds, with Holm's correction.
    """
    from scipy.stats import ttest_ind

    slopes = {judged.ground.name: per_metre_by_run(judged) for judged in judgements}
    text = "; ".join(
        f"{name} {np.median(values):.3g} J/m (runs {values.min():.3g} to {values.max():.3g})"
        for name, values in slopes.items()
    )
    pairs = [
        (float(ttest_ind(slopes[a], slopes[b], equal_var=False).pvalue), a, b)
        for a, b in combinations(slopes, 2)
        if min(len(slopes[a]), len(slopes[b])) > 1
    ]
    differ = []
    for number, (chance, a, b) in enumerate(sorted(pairs)):
        if not chance * (len(pairs) - number) < _SURE:
            break
        differ.append(f"{a} and {b}")
    if differ:
        return f"{text}. Metres cost differently on {', '.join(differ)}: judge them apart."
    return (
        f"{text}. Metres do not cost differently on these grounds, as far as these logs can tell."
    )
