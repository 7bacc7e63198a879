//! Stencils: code for one step of a tape, or for one clause, compiled once per process.
//!
//! A stencil reads the values of a step's operands from a frame in memory and writes the step's
//! value there. Which vectors a value has is known when the stencil is compiled. So an operation
//! has a stencil for each shape, [coarse](Tape::coarse) range and kind of exponent of its operands.
//! A clause has a stencil for its operations, and for the shapes, ranges and kinds of exponent of
//! its constants, its coordinates and the steps that it uses.

use crate::clause_code::ClauseCode;
use crate::code::Code;
use crate::count::Counter;
use crate::error::Error;
use crate::lanes::{Emitter, LaneVector};
use crate::stencil_code::{StencilFrame, StencilPointers, compile_stencil};
use cranelift_codegen::ir::Value;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use std::any::{Any, TypeId};
use std::collections::HashMap;
use std::marker::PhantomData;
use std::sync::{
    LazyLock, Mutex, OnceLock, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard,
};
use zeroset_eval::{Query, QueryNumber, QueryTask, QueryValue, Real, Tape, ValueKind};
use zeroset_interval::{Exponent, Format, Interval, Term};
use zeroset_ir::Axis;
use zeroset_ops::Op;

/// A value without vectors: only what is known when code is compiled.
pub type Shape<Q> = QueryValue<Q, Counter>;

/// The properties of an operand that are known when code is compiled.
#[derive(Clone, Copy)]
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

