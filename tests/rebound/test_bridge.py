"""Bodies from REBOUND to tridisk and back: bits, names, test particles, units, archives, and refusals in a sentence."""

import subprocess
import sys
import warnings

import numpy as np
import pytest
import rebound

import tridisk

# Twice what was measured: rounding, which grows along the orbits.
BARS = {
    "archive": {"ias15": 6e-14, "whfast": 1.6e-12},
    "test particles": 6e-14,
    "G": 6e-14,
    "velocities, G": 1.8e-12,
    "compare": dict(position=1.4e-12, semi_major_axis=2.3e-15, eccentricity=5e-15, inclination=3.5e-16, energy_error=1.4e-15, rebound_energy_error=1.4e-15),
}


def planets(g=1.0, units=None):
    """A star, two planets with names, a body by number, and two test particles; awkward digits, centre of mass at rest."""
    sim = rebound.Simulation()
    if units:
        sim.units = units
    sim.G = g
    sim.add(m=1.0000003, r=0.00465, name="Sun")
    sim.add(m=9.55e-4, r=4.8e-4, a=1.1, e=0.048, inc=0.0228, Omega=1.75, omega=4.78, M=0.35, name="Jupiter")
    sim.add(m=2.86e-4, r=3.9e-4, a=2.03, e=0.054, inc=0.0434, Omega=1.98, omega=5.92, M=5.53, name="Saturn")
    sim.add(m=1e-9, r=1e-5, a=4.1, e=0.1, M=1.0, name="17")
    sim.add(a=0.31, e=0.2, inc=0.3, M=2.0, name="near")
    sim.add(a=7.3, e=0.1, inc=0.1, M=4.0, name="far")
    sim.N_active = 4
    sim.move_to_com()
    return sim


def state(sim):
    """All numbers of a simulation's particles by name."""
    return {p.name: (p.m, p.r, p.x, p.y, p.z, p.vx, p.vy, p.vz) for p in sim.particles}


def places(sim, names):
    return np.array([sim.particles[name].xyz for name in names])


NAMES = ("Jupiter", "Saturn", "17", "near", "far")


def test_bodies_come_back_from_a_file_with_the_same_bits_and_names(tmp_path):
    sim = planets()
    sim.t = 123.456
    back = tridisk.to_rebound(tridisk.from_rebound(sim, tmp_path / "start.hdf5"))
    star = state(sim).pop("Sun")
    assert state(back).pop("star") == star
    assert {name: state(back)[name] for name in NAMES} == {name: state(sim)[name] for name in NAMES}
    assert (back.N, back.N_active, back.G, back.t) == (6, 4, 1.0, 123.456)


def test_bodies_come_back_from_a_snapshot_of_the_program_with_the_same_bits(tmp_path):
    sim = planets(units=("AU", "yr2pi", "Msun"))
    sim.t = 7.25
    done = tridisk.continue_in_tridisk(sim, 8.0, tmp_path / "run", integrator="gauss-radau")
    start = done.simulation(0)
    for name in NAMES:
        assert state(start)[name] == state(sim)[name]
    # The mass and the place; a radius of the star is that in which it accretes.
    assert state(start)["star"][2:] == state(sim)["Sun"][2:] and state(start)["star"][0] == state(sim)["Sun"][0]
    assert start.t == 7.25 and start.units == {"length": "au", "mass": "msun", "time": "yr2pi"}
    # A body without its name is found by its id.
    assert state(tridisk.to_rebound(done.snapshots[0]))["17"] == state(sim)["17"]


def test_bodies_of_a_generated_belt_are_found_by_their_ids(tmp_path):
    scene = """
    [run]
    end_time = 0.01
    snapshots = 0.01
    [star]
    mass = 1.0
    [planetesimals]
    number = 20
    total_mass = "0.1 Mearth"
    inner_radius = 0.9
    outer_radius = 1.1
    integrator = "wisdom-holman"
    collisions = { outcome = "none" }
    """
    tridisk.run(scene, tmp_path / "run")
    last = tridisk.snapshots(tmp_path / "run")[-1]
    sim, bodies = tridisk.to_rebound(last), tridisk.read(last, "planetesimals")
    assert sim.t == bodies["Time"] and sim.G == 1.0 and sim.N == 21 and sim.N_active == 2**64 - 1
    for i, name in enumerate(bodies["ParticleIDs"]):
        p = sim.particles[str(name)]
        assert (p.m, p.r, *p.xyz, *p.vxyz) == (bodies["Masses"][i], bodies["Radii"][i], *bodies["Coordinates"][i], *bodies["Velocities"][i])


