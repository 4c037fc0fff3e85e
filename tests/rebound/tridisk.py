"""tridisk from Python: write initial conditions, run scenes, read snapshots, and carry bodies to and from REBOUND.

Units are those of the scene; bodies need G = 1 (au, solar mass, yr/2pi) to travel between the two codes.
"""

import json
import os
import pathlib
import subprocess

import h5py
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
GROUPS = {"gas": "PartType0", "planetesimals": "PartType1", "dust": "PartType2", "star": "PartType4"}


def program():
    """Path of the release build of tridisk."""
    target = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    path = target / "release" / "tridisk"
    if not path.exists():
        raise FileNotFoundError(f"{path} is missing: cargo build --release builds it")
    return str(path)


def run(scene, output, *arguments, threads=1):
    """Runs the scene (TOML text) with `output` as its folder; returns the folder's timings."""
    output = pathlib.Path(output)
    file = output.with_suffix(".toml")
    file.write_text(scene)
    command = [program(), "run", str(file), "--output", str(output), "--threads", str(threads), "--quiet", *arguments]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"tridisk ended with status {done.returncode}: {done.stderr}")
    return json.loads((output / "timings.json").read_text())


def write(path, **populations):
    """Writes a file that `[initial] file` reads. Each population is a dict of arrays by dataset name (N or N x 3)."""
    with h5py.File(path, "w") as f:
        for name, columns in populations.items():
            group = f.create_group(GROUPS[name])
            for dataset, values in columns.items():
                group[dataset] = np.ascontiguousarray(values)


def snapshots(output):
    """The snapshots of a run's folder, in order."""
    return sorted(pathlib.Path(output).glob("snapshot_*.hdf5"))


def read(snapshot, population):
    """A population of a snapshot as a dict of arrays, in the order of ParticleIDs; with the time as "Time"."""
    with h5py.File(snapshot) as f:
        group = f[GROUPS[population]]
        order = np.argsort(group["ParticleIDs"][:])
        columns = {name: group[name][:][order] for name in group}
        columns["Time"] = float(np.ravel(f["Header"].attrs["Time"])[0])
    return columns


def to_rebound(snapshot):
    """The star and all bodies of a snapshot as a rebound.Simulation, the star first."""
    import rebound

    sim = rebound.Simulation()
    with h5py.File(snapshot) as f:
        names = [GROUPS[name] for name in ("star", "planetesimals") if GROUPS[name] in f]
    for name, group in GROUPS.items():
        if group in names and name == "star":
            _add(sim, read(snapshot, name))
    if GROUPS["planetesimals"] in names:
        _add(sim, read(snapshot, "planetesimals"))
    with h5py.File(snapshot) as f:
        sim.t = float(np.ravel(f["Header"].attrs["Time"])[0])
    return sim


def _add(sim, bodies):
    radii = bodies.get("Radii", np.zeros(len(bodies["Masses"])))
    for m, r, x, v in zip(bodies["Masses"], radii, bodies["Coordinates"], bodies["Velocities"]):
        sim.add(m=m, r=r, x=x[0], y=x[1], z=x[2], vx=v[0], vy=v[1], vz=v[2])


def from_rebound(sim, path, star=True):
    """Writes the bodies of a rebound.Simulation for `[initial] file`; the first is the star unless `star` is False."""
    rows = np.array([[p.m, p.r, p.x, p.y, p.z, p.vx, p.vy, p.vz] for p in sim.particles])

    def columns(rows, first):
        return {
            "Masses": rows[:, 0],
            "Radii": rows[:, 1],
            "Coordinates": rows[:, 2:5],
            "Velocities": rows[:, 5:8],
            "ParticleIDs": np.arange(first, first + len(rows), dtype="u8"),
        }

    populations = {"planetesimals": columns(rows[int(star):], 1)}
    if star:
        populations["star"] = columns(rows[:1], 0)
    write(path, **populations)
    return path


def yt_load(snapshot):
    """Opens a snapshot with yt, whole: yt drops what lies outside [0, BoxSize], so an open scene gets a box around all its particles."""
    import yt

    lo, hi = np.full(3, np.inf), np.full(3, -np.inf)
    with h5py.File(snapshot) as f:
        size = np.ravel(f["Header"].attrs["BoxSize"]) * np.ones(3)
        for group in GROUPS.values():
            if group in f:
                x = f[group]["Coordinates"][:]
                lo, hi = np.minimum(lo, x.min(0)), np.maximum(hi, x.max(0))
    ds = yt.load(str(snapshot))
    if (lo < 0).any() or (hi > size).any():
        # Before anything has been read: the box that yt looks in, in the file's units.
        margin = 1e-3 * (hi - lo).max()
        ds.domain_left_edge = ds.arr(lo - margin, "code_length")
        ds.domain_right_edge = ds.arr(hi + margin, "code_length")
        ds.domain_width = ds.domain_right_edge - ds.domain_left_edge
        ds.domain_center = 0.5 * (ds.domain_left_edge + ds.domain_right_edge)
    return ds


def elements(x, v, mu=1.0):
    """Semi-major axis, eccentricity and inclination of positions and velocities relative to the star."""
    h = np.cross(x, v)
    r = np.linalg.norm(x, axis=1)
    energy = 0.5 * (v**2).sum(1) - mu / r
    e = np.cross(v, h) / mu - x / r[:, None]
    return -0.5 * mu / energy, np.linalg.norm(e, axis=1), np.arccos(np.clip(h[:, 2] / np.linalg.norm(h, axis=1), -1, 1))
