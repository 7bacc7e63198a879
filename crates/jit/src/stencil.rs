//! Stencils: code for one step of a tape, compiled once per process.
//!
//! A stencil reads the values of a step's operands from a frame in memory and writes the step's
//! value there. Which vectors a value has is known when the stencil is compiled. So there is a
//! stencil for each operation, shape and [coarse](Tape::coarse) range of its operands.

use crate::code::Code;
use crate::count::Counter;
use crate::error::Error;
use crate::lanes::{Emitter, LaneVector};
use crate::stencil_code::{Frame, StencilPointers, compile_stencil};
use std::any::{Any, TypeId};
use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};
use zeroset_eval::{Query, QueryValue, Real, ValueKind};
use zeroset_interval::{Exponent, Interval, Term};
use zeroset_ir::Axis;
use zeroset_ops::Op;

/// A value without vectors: only what is known when code is compiled.
pub type Shape<Q> = QueryValue<Q, Counter>;

/// An operand as far as it is known when code is compiled.
pub struct StencilOperand<Q: Query> {
    /// The vectors that the operand's value has.
    pub shape: Shape<Q>,
    /// The operand's coarse range.
    pub range: Interval,
    /// The operand's kind as an exponent.
    pub exponent: Exponent,
    /// Whether the value is among the constants, not in the frame.
    pub is_constant: bool,
}

/// A step of a tape, or the result that follows the last step.
pub enum StencilStep<'a, Q: Query> {
    /// Loads a coordinate.
    Coordinate(Axis),
    /// Applies an operation.
    Apply(Op, &'a [StencilOperand<Q>]),
    /// Computes the result of the query; `true` if the first value is finite in every sample.
    Result(&'a [StencilOperand<Q>], bool),
}

/// Code for one step.
pub struct Stencil<Q: Query> {
    /// The code, whose arguments are those of [`StencilPointers`].
    pub code: Code,
    /// The shape of the step's value; `None` for the result.
    pub shape: Option<Shape<Q>>,
}

/// Number of vectors in a value.
pub fn parts<Q: Query>(shape: &Shape<Q>) -> usize {
    let mut parts = 0;
    Q::Kind::map(shape, &mut |()| parts += 1);
    parts
}

/// The key of a stencil: bits that distinguish it from all others of its query, format and width.
type Key = Vec<u64>;

fn key<Q: Query>(step: &StencilStep<'_, Q>, width: usize) -> Key {
    let mut key = vec![width as u64];
    let operands = match step {
        StencilStep::Coordinate(axis) => {
            key.extend([0, *axis as u64]);
            return key;
        }
        StencilStep::Apply(op, operands) => {
            key.extend([1, *op as u64]);
            operands
        }
        StencilStep::Result(operands, is_bounded) => {
            key.extend([2, u64::from(*is_bounded)]);
            operands
        }
    };
    for operand in *operands {
        let shape = Q::Kind::shape(&operand.shape);
        let exponent = match operand.exponent {
            Exponent::Real => 0,
            Exponent::Integer(n) => 1 << 32 | u64::from(n as u32),
            Exponent::LargeInteger { odd } => 2 << 32 | u64::from(odd),
        };
        key.extend([
            shape as u64,
            (shape >> 64) as u64,
            operand.range.lo.to_bits(),
            operand.range.hi.to_bits(),
            exponent,
            u64::from(operand.is_constant),
        ]);
    }
    key
}

/// All stencils of one query in one format.
type Cache<Q> = Mutex<HashMap<Key, Arc<Stencil<Q>>>>;

/// The caches of this process, by query and format.
static CACHES: LazyLock<Mutex<HashMap<TypeId, Arc<dyn Any + Send + Sync>>>> =
    LazyLock::new(Mutex::default);

fn cache<Q: Query, T: Real>() -> Arc<Cache<Q>> {
    let mut caches = CACHES.lock().unwrap_or_else(PoisonError::into_inner);
    let cache =
        caches.entry(TypeId::of::<(Q, T)>()).or_insert_with(|| Arc::new(Cache::<Q>::default()));
    Arc::clone(cache).downcast().expect("the type is the key")
}

/// Finds stencils, and compiles those that this process has not needed before.
pub struct StencilFinder<Q: Query, T: Real> {
    cache: Arc<Cache<Q>>,
    width: usize,
    format: std::marker::PhantomData<T>,
}

impl<Q: Query, T: Real> StencilFinder<Q, T> {
    /// Creates a finder of stencils for vectors of `width` bytes.
    pub fn new(width: usize) -> Self {
        Self { cache: cache::<Q, T>(), width, format: std::marker::PhantomData }
    }

    /// Returns the stencil for a step.
    pub fn find(&self, step: &StencilStep<'_, Q>) -> Result<Arc<Stencil<Q>>, Error> {
        let key = key(step, self.width);
        let known = self.cache.lock().unwrap_or_else(PoisonError::into_inner).get(&key).cloned();
        if let Some(stencil) = known {
            return Ok(stencil);
        }
        let stencil = Arc::new(make::<Q, T>(step, self.width)?);
        let mut cache = self.cache.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(Arc::clone(cache.entry(key).or_insert(stencil)))
    }
}

/// Loads the operands of a step from the frame and the constants.
fn load<Q: Query, T: Real>(
    emitter: &mut Emitter<'_, '_>,
    frame: &Frame<T>,
    operands: &[StencilOperand<Q>],
) -> Vec<Term<<Q::Kind as ValueKind>::Value<LaneVector>>> {
    let mut values = Vec::new();
    for (number, operand) in operands.iter().enumerate() {
        // The first argument is the place of the result.
        let base = frame.address(emitter, number + 1, operand.is_constant);
        let mut part = 0;
        let value = Q::Kind::map(&operand.shape, &mut |()| {
            part += 1;
            frame.load(emitter, base, part - 1)
        });
        values.push(Term { value, range: operand.range, exponent: operand.exponent });
    }
    values
}

/// Compiles a stencil.
fn make<Q: Query, T: Real>(step: &StencilStep<'_, Q>, width: usize) -> Result<Stencil<Q>, Error> {
    let mut shape = None;
    let code = compile_stencil::<T>(width, |emitter, pointers| {
        let StencilPointers { frame, input, output, lane } = pointers;
        let value = match step {
            StencilStep::Coordinate(axis) => {
                let context = Q::context::<T, _>(emitter, input);
                Q::coordinate::<T, _>(emitter, input, context, *axis)
            }
            StencilStep::Apply(op, operands) => {
                let operands = load::<Q, T>(emitter, frame, operands);
                Q::Kind::apply::<T, _>(emitter, *op, &operands)
            }
            StencilStep::Result(operands, is_bounded) => {
                let values: Vec<_> = load::<Q, T>(emitter, frame, operands)
                    .into_iter()
                    .map(|operand| operand.value)
                    .collect();
                let context = Q::context::<T, _>(emitter, input);
                let result = Q::result::<T, _>(emitter, input, context, &values, *is_bounded);
                output.store::<Q>(emitter, result, *lane);
                return;
            }
        };
        let value = Q::Kind::settled::<T, _>(emitter, value);
        let base = frame.address(emitter, 0, false);
        let mut part = 0;
        shape = Some(Q::Kind::map(&value, &mut |vector: LaneVector| {
            frame.store(emitter, base, part, vector);
            part += 1;
        }));
    })?;
    Ok(Stencil { code, shape })
}
