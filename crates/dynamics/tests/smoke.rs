mod support;
use support::*;
use asperity_dynamics::*;
#[test]
fn smoke() {
    let law = constant();
        let stack = rig(&law);
        for set in InstructionSet::available() {
        for cell in [4e-3, 2e-3, 1e-3, 0.5e-3, 0.25e-3, 0.125e-3] {
        let m = FiniteDifference { instructions: set, cell, ..Default::default() };
        let nodes = asperity_mesh::Grid::new(&stack, cell).unwrap().nodes() as f64;
        let time = |d: f64| (0..12).map(|_| {
        let t0 = std::time::Instant::now();
        let t = run(&stack, &m, &pulse(32.0), d);
        (t0.elapsed().as_secs_f64(), t.steps)}).min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
        let d = 30.0 * cell;
        let (a, b) = (time(d), time(0.1*d));
        println!("const {set:?} {cell} {nodes} fixed {:.4} s, per step {:.2} ns, {:.2e} updates/s", b.0, (a.0-b.0)/(a.1-b.1) as f64*1e9, nodes * (a.1-b.1) as f64 / (a.0-b.0));
        }}
}
