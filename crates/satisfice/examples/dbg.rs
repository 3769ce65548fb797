#![allow(missing_docs)]
use satisfice::*;
fn main() {
    let a = Located::new(&[9.0_f32, 0.29999998, -2.0], 0.02);
    println!("{} same {}", a.key(), a.same(&a));
    a.visit_keys(&mut |k| {
        println!("{k}");
        false
    });
    let sep = 0.02_f32;
    for x in a.coordinates {
        let r = sep * (1.0 + 1e-6);
        println!(
            "{x}: {} {} {}",
            ((x - r) / (sep + sep)).floor(),
            (x / (sep + sep)).floor(),
            ((x + r) / (sep + sep)).floor()
        );
    }
}
