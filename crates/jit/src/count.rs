//! A machine that counts operations, to predict the length of code before it is generated.

use zeroset_interval::{Format, Machine};

/// Counts the operations that the emitter would emit. Constants and copies cost nothing.
#[derive(Debug, Default)]
pub struct Counter(pub usize);

/// Operations that count once, by their number of vectors.
macro_rules! counted {
    ($($one:ident)*; $($two:ident)*; $($three:ident)*) => {
        $(fn $one(&mut self, _: ()) {
            self.0 += 1;
        })*
        $(fn $two(&mut self, _: (), _: ()) {
            self.0 += 1;
        })*
        $(fn $three(&mut self, _: (), _: (), _: ()) {
            self.0 += 1;
        })*
    };
}

impl Machine for Counter {
    type V = ();

    fn number(&mut self, _: Format, _: f64) {}

    fn bits(&mut self, _: Format, _: u64) {}

    counted! {
        sqrt neg abs floor ceil trunc nearest;
        add sub mul div min max lt le eq and or xor int_add int_sub;
        mul_add mul_sub select select_signed
    }

    fn shift_left(&mut self, (): (), _: u8) {
        self.0 += 1;
    }

    fn shift_right(&mut self, (): (), _: u8) {
        self.0 += 1;
    }

    fn widen(&mut self, (): ()) -> [(); 2] {
        self.0 += 1;
        [(); 2]
    }

    fn narrow(&mut self, _: [(); 2]) {
        self.0 += 1;
    }

    /// Counts the routine once, since native code runs it in a loop.
    fn repeat<const ROWS: usize, const IN: usize, const OUT: usize>(
        &mut self,
        _: [[(); IN]; ROWS],
        mut text: impl FnMut(&mut Self, [(); IN]) -> [(); OUT],
    ) -> [[(); OUT]; ROWS] {
        self.0 += ROWS * (IN + OUT);
        text(self, [(); IN]);
        [[(); OUT]; ROWS]
    }
}