/// A step of a tape, or the result that follows the last step. Operands are given by number.
pub enum StencilStep<'a> {
    /// Loads a coordinate.
    Coordinate(Axis),
    /// Applies an operation.
    Apply(Op, &'a [OperandNumber]),
    /// Computes a clause from the steps that it uses.
    Clause(ClauseNumber, &'a [OperandNumber]),
    /// Stores the bounds of a value in the trace.
    Trace(OperandNumber),
    /// Computes the result of the query; `true` if the first value is finite in every sample.
    Result(&'a [OperandNumber], bool),
}

/// Code for one step.
pub struct Stencil<Q: Query> {
    /// The code, whose arguments are those of [`StencilPointers`].
    pub code: Code,
    /// The shape of the step's value; `None` for the result.
    pub shape: Option<Shape<Q>>,
    /// The number of the step's value as an operand, set once it is known to follow from the
    /// operands.
    value: OnceLock<OperandNumber>,
}

/// Number of vectors in a value.
pub fn parts<Q: Query>(shape: &Shape<Q>) -> usize {
    let mut parts = 0;
    Q::Kind::map(shape, &mut |()| parts += 1);
    parts
}

/// Key of an operand: the code of its shape, its range, its kind of exponent, and whether it is a
/// constant.
type OperandKey = (u128, [u64; 2], Exponent, bool);
/// Number of an operand among all of its query that this process has seen.
pub type OperandNumber = u32;
/// Number of a [`ClauseCode`] among all of its query that this process has seen.
pub type ClauseNumber = u32;
/// Key of a stencil: width of vectors, kind of step, its operation, axis or flag, and its operands.
/// Those of a clause follow its number.
type StencilKey = (u8, u8, u8, SmallVec<[OperandNumber; 4]>);

/// All stencils of one query in one format.
struct Cache<Q: Query> {
    numbers: FxHashMap<OperandKey, OperandNumber>,
    /// The operands by number.
    operands: Vec<StencilOperand<Q>>,
    clause_numbers: FxHashMap<&'static ClauseCode, ClauseNumber>,
    /// The codes of clauses by number.
    clauses: Vec<&'static ClauseCode>,
    /// Stencils are never freed, so that calls need not keep them alive.
    stencils: FxHashMap<StencilKey, &'static Stencil<Q>>,
}

impl<Q: Query> Default for Cache<Q> {
    fn default() -> Self {
        Self {
            numbers: FxHashMap::default(),
            operands: Vec::new(),
            clause_numbers: FxHashMap::default(),
            clauses: Vec::new(),
            stencils: FxHashMap::default(),
        }
    }
}

/// Returns the key of a step.
fn key(step: &StencilStep<'_>, width: usize) -> StencilKey {
    let (kind, detail, operands) = match step {
        StencilStep::Clause(number, used) => {
            let numbers = std::iter::once(number).chain(*used).copied();
            return (width as u8, 4, 0, numbers.collect());
        }
        StencilStep::Coordinate(axis) => (0, *axis as u8, &[][..]),
        StencilStep::Apply(op, operands) => (1, *op as u8, *operands),
        StencilStep::Trace(operand) => (2, 0, std::slice::from_ref(operand)),
        StencilStep::Result(operands, is_bounded) => (3, u8::from(*is_bounded), *operands),
    };
    (width as u8, kind, detail, SmallVec::from_slice(operands))
}

fn operand_key<Q: Query>(operand: &StencilOperand<Q>) -> OperandKey {
    let Interval { lo, hi } = operand.range;
    let ends = [lo, hi].map(f64::to_bits);
    (Q::Kind::shape(&operand.shape), ends, operand.exponent, operand.is_constant)
}

/// A cache that all threads share.
type SharedCache<Q> = RwLock<Cache<Q>>;

/// The caches of this process, by query and format.
static CACHES: LazyLock<Mutex<HashMap<TypeId, &'static (dyn Any + Send + Sync)>>> =
    LazyLock::new(Mutex::default);

fn cache<Q: Query, T: Real>() -> &'static SharedCache<Q> {
    let mut caches = CACHES.lock().unwrap_or_else(PoisonError::into_inner);
    let cache = caches
        .entry(TypeId::of::<(Q, T)>())
        .or_insert_with(|| Box::leak(Box::new(SharedCache::<Q>::default())));
    cache.downcast_ref().expect("the type is the key")
}

/// Finds stencils, and compiles those that this process has not needed before.
pub struct StencilFinder<Q: Query, T: Real> {
    cache: &'static SharedCache<Q>,
    /// Locked for reading while many steps are found.
    guard: Option<RwLockReadGuard<'static, Cache<Q>>>,
    width: usize,
    format: PhantomData<T>,
}

impl<Q: Query, T: Real> StencilFinder<Q, T> {
    /// Creates a finder of stencils for vectors of `width` bytes.
    pub fn new(width: usize) -> Self {
        Self { cache: cache::<Q, T>(), guard: None, width, format: PhantomData }
    }

    fn read(&mut self) -> &Cache<Q> {
        let cache = self.cache;
        self.guard.get_or_insert_with(|| cache.read().unwrap_or_else(PoisonError::into_inner))
    }

    fn write(&mut self) -> RwLockWriteGuard<'static, Cache<Q>> {
        self.guard = None;
        self.cache.write().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns the number of an operand.
    pub fn number(&mut self, operand: &StencilOperand<Q>) -> OperandNumber {
        let key = operand_key(operand);
        if let Some(number) = self.read().numbers.get(&key) {
            return *number;
        }
        let mut cache = self.write();
        let Cache { numbers, operands, .. } = &mut *cache;
        *numbers.entry(key).or_insert_with(|| {
            operands.push(*operand);
            operands.len() as OperandNumber - 1
        })
    }

    /// Returns an operand by its number.
    pub fn operand(&mut self, number: OperandNumber) -> StencilOperand<Q> {
        self.read().operands[number as usize]
    }

    /// Returns the number of a clause's code, and the code as it is kept.
    pub fn keep_clause(&mut self, code: ClauseCode) -> (ClauseNumber, &'static ClauseCode) {
        if let Some((code, number)) = self.read().clause_numbers.get_key_value(&code) {
            return (*number, *code);
        }
        let mut cache = self.write();
        let Cache { clause_numbers, clauses, .. } = &mut *cache;
        let code: &'static ClauseCode = Box::leak(Box::new(code));
        let number = *clause_numbers.entry(code).or_insert_with(|| {
            clauses.push(code);
            clauses.len() as ClauseNumber - 1
        });
        (number, code)
    }

    /// Returns the stencil of a step that has a value, and the number of that value.
    pub fn find_valued(
        &mut self,
        step: &StencilStep<'_>,
    ) -> Result<(&'static Stencil<Q>, OperandNumber), Error> {
        let stencil = self.find(step)?;
        if let Some(&number) = stencil.value.get() {
            return Ok((stencil, number));
        }
        let range = match step {
            StencilStep::Apply(op, operands) => {
                let term = |&number: &OperandNumber| {
                    let one = self.operand(number);
                    (one.range, one.exponent)
                };
                Tape::<T>::coarse_range(*op, &operands.iter().map(term).collect::<Vec<_>>())
            }
            StencilStep::Clause(number, used) => {
                let code = self.read().clauses[*number as usize];
                let operand = |&number: &OperandNumber| self.operand(number);
                let operands: Vec<_> = code.operands(used).map(operand).collect();
                *code.ranges::<Q, T>(used, &operands).last().expect("a step")
            }
            _ => unreachable!("a step with operands"),
        };
        let shape = stencil.shape.expect("a step has a value");
        let value = StencilOperand { shape, range, exponent: Exponent::Real, is_constant: false };
        // Nobody waits for a lock inside `get_or_init`: others may wait there with a lock.
        let number = self.number(&value);
        Ok((stencil, *stencil.value.get_or_init(|| number)))
    }

    /// Returns the stencil for a step.
    pub fn find(&mut self, step: &StencilStep<'_>) -> Result<&'static Stencil<Q>, Error> {
        let key = key(step, self.width);
        let cache = self.read();
        if let Some(stencil) = cache.stencils.get(&key) {
            return Ok(stencil);
        }
        let operand = |&number: &OperandNumber| cache.operands[number as usize];
        let (clause, operands): (_, Vec<StencilOperand<Q>>) = match step {
            StencilStep::Clause(number, used) => {
                let code = cache.clauses[*number as usize];
                (Some(code), code.operands(used).map(operand).collect())
            }
            _ => (None, key.3.iter().map(operand).collect()),
        };
        // Compiling must not keep others from reading.
        self.guard = None;
        let make = Make { step, clause, operands: &operands, width: self.width };
        let stencil = make_any(Q::NUMBER, T::FORMAT, make)?;
        let stencil = stencil.downcast().expect("a stencil for the query");
        Ok(self.write().stencils.entry(key).or_insert_with(|| Box::leak(stencil)))
    }
}

/// A value in code that is being generated.
pub type CodeTerm<Q> = Term<<<Q as Query>::Kind as ValueKind>::Value<LaneVector>>;

/// Loads an operand from its address, less `skipped` vectors.
pub fn load_at<Q: Query, T: Real>(
    emitter: &mut Emitter<'_, '_>,
    frame: &StencilFrame<T>,
    operand: &StencilOperand<Q>,
    base: Value,
    skipped: usize,
) -> CodeTerm<Q> {
    let mut part = skipped;
    let value = Q::Kind::map(&operand.shape, &mut |()| {
        part += 1;
        frame.load(emitter, base, part - 1)
    });
    Term { value, range: operand.range, exponent: operand.exponent }
}

/// Loads operands of a step from the frame and the constants. `first` is the place of the first one
/// among those of the call.
pub fn load<Q: Query, T: Real>(
    emitter: &mut Emitter<'_, '_>,
    frame: &StencilFrame<T>,
    operands: &[StencilOperand<Q>],
    first: usize,
) -> Vec<CodeTerm<Q>> {
    let mut values = Vec::new();
    for (number, operand) in operands.iter().enumerate() {
        let base = frame.address(emitter, first + number, operand.is_constant);
        values.push(load_at::<Q, T>(emitter, frame, operand, base, 0));
    }
    values
}

/// Compiles a stencil. It is compiled in this crate alone.
fn make_any(query: QueryNumber, format: Format, task: Make<'_>) -> Result<Box<dyn Any>, Error> {
    query.run(format, task)
}

struct Make<'a> {
    step: &'a StencilStep<'a>,
    /// The code of a clause.
    clause: Option<&'a ClauseCode>,
    /// A vector of operands of the task's query.
    operands: &'a dyn Any,
    width: usize,
}

impl QueryTask for Make<'_> {
    /// A stencil for the task's query.
    type Result = Result<Box<dyn Any>, Error>;

    fn run<Q: Query, T: Real>(self) -> Result<Box<dyn Any>, Error> {
        let operands = self.operands.downcast_ref::<Vec<StencilOperand<Q>>>();
        let operands = operands.expect("operands of this query");
        Ok(Box::new(make::<Q, T>(&self, operands)?))
    }
}