def archive(path, sim):
    sim.save_to_file(str(path), interval=10.0, delete_file=True)
    sim.integrate(25.0, exact_finish_time=0)
    return path


@pytest.mark.parametrize("integrator", ["ias15", "whfast"])
def test_an_archive_goes_on_in_tridisk_as_in_rebound(tmp_path, integrator):
    sim = planets()
    sim.integrator = integrator
    if integrator == "whfast":
        sim.dt = 0.01
        sim.integrator.safe_mode = 0  # the archive holds states between half steps
    path = archive(tmp_path / "archive.bin", sim)
    ours = tridisk.continue_in_tridisk(path, 60.0, tmp_path / "run", integrator="gauss-radau").simulation()
    # Synchronized, then by IAS15 whatever wrote the archive: the same problem for both codes.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        theirs = rebound.Simulationarchive(str(path))[-1]
    theirs.synchronize()
    theirs.integrator = "ias15"
    theirs.integrate(60.0)
    assert ours.t == pytest.approx(60.0, rel=1e-15)
    difference = np.linalg.norm(places(ours, NAMES) - places(theirs, NAMES), axis=1) / np.linalg.norm(places(theirs, NAMES), axis=1)
    print(f"archive of {integrator}, 40 units on: largest relative difference {difference.max():.1e}")
    assert difference.max() < BARS["archive"][integrator]


def test_a_simulation_between_half_steps_is_left_as_it_is(tmp_path):
    writer = planets()
    writer.integrator = "whfast"
    writer.dt = 0.01
    writer.integrator.safe_mode = 0
    with pytest.warns(RuntimeWarning, match="might not be synchronized"):
        sim = rebound.Simulationarchive(str(archive(tmp_path / "archive.bin", writer)))[-1]
    between = state(sim)
    back = tridisk.to_rebound(tridisk.from_rebound(sim, tmp_path / "start.hdf5"))
    assert not sim.is_synchronized and state(sim) == between
    sim.synchronize()
    assert state(sim) != between
    assert {name: state(back)[name] for name in NAMES} == {name: state(sim)[name] for name in NAMES}


def test_elements_are_those_of_rebound():
    sim = planets()
    orbits = [p.orbit(primary=sim.particles[0]) for p in list(sim.particles)[1:]]
    m, x, v = (np.array([getattr(p, name) for p in sim.particles]) for name in ("m", "xyz", "vxyz"))
    a, e, inc = tridisk.elements(x[1:] - x[0], v[1:] - v[0], m[0] + m[1:])
    # A few roundings, of which those in 1/a and e are made larger by 2/(1 - e).
    np.testing.assert_allclose(a, [o.a for o in orbits], rtol=2e-15)
    np.testing.assert_allclose(e, [o.e for o in orbits], rtol=0, atol=2e-15)
    # REBOUND's arc cosine is as exact as the rounding of the cosine leaves it.
    assert (np.abs(inc - [o.inc for o in orbits]) < 2.3e-16 / inc).all()


def test_an_archive_is_entered_by_index_and_by_time(tmp_path):
    # The writer lives on: REBOUND 5.2.2 mixes up names whose addresses have been given away.
    writer = planets()
    path = archive(tmp_path / "archive.bin", writer)
    held = rebound.Simulationarchive(str(path))
    for chosen, index in ((dict(snapshot=1), 1), (dict(time=15.0), 1), (dict(snapshot=0), 0), ({}, 2)):
        expected = {name: state(held[index])[name] for name in NAMES}
        for source in (path, held):
            back = state(tridisk.to_rebound(tridisk.from_rebound(source, tmp_path / "start.hdf5", **chosen)))
            assert {name: back[name] for name in NAMES} == expected


