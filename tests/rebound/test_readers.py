"""Snapshots in the hands of h5py, yt, swiftsimio and pynbody: whole, with the right units, coordinates as they are."""

import numpy as np
import pytest

import tridisk

AU, MSUN = 1.495978707e13, 1.98841e33

SCENE = """
title = "a small disk"
[run]
end_time = "0.01 yr"
snapshots = "0.01 yr"
[star]
mass = "1 Msun"
accretion_radius = "0.1 au"
[gas]
particles = 2000
[gas.disk]
surface_density = "1700 g/cm^2"
inner_radius = "0.7 au"
outer_radius = "1.3 au"
[gas.eos]
kind = "locally-isothermal"
aspect_ratio = 0.07
[dust]
particles = 500
dust_to_gas = 0.01
size = "1 cm"
[planetesimals]
number = 100
total_mass = "0.1 Mearth"
inner_radius = "0.8 au"
outer_radius = "1.2 au"
"""


@pytest.fixture(scope="module")
def snapshot(tmp_path_factory):
    folder = tmp_path_factory.mktemp("disk") / "run"
    tridisk.run(SCENE, folder)
    return tridisk.snapshots(folder)[-1]


def test_a_snapshot_has_every_population_with_its_datasets(snapshot):
    gas, dust = tridisk.read(snapshot, "gas"), tridisk.read(snapshot, "dust")
    bodies, star = tridisk.read(snapshot, "planetesimals"), tridisk.read(snapshot, "star")
    assert [len(p["Masses"]) for p in (gas, dust, bodies, star)] == [2000, 500, 100, 1]
    for name in ("InternalEnergies", "Densities", "SmoothingLengths", "Pressures", "Temperatures", "ViscosityParameters"):
        assert np.isfinite(gas[name]).all() and (name == "ViscosityParameters" or (gas[name] > 0).all()), name
    for name in ("GrainRadii", "GrainDensities", "SwarmNumbers", "StoppingTimes", "StokesNumbers", "GasDensities"):
        assert (dust[name] > 0).all(), name
    assert (bodies["Radii"] > 0).all() and (bodies["Densities"] > 0).all()
    # A swarm holds so many grains that their masses are the superparticle's; 280 K at 1 au for H/R = 0.033, (0.07/0.033)^2 more here.
    grain = 4 / 3 * np.pi * dust["GrainRadii"] ** 3 * dust["GrainDensities"]
    np.testing.assert_allclose(grain * dust["SwarmNumbers"], dust["Masses"], rtol=1e-12)
    radius = np.hypot(*gas["Coordinates"][:, :2].T)
    near = np.abs(radius - 1) < 0.02
    assert abs(gas["Temperatures"][near].mean() / (280 * (0.07 / 0.033) ** 2) - 1) < 0.1


def test_yt_opens_all_particles_with_the_right_units(snapshot):
    yt = pytest.importorskip("yt")
    yt.set_log_level("error")
    ds = tridisk.yt_load(snapshot)
    gas = tridisk.read(snapshot, "gas")
    data = ds.all_data()
    assert len(data["PartType0", "Mass"]) == len(gas["Masses"])
    total = float(data["PartType0", "Mass"].sum().to("g"))
    assert abs(total / (gas["Masses"].sum() * MSUN) - 1) < 1e-3
    x = np.sort(np.asarray(data["PartType0", "Coordinates"].to("cm"))[:, 0])
    np.testing.assert_allclose(x, np.sort(gas["Coordinates"][:, 0]) * AU, rtol=1e-4)


def test_swiftsimio_opens_it_with_the_right_units(snapshot):
    swiftsimio = pytest.importorskip("swiftsimio")
    data = swiftsimio.load(str(snapshot))
    gas = tridisk.read(snapshot, "gas")
    assert abs(float(data.gas.masses.sum().to("g")) / (gas["Masses"].sum() * MSUN) - 1) < 1e-3
    np.testing.assert_allclose(np.sort(np.asarray(data.gas.coordinates.to("cm"))[:, 1]), np.sort(gas["Coordinates"][:, 1]) * AU, rtol=1e-4)


def test_pynbody_opens_it_with_the_right_units(snapshot):
    pynbody = pytest.importorskip("pynbody")
    data = pynbody.load(str(snapshot))
    gas = tridisk.read(snapshot, "gas")
    assert len(data.gas) == len(gas["Masses"])
    assert abs(float(data.gas["mass"].in_units("g").sum()) / (gas["Masses"].sum() * MSUN) - 1) < 1e-3
