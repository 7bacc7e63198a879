//! The kernels of surfaces: made when they are first asked for, compiled once whatever the parameters' values, counted.
//!
//! What is simplified and which values parameters have is said elsewhere; what kernels are
//! asked about is not known here.

use crate::simplified::{Form, ProgramError, Simplified};
use crate::uniforms::Uniforms;
use std::fmt;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use zeroset_eval::{
    Asked, Binding, ContractSegments, ContractTiles, Enclose, EncloseGradient, FindZeros, Kernel,
    KernelError, Kernels, Question, Real, Reference, Sample, SampleGradient, Surface, Tape,
    ZeroTest,
};
use zeroset_interval::{Format, Interval};
use zeroset_jit::Compiled;

/// Machine code of all kernels of a document, at most: so much takes about a second to make, and the largest single surfaces
/// that kernels hold need half of it.
const CODE_BYTES: usize = 8 << 20;

/// What runs kernels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Evaluator {
    /// Native code.
    #[default]
    Native,
    /// The reference: the same bits, some hundred times slower.
    Reference,
}

/// A kernel that was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Made {
    /// The number of its surface.
    pub surface: usize,
    /// What question it answers.
    pub question: &'static str,
    /// Of which form of the surface's function.
    pub form: Form,
    /// What it computes in.
    pub format: Format,
    /// Size of the machine code in bytes; 0 for the reference evaluator.
    pub bytes: usize,
    /// Bytes of the vectors that it computes with; 0 likewise.
    pub vector_bytes: usize,
}

impl Made {
    /// The name of the floats it computes in.
    pub fn floats(&self) -> &'static str {
        match self.format {
            Format::F32 => "f32",
            Format::F64 => "f64",
        }
    }

    /// Why a picture needs it.
    pub fn reason(&self) -> &'static str {
        match (self.form, self.question) {
            (_, question) if question == ContractTiles::NAME => "to find the surface, tile by tile",
            (_, question) if question == ContractSegments::NAME => {
                "to find the surface, ray by ray"
            }
            (Form::Function, question) if question == FindZeros::NAME => "to find the surface",
            (Form::Function, question) if question == Sample::NAME => {
                "for places between samples, or normals by differences"
            }
            (Form::Function, _) => "to tell one side from the other",
            (Form::Numerator, question) if question == FindZeros::NAME => {
                "to prove that there is nothing at poles"
            }
            (Form::Numerator | Form::Denominator, _) => "for the cleared form",
            (Form::Branches, _) => "to prove that there is nothing at jumps",
            (Form::Gradient, question) if question == SampleGradient::NAME => "for normals",
            (Form::Gradient, _) => "for proofs by slopes",
        }
    }
}

impl fmt::Display for Made {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { question, form, bytes, .. } = self;
        write!(f, "{question} of {form}, {}, {bytes} bytes, {}", self.floats(), self.reason())
    }
}

/// What all kernels of a program share: how large they may be together, and a list of them.
#[derive(Debug, Default)]
pub(crate) struct Ledger {
    bytes: AtomicUsize,
    made: Mutex<Vec<Made>>,
}

impl Ledger {
    /// All kernels made so far, by surface.
    pub fn made(&self) -> Vec<Made> {
        let mut made = self.made.lock().unwrap_or_else(PoisonError::into_inner).clone();
        made.sort_by_key(|made| (made.surface, made.form, made.question, made.format as u8));
        made
    }

    fn add(&self, made: Made) -> Result<(), ProgramError> {
        let bytes = made.bytes + self.bytes.fetch_add(made.bytes, Ordering::Relaxed);
        self.made.lock().unwrap_or_else(PoisonError::into_inner).push(made);
        within_limit(bytes)
    }

    /// An error once all code together is too long.
    fn is_open(&self) -> Result<(), ProgramError> {
        within_limit(self.bytes.load(Ordering::Relaxed))
    }
}

fn within_limit(bytes: usize) -> Result<(), ProgramError> {
    if bytes > CODE_BYTES {
        return Err(ProgramError::TooMuchCode { limit: CODE_BYTES });
    }
    Ok(())
}

/// Code before values are bound, and how values are.
struct Code<Q: Question, T: Real> {
    steps: Steps<Q, T>,
    uniforms: Uniforms,
}

enum Steps<Q: Question, T: Real> {
    Native(Compiled<Q, T>),
    Reference(Tape<T>),
}

/// Code that is made at most once, or the reason why there can be none; `None` where a surface has no such form.
///
/// The first place is for code in which what depends on parameters alone is computed beforehand, the other for values with
/// which that has no value.
type Slot<Q, T> = [Once<Option<Code<Q, T>>>; 2];