def test_test_particles_feel_and_do_not_pull(tmp_path):
    sim = planets()
    sim.particles["near"].m = 1e-3  # would move the planets if it pulled
    with pytest.warns(UserWarning, match="1 test particles have masses, which pull nobody"):
        ours = tridisk.continue_in_tridisk(sim, 20.0, tmp_path / "run", integrator="gauss-radau").simulation()
    assert ours.N_active == 4 and ours.particles["near"].m == 0
    sim.testparticle_hidewarnings = 1
    sim.integrator = "ias15"
    sim.integrate(20.0)
    difference = np.abs(places(ours, NAMES) - places(sim, NAMES)).max()
    print(f"test particles, 20 units: largest difference {difference:.1e}")
    assert difference < BARS["test particles"]


@pytest.mark.parametrize("units", [("yr", "AU", "Msun"), None])
def test_another_gravitational_constant_is_taken_into_the_times(tmp_path, units):
    sim = planets(4 * np.pi**2, units)
    sim.t = 3.0
    sim.integrator = "ias15"
    if units is None:
        with pytest.warns(UserWarning, match="names no units: lengths and masses are kept, times multiplied by sqrt"):
            done = tridisk.continue_in_tridisk(sim, 8.0, tmp_path / "run", integrator="gauss-radau")
    else:
        done = tridisk.continue_in_tridisk(sim, 8.0, tmp_path / "run", integrator="gauss-radau")
    ours = done.simulation()
    sim.integrate(8.0)
    assert ours.G == sim.G and ours.units == sim.units and ours.t == pytest.approx(8.0, rel=1e-15)
    difference = np.abs(places(ours, NAMES) - places(sim, NAMES)).max()
    v = np.array([np.subtract(ours.particles[name].vxyz, sim.particles[name].vxyz) for name in NAMES])
    print(f"G = 4 pi^2, 5 units: largest difference {difference:.1e}, of velocities {np.abs(v).max():.1e}")
    assert difference < BARS["G"] and np.abs(v).max() < BARS["velocities, G"]


def test_ids_are_numbers_or_hashes_of_names_or_one_to_n(tmp_path):
    path = tridisk.from_rebound(planets(), tmp_path / "start.hdf5")
    ids = tridisk.files.h5py.File(path)["PartType1/ParticleIDs"][:]
    rebound.clibrebound.reb_hash.restype = rebound.c_uint32
    assert ids[2] == 17 and ids[0] == rebound.clibrebound.reb_hash(b"Jupiter") and len(set(ids)) == 5
    sim = planets()
    sim.particles["far"].name = None  # one without a name: all are counted
    path = tridisk.from_rebound(sim, tmp_path / "start.hdf5")
    assert list(tridisk.files.h5py.File(path)["PartType1/ParticleIDs"][:]) == [1, 2, 3, 4, 5]
    back = tridisk.to_rebound(path)
    assert back.particles["5"].m == 0 and back.particles["5"].x == sim.particles[5].x


def test_names_that_occur_twice_are_given_up(tmp_path):
    sim = planets()
    sim.particles[5].name = "near"
    with pytest.warns(UserWarning, match="names occur twice"):
        back = tridisk.to_rebound(tridisk.from_rebound(sim, tmp_path / "start.hdf5"))
    assert [p.name for p in back.particles] == ["star", "1", "2", "3", "4", "5"]


def variational(sim):
    sim.add_variation()


def pulling(sim):
    sim.testparticle_type = 1


def light_star(sim):
    sim.particles["Sun"].m = 1e-5


def gone(sim):
    sim.particles["far"].x = np.nan


def without_g(sim):
    sim.G = 0.0


def shear(sim):
    sim.root_size = 100.0
    sim.boundary = "shear"


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (variational, "variational particles, which tridisk does not have"),
        (pulling, "test particles that pull"),
        (light_star, "particle 0 has the mass 1e-05, the heaviest 0.000955: say which is the star"),
        (gone, "particle 5 has a position that is not finite"),
        (without_g, "the simulation has G = 0.0; tridisk needs a positive one"),
        (shear, "the simulation has a shear boundary"),
    ],
)
def test_what_tridisk_does_not_have_is_refused_in_a_sentence(tmp_path, change, sentence):
    sim = planets()
    change(sim)
    with pytest.raises(ValueError, match=sentence):
        tridisk.from_rebound(sim, tmp_path / "start.hdf5")
    assert not (tmp_path / "start.hdf5").exists()


