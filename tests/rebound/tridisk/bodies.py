"""Bodies on the way between tridisk's files and rebound.Simulation.

Files have G = 1. A simulation with another G keeps its lengths and masses; its times become t sqrt(G), its velocities v / sqrt(G).
"""

import os
import pathlib
import warnings

import h5py
import numpy as np

from .files import GROUPS, write

G_CGS = 6.6743e-8
ALL = 2**64 - 1  # REBOUND's N_active for "every particle"


def rebound_module():
    """The module rebound, version 5 or newer."""
    try:
        import rebound
    except ImportError as error:
        raise ImportError("REBOUND is not installed: pip install rebound==5.2.2") from error
    if int(rebound.__version__.split(".")[0]) < 5:
        raise ImportError(f"REBOUND {rebound.__version__} is too old, its names changed with version 5: pip install rebound==5.2.2")
    return rebound


def to_rebound(snapshot, names=None):
    """The star and the bodies of a snapshot, or of a file for `[initial] file`, as a rebound.Simulation with G = 1.

    Masses, radii, positions, velocities and the time are carried over to the last bit; units are those of the file (au, solar mass, yr/2pi
    are set where it says so; a scene in cgs keeps its G). The star comes first and is called "star", a body is called by its id:
    sim.particles["17"]; a dict `names` (id -> name) or a file written by `from_rebound` gives other names. Bodies without mass come last,
    as test particles (N_active). Left out, since REBOUND has no place for them: gas, dust, Spins, Densities, Compositions, Ages, softening.
    """
    rebound = rebound_module()
    sim = rebound.Simulation()
    with _opened(snapshot) as f:
        present = [name for name in ("star", "planetesimals") if GROUPS[name] in f]
        if not present:
            raise ValueError(f"{snapshot} has neither a star (PartType4) nor bodies (PartType1)")
        _set_units(sim, f, snapshot)
        time = _time(f)
        rows = [row for name in present for row in _rows(f[GROUPS[name]], name, names or {})]
    massive = [row for row in rows if row["m"] > 0 or row["name"] == "star"]
    massless = [row for row in rows if not (row["m"] > 0 or row["name"] == "star")]
    for row in massive + massless:
        sim.add(**row)
    if massless:
        sim.N_active = len(massive)
    sim.t = time
    return sim


def from_rebound(sim, path, star=0, snapshot=-1, time=None):
    """Writes a rebound.Simulation as a file for `[initial] file`; returns the path.

    `sim` may be a Simulationarchive too, as an object or a path: its `snapshot` (index), or the last one at or before `time`. `star` is the
    index or name of the star; None: all are bodies. Test particles (from N_active on) become massless. Ids are names that are whole numbers
    or hashes of other names, where all bodies have names and these differ; else 1..N in order. A G other than 1 is taken into times and
    velocities (see above), the time of the simulation is kept in Header/Time. The user's simulation is left as it is.
    """
    sim = simulation(sim, snapshot, time)
    _refuse(sim)
    columns, names = _columns(sim)
    # REBOUND's units of au, solar mass and yr/2pi have a G that is one but for rounding.
    if abs(sim.G - 1) > 4 * np.finfo(float).eps:
        columns["Velocities"] /= np.sqrt(sim.G)
        if None in sim.units.values():
            warnings.warn(f"G = {sim.G} and the simulation names no units: lengths and masses are kept, times multiplied by sqrt(G)", stacklevel=2)
    first = _star(sim, star, columns["Masses"])
    rows = np.array([i for i in range(sim.N) if i != first], dtype=int)
    columns["ParticleIDs"] = _ids(names, rows, first)
    populations = {"planetesimals": _chosen(columns, names, rows)} if len(rows) else {}
    if first is not None:
        populations["star"] = _chosen(columns, names, np.array([first]))
    write(path, **populations)
    with h5py.File(path, "a") as f:
        f.create_group("Header").attrs["Time"] = np.array([sim.t * time_factor(sim)])
    return path


