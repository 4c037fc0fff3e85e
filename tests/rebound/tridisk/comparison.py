"""The same bodies through tridisk and through REBOUND: how far they agree, and what each costs."""

import dataclasses
import pathlib
import tempfile
import time as clock
import tomllib

import numpy as np

from . import continuation
from .bodies import elements, rebound_module, simulation, to_rebound
from .files import run, snapshots


@dataclasses.dataclass
class Comparison:
    """Largest differences over the bodies that both codes have at the end, and the error of energy and CPU time of each."""

    bodies: int
    time: float
    time_step: float | None
    integrators: tuple
    position: float  # relative to the distance from the star
    semi_major_axis: float  # relative
    eccentricity: float
    inclination: float
    energy_error: float
    rebound_energy_error: float
    cpu_s: float
    rebound_cpu_s: float
    missing: int  # bodies that one code alone has at the end

    @property
    def ratio(self):
        """CPU time of REBOUND in that of tridisk."""
        return self.rebound_cpu_s / self.cpu_s

    def __str__(self):
        ours, theirs = self.integrators
        step = "" if self.time_step is None else f", step {self.time_step:.4g}"
        return "\n".join(
            [
                f"{self.bodies} bodies to time {self.time:.6g}{step}; tridisk {ours}, REBOUND {theirs}",
                f"largest differences: position {self.position:.1e}, a {self.semi_major_axis:.1e} (relative), e {self.eccentricity:.1e}, i {self.inclination:.1e} rad",
                f"energy error: tridisk {self.energy_error:.1e}, REBOUND {self.rebound_energy_error:.1e}",
                f"CPU time: tridisk {self.cpu_s:.3f} s, REBOUND {self.rebound_cpu_s:.3f} s, ratio {self.ratio:.2f}",
            ]
            + ([f"{self.missing} bodies are left in one code alone"] if self.missing else [])
        )


def compare(start, integrator=None, rebound_integrator=None, *, years=None, time_step=None, runs=1, output=None, quiet=False):
    """Runs the same bodies through both codes without collisions, prints and returns their agreement as a Comparison.

    `start` is a scene (.toml) with bodies alone, a snapshot or start file (.hdf5), a Simulationarchive (path or object) or a simulation.
    `integrator` is tridisk's or REBOUND's name (a scene's own if None, else "wisdom-holman"), `rebound_integrator` the nearest of REBOUND's
    if None. `years` are 2 pi units of time with G = 1 (a scene's end_time if None, else 10). The step is that given, or the scene's, or the
    archive's dt, or 1/60 of the shortest period, for both codes alike. CPU times are the least of `runs`, tridisk's without its files. Agreement
    to rounding is to be expected where both codes have the same map: in Jacobi coordinates with all bodies massive, and for "gauss-radau".
    """
    rebound_module()
    with tempfile.TemporaryDirectory() as folder:
        output = pathlib.Path(output or pathlib.Path(folder) / "run")
        text, sim, name, end, step = _prepared(start, integrator, years, time_step, pathlib.Path(folder))
        cpu = []
        for k in range(runs):
            place = output if k == 0 else output.with_name(f"{output.name}-{k}")
            timings = run(text, place)
            cpu.append(timings["cpu_s"] - timings["phases"]["output"]["cpu_s"])
        files = snapshots(output)
        first, last = to_rebound(files[0]), to_rebound(files[-1])
    rebound_name, theirs, rebound_cpu = _by_rebound(first, name, rebound_integrator, last.t, step, sim.softening, runs)
    result = _difference(first, last, theirs, sim.softening)
    result = Comparison(
        bodies=first.N - 1, time=last.t, time_step=step, integrators=(name, rebound_name), cpu_s=min(cpu), rebound_cpu_s=rebound_cpu, **result
    )
    if not quiet:
        print(result)
    return result


