"""Orbits against REBOUND: the same initial conditions through a scene file and through rebound."""

import numpy as np
import pytest
import rebound

import tridisk

SCENE = """
title = "{title}"
[run]
end_time = {end}
snapshots = {every}
{step}
[star]
mass = 1.0
[initial]
file = "{file}"
[planetesimals]
integrator = "{integrator}"
softening = {softening}
collisions = {{ outcome = "none" }}
[gravity]
method = "{method}"
{accuracy}
"""


def five_bodies():
    """The Sun and the four giant planets (masses and elements rounded), in the centre-of-mass frame."""
    sim = rebound.Simulation()
    sim.add(m=1.0)
    sim.add(m=9.55e-4, a=5.203, e=0.048, inc=0.0228, Omega=1.75, omega=4.78, M=0.35)
    sim.add(m=2.86e-4, a=9.537, e=0.054, inc=0.0434, Omega=1.98, omega=5.92, M=5.53)
    sim.add(m=4.37e-5, a=19.19, e=0.047, inc=0.0135, Omega=1.29, omega=1.69, M=2.48)
    sim.add(m=5.18e-5, a=30.07, e=0.0086, inc=0.0309, Omega=2.30, omega=4.77, M=4.47)
    sim.move_to_com()
    return sim


def test_five_bodies_over_100_orbits_agree_to_1e_9(tmp_path):
    sim = five_bodies()
    end = 100 * sim.particles[1].P
    file = tridisk.from_rebound(sim, tmp_path / "start.hdf5")
    scene = SCENE.format(title="five bodies", end=end, every='"none"', step="", file=file, integrator="gauss-radau", softening=0.0,
                         method="direct", accuracy="").replace('snapshots = "none"', f"snapshots = {end}")
    tridisk.run(scene, tmp_path / "run")
    sim.integrator = "ias15"
    sim.integrate(end)
    last = tridisk.snapshots(tmp_path / "run")[-1]
    ours = np.concatenate([tridisk.read(last, name)["Coordinates"] for name in ("star", "planetesimals")])
    theirs = np.array([[p.x, p.y, p.z] for p in sim.particles])
    # Relative to the distance from the star; the star itself to that of Jupiter.
    scale = np.maximum(np.linalg.norm(theirs - theirs[0], axis=1), 5.2)
    error = np.linalg.norm(ours - theirs, axis=1) / scale
    print(f"five bodies, 100 orbits: largest relative difference {error.max():.2e}")
    assert error.max() < 1e-9


def swarm(seed, n=1000, mass=2e-8):
    """Equal-mass planetesimals around 1 au on nearly circular orbits, heliocentric elements."""
    rng = np.random.default_rng(seed)
    sim = rebound.Simulation()
    sim.add(m=1.0)
    for _ in range(n):
        angles = rng.random(3) * 2 * np.pi
        sim.add(m=mass, a=rng.uniform(0.95, 1.05), e=rng.rayleigh(1e-3), inc=rng.rayleigh(5e-4), Omega=angles[0],
                omega=angles[1], M=angles[2], primary=sim.particles[0])
    sim.move_to_com()
    return sim


SOFTENING = 1e-3
ORBITS = 10
STEP = 2 * np.pi / 64


def spread(x, v, star_x, star_v):
    _, e, i = tridisk.elements(x - star_x, v - star_v)
    return np.sqrt((e**2).mean()), np.sqrt((i**2).mean())


@pytest.fixture(scope="module")
def growth(tmp_path_factory):
    """rms e and i after ORBITS orbits, by both codes from the same starts: arrays [seed, (e, i)]."""
    ours, theirs, start = [], [], []
    for seed in range(5):
        folder = tmp_path_factory.mktemp(f"swarm{seed}")
        sim = swarm(seed)
        file = tridisk.from_rebound(sim, folder / "start.hdf5")
        p = np.array([[p.x, p.y, p.z, p.vx, p.vy, p.vz] for p in sim.particles])
        start.append(spread(p[1:, :3], p[1:, 3:], p[0, :3], p[0, 3:]))
        end = ORBITS * 2 * np.pi
        # Plummer lengths of both partners add in quadrature here; rebound has one length for the pair.
        scene = SCENE.format(title="swarm", end=end, every=end, step=f"time_step = {STEP}", file=file, integrator="wisdom-holman",
                             softening=SOFTENING / np.sqrt(2), method="tree", accuracy="force_error = 1e-3")
        tridisk.run(scene, folder / "run")
        last = tridisk.snapshots(folder / "run")[-1]
        star, bodies = tridisk.read(last, "star"), tridisk.read(last, "planetesimals")
        ours.append(spread(bodies["Coordinates"], bodies["Velocities"], star["Coordinates"], star["Velocities"]))
        sim.integrator = "whfast"
        sim.integrator.coordinates = "democraticheliocentric"
        sim.softening = SOFTENING
        sim.dt = STEP
        sim.integrate(end, exact_finish_time=1)
        p = np.array([[p.x, p.y, p.z, p.vx, p.vy, p.vz] for p in sim.particles])
        theirs.append(spread(p[1:, :3], p[1:, 3:], p[0, :3], p[0, 3:]))
    return np.array(start), np.array(ours), np.array(theirs)


def test_a_swarm_is_stirred_as_by_rebound(growth):
    start, ours, theirs = growth
    grown, expected = ours - start, theirs - start
    print(f"growth of rms e, i over {ORBITS} orbits: tridisk {grown.mean(0)}, rebound {expected.mean(0)}, "
          f"spread between seeds {expected.std(0, ddof=1)}")
    # Stirred at all, by much more than the spread between seeds: otherwise the comparison would be empty.
    assert (expected.mean(0) > 3 * expected.std(0, ddof=1)).all()
    # Same seeds, chaotic orbits: the means differ by no more than two standard errors of the ensemble.
    error = np.abs(grown.mean(0) - expected.mean(0)) / (expected.std(0, ddof=1) * np.sqrt(2 / len(start)))
    assert (error < 2).all()
