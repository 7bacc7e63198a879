//! Special forms: they look like functions, but their arguments are not a plain list of numbers.

/// The meaning of a special form.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FormKind {
    /// A choice between values. Conditions and values alternate, and a default value may come last.
    Choose,
    /// A choice written as bracketed pieces, each with its value before its condition.
    Pieces,
    /// A sum over a range of whole numbers.
    Sum,
    /// A product over a range of whole numbers.
    Product,
    /// A function that is applied repeatedly.
    Iterate,
    /// A vector with this number of components.
    Vector(u8),
    /// A square matrix with this number of rows.
    Matrix(u8),
    /// A function that combines the components of vectors or matrices.
    OfVectors(VectorFunction),
    /// A product of matrices and vectors.
    Multiply,
    /// A derivative by one or more variables.
    Derivative,
    /// A function of the derivatives by x, y and z.
    OfDerivatives(Differential),
}

/// A function of a value's derivatives by x, y and z.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Differential {
    /// The vector of the three derivatives.
    Gradient,
    /// The sum of the three second derivatives.
    Laplacian,
    /// The mean curvature of the level surface through a point; above 0 where a solid is convex.
    MeanCurvature,
    /// The Gaussian curvature of the level surface through a point.
    GaussianCurvature,
}

impl Differential {
    /// The name under which the function is printed.
    ///
    /// # Panics
    /// Never: the table has a row for every function.
    pub fn name(self) -> &'static str {
        name_of(FormKind::OfDerivatives(self))
    }
}

/// A function that combines the components of its arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum VectorFunction {
    /// The scalar product.
    Dot,
    /// The vector product.
    Cross,
    /// The vector of length 1 in the direction of a given vector.
    Normalize,
    /// The distance between two points.
    Distance,
    /// The mirror image of a vector in the plane that has a given unit normal.
    Reflect,
    /// A matrix with rows and columns exchanged.
    Transpose,
    /// The determinant of a matrix.
    Determinant,
    /// The complex number with given real and imaginary parts.
    Complex,
    /// The quaternion with given components, the real one first.
    Quaternion,
    /// The real part of a complex number or quaternion.
    RealPart,
    /// The imaginary part of a complex number. For a quaternion, the vector of its other parts.
    ImaginaryPart,
    /// The angle of a complex number, in (−π, π]; undefined at 0.
    Argument,
    /// The complex number or quaternion with the opposite imaginary part.
    Conjugate,
}

impl VectorFunction {
    /// The name under which the function is printed.
    ///
    /// # Panics
    /// Never: the table has a row for every function.
    pub fn name(self) -> &'static str {
        name_of(FormKind::OfVectors(self))
    }

    /// Returns whether the function makes complex numbers or quaternions, or takes them apart.
    pub fn is_complex(self) -> bool {
        match self {
            Self::Complex
            | Self::Quaternion
            | Self::RealPart
            | Self::ImaginaryPart
            | Self::Argument
            | Self::Conjugate => true,
            Self::Dot
            | Self::Cross
            | Self::Normalize
            | Self::Distance
            | Self::Reflect
            | Self::Transpose
            | Self::Determinant => false,
        }
    }

    /// Number of arguments that the function takes.
    pub fn arity(self) -> usize {
        match self {
            Self::Normalize
            | Self::Transpose
            | Self::Determinant
            | Self::RealPart
            | Self::ImaginaryPart
            | Self::Argument
            | Self::Conjugate => 1,
            Self::Dot | Self::Cross | Self::Distance | Self::Reflect | Self::Complex => 2,
            Self::Quaternion => 4,
        }
    }
}

/// A special form and its spellings.
#[derive(Debug)]
pub struct SpecialForm {
    /// The name under which the form is printed.
    pub name: &'static str,
    /// Other names that formulas may use for the form.
    pub aliases: &'static [&'static str],
    /// The meaning of the form.
    pub meaning: FormKind,
    /// An example of how the form is used.
    pub usage: &'static str,
    /// One line of help about the form.
    pub doc: &'static str,
}

const fn row(
    name: &'static str,
    aliases: &'static [&'static str],
    meaning: FormKind,
    usage: &'static str,
    doc: &'static str,
) -> SpecialForm {
    SpecialForm { name, aliases, meaning, usage, doc }
}