def _prepared(start, integrator, years, step, folder):
    """Text of the scene, a simulation of its start, tridisk's name of the integrator, end and step (None where steps are chosen)."""
    end = None if years is None else 2 * np.pi * years
    suffix = pathlib.Path(start).suffix if isinstance(start, (str, pathlib.Path)) else ""
    if suffix == ".toml":
        sim, found, scene_end, scene_step = _of_scene(pathlib.Path(start), folder)
        name, end, step = integrator or found, end or scene_end, step or scene_step
    elif suffix == ".hdf5":
        sim, name = to_rebound(start), integrator or "wisdom-holman"
    else:
        sim, name = simulation(start), integrator or "wisdom-holman"
        step = step or sim.dt * continuation.time_factor(sim)
    name = continuation.own_name(name)
    if name == "auto":
        name = "wisdom-holman"
    end = end or 20 * np.pi
    file = continuation.from_rebound(sim, folder / "start.hdf5")
    begin = to_rebound(file)
    if begin.N < 2:
        raise ValueError(f"{start} has no bodies beside its star")
    begin.softening = sim.softening
    if name not in continuation.FIXED_STEP:
        step = None
    elif not step:
        step = min(p.P for p in begin.orbits() if p.P > 0) / 60
    if step:
        # Both codes end at a whole number of equal steps.
        step = end / np.ceil(end / step * (1 - 1e-12))
    return continuation.scene(begin, file, end, None, name, step, "none"), begin, name, end, step


def _of_scene(path, folder):
    """The start of a scene by tridisk itself, its integrator, end and step."""
    if not path.is_file():
        raise FileNotFoundError(f"{path} is no file")
    output = folder / "scene"
    try:
        end = tomllib.loads(path.read_text())["run"]["end_time"]
    except (tomllib.TOMLDecodeError, KeyError, TypeError) as error:
        raise ValueError(f"{path} is no scene with a run.end_time: {error}") from None
    # Written back as a number, the end in place of the interval of snapshots says how long it is in the scene's units.
    run(path.resolve(), output, "--end-time", "1e-9", "--set", f"run.snapshots={end!r}".replace("'", '"'))
    resolved = tomllib.loads((output / "scene.toml").read_text())
    sim = to_rebound(snapshots(output)[0])
    bodies = resolved.get("planetesimals", {})
    sim.softening = np.sqrt(2) * bodies.get("softening", 0.0)
    for table in ("gas", "dust", "surroundings"):
        if table in resolved:
            raise ValueError(f"{path} has [{table}]; REBOUND is compared by bodies alone")
    if "star" not in resolved:
        raise ValueError(f"{path} has no [star]; orbits are compared about one")
    name = bodies.get("integrator", "wisdom-holman")
    if bodies.get("coordinates") == "jacobi":
        name = "jacobi"
    step = bodies.get("time_step", "auto")
    factor = continuation.time_factor(sim)
    return sim, name, factor * resolved["run"]["snapshots"], None if step == "auto" else factor * step


def _by_rebound(first, name, wanted, end, step, softening, runs):
    """REBOUND's name of the integrator, its simulation at the end, and its CPU time."""
    default, coordinates = continuation.PAIRS[name]
    chosen = wanted or default
    best = np.inf
    for _ in range(runs):
        sim = first.copy()
        sim.softening = softening
        sim.integrator = chosen
        if chosen == "whfast":
            sim.integrator.coordinates = coordinates or "jacobi"
            sim.integrator.safe_mode = 0
        if step:
            sim.dt = step
        begin = clock.process_time()
        sim.integrate(end, exact_finish_time=1)
        sim.synchronize()
        best = min(best, clock.process_time() - begin)
    return chosen, sim, best


def _difference(first, ours, theirs, softening):
    def table(sim):
        sim.softening = softening
        m, x, v = np.zeros(sim.N), np.zeros((sim.N, 3)), np.zeros((sim.N, 3))
        sim.serialize_particle_data(m=m, xyz=x, vxvyvz=v)
        return {p.name: i for i, p in enumerate(sim.particles)}, m, x - x[0], v - v[0], sim.energy()

    energy = table(first)[-1]
    mine, m, x, v, e = table(ours)
    other, _, X, V, E = table(theirs)
    common = [name for name in mine if name in other and name != "star"]
    i, j = [mine[name] for name in common], [other[name] for name in common]
    mu = ours.G * (m[0] + m[i])
    (a, ecc, inc), (A, ECC, INC) = elements(x[i], v[i], mu), elements(X[j], V[j], mu)
    return {
        "position": (np.linalg.norm(x[i] - X[j], axis=1) / np.linalg.norm(X[j], axis=1)).max(),
        "semi_major_axis": np.abs(a / A - 1).max(),
        "eccentricity": np.abs(ecc - ECC).max(),
        "inclination": np.abs(inc - INC).max(),
        "energy_error": abs(e / energy - 1),
        "rebound_energy_error": abs(E / energy - 1),
        "missing": len(set(mine) ^ set(other)),
    }
