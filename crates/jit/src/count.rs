//! A machine that counts operations, to predict the length of code before it is generated.

use zeroset_interval::{Format, Machine};

/// Counts the operations that the emitter would emit. Constants and copies cost nothing.
#[derive(Debug, Default)]
pub struct Counter(pub usize);

macro_rules! counted {
    ($($name:ident($($operand:ident: $kind:ty),*) -> $result:ty = $value:expr;)*) => {
        $(fn $name(&mut self, $($operand: $kind),*) -> $result {
            self.0 += 1;
            $(let _ = $operand;)*
            $value
        })*
    };
}

impl Machine for Counter {
    type V = ();

    fn number(&mut self, _: Format, _: f64) {}

    fn bits(&mut self, _: Format, _: u64) {}

    counted! {
        add(a: (), b: ()) -> () = ();
        sub(a: (), b: ()) -> () = ();
        mul(a: (), b: ()) -> () = ();
        mul_add(a: (), b: (), c: ()) -> () = ();
        mul_sub(a: (), b: (), c: ()) -> () = ();
        div(a: (), b: ()) -> () = ();
        sqrt(a: ()) -> () = ();
        neg(a: ()) -> () = ();
        abs(a: ()) -> () = ();
        min(a: (), b: ()) -> () = ();
        max(a: (), b: ()) -> () = ();
        floor(a: ()) -> () = ();
        ceil(a: ()) -> () = ();
        trunc(a: ()) -> () = ();
        nearest(a: ()) -> () = ();
        lt(a: (), b: ()) -> () = ();
        le(a: (), b: ()) -> () = ();
        eq(a: (), b: ()) -> () = ();
        and(a: (), b: ()) -> () = ();
        or(a: (), b: ()) -> () = ();
        xor(a: (), b: ()) -> () = ();
        select(mask: (), a: (), b: ()) -> () = ();
        select_signed(sign: (), a: (), b: ()) -> () = ();
        int_add(a: (), b: ()) -> () = ();
        int_sub(a: (), b: ()) -> () = ();
        shift_left(a: (), by: u8) -> () = ();
        shift_right(a: (), by: u8) -> () = ();
        widen(a: ()) -> [(); 2] = [(); 2];
        narrow(halves: [(); 2]) -> () = ();
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
