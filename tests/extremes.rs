//! Scenes at the extremes: the table of `tridisk verify extremes`, but for what takes long.

use tridisk::verify::extremes::judge;

/// Runs the cases of a problem; all must hold, and there must be `least` of them.
fn all_hold(name: &str, least: usize) {
    let (mut failures, mut number) = (String::new(), 0);
    judge(name, false, |case| {
        number += 1;
        let line = format!("{}: {}: {}\n", case.name, case.must_hold, case.measured);
        print!("{line}");
        if !case.kept {
            failures += &line;
        }
    });
    assert!(failures.is_empty(), "{failures}");
    assert!(number >= least, "{number} cases");
}

#[test]
fn bodies() {
    all_hold("extremes-bodies", 90);
}

#[test]
fn gas() {
    all_hold("extremes-gas", 50);
}

#[test]
fn disks() {
    all_hold("extremes-disks", 15);
}

#[test]
fn dust() {
    all_hold("extremes-dust", 80);
}

#[test]
fn populations_on_each_other() {
    all_hold("extremes-mixed", 40);
}

#[test]
fn numbers_of_scenes() {
    all_hold("extremes-inputs", 200);
}

#[test]
fn columns_of_files() {
    all_hold("extremes-files", 100);
}
