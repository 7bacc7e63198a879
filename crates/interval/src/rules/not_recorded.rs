//! Operations that machines for proofs do not know.

/// Operations that no recorded rule uses.
macro_rules! not_recorded {
    ($($name:ident($($argument:ident: $kind:ty),*) -> $result:ty;)*) => {
        $(fn $name(&mut self, $($argument: $kind),*) -> $result {
            let _ = ($($argument,)*);
            unimplemented!(stringify!($name))
        })*
    };
}
macro_rules! integers_and_bits_are_not_recorded {
    ($v:ty) => {
        not_recorded! {
            floor(a: $v) -> $v;
            ceil(a: $v) -> $v;
            trunc(a: $v) -> $v;
            nearest(a: $v) -> $v;
            le(a: $v, b: $v) -> $v;
            eq(a: $v, b: $v) -> $v;
            and(a: $v, b: $v) -> $v;
            or(a: $v, b: $v) -> $v;
            xor(a: $v, b: $v) -> $v;
            select_signed(sign: $v, a: $v, b: $v) -> $v;
            int_add(a: $v, b: $v) -> $v;
            int_sub(a: $v, b: $v) -> $v;
            shift_left(a: $v, by: u8) -> $v;
            shift_right(a: $v, by: u8) -> $v;
            widen(a: $v) -> [$v; 2];
            narrow(halves: [$v; 2]) -> $v;
        }
    };
}
