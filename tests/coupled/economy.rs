//! Economy: what a scene leaves out is not in the list of operators and holds no memory.

use nbody::points::Columns;
use tridisk::assemble;
use tridisk::scene::Scene;

use crate::bench::shipped;

fn assembled(scene: &str) -> assemble::Assembly {
    let scene = Scene::load(&shipped(scene), &[]).unwrap_or_else(|refusal| panic!("{refusal}"));
    let system = assemble::start(&scene).unwrap_or_else(|refusal| panic!("{refusal}"));
    assemble::assembly(&scene, system).unwrap_or_else(|refusal| panic!("{refusal}"))
}

#[test]
fn a_scene_of_planetesimals_has_nothing_of_gas_and_dust() {
    let assembly = assembled("nbody/belt.toml");
    assert_eq!(
        assembly.splitting.names(),
        ["gravity", "kick bodies", "drift bodies", "collisions"]
    );
    let (gas, dust) = (&assembly.system.gas, &assembly.system.dust);
    let sets: [&dyn Columns; 6] = [
        &gas.particles,
        &gas.derived,
        &gas.rates,
        &dust.particles,
        &dust.derived,
        &dust.rates,
    ];
    assert_eq!(sets.iter().map(|set| set.reserved()).sum::<usize>(), 0);
    assert_eq!(gas.tree.nodes.capacity() + dust.tree.nodes.capacity(), 0);
}

#[test]
fn a_scene_of_gas_is_kick_drift_kick() {
    assert_eq!(
        assembled("gas/sod.toml").splitting.names(),
        ["density", "kick gas", "drift gas"]
    );
}

#[test]
fn a_scene_of_all_has_all() {
    let names = assembled("coupled/embryo-in-disk.toml").splitting.names();
    let all = [
        "density",
        "gravity",
        "drag dust",
        "drag bodies",
        "kick bodies",
        "kick dust",
        "kick gas",
        "drift gas",
        "drift dust",
        "drift bodies",
        "accretion",
        "collisions",
    ];
    assert_eq!(names, all);
}