/// Compiles a stencil.
fn make<Q: Query, T: Real>(
    &Make { step, clause, width, .. }: &Make<'_>,
    operands: &[StencilOperand<Q>],
) -> Result<Stencil<Q>, Error> {
    let mut shape = None;
    let code = compile_stencil::<T>(width, |emitter, pointers| {
        let StencilPointers { frame, input, output, lane } = pointers;
        let value = match step {
            StencilStep::Coordinate(axis) => {
                let context = Q::Kind::context::<T, _>(emitter, input);
                Q::Kind::coordinate::<T, _>(emitter, input, context, *axis)
            }
            StencilStep::Apply(op, _) => {
                let operands = load::<Q, T>(emitter, frame, operands, 1);
                Q::Kind::apply::<T, _>(emitter, *op, &operands)
            }
            StencilStep::Clause(_, used) => {
                let code = clause.expect("the code of a clause");
                code.emit::<Q, T>(emitter, frame, used, operands)
            }
            StencilStep::Trace(_) => {
                let values = load::<Q, T>(emitter, frame, operands, 1);
                let bounds = Q::Kind::bounds::<T, _>(emitter, &values[0]);
                frame.trace(emitter, *lane, &bounds.expect("a kind with proofs"));
                return;
            }
            StencilStep::Result(_, is_bounded) => {
                let values: Vec<_> = load::<Q, T>(emitter, frame, operands, 1)
                    .into_iter()
                    .map(|operand| operand.value)
                    .collect();
                let context = Q::Kind::context::<T, _>(emitter, input);
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
    Ok(Stencil { code, shape, value: OnceLock::new() })
}