def simulation(source, snapshot=-1, time=None):
    """A synchronized rebound.Simulation of a simulation, of a Simulationarchive, or of the path of one."""
    rebound = rebound_module()
    if isinstance(source, (str, os.PathLike)):
        if not pathlib.Path(source).is_file():
            raise FileNotFoundError(f"{source} is no file")
        try:
            source = rebound.Simulationarchive(os.fspath(source))
        except (RuntimeError, ValueError) as error:
            raise ValueError(f"{source} is no Simulationarchive that REBOUND {rebound.__version__} can read: {error}") from None
    if isinstance(source, rebound.Simulationarchive):
        source = _of_archive(source, snapshot, time)
    elif not isinstance(source, rebound.Simulation):
        raise TypeError(f"a {type(source).__name__} is neither a rebound.Simulation nor a Simulationarchive nor a path of one")
    elif not source.is_synchronized:
        source = source.copy()
    source.synchronize()
    return source


def time_factor(sim):
    """The file's times in those of the simulation: 1 for G = 1."""
    return np.sqrt(sim.G) if abs(sim.G - 1) > 4 * np.finfo(float).eps else 1.0


def test_particles_from(sim):
    """Index of the first test particle."""
    return sim.N if sim.N_active == ALL else min(sim.N_active, sim.N)


def elements(x, v, mu=1.0):
    """Semi-major axis, eccentricity and inclination of positions and velocities relative to the star."""
    h = np.cross(x, v)
    r = np.linalg.norm(x, axis=1)
    energy = 0.5 * (v**2).sum(1) - mu / r
    e = np.cross(v, h) / np.reshape(mu, (-1, 1)) - x / r[:, None]
    return -0.5 * mu / energy, np.linalg.norm(e, axis=1), np.arctan2(np.hypot(h[:, 0], h[:, 1]), h[:, 2])


def _of_archive(archive, snapshot, time):
    with warnings.catch_warnings():
        # Said of every archive without safe mode; it is synchronized below.
        warnings.filterwarnings("ignore", message="The simulation might not be synchronized")
        try:
            return archive[snapshot] if time is None else archive.getSimulation(time, keep_unsynchronized=0)
        except IndexError:
            raise ValueError(f"the archive has snapshots 0 to {len(archive) - 1}, not {snapshot}") from None
        except ValueError:
            raise ValueError(f"the archive has times {archive.tmin} to {archive.tmax}, not {time}") from None


def _opened(path):
    if not pathlib.Path(path).is_file():
        raise FileNotFoundError(f"{path} is no file")
    try:
        return h5py.File(path)
    except OSError:
        raise ValueError(f"{path} is no HDF5 file, so no snapshot") from None


def _time(f):
    return float(np.ravel(f["Header"].attrs["Time"])[0]) if "Header" in f and "Time" in f["Header"].attrs else 0.0


def _text(value):
    return value.decode() if isinstance(value, bytes) else str(value)


def _set_units(sim, f, path):
    import tomllib

    parameters = f["Parameters"].attrs if "Parameters" in f else {}
    system = _text(parameters.get("UnitSystem", ""))
    if system == "astronomical":
        sim.units = ("AU", "yr2pi", "Msun")
        sim.G = 1.0  # exactly, as in the file
    elif system == "cgs":
        sim.units = ("cm", "s", "g")
        sim.G = G_CGS
    else:
        gravity = tomllib.loads(_text(parameters.get("Scene", ""))).get("gravity", {})
        sim.G = gravity.get("constant", 1.0)
    if not sim.G > 0:
        raise ValueError(f"{path}: the scene has gravity.constant = {sim.G}; REBOUND needs a positive one")


def _rows(group, population, names):
    """Arguments of Simulation.add for a population, in the order of ids."""
    n = len(group["Masses"])
    ids = group["ParticleIDs"][:] if "ParticleIDs" in group else np.arange(1, n + 1)
    radii = group["Radii"][:] if "Radii" in group else np.zeros(n)
    own = [_text(name) for name in group["Names"][:]] if "Names" in group else [""] * n
    x, v, m = group["Coordinates"][:], group["Velocities"][:], group["Masses"][:]
    for i in np.argsort(ids):
        name = "star" if population == "star" else names.get(int(ids[i]), own[i] or str(ids[i]))
        place = dict(zip(("x", "y", "z", "vx", "vy", "vz"), map(float, (*x[i], *v[i])), strict=True))
        yield dict(m=float(m[i]), r=float(radii[i]), name=name, **place)


