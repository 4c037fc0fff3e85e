"""tridisk from Python: write initial conditions, run scenes, read snapshots, and carry bodies to and from REBOUND.

    sim = tridisk.to_rebound("runs/belt/snapshot_0010.hdf5")
    tridisk.from_rebound(sim, "start.hdf5")
    tridisk.continue_in_tridisk("archive.bin", end_time=1e4, output="runs/onward").simulation()
    tridisk.compare("archive.bin", integrator="whfast", years=100)      # or: python -m tridisk compare archive.bin

REBOUND (version 5) is imported by the functions that need it alone.
"""

from .bodies import elements, from_rebound, to_rebound
from .comparison import Comparison, compare
from .continuation import Continuation, continue_in_tridisk
from .files import ROOT, program, read, run, snapshots, write, yt_load

__all__ = [
    "ROOT", "Comparison", "Continuation", "compare", "continue_in_tridisk", "elements", "from_rebound", "program", "read", "run", "snapshots",
    "to_rebound", "write", "yt_load",
]