/// The code of one surface in one precision.
#[derive(Default)]
struct Codes<T: Real> {
    zeros: Slot<FindZeros, T>,
    numerator_zeros: Slot<FindZeros, T>,
    branches: Slot<FindZeros, T>,
    bounds: Slot<Enclose, T>,
    numerator: Slot<Enclose, T>,
    denominator: Slot<Enclose, T>,
    segments: Slot<ContractSegments, T>,
    numerator_segments: Slot<ContractSegments, T>,
    tiles: Slot<ContractTiles, T>,
    numerator_tiles: Slot<ContractTiles, T>,
    gradient_bounds: Slot<EncloseGradient, T>,
    values: Slot<Sample, T>,
    gradients: Slot<SampleGradient, T>,
}

/// A kernel with values bound.
type Bound<Q, T> = Box<dyn Kernel<Q, T>>;

/// A kernel that is bound at most once.
type Once<K> = OnceLock<Result<K, KernelError>>;

/// The kernels of one surface in one precision, for present values.
struct Bindings<T: Real> {
    source: Source,
    codes: Arc<Codes<T>>,
    zeros: Once<Bound<FindZeros, T>>,
    bounds: Once<Bound<Enclose, T>>,
    cleared: Once<Option<[Bound<Enclose, T>; 2]>>,
    segments: Once<Bound<ContractSegments, T>>,
    tiles: Once<Bound<ContractTiles, T>>,
    gradient_bounds: Once<Bound<EncloseGradient, T>>,
    values: Once<Bound<Sample, T>>,
    gradients: Once<Bound<SampleGradient, T>>,
}

/// What kernels of one surface are made of.
#[derive(Clone)]
struct Source {
    simplified: Arc<Simplified>,
    ledger: Arc<Ledger>,
    surface: usize,
    evaluator: Evaluator,
    values: Arc<[Interval]>,
}

/// A surface for present values of its parameters.
pub(crate) struct BoundSurface {
    single: Bindings<f32>,
    double: Bindings<f64>,
}

impl BoundSurface {
    pub fn new(
        simplified: &Arc<Simplified>,
        ledger: &Arc<Ledger>,
        surface: usize,
        evaluator: Evaluator,
        values: &Arc<[Interval]>,
    ) -> Self {
        let (simplified, ledger) = (Arc::clone(simplified), Arc::clone(ledger));
        let source = Source { simplified, ledger, surface, evaluator, values: Arc::clone(values) };
        Self {
            single: Bindings::new(source.clone(), Arc::default()),
            double: Bindings::new(source, Arc::default()),
        }
    }

    /// The same code for other values.
    pub fn with(&self, values: &Arc<[Interval]>) -> Self {
        let source = Source { values: Arc::clone(values), ..self.single.source.clone() };
        Self {
            single: Bindings::new(source.clone(), Arc::clone(&self.single.codes)),
            double: Bindings::new(source, Arc::clone(&self.double.codes)),
        }
    }
}

impl Surface for BoundSurface {
    fn single(&self) -> &dyn Kernels<f32> {
        &self.single
    }

    fn double(&self) -> &dyn Kernels<f64> {
        &self.double
    }
}

impl Source {
    /// A form's code with present values bound; `None` if the surface has no such form.
    fn bind<Q: Question, T: Real>(
        &self,
        slot: &Slot<Q, T>,
        form: Form,
    ) -> Result<Option<Bound<Q, T>>, KernelError> {
        for (slot, hoisted) in slot.iter().zip([true, false]) {
            if slot.get().is_none() {
                // Asked beforehand, so that no code is made which does not hold.
                let steps = self.simplified.steps(self.surface, form, hoisted);
                if let Ok(Some((_, uniforms))) = &steps
                    && uniforms.values(&self.values).is_none()
                {
                    continue;
                }
                slot.get_or_init(|| self.make(form, steps).map_err(|error| Arc::new(error) as _));
            }
            let code = slot.get().expect("made").as_ref().map_err(Arc::clone)?;
            let Some(code) = code else { return Ok(None) };
            let Some(values) = code.uniforms.values(&self.values) else { continue };
            let binding = Binding::new(&values);
            return Ok(Some(match &code.steps {
                Steps::Native(compiled) => Box::new(compiled.bind(binding)),
                Steps::Reference(tape) => Box::new(Reference::new(tape.clone(), binding)),
            }));
        }
        unreachable!("a program's values are within what it assumes")
    }

    /// As [`Source::bind`], for forms that every surface has.
    fn bind_always<Q: Question, T: Real>(
        &self,
        slot: &Slot<Q, T>,
        form: Form,
    ) -> Result<Bound<Q, T>, KernelError> {
        Ok(self.bind(slot, form)?.expect("a form of every surface"))
    }

