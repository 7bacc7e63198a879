//! Evaluates a function at points, for several values of a parameter.
//!
//! `cargo run --example evaluate`

use zeroset::{Error, Function};

fn main() -> Result<(), Error> {
    // Definitions have lines of their own. `R` has a range, so code is compiled once.
    let mut torus = Function::parse("R = 2 in [1, 3]\n(sqrt(x^2+y^2) - R)^2 + z^2 - 1/4")?;
    println!("f = {torus}");
    let points = [[2.0, 0.0, 0.0], [0.0, 2.5, 0.0], [0.0, 0.0, 0.0]];
    for radius in [1.5, 2.0, 2.5] {
        torus.set("R", radius)?;
        let (values, gradients) = (torus.eval(&points), torus.gradient(&points)?);
        for ((point, value), gradient) in points.iter().zip(values).zip(gradients) {
            println!("R = {radius}: f{point:?} = {value}, gradient {gradient:?}");
        }
    }
    Ok(())
}