def test_wrong_files_and_arguments_are_refused_in_a_sentence(tmp_path):
    text = tmp_path / "text.txt"
    writer = planets()
    text.write_text("no snapshot")
    gas = tmp_path / "gas.hdf5"
    tridisk.write(gas, gas={"Masses": np.ones(2)})
    held = archive(tmp_path / "archive.bin", writer)
    start = tmp_path / "start.hdf5"
    for refused, kind, sentence in (
        (lambda: tridisk.to_rebound(tmp_path / "none.hdf5"), FileNotFoundError, "none.hdf5 is no file"),
        (lambda: tridisk.to_rebound(text), ValueError, "is no HDF5 file"),
        (lambda: tridisk.to_rebound(gas), ValueError, "has neither a star"),
        (lambda: tridisk.from_rebound(tmp_path / "none.bin", start), FileNotFoundError, "none.bin is no file"),
        (lambda: tridisk.from_rebound(text, start), ValueError, "is no Simulationarchive"),
        (lambda: tridisk.from_rebound(17, start), TypeError, "a int is neither"),
        (lambda: tridisk.from_rebound(held, start, snapshot=9), ValueError, "has snapshots 0 to 2, not 9"),
        (lambda: tridisk.from_rebound(held, start, time=99.0), ValueError, "has times 0.0 to 2"),
        (lambda: tridisk.from_rebound(rebound.Simulation(), start), ValueError, "has no particles"),
        (lambda: tridisk.from_rebound(planets(), start, star="Moon"), ValueError, 'no particle is called "Moon"'),
        (lambda: tridisk.from_rebound(planets(), start, star=6), ValueError, "none has the index 6"),
        (lambda: tridisk.continue_in_tridisk(held, 1.0, tmp_path / "run"), ValueError, "end_time = 1.0 is not after the time"),
        (lambda: tridisk.continue_in_tridisk(held, 99.0, tmp_path / "run", integrator="euler"), ValueError, 'no integrator is called "euler"'),
        (lambda: tridisk.compare(tmp_path / "none.toml"), FileNotFoundError, "none.toml is no file"),
    ):
        with pytest.raises(kind, match=sentence):
            refused()


def test_a_missing_rebound_is_said_by_the_functions_that_need_it(tmp_path, monkeypatch):
    file = tridisk.from_rebound(planets(), tmp_path / "start.hdf5")
    monkeypatch.setitem(sys.modules, "rebound", None)
    for refused in (lambda: tridisk.to_rebound(file), lambda: tridisk.from_rebound("archive.bin", file), lambda: tridisk.compare(file)):
        with pytest.raises(ImportError, match="REBOUND is not installed: pip install"):
            refused()


def test_both_codes_agree_about_the_same_start():
    result = tridisk.compare(planets(), "ias15", years=10)
    assert result.bodies == 5 and result.missing == 0 and result.cpu_s > 0 and result.rebound_cpu_s > 0
    for name in ("position", "semi_major_axis", "eccentricity", "inclination", "energy_error", "rebound_energy_error"):
        assert getattr(result, name) < BARS["compare"][name], name


def test_a_scene_is_compared_from_the_command_line(tmp_path):
    scene = tridisk.ROOT / "scenarios" / "nbody" / "outer-solar-system.toml"
    command = [sys.executable, "-m", "tridisk", "compare", str(scene), "--integrator", "whfast", "--years", "1000", "--runs", "1"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tridisk.ROOT / "tests" / "rebound")
    print(done.stdout)
    assert done.returncode == 0 and "4 bodies to time 6283.19" in done.stdout and "tridisk jacobi, REBOUND whfast" in done.stdout
    command[4] = str(tmp_path / "none.toml")
    done = subprocess.run(command, capture_output=True, text=True, cwd=tridisk.ROOT / "tests" / "rebound")
    assert done.returncode == 2 and done.stderr.startswith("tridisk: ") and done.stderr.endswith("none.toml is no file\n")
