"""Scenes and snapshots: runs of the program, files for `[initial] file`, and what a run has written."""

import json
import os
import pathlib
import subprocess

import h5py
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[3]
GROUPS = {"gas": "PartType0", "planetesimals": "PartType1", "dust": "PartType2", "star": "PartType4"}


def program():
    """Path of the release build of tridisk."""
    target = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    path = target / "release" / "tridisk"
    if not path.exists():
        raise FileNotFoundError(f"{path} is missing: cargo build --release builds it")
    return str(path)


def run(scene, output, *arguments, threads=1):
    """Runs the scene (TOML text, or the pathlib.Path of a file) with `output` as its folder; returns the folder's timings."""
    output = pathlib.Path(output)
    file = scene
    if not isinstance(scene, pathlib.Path):
        file = output.with_suffix(".toml")
        file.write_text(scene)
    command = [program(), "run", str(file), "--output", str(output), "--threads", str(threads), "--quiet", *arguments]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"tridisk ended with status {done.returncode}: {done.stderr.strip()}")
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
