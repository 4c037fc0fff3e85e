//! The field's problems, run from scene files through the whole program, against their exact answers.

mod allocator;
mod bench;
mod coupled {
    mod box_bodies;
    mod conservation;
    mod economy;
    mod plane;
    mod reproducible;
    mod splitting;
    mod temperature;
    mod tolerance;
}
mod dust {
    mod clumps;
    mod dusty_box;
    mod extremes;
    mod growth;
    mod turbulence;
    mod wave;
}
mod gas {
    mod allocation;
    mod cooling;
    mod edges;
    mod extremes;
    mod glass;
    mod sedov;
    pub mod shearing;
    mod shock_tube;
    mod square;
}
mod nbody {
    mod collisions;
    mod extremes;
    mod orbits;
    mod surroundings;
}
mod architecture;
