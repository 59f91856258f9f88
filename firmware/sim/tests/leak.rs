//! Alone in its process, so that nothing else moves the figures.

mod common;

#[test]
fn cores_are_given_back() {
    let elf = common::build("stuck", &["WAY=0"]);
    let resident = || {
        let pages = std::fs::read_to_string("/proc/self/statm").expect("Linux");
        pages.split(' ').nth(1).and_then(|pages| pages.parse::<u64>().ok()).expect("a number") * 4096
    };
    let cycle = |n: u32| (0..n).for_each(|_| drop(slider_sim::Mcu::load(&elf).expect("a program")));
    cycle(50);
    let before = resident();
    cycle(500);
    let grown = resident().saturating_sub(before);
    // A core is some 60 KB.
    assert!(grown < 500 * 500, "{grown} bytes after 500 cores");
    std::fs::remove_file(elf).expect("the file just made");
}
