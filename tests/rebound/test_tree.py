"""Tree gravity against REBOUND's tree: the same annulus of 1e5 planetesimals, error against the direct sum, CPU time a particle."""

import time

import numpy as np
import pytest
import rebound

import tridisk

M_EARTH = 3.0034896e-6
N = 100_000
TARGETS = 1000
RUNS = 3

SCENE = """
title = "annulus"
[run]
end_time = {end}
snapshots = "none"
time_step = {step}
write_accelerations = true
[initial]
file = "{file}"
[planetesimals]
integrator = "leapfrog"
collisions = {{ outcome = "none" }}
[gravity]
method = "tree"
force_error = {error}
"""


def annulus(n, seed=1):
    """Half to one and a half au, surface density a^-1.5, Rayleigh e 0.01 and i 0.005, ten Earth masses; positions alone."""
    rng = np.random.default_rng(seed)
    a = (0.5**0.5 + rng.random(n) * (1.5**0.5 - 0.5**0.5)) ** 2
    e, i = rng.rayleigh(0.01, n), rng.rayleigh(0.005, n)
    node, argument, mean = rng.random((3, n)) * 2 * np.pi
    anomaly = mean + e * np.sin(mean)
    for _ in range(10):
        anomaly -= (anomaly - e * np.sin(anomaly) - mean) / (1 - e * np.cos(anomaly))
    p, q = a * (np.cos(anomaly) - e), a * np.sqrt(1 - e * e) * np.sin(anomaly)
    u, w = p * np.cos(argument) - q * np.sin(argument), p * np.sin(argument) + q * np.cos(argument)
    x = u * np.cos(node) - w * np.cos(i) * np.sin(node)
    y = u * np.sin(node) + w * np.cos(i) * np.cos(node)
    return np.column_stack((x, y, w * np.sin(i))), np.full(n, 10 * M_EARTH / n)


def direct(x, m, targets):
    a = np.zeros((len(targets), 3))
    for k, i in enumerate(targets):
        d = x - x[i]
        r2 = (d * d).sum(1)
        r2[i] = np.inf
        a[k] = (m / (r2 * np.sqrt(r2))) @ d
    return a


def errors(a, exact):
    e = np.linalg.norm(a - exact, axis=1) / np.linalg.norm(exact, axis=1)
    return np.sqrt((e**2).mean()), np.percentile(e, 99)


def rebound_tree(x, m, theta):
    """Accelerations by REBOUND's tree and the CPU time of one evaluation, tree built anew: the least of several."""
    sim = rebound.Simulation()
    for mass, place in zip(m, x):
        sim.add(m=mass, x=place[0], y=place[1], z=place[2])
    sim.gravity = "tree"
    sim.root_size = 2.02 * np.abs(x).max()
    sim.opening_angle2 = theta * theta
    costs = []
    # Small angles take long: on a busy machine not more than what shows the order.
    while len(costs) < RUNS and sum(costs) < 10:
        start = time.process_time()
        rebound.clibrebound.reb_simulation_update_acceleration(rebound.simulation.byref(sim))
        costs.append(time.process_time() - start)
    return np.array([[p.ax, p.ay, p.az] for p in sim.particles]), min(costs)


def ours(tmp_path, x, m, error):
    """Accelerations by tridisk and the CPU time of one evaluation, the tree built anew each time: the mean of a run, the least of several runs."""
    file = tmp_path / "annulus.hdf5"
    tridisk.write(file, planetesimals={"Coordinates": x, "Velocities": np.zeros_like(x), "Masses": m,
                                       "ParticleIDs": np.arange(1, len(m) + 1, dtype="u8")})
    step = 1e-9
    scene = SCENE.format(end=8 * step, step=step, file=file, error=error).replace('snapshots = "none"', f"snapshots = {8 * step}")
    best = np.inf
    for k in range(RUNS):
        folder = tmp_path / f"run{error}-{k}"
        phases = tridisk.run(scene, folder)["phases"]
        evaluations = phases["gravity"]["targets"] / len(m)
        best = min(best, (phases["tree"]["cpu_s"] + phases["gravity"]["cpu_s"]) / evaluations)
    return tridisk.read(tridisk.snapshots(folder)[0], "planetesimals")["GravitationalAccelerations"], best


@pytest.fixture(scope="module")
def problem():
    """Positions, masses, a sample of the particles and the direct sum at it."""
    x, m = annulus(N)
    targets = np.sort(np.random.default_rng(7).choice(N, TARGETS, replace=False))
    return x, m, targets, direct(x, m, targets)


# REBOUND's opening angle, and the least ratio of CPU times: half of 18 and 11 as measured, and of 48 from REBOUND's 53 us on a quiet machine;
# on a busy one REBOUND's tree, which is not in the order of memory, loses more.
@pytest.mark.parametrize(("theta", "least"), [(0.2, 24.0), (0.5, 9.0), (0.8, 5.5)])
def test_the_tree_is_faster_than_rebounds_at_equal_error(tmp_path, problem, theta, least):
    x, m, targets, exact = problem
    a, cost = rebound_tree(x, m, theta)
    rms, p99 = errors(a[targets], exact)
    mine, my_cost = ours(tmp_path, x, m, float(f"{rms:.2e}"))
    my_rms, my_p99 = errors(mine[targets], exact)
    print(f"\nN = {N}: REBOUND tree, angle {theta}: rms {rms:.1e}, 99 % {p99:.1e}, {cost / N * 1e6:.2f} us a particle; "
          f"tridisk: rms {my_rms:.1e}, 99 % {my_p99:.1e}, {my_cost / N * 1e6:.2f} us; ratio {cost / my_cost:.1f}")
    assert my_rms <= rms
    assert cost / my_cost > least
