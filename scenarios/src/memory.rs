//! Memory: scenes that outgrow the machine are refused, and large buffers go back to the system as soon as they are freed.
//!
//! The allocator of the GNU library learns from the first large buffer that is freed to keep all of that size in its heap, where what lives
//! longer keeps the gaps between from being returned: a sixth of what a million bodies need.

use crate::populate::Refusal;
use crate::scene::Scene;
use crate::validate::block_number;

/// Bytes of columns that a particle of gas, dust and planetesimals has at least, as runs of many show.
const LEAST: [(&str, f64); 3] = [
    ("gas particles", 370.0),
    ("dust superparticles", 190.0),
    ("planetesimals", 250.0),
];

/// Refuses a scene of more particles than the machine has memory for.
pub fn fits(scene: &Scene) -> Result<(), Refusal> {
    let blocks = |filled: f64, disk: usize| filled + disk as f64;
    let gas = scene.gas.as_ref().map_or(0.0, |gas| {
        let filled = gas.blocks.iter().map(|b| block_number(scene, &b.block));
        blocks(filled.sum(), gas.particles)
    });
    let dust = scene.dust.as_ref().map_or(0.0, |dust| {
        let filled = dust.blocks.iter().map(|b| block_number(scene, &b.block));
        blocks(filled.sum(), dust.particles)
    });
    let bodies = scene.planetesimals.map_or(0.0, |p| p.number as f64);
    let numbers = [gas, dust, bodies];
    let needed: f64 = LEAST
        .iter()
        .zip(numbers)
        .map(|((_, each), n)| each * n)
        .sum();
    let has = physical();
    if needed <= has {
        return Ok(());
    }
    let named = LEAST.iter().zip(numbers).filter(|(_, n)| *n > 0.0);
    let named: Vec<String> = named
        .map(|((name, _), n)| format!("{n:.0} {name}"))
        .collect();
    Err(Refusal(format!(
        "{} need at least {:.0} GB of memory, but this machine has {:.0} GB",
        named.join(", "),
        needed / 1e9,
        has / 1e9
    )))
}

/// Bytes of memory of this machine; without end where it does not say.
fn physical() -> f64 {
    // SAFETY: asks for two numbers.
    let [pages, size] =
        [libc::_SC_PHYS_PAGES, libc::_SC_PAGESIZE].map(|of| unsafe { libc::sysconf(of) });
    if pages > 0 && size > 0 {
        pages as f64 * size as f64
    } else {
        f64::INFINITY
    }
}

/// Bytes from which on a buffer is a mapping of its own.
#[cfg(target_env = "gnu")]
const LARGE: libc::c_int = 4 << 20;

/// Keeps large buffers out of the heap; to be called before the first is made.
pub fn keep_apart() {
    #[cfg(target_env = "gnu")]
    // SAFETY: sets a parameter of the allocator, which may be done at any time.
    unsafe {
        libc::mallopt(libc::M_MMAP_THRESHOLD, LARGE);
    }
}