/// Every special form, one row each.
#[rustfmt::skip] // one row a line
pub static FORMS: &[SpecialForm] = &[
    row("if", &["which", "where", "ifelse"], FormKind::Choose, "if(x < 0, x^2, x)", "a choice, also {x < 0: x^2, x}; conditions are tried in turn, and without a last value it is undefined where none holds"),
    row("piecewise", &[], FormKind::Pieces, "piecewise([[x^2, x < 0], [x, x >= 0]])", "a choice whose pieces are in brackets, the value first"),
    row("sum", &["summation", "add"], FormKind::Sum, "sum(k = 1..5, sin(k x)/k)", "a sum over whole numbers, at most 1000"),
    row("product", &["prod"], FormKind::Product, "product(k = 1..3, x - k)", "a product over whole numbers, at most 1000"),
    row("iterate", &["nest"], FormKind::Iterate, "iterate(f, 3, x)", "f(f(f(x))): a function applied n times, at most 1000"),
    row("vec2", &["float2", "vec2f", "ivec2"], FormKind::Vector(2), "vec2(x, y)", "a vector of two components, its parts .x and .y"),
    row("vec3", &["float3", "vec3f", "ivec3", "vector", "array", "stack", "tensor"], FormKind::Vector(3), "vec3(x, y, z)", "a vector of three components, its parts .x, .y and .z"),
    row("vec4", &["float4", "vec4f"], FormKind::Vector(4), "vec4(x, y, z, 1)", "a vector of four components, its parts .x to .w"),
    row("mat2", &["mat2x2", "mat2x2f", "float2x2", "half2x2", "matrix"], FormKind::Matrix(2), "mat2(1, 0, 0, 1)", "a matrix of two columns, given one after the other; times a vector it is one"),
    row("mat3", &["mat3x3", "mat3x3f", "float3x3", "half3x3"], FormKind::Matrix(3), "mat3(1, 0, 0, 0, 1, 0, 0, 0, 1)", "a matrix of three columns"),
    row("mat4", &["mat4x4", "mat4x4f", "float4x4", "half4x4"], FormKind::Matrix(4), "mat4(1)", "a matrix of four columns, here with ones on its diagonal"),
    row("transpose", &[], FormKind::OfVectors(VectorFunction::Transpose), "transpose(mat2(1, 2, 3, 4))", "a matrix with rows and columns exchanged"),
    row("determinant", &["det"], FormKind::OfVectors(VectorFunction::Determinant), "determinant(mat2(1, 2, 3, 4))", "the determinant of a matrix"),
    row("mul", &[], FormKind::Multiply, "mul(mat2(1, 2, 3, 4), vec2(x, y))", "m*p: a product of matrices and vectors"),
    row("dot", &[], FormKind::OfVectors(VectorFunction::Dot), "dot(p, q)", "scalar product of two vectors"),
    row("cross", &[], FormKind::OfVectors(VectorFunction::Cross), "cross(p, q)", "vector product of two vectors of three components"),
    row("normalize", &[], FormKind::OfVectors(VectorFunction::Normalize), "normalize(p)", "p/length(p)"),
    row("distance", &[], FormKind::OfVectors(VectorFunction::Distance), "distance(p, q)", "length(p - q)"),
    row("reflect", &[], FormKind::OfVectors(VectorFunction::Reflect), "reflect(p, n)", "p - 2 dot(n, p) n"),
    row("diff", &["D", "Diff", "derivative", "differentiate"], FormKind::Derivative, "diff(x^2*y, x)", "derivative; diff(f, x, x, y) is a third one"),
    row("grad", &["gradient"], FormKind::OfDerivatives(Differential::Gradient), "length(grad(x^2 + y*z))", "the vector of the derivatives by x, y and z"),
    row("laplacian", &["laplace"], FormKind::OfDerivatives(Differential::Laplacian), "laplacian(x^2 + y*z)", "the sum of the second derivatives by x, y and z"),
    row("mean_curvature", &[], FormKind::OfDerivatives(Differential::MeanCurvature), "mean_curvature(x^2 + y*z)", "mean curvature of the level surface; 1/r on a ball x^2 + y^2 + z^2 - r^2"),
    row("curvature", &["gaussian_curvature"], FormKind::OfDerivatives(Differential::GaussianCurvature), "curvature(x^2 + y*z)", "Gaussian curvature of the level surface"),
    row("complex", &["cmplx"], FormKind::OfVectors(VectorFunction::Complex), "abs(complex(x, y)^2)", "the complex number x + i y"),
    row("quat", &["quaternion"], FormKind::OfVectors(VectorFunction::Quaternion), "abs(quat(x, y, z, 0)^2)", "a quaternion, its real part first; a product depends on the order"),
    row("re", &["real", "creal", "realpart"], FormKind::OfVectors(VectorFunction::RealPart), "re((x + i y)^2)", "real part of a complex number"),
    row("im", &["imag", "cimag", "imagpart"], FormKind::OfVectors(VectorFunction::ImaginaryPart), "im((x + i y)^2)", "imaginary part of a complex number"),
    row("arg", &["carg", "phase", "angle"], FormKind::OfVectors(VectorFunction::Argument), "arg(x + i y)", "angle of a complex number, in (-pi, pi]; undefined at 0"),
    row("conj", &["conjugate", "overline"], FormKind::OfVectors(VectorFunction::Conjugate), "abs(conj(x + i y))", "x - i y: the conjugate of x + i y"),
];

/// The name under which a form is printed.
fn name_of(meaning: FormKind) -> &'static str {
    FORMS.iter().find(|form| form.meaning == meaning).expect("each has a row").name
}

/// Returns the special form with this name or alias, in exact spelling.
pub fn form(name: &str) -> Option<&'static SpecialForm> {
    FORMS.iter().find(|form| form.name == name || form.aliases.contains(&name))
}