def _refuse(sim):
    if sim.N == 0:
        raise ValueError("the simulation has no particles")
    if sim.N_var_config > 0 or sim.N_var > 0:
        raise ValueError(f"the simulation has {sim.N_var} variational particles, which tridisk does not have: take a simulation without them")
    if not (np.isfinite(sim.G) and sim.G > 0):
        raise ValueError(f"the simulation has G = {sim.G}; tridisk needs a positive one")
    if sim.testparticle_type != 0 and test_particles_from(sim) < sim.N:
        raise ValueError("the simulation has test particles that pull (testparticle_type = 1), which tridisk does not have: set it to 0, or N_active to all")
    if sim.boundary not in ("none", "open"):
        raise ValueError(f"the simulation has a {sim.boundary} boundary; bodies go to an open domain alone")


def _columns(sim):
    n = sim.N
    m, r, x, v = np.zeros(n), np.zeros(n), np.zeros((n, 3)), np.zeros((n, 3))
    sim.serialize_particle_data(m=m, r=r, xyz=x, vxvyvz=v)
    for what, values in (("a mass", m), ("a radius", r), ("a position", x), ("a velocity", v)):
        wrong = np.flatnonzero(~np.isfinite(values.reshape(n, -1)).all(1))
        if len(wrong):
            raise ValueError(f"particle {wrong[0]} has {what} that is not finite")
    tests = test_particles_from(sim)
    if (m[tests:] != 0).any():
        warnings.warn(f"{np.count_nonzero(m[tests:])} test particles have masses, which pull nobody: they are written without", stacklevel=3)
        m[tests:] = 0.0
    names = [p.name for p in sim.particles]
    known = [name for name in names if name]
    if len(set(known)) < len(known):
        # REBOUND itself mixes up names of some archives that it loads (5.2.2), so none of them can be relied on.
        warnings.warn("names occur twice in the simulation: its bodies are numbered from 1 and lose their names", stacklevel=3)
        names = [None] * len(names)
    return {"Masses": m, "Radii": r, "Coordinates": x, "Velocities": v}, names


def _star(sim, star, m):
    """Index of the star."""
    if star is None or star is False:
        return None
    if isinstance(star, str):
        found = [i for i, p in enumerate(sim.particles) if p.name == star]
        if not found:
            raise ValueError(f'no particle is called "{star}"')
        return found[0]
    if not -sim.N <= star < sim.N:
        raise ValueError(f"the simulation has {sim.N} particles, so none has the index {star}")
    star = int(star) % sim.N
    if not m[star] > 0 or m[star] < m.max():
        raise ValueError(f"particle {star} has the mass {m[star]}, the heaviest {m.max()}: say which is the star (star = index or name), or star = None")
    return star


def _ids(names, rows, star):
    """Ids of all particles: of the bodies by name where that is possible, of the star 0."""
    from ctypes import c_char_p, c_uint32

    library = rebound_module().clibrebound
    library.reb_hash.restype = c_uint32

    def number(name):
        whole = name.isascii() and name.isdigit() and int(name) < 2**63 and str(int(name)) == name
        return int(name) if whole else library.reb_hash(c_char_p(name.encode()))

    ids = np.zeros(len(names), dtype="u8")
    chosen = [number(names[i]) for i in rows if names[i]]
    unique = len(chosen) == len(rows) and len(set(chosen)) == len(rows) and 0 not in chosen
    ids[rows] = chosen if unique else np.arange(1, len(rows) + 1)
    return ids


def _chosen(columns, names, rows):
    chosen = {name: values[rows] for name, values in columns.items()}
    if any(names[i] for i in rows):
        chosen["Names"] = np.array([(names[i] or "").encode() for i in rows])
    return chosen
