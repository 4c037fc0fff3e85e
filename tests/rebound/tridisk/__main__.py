"""python -m tridisk: what the module does, as commands."""

import argparse
import sys

from .comparison import compare
from .continuation import continue_in_tridisk


def main():
    parser = argparse.ArgumentParser(prog="python -m tridisk", description="tridisk beside REBOUND")
    commands = parser.add_subparsers(dest="command", required=True)
    one = commands.add_parser("compare", help="the same bodies through both codes", epilog="Example: compare scene.toml --integrator whfast --years 100")
    one.add_argument("start", help="scene (.toml) with bodies alone, snapshot or start file (.hdf5), or Simulationarchive")
    one.add_argument("--integrator", help="tridisk's name, or the nearest of REBOUND's")
    one.add_argument("--rebound-integrator", help="the nearest if not given")
    one.add_argument("--years", type=float, help="units of time / 2 pi")
    one.add_argument("--time-step", type=float, help="of both codes, in units of time (yr/2pi)")
    one.add_argument("--runs", type=int, default=3, help="CPU times are the least of so many")
    two = commands.add_parser("continue", help="goes on from a Simulationarchive", epilog="Example: continue archive.bin 1e4 --output runs/onward")
    two.add_argument("archive")
    two.add_argument("end_time", type=float, help="on the archive's clock")
    two.add_argument("--output", required=True, help="folder of the run")
    two.add_argument("--integrator", default="auto")
    two.add_argument("--snapshot", type=int, default=-1, help="index in the archive, the last if not given")
    two.add_argument("--time-step", type=float)
    two.add_argument("--every", type=float, help="time between snapshots")
    arguments = vars(parser.parse_args())
    command = arguments.pop("command")
    try:
        if command == "compare":
            compare(**arguments)
        else:
            done = continue_in_tridisk(**arguments)
            print(f"{done.output}: {len(done.snapshots)} snapshots, {done.timings['cpu_s']:.2f} s of CPU time")
    except (ValueError, OSError, ImportError, RuntimeError, TypeError) as error:
        print(f"tridisk: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
