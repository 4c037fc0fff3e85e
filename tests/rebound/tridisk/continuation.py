"""From a Simulationarchive on with tridisk: file, scene and run in one call."""

import dataclasses
import pathlib

import h5py
import numpy as np

from .bodies import from_rebound, simulation, time_factor, to_rebound
from .files import run, snapshots

# Integrators of tridisk and those of REBOUND that are nearest to them, with their coordinates.
PAIRS = {
    "wisdom-holman": ("whfast", "democraticheliocentric"),
    "jacobi": ("whfast", "jacobi"),
    "hybrid": ("mercurius", None),
    "gauss-radau": ("ias15", None),
    "leapfrog": ("leapfrog", None),
    "hermite": ("ias15", None),
}
# What REBOUND's names mean here.
MEANT = {"whfast": "jacobi", "mercurius": "hybrid", "trace": "hybrid", "ias15": "gauss-radau"}
FIXED_STEP = ("wisdom-holman", "jacobi", "hybrid", "leapfrog")

SCENE = """
title = "bodies of REBOUND"
[run]
end_time = {end}
snapshots = {every}
[units]
system = "{units}"
[initial]
file = {file}
{star}
[planetesimals]
{keys}
softening = {softening}
collisions = {{ outcome = "{collisions}" }}
[gravity]
method = "direct"
"""


@dataclasses.dataclass
class Continuation:
    """A run of tridisk that went on from a REBOUND simulation."""

    output: pathlib.Path
    timings: dict
    start: float  # the simulation's clock at the start
    G: float
    units: dict
    names: dict

    @property
    def snapshots(self):
        """The files of the run, in order."""
        return snapshots(self.output)

    def simulation(self, snapshot=-1):
        """A snapshot as a rebound.Simulation with the G, the names and the clock of the simulation that the run started from."""
        sim = to_rebound(self.snapshots[snapshot], self.names)
        factor = np.sqrt(self.G) if self.G != 1 else 1.0
        if None not in self.units.values():
            sim.update_units((self.units["length"], self.units["time"], self.units["mass"]))
        sim.G = self.G
        for p in sim.particles:
            p.vx, p.vy, p.vz = p.vx * factor, p.vy * factor, p.vz * factor
        sim.t = self.start + sim.t / factor
        return sim


def continue_in_tridisk(
    archive, end_time, output, *, integrator="auto", snapshot=-1, time=None, star=0, time_step=None, every=None, collisions="none", threads=1
):
    """Takes a Simulationarchive (path or object) or a simulation, and goes on in tridisk until `end_time`; returns a Continuation.

    `end_time`, `every` (between snapshots) and `time_step` are in the units and on the clock of the archive, as in sim.integrate. `integrator`
    is tridisk's name or the nearest of REBOUND's ("whfast" means Jacobi coordinates); the step of integrators that need one is the
    simulation's dt unless given. `output` is the folder of the run; beside it stand its scene, OUTPUT.toml, and its start, OUTPUT.start.hdf5,
    to change and run again. Softening is carried over. Additional forces (REBOUNDx) are not: an archive does not hold them.
    """
    sim = simulation(archive, snapshot, time)
    if not end_time > sim.t:
        raise ValueError(f"end_time = {end_time} is not after the time of the simulation, {sim.t}")
    output = pathlib.Path(output).resolve()
    if (output / "scene.toml").exists():
        raise FileExistsError(f"{output} holds an earlier run: give another folder")
    output.parent.mkdir(parents=True, exist_ok=True)
    file = from_rebound(sim, output.with_name(output.name + ".start.hdf5"), star)
    factor = time_factor(sim)
    end, every, step = (factor * t if t else None for t in (end_time - sim.t, every, time_step or sim.dt))
    text = scene(sim, file, end, every, integrator, step, collisions)
    timings = run(text, output, threads=threads)
    with h5py.File(file) as f:
        bodies = f["PartType1"] if "PartType1" in f else {}
        names = {int(i): name.decode() for i, name in zip(bodies["ParticleIDs"][:], bodies["Names"][:])} if "Names" in bodies else {}
    names = {i: name for i, name in names.items() if name}
    return Continuation(output, timings, sim.t, sim.G if factor != 1 else 1.0, sim.units, names)


def scene(sim, file, end, every, integrator, step, collisions):
    """TOML text of a scene that starts from `file`, which was written of `sim`; times are those of the file."""
    with h5py.File(file) as f:
        star = f"[star]\nmass = {float(f['PartType4/Masses'][0])!r}" if "PartType4" in f else ""
        if star and collisions != "none":
            star += f"\naccretion_radius = {float(f['PartType4/Radii'][0])!r}"
    known = sim.units["length"] == "au" and sim.units["mass"] == "msun"
    return SCENE.format(
        end=float(end),
        every=float(every or end),
        # Without names of units numbers stay numbers, with G = 1.
        units="astronomical" if known else "dimensionless",
        file=f'"{pathlib.Path(file).resolve()}"',
        star=star,
        keys="\n".join(f"{key} = {value}" for key, value in keys(integrator, step).items()),
        # Lengths of both partners add in quadrature here; REBOUND has one length for the pair.
        softening=float(sim.softening) / np.sqrt(2),
        collisions=collisions,
    )


def own_name(integrator):
    """tridisk's name of an integrator of either code."""
    name = MEANT.get(integrator, integrator)
    if name not in PAIRS and name != "auto":
        raise ValueError(f'no integrator is called "{integrator}": tridisk has {", ".join(PAIRS)} and auto; of REBOUND\'s {", ".join(MEANT)} are understood')
    return name


def keys(integrator, step):
    """Keys of [planetesimals] for an integrator of either code."""
    name = own_name(integrator)
    keys = {"integrator": '"wisdom-holman"' if name == "jacobi" else f'"{name}"'}
    if name == "jacobi":
        keys["coordinates"] = '"jacobi"'
    if name in FIXED_STEP and step:
        keys["time_step"] = float(step)
    return keys
