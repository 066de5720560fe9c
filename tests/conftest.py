"""Property tests draw the same examples every time, so that what passed here passes elsewhere.

``EXPLORE=1`` draws others: to look for what nobody has thought of, not to decide whether a change
is good. How long an example takes says something of the machine alone.
"""

from __future__ import annotations

import os

from hypothesis import settings

settings.register_profile("same", deadline=None, derandomize=True)
settings.register_profile("explore", deadline=None)
settings.load_profile("explore" if os.environ.get("EXPLORE") else "same")
