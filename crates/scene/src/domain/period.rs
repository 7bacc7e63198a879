//! Periods of a function along each axis, read off its graph: those of sines, of remainders, and of
//! roundings whose steps cancel, as in x − 2·round(x/2).
//!
//! Nothing here is a proof: periods only serve to choose a window. This module depends neither on
//! kernels nor on boxes.

use std::f64::consts::{PI, TAU};
use zeroset_ops::{Class, Law, Op, Rounding};

/// Two periods have a common one if some multiple of the longer one, by at most this number, is a
/// multiple of the shorter one up to `ROUNDING`.
const MULTIPLES: u32 = 12;
const ROUNDING: f64 = 1e-9;

/// The period of a function along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Period {
    pub length: f64,
    /// Whether the function has jumps or folds that repeat. The cells between them begin and end
    /// at their own places, so a window should show whole cells.
    pub has_cells: bool,
}

/// How a node behaves along an axis: it is a periodic function plus `slope` times the coordinate.
#[derive(Clone, Copy, Debug)]
pub struct Course {
    /// The period; 0 if the periodic function is constant.
    pub period: f64,
    pub slope: f64,
    pub has_cells: bool,
}

pub const CONSTANT: Course = Course { period: 0.0, slope: 0.0, has_cells: false };

impl Course {
    /// The course of `self + sign · other`. `None` if the periods have no common multiple.
    fn sum(self, sign: f64, other: Self) -> Option<Self> {
        let sum = self.slope + sign * other.slope;
        let size = self.slope.abs().max(other.slope.abs());
        Some(Self {
            period: common(self.period, other.period)?,
            slope: if sum.abs() <= ROUNDING * size { 0.0 } else { sum },
            has_cells: self.has_cells || other.has_cells,
        })
    }

    fn times(self, factor: f64) -> Self {
        Self { slope: self.slope * factor, ..self }
    }

    /// The period of a function of period `unit` of this node.
    fn wrapped(self, unit: f64) -> Option<f64> {
        let own = if self.slope == 0.0 { 0.0 } else { unit / self.slope.abs() };
        common(self.period, own)
    }

    fn is_level(self) -> bool {
        self.slope == 0.0
    }
}

/// The shortest common multiple of two periods, if there is one. 0 is the period of a constant.
fn common(a: f64, b: f64) -> Option<f64> {
    let [short, long] = [a.min(b), a.max(b)];
    if short == 0.0 {
        return Some(long);
    }
    let is_whole = |count: f64| (count - count.round()).abs() <= ROUNDING * count;
    (1..=MULTIPLES).map(|n| f64::from(n) * long).find(|all| is_whole(all / short))
}

impl Period {
    /// The period of a function with this course. `None` if it does not depend on the axis, or has
    /// no period along it.
    pub fn of(course: Option<Course>) -> Option<Self> {
        let Course { period, has_cells, .. } = course.filter(|course| course.is_level())?;
        (period > 0.0 && period.is_finite()).then_some(Self { length: period, has_cells })
    }
}

/// The course of an operation along an axis, computed from the courses of its operands. `values`
/// are the operands that are numbers.
pub fn combined(op: Op, operands: &[Course], values: &[Option<f64>]) -> Option<Course> {
    let number = |k: usize| values.get(k).copied().flatten();
    let cells = |period: f64, slope: f64| Some(Course { period, slope, has_cells: true });
    // A function of operands that only repeat repeats with them.
    let level = || {
        let all = operands.iter().try_fold(CONSTANT, |all, one| all.sum(1.0, *one));
        all.filter(|_| operands.iter().all(|one| one.is_level()))
    };
    let a = operands[0];
    match op.row().class {
        Class::Negation => Some(a.times(-1.0)),
        Class::Sum => a.sum(if op == Op::Add { 1.0 } else { -1.0 }, operands[1]),
        Class::Product => match (number(0), number(1)) {
            (Some(factor), _) => Some(operands[1].times(factor)),
            (None, Some(factor)) => Some(a.times(factor)),
            (None, None) => level(),
        },
        Class::Quotient => match number(1) {
            Some(divisor) => Some(a.times(1.0 / divisor)),
            None => level(),
        },
        Class::Remainder => match number(1) {
            Some(divisor) => cells(a.wrapped(divisor.abs())?, 0.0),
            None => level(),
        },
        Class::Function(Law::Fraction) => cells(a.wrapped(1.0)?, 0.0),
        Class::Function(Law::Rounding(Rounding::Down | Rounding::Up | Rounding::Nearest))
            if !a.is_level() =>
        {
            cells(a.wrapped(1.0)?, a.slope)
        }
        Class::Function(_) if [Op::Sin, Op::Cos].contains(&op) => {
            Some(Course { period: a.wrapped(TAU)?, slope: 0.0, ..a })
        }
        Class::Function(_) if op == Op::Tan => {
            Some(Course { period: a.wrapped(PI)?, slope: 0.0, ..a })
        }
        Class::Square
        | Class::Power
        | Class::Extremum
        | Class::Choice
        | Class::Fallback
        | Class::Restriction(_)
        | Class::Function(_)
        | Class::FunctionOfTwo => level(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::shape::shapes;
    use super::*;
    use crate::program::Program;
    use zeroset_interval::Interval;
    use zeroset_syntax::{Options, read};

    #[test]
    fn a_period_is_that_of_what_repeats() {
        let none: [Option<f64>; 3] = [None; 3];
        for (text, wanted, has_cells) in [
            ("hypot(x-2round(x/2),y-3round(y/3),z)=0.5", [Some(2.0), Some(3.0), None], true),
            ("mod(x,4)^2+fract(3y)+fract(z/5)=1", [Some(4.0), Some(1.0 / 3.0), Some(5.0)], true),
            ("mod(floor(x)+floor(y)+floor(z),2)=0.5", [Some(2.0); 3], true),
            ("mod(x,4)+mod(x,6)+y*z=3", [Some(12.0), None, None], true),
            ("x-floor(x)+y^2=z", [Some(1.0), None, None], true),
            ("sin(2x)+cos(3x)+y=z", [Some(TAU), None, None], false),
            ("sin(pi*x)+tan(pi*y)=z", [Some(2.0), Some(1.0), None], false),
            ("fract(x/3+y/2)=z", [Some(3.0), Some(2.0), None], true),
            // The steps do not cancel, the periods have no common one, the argument is not linear.
            ("x-2round(x/3)+y=z", none, true),
            ("mod(x,1)+mod(x,sqrt(2))=z+y", none, true),
            ("fract(x^2+y*z)=0.5", none, true),
            ("x*mod(x,2)+y=z", none, true),
        ] {
            let document = read(text, &Options::default()).expect(text);
            let program = Program::new(&document, [Interval::ENTIRE; 3]).expect(text);
            let known = shapes(program.graph(), program.roots()[0], program.values());
            let found = known[program.roots()[0].index()].courses.map(Period::of);
            for (found, wanted) in found.into_iter().zip(wanted) {
                let is_near = match (found, wanted) {
                    (Some(found), Some(wanted)) => {
                        (found.length - wanted).abs() < 1e-9 && found.has_cells == has_cells
                    }
                    (found, wanted) => found.is_none() && wanted.is_none(),
                };
                assert!(is_near, "{text}: {found:?}, not {wanted:?}");
            }
        }
    }
}