    fn make<Q: Question, T: Real>(
        &self,
        form: Form,
        steps: Result<Option<(Tape<T>, Uniforms)>, ProgramError>,
    ) -> Result<Option<Code<Q, T>>, ProgramError> {
        let Self { ledger, surface, evaluator, .. } = self;
        let Some((tape, uniforms)) = steps? else { return Ok(None) };
        // Others may have used up what there is.
        ledger.is_open()?;
        let (surface, question, format) = (*surface, Q::NAME, T::FORMAT);
        let mut made = Made { surface, question, form, format, bytes: 0, vector_bytes: 0 };
        let steps = match evaluator {
            Evaluator::Native => {
                let compiled = Compiled::new(tape)?;
                (made.bytes, made.vector_bytes) = (compiled.code_bytes(), compiled.vector_bytes());
                Steps::Native(compiled)
            }
            Evaluator::Reference => Steps::Reference(tape),
        };
        ledger.add(made)?;
        Ok(Some(Code { steps, uniforms }))
    }
}

impl<T: Real> Bindings<T> {
    fn new(source: Source, codes: Arc<Codes<T>>) -> Self {
        Self {
            source,
            codes,
            zeros: OnceLock::new(),
            bounds: OnceLock::new(),
            cleared: OnceLock::new(),
            segments: OnceLock::new(),
            tiles: OnceLock::new(),
            gradient_bounds: OnceLock::new(),
            values: OnceLock::new(),
            gradients: OnceLock::new(),
        }
    }

    fn zero_test(&self) -> Result<Bound<FindZeros, T>, KernelError> {
        let (source, codes) = (&self.source, &self.codes);
        let function = source.bind_always(&codes.zeros, Form::Function)?;
        // The boundary of a solid is also where its function changes sign at a pole or in a jump.
        if source.simplified.solid[source.surface] {
            return Ok(function);
        }
        let numerator = source.bind(&codes.numerator_zeros, Form::Numerator)?;
        let branches = source.bind(&codes.branches, Form::Branches)?;
        if numerator.is_none() && branches.is_none() {
            return Ok(function);
        }
        Ok(Box::new(ZeroTest { function, numerator, branches }))
    }

    /// A kernel of the cleared form's numerator, or of the function where there is none.
    fn without_poles<Q: Question>(
        &self,
        numerator: &Slot<Q, T>,
        function: &Slot<Q, T>,
    ) -> Result<Bound<Q, T>, KernelError> {
        let source = &self.source;
        // The boundary of a solid is also where its function changes sign at a pole.
        if !source.simplified.solid[source.surface]
            && let Some(cleared) = source.bind(numerator, Form::Numerator)?
        {
            return Ok(cleared);
        }
        source.bind_always(function, Form::Function)
    }

    fn both_of_cleared(&self) -> Result<Option<[Bound<Enclose, T>; 2]>, KernelError> {
        let numerator = self.source.bind(&self.codes.numerator, Form::Numerator)?;
        let denominator = self.source.bind(&self.codes.denominator, Form::Denominator)?;
        Ok(numerator.zip(denominator).map(Into::into))
    }
}

fn known<K>(result: &Result<K, KernelError>) -> Result<&K, KernelError> {
    result.as_ref().map_err(Arc::clone)
}

impl<T: Real> Kernels<T> for Bindings<T> {
    fn zeros(&self) -> Asked<'_, FindZeros, T> {
        Ok(&**known(self.zeros.get_or_init(|| self.zero_test()))?)
    }

    fn bounds(&self) -> Asked<'_, Enclose, T> {
        let make = || self.source.bind_always(&self.codes.bounds, Form::Function);
        Ok(&**known(self.bounds.get_or_init(make))?)
    }

    fn cleared(&self) -> Result<Option<[&dyn Kernel<Enclose, T>; 2]>, KernelError> {
        let both = known(self.cleared.get_or_init(|| self.both_of_cleared()))?;
        Ok(both.as_ref().map(|[numerator, denominator]| [&**numerator, &**denominator]))
    }

    fn segments(&self) -> Asked<'_, ContractSegments, T> {
        let Codes { numerator_segments, segments, .. } = &*self.codes;
        let make = || self.without_poles(numerator_segments, segments);
        Ok(&**known(self.segments.get_or_init(make))?)
    }

    fn tiles(&self) -> Asked<'_, ContractTiles, T> {
        let Codes { numerator_tiles, tiles, .. } = &*self.codes;
        let make = || self.without_poles(numerator_tiles, tiles);
        Ok(&**known(self.tiles.get_or_init(make))?)
    }

    fn gradient_bounds(&self) -> Asked<'_, EncloseGradient, T> {
        let make = || self.source.bind_always(&self.codes.gradient_bounds, Form::Gradient);
        Ok(&**known(self.gradient_bounds.get_or_init(make))?)
    }

    fn values(&self) -> Asked<'_, Sample, T> {
        let make = || self.source.bind_always(&self.codes.values, Form::Function);
        Ok(&**known(self.values.get_or_init(make))?)
    }

    fn gradients(&self) -> Asked<'_, SampleGradient, T> {
        let make = || self.source.bind_always(&self.codes.gradients, Form::Gradient);
        Ok(&**known(self.gradients.get_or_init(make))?)
    }
}
