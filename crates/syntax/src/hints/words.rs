//! Hints on words: names of functions in other languages and spellings, functions that are not
//! there, and words that begin a line in other systems.

use super::pattern::{calls, filled, matched, pieces};
use super::{Mistake, Proposal};
use std::collections::BTreeSet;
use zeroset_parser::ErrorKind;
use zeroset_parser::settings::setting;
use zeroset_parser::tree::scope::nearest;

/// Names of this language, each with names for the same elsewhere: in words, in German, French,
/// Spanish, Italian and Portuguese, in other systems, and in common misspellings.
#[rustfmt::skip] // one row a line
const NAMES: &[(&str, &str)] = &[
    ("sin", "sine sinus seno sinn sen sinx sinus_ sinu"),
    ("cos", "cosine cosinus coseno kosinus cosseno coss cosx cosin cosn"),
    ("tan", "tangent tangens tangente tann tang"),
    ("cot", "cotangent cotangens cotan"),
    ("sec", "secant sekans"),
    ("csc", "cosecant cosec"),
    ("asin", "arcsine arcussinus arcsinus arcseno invsin sininv asine arcosin aresin"),
    ("acos", "arccosine arcuscosinus arccosinus invcos cosinv acosine arcocos"),
    ("atan", "arctangent arcustangens arctangens invtan taninv arcotan atangent"),
    ("sinh", "hypsin sinushyperbolicus senh shyp sinhyp"),
    ("cosh", "hypcos cosinushyperbolicus cosenh chyp coshyp"),
    ("tanh", "hyptan tangenshyperbolicus tgh thyp tanhyp"),
    ("sqrt", "squareroot square_root sqareroot wurzel quadratwurzel racine raiz radice raizq sqroot rootsq sqtr srqt sqr2 sqrroot rac sqaure_root sqrtt sqroot2 rootof"),
    ("cbrt", "cuberoot cube_root cubicroot kubikwurzel curt cubrt"),
    ("abs", "absolute absolutevalue absolute_value absval betrag valeurabsolue valorabsoluto magn modulus absolut abss asb"),
    ("exp", "exponential exponent expo expon expp esp powe exq"),
    ("ln", "naturallog natlog logn loge logarithm logarithme logaritmo logarithmus lognat nlog log_e lnn"),
    ("log10", "logten log_ten decimallog logdec"),
    ("log2", "logtwo ld lb log_two binarylog"),
    ("pow", "power potenz puissance potencia potenza pwr powr"),
    ("sqr", "squared quadrat squareof carre cuadrado"),
    ("min", "minimum minim mini minimo kleinste least smallest"),
    ("max", "maximum maxim maxi massimo maximo groesste greatest largest"),
    ("floor", "flor floored rounddown round_down abrunden entier gauss_bracket intpart int integer_part suelo piso partieentiere floorr"),
    ("ceil", "ceiling cieling cieil ceilling roundup round_up aufrunden techo teto plafond cel"),
    ("round", "rnd rond rounded runden arrondi nearest roundEven roundto redondear rint"),
    ("trunc", "truncate truncated fix truncation"),
    ("sign", "signum vorzeichen signo signe sinal sgnum sgin"),
    ("mod", "modulo remainder rest reste resto modulus_ rem modul"),
    ("hypot", "hypotenuse hypoth pythag hypothenuse"),
    ("length", "lenght len norm2 magnitude lenth laenge longueur longitud veclength lengh leght lengthof"),
    ("dot", "dotproduct dot_product scalarproduct innerproduct inner skalarprodukt"),
    ("cross", "crossproduct cross_product vectorproduct kreuzprodukt"),
    ("normalize", "normalise normalized normalised unitvector unit normed"),
    ("distance", "dist distanz abstand distancia distanza dst"),
    ("pi", "pie pii PI_ p_i"),
    ("heaviside", "heavyside step_function unitstep stepfunction theta_function hside"),
    ("clamp", "clip limitto constrain bound saturate_"),
    ("mix", "interpolate lerpolate linearinterpolation blendvalues"),
    ("smoothstep", "smooth_step smothstep smootstep"),
    ("besselj", "jbessel besseljn bessel_j"),
    ("diff", "derive deriv derivate ableitung derivee derivada derivata ddx differential"),
    ("grad", "nabla gradiente"),
    ("sum", "summe somme suma somma sigma summ add_up"),
    ("product", "produkt produit producto prodotto multiply_all"),
    ("sphere", "ball kugel esfera sfera bola spere sfere spher shpere"),
    ("box", "cube cuboid quader wuerfel boite caja scatola block brick bx rectangle3d"),
    ("cylinder", "zylinder cylindre cilindro cilinder cyl tube_solid cylindar rod pipe_solid"),
    ("cone", "kegel cono konus conus"),
    ("torus", "donut doughnut toro tore ring_solid torous taurus"),
    ("ellipsoid", "elipsoid elipsoide ellipsoide"),
    ("union", "join unite combine merge unify vereinigung fuse add_solids unon opUnion op_union Union3D"),
    ("intersect", "intersection common overlap schnitt interseccion intersct opIntersection"),
    ("subtract", "difference minus cut substract subtraction differenz without opSubtraction remove carve"),
    ("translate", "shift displace verschieben moveto moved trasladar tranlate transalte"),
    ("rotate", "turn spin drehen rotar rotation roate rotateZ rotate_z"),
    ("scale", "resize enlarge zoomed skalieren stretch escala scaled grow"),
    ("mirror", "flip spiegeln espejo reflectsolid"),
    ("extrude", "linear_extrude linearextrude extrusion extrud"),
    ("revolve", "rotate_extrude lathe rotateextrude revolution revolv"),
    ("offset", "inflate expand dilate thicken_out grow_by"),
    ("shell", "hollow thicken shellof onion opOnion"),
    ("blend", "smooth_union smoothunion smoothmin opSmoothUnion smoothUnion sminUnion blended"),
    ("repeat", "array tile pattern copies opRepeat linear_pattern"),
    ("ring", "polar_array polararray circular_pattern polarpattern circulararray"),
    ("rectangle", "square_shape rectangel rechteck"),
    ("circle", "disk disc kreis circel cercle"),
];

/// Calls that are written otherwise here: the pattern, the reason, and templates in this language.
#[rustfmt::skip] // one row a line
const CALLS: &[(&str, &str, &[&str])] = &[
    ("log(A, V)", "", &["ln(A)/ln(V)"]),
    ("log(V, A)", "", &["ln(A)/ln(V)"]),
    ("log(A, B)", "", &["ln(A)/ln(B)"]),
    ("ln(A, V)", "", &["ln(A)/ln(V)"]),
    ("ln(V, A)", "", &["ln(A)/ln(V)"]),
    ("ln(A, B)", "", &["ln(A)/ln(B)"]),
    ("sqrt(A, V)", "another root is a `root`", &["root(A, V)"]),
    ("sum(N = A to B, D)", "a range has dots between its ends", &["sum(N = A..B, D)"]),
    ("sum(N = A, B, D)", "a range has dots between its ends", &["sum(N = A..B, D)"]),
    ("sum(N, A..B, D)", "a range has an equals sign", &["sum(N = A..B, D)"]),
    ("sum(D, N = A to B)", "a sum has its range first", &["sum(N = A..B, D)"]),
    ("sum(D, N, A, B)", "a sum has its range first", &["sum(N = A..B, D)"]),
    ("product(N = A to B, D)", "a range has dots between its ends", &["product(N = A..B, D)"]),
    ("product(N, A, B, D)", "a product has its range first", &["product(N = A..B, D)"]),
    ("logb(A, B)", "a logarithm to a base is a quotient", &["ln(B)/ln(A)"]),
    ("atan2(A)", "the angle of a point takes both coordinates, as in `atan2(y, x)`; of one value it is `atan`", &["atan(A)"]),
    ("mod(A)", "`mod` also takes what to divide by", &["mod(A, 1)"]),
    ("clamp(A, B)", "`clamp` takes a value and two bounds", &["clamp(A, 0, B)"]),
    ("clamp(A)", "`clamp` takes a value and two bounds", &["clamp(A, 0, 1)"]),
    ("smoothstep(A)", "`smoothstep` takes two ends and a value", &["smoothstep(0, 1, A)"]),
    ("smoothstep(A, B)", "`smoothstep` takes two ends and a value", &["smoothstep(0, A, B)"]),
    ("mix(A, B)", "`mix` also takes how far to go from one to the other", &["mix(A, B, 0.5)"]),
    ("step(A)", "`step` takes an edge and a value", &["step(0, A)"]),
    ("pow(A)", "`pow` takes a base and an exponent", &["pow(A, 2)"]),
    ("root(A)", "`root` also takes which root", &["root(A, 3)"]),
    ("max(A)", "`max` compares two or more values", &["max(A, y)"]),
    ("min(A)", "`min` compares two or more values", &["min(A, y)"]),
    ("besselj(A)", "the order comes first", &["besselj(0, A)"]),
    ("legendre(A)", "the degree comes first", &["legendre(3, A)"]),
    ("round(A, 0)", "`round` takes one value", &["round(A)"]),
    ("round(A, 1)", "`round` takes one value; to one place it is divided again", &["round(10*A)/10"]),
    ("round(A, 2)", "`round` takes one value; to two places it is divided again", &["round(100*A)/100"]),
    ("round(A, 3)", "`round` takes one value; to three places it is divided again", &["round(1000*A)/1000"]),
    ("floor(A, B)", "`floor` takes one value", &["B*floor((A)/B)"]),
    ("bessely(A)", "there are Bessel functions of the first kind only", &["besselj(A)"]),
    ("besselk(A)", "there are Bessel functions of the first kind only", &["besselj(A)"]),
    ("besseli(A)", "there are Bessel functions of the first kind only", &["besselj(A)"]),
    ("yn(A)", "there are Bessel functions of the first kind only", &["besselj(A)"]),
    ("bessel(A)", "there are Bessel functions of the first kind", &["besselj(0, A)"]),
    ("lerp(A, B)", "`lerp` also takes how far to go from one to the other", &["lerp(A, B, 0.5)"]),
    ("length(A, B)", "a distance is the length of a difference", &["length(A - B)"]),
    ("norm(A, B)", "a distance is the length of a difference", &["length(A - B)"]),
    ("vec2(A, B, C)", "three components are a `vec3`", &["vec3(A, B, C)"]),
    ("vec3(A, B)", "two components are a `vec2`", &["vec2(A, B)", "vec3(A, B, 0)"]),
    ("vec3(A, B, C, D)", "four components are a `vec4`", &["vec4(A, B, C, D)"]),
    ("vec4(A, B, C)", "three components are a `vec3`", &["vec3(A, B, C)", "vec4(A, B, C, 1)"]),
    ("dot(A)", "`dot` takes two vectors", &["dot(A, A)"]),
    ("cross(A)", "`cross` takes two vectors", &["cross(A, vec3(0, 0, 1))"]),
    ("distance(A)", "`distance` takes two points", &["length(A)"]),
    ("union(A)", "a union joins two solids or more", &["union(A, box(0.8))"]),
    ("intersect(A)", "an intersection has two solids or more", &["intersect(A, box(0.8))"]),
    ("subtract(A)", "`subtract` takes a solid and what is cut out", &["subtract(A, sphere(0.5))"]),
    ("blend(A, B)", "`blend` also takes the width of the blend", &["blend(A, B, 0.2)"]),
    ("smin(A, B)", "`smin` also takes the width of the blend", &["smin(A, B, 0.2)"]),
    ("twist(A, B)", "there is no `twist`; turn by an angle that grows with z", &["rotate(A, B*z)"]),
    ("twist(A)", "there is no `twist`; turn by an angle that grows with z", &["rotate(A, z)"]),
    ("bend(A, B)", "there is no `bend`; move by a vector that depends on x", &["translate(A, 0, 0, B*x^2)"]),
    ("bend(A)", "there is no `bend`; move by a vector that depends on x", &["translate(A, 0, 0, 0.3*x^2)"]),
    ("shear(A, B)", "there is no `shear`; move by a vector that depends on z", &["translate(A, B*z, 0, 0)"]),
    ("skew(A, B)", "there is no `skew`; move by a vector that depends on z", &["translate(A, B*z, 0, 0)"]),
    ("taper(cylinder(A, B), C)", "there is no `taper`; a cone with two radii is `cone`", &["cone(A, C, B)"]),
    ("minkowski(A, sphere(B))", "there is no `minkowski`; `offset` grows a solid on all sides", &["offset(A, B)"]),
    ("round_edges(box(A), B)", "a box with rounded edges is a `rounded_box`", &["rounded_box(A, B)"]),
    ("fillet(box(A), B)", "a box with rounded edges is a `rounded_box`", &["rounded_box(A, B)"]),
    ("round(box(A), B)", "a box with rounded edges is a `rounded_box`", &["rounded_box(A, B)"]),
    ("hull(sphere(A, (B, C, D)), sphere(A, (E, F, G)))", "there is no `hull`; that of two balls of one radius is a `capsule`", &["capsule((B, C, D), (E, F, G), A)"]),
    ("hull(sphere(A), sphere(A, (E, F, G)))", "there is no `hull`; that of two balls of one radius is a `capsule`", &["capsule((0, 0, 0), (E, F, G), A)"]),
    ("hull(sphere(A), translate(sphere(A), E, F, G))", "there is no `hull`; that of two balls of one radius is a `capsule`", &["capsule((0, 0, 0), (E, F, G), A)"]),
    ("pyramid(A, B)", "there is no `pyramid`; it is a square that grows smaller", &["max(abs(x), abs(y)) - A*(1 - z/B)"]),
    ("pyramid(A)", "there is no `pyramid`; it is a square that grows smaller", &["max(abs(x), abs(y)) - A*(1 - z/A)"]),
    ("prism(A, B, C)", "a prism is an extruded polygon", &["extrude(polygon(A, B), C)"]),
    ("prism(A, B)", "a prism is an extruded polygon", &["extrude(polygon(6, A), B)"]),
    ("hexagon(A)", "a hexagon is a polygon of six sides", &["polygon(6, A)"]),
    ("triangle(A)", "a triangle is a polygon of three sides", &["polygon(3, A)"]),
    ("octagon(A)", "an octagon is a polygon of eight sides", &["polygon(8, A)"]),
    ("square(A)", "a square is a rectangle by its half sizes", &["rectangle(A/2, A/2)"]),
    ("tube(A, B, C)", "a tube is a cylinder less another", &["subtract(cylinder(A, C), cylinder(B, C + 1))"]),
    ("pipe(A, B, C)", "a pipe is a cylinder less another", &["subtract(cylinder(A, C), cylinder(B, C + 1))"]),
    ("tube(A, B)", "a tube is a thin wall in a cylinder", &["shell(cylinder(A, B), 0.1)"]),
    ("washer(A, B)", "a washer is a cylinder less another", &["subtract(cylinder(A, 0.1), cylinder(B, 1))"]),
    ("hemisphere(A)", "half a ball is cut by a plane", &["intersect(sphere(A), -z)"]),
    ("half_sphere(A)", "half a ball is cut by a plane", &["intersect(sphere(A), -z)"]),
    ("dome(A)", "half a ball is cut by a plane", &["intersect(sphere(A), -z)"]),
    ("xor(A, B)", "`xor` is not built in; it is the union without the intersection", &["subtract(union(A, B), intersect(A, B))"]),
    ("gyroid(A)", "a gyroid is written out", &["(sin x cos y + sin y cos z + sin z cos x)"]),
    ("sdSphere(p, A)", "this solid is built in", &["sphere(A)"]),
    ("sdBox(p, A)", "this solid is built in", &["box(A)"]),
    ("sdTorus(p, vec2(A, B))", "this solid is built in, around the z axis", &["rotate(torus(A, B), 90°, (1, 0, 0))"]),
    ("sdCapsule(p, A, B, C)", "this solid is built in", &["capsule(A, B, C)"]),
    ("square(A, B)", "a rectangle is given by its half sizes", &["rectangle(A/2, B/2)"]),
];

/// Lines that draw a curve by a command.
#[rustfmt::skip] // one row a line
const CURVES: &[(&str, &str)] = &[
    ("helix(A, B)", "(A*cos t, A*sin t, B*t) for t in [0, 20]"),
    ("helix(A)", "(A*cos t, A*sin t, 0.2*t) for t in [0, 20]"),
    ("spiral(A, B)", "(A*t*cos t, A*t*sin t, B*t) for t in [0, 20]"),
    ("spiral(A)", "(A*t*cos t, A*t*sin t, 0) for t in [0, 20]"),
    ("spring(A, B)", "(A*cos t, A*sin t, B*t) for t in [0, 20]"),
    ("knot(A, B)", "((2 + cos(B*t))*cos(A*t), (2 + cos(B*t))*sin(A*t), sin(B*t)) for t in [0, 2pi]"),
    ("trefoil()", "(sin t + 2sin(2t), cos t - 2cos(2t), -sin(3t)) for t in [0, 2pi]"),
    ("line(A, B)", "(1 - t)*A + t*B for t in [0, 1]"),
    ("Line(A, B)", "A + t*(B - A) for t in [-3, 3]"),
    ("ray(A, B)", "A + t*(B - A) for t in [0, 3]"),
    ("Ray(A, B)", "A + t*(B - A) for t in [0, 3]"),
];

/// Surfaces with names, and their functions.
#[rustfmt::skip] // one row a line
const SURFACES: &[(&str, &str)] = &[
    ("gyroid", "sin x cos y + sin y cos z + sin z cos x"),
    ("schwarz_p", "cos x + cos y + cos z"),
    ("schwarzp", "cos x + cos y + cos z"),
    ("primitive", "cos x + cos y + cos z"),
    ("diamond", "sin x sin y sin z + sin x cos y cos z + cos x sin y cos z + cos x cos y sin z"),
    ("saddle", "x^2 - y^2 - z"),
    ("paraboloid", "x^2 + y^2 - z"),
    ("hyperboloid", "x^2 + y^2 - z^2 - 1"),
    ("heart", "(x^2 + 9/4*y^2 + z^2 - 1)^3 - x^2*z^3 - 9/80*y^2*z^3"),
    ("helicoid", "x*sin(z) - y*cos(z)"),
    ("catenoid", "cosh(z)^2 - x^2 - y^2"),
    ("goursat", "x^4 + y^4 + z^4 - x^2 - y^2 - z^2"),
    ("tanglecube", "x^4 - 5x^2 + y^4 - 5y^2 + z^4 - 5z^2 + 11.8"),
];

/// Functions that have no counterpart, and advice on each.
#[rustfmt::skip] // one row a line
const ABSENT: &[(&str, &str)] = &[
    ("rand random randint uniform rnd_ randn normal_random zufall Random RandomReal rand01 hash", "there are no random numbers, since each point has one value; write a number such as `0.7`"),
    ("noise perlin simplex snoise fbm perlin_noise simplexnoise voronoi worley cellular turbulence pnoise", "there is no noise here; a sum of waves such as `sin(3x)*sin(4y)/3` is uneven, too, or define `noise(a, b) = …`"),
    ("integral integrate int_ Integrate quad antiderivative primitive_of trapz NIntegrate", "there are no integrals; write the antiderivative, as in `1 - cos(x)` for that of sin from 0 to x"),
    ("texture texture2D tex2D texelFetch sampler textureLod tex image imread", "there are no textures; write a formula in its place, such as `0.1*sin(9*x)`"),
    ("hypergeometric zeta polylog lambertw airy airyai elliptic ellipk beta digamma psi theta3", "no proven bounds are known here for this function; write a formula for it"),
    ("inverse", "there is no inverse of a matrix; that of one that only turns is `transpose(m)`"),
    ("chamfer fillet round_edges bevel", "edges are not cut or rounded one by one; a box with rounded edges is `rounded_box(2, 1, 1, 0.2)`, and `blend(a, b, r)` rounds where two solids meet"),
    ("hull convex_hull", "there is no hull of any solids; that of two balls of one radius is `capsule((0, 0, 0), (2, 0, 0), 1)`"),
    ("thread screw_thread", "there are no threads; a solid that turns with z is `rotate(s, 2*pi*z/pitch)`"),
    ("fft convolve interp interp1d spline polyfit fit regression", "there is no data here; write the formula of what is to be drawn"),
    ("print printf disp echo console_log println alert", "nothing is printed here; a formula is drawn, and `zeroset eval` prints its values"),
    ("input prompt readline scanf", "nothing is asked here; a slider is written `a = 2 in [0, 5]`"),
];

/// Advice on the function `name`, if it has no counterpart here, and whether some calls of it have
/// one.
pub(super) fn absent(name: &str) -> Option<(&'static str, bool)> {
    let is_name = |names: &str| names.split(' ').any(|one| one == name);
    let (_, why) = ABSENT.iter().find(|(names, _)| is_name(names))?;
    let has_calls = CALLS.iter().any(|(call, ..)| call.split('(').next() == Some(name));
    Some((why, has_calls))
}

/// The name in this language for a name from elsewhere.
fn here(name: &str) -> Option<&'static str> {
    let is_own = |names: &str| names.split_whitespace().any(|one| one.eq_ignore_ascii_case(name));
    NAMES.iter().find(|(_, names)| is_own(names)).map(|(here, _)| *here)
}

/// Calls in other words, and names of surfaces.
pub(super) fn proposals(mistake: &Mistake<'_>) -> Vec<Proposal> {
    let line = mistake.line;
    let mut all = Vec::new();
    for (pattern, template) in CURVES {
        if let Some(parts) = matched(pattern, line) {
            all.push(Proposal::new("this is a curve with a parameter", filled(template, &parts)));
        }
    }
    for call in calls(line).into_iter().filter(|call| call.range.contains(&mistake.place.start)) {
        for (pattern, why, templates) in CALLS {
            if let Some(parts) = matched(pattern, &line[call.range.clone()]) {
                let lines = templates.iter().map(|template| {
                    let whole = mistake.replaced(call.range.clone(), &filled(template, &parts));
                    Proposal::new(*why, whole)
                });
                all.extend(lines);
            }
        }
    }
    if let ErrorKind::InWords = mistake.kind {
        for call in calls(line) {
            let name = call.range.start..call.range.start + call.name.len();
            let named = here(call.name).map(|here| mistake.replaced(name, here));
            let why = format!("`{}` is a function", call.name);
            all.extend(named.map(|line| Proposal::new(why, line)));
        }
    }
    let parts = matched("N(A) = B", line).or_else(|| matched("N = B", line));
    if let Some(parts) = parts
        && parts[&'B'].parse::<f64>().is_ok()
        && let Some((name, function)) = SURFACES.iter().find(|(name, _)| *name == parts[&'N'])
    {
        let formula = format!("{function} = {}", parts[&'B']);
        all.push(Proposal::new(format!("`{name}` is not built in, but has a formula"), formula));
    }
    let word = mistake.typed();
    if let ErrorKind::UnknownName { .. } = mistake.kind
        && let Some((name, function)) = SURFACES.iter().find(|(name, _)| *name == word)
    {
        let why = format!("give `{name}` its formula on a line of its own");
        all.push(Proposal::new(why, format!("{name} = {function}\n{line}")));
    }
    // Renames all calls from elsewhere at once.
    let mut renamed = line.to_owned();
    let mut others = 0;
    for call in calls(line).iter().rev() {
        if let Some(here) = here(call.name) {
            let end = call.range.start + call.name.len();
            renamed.replace_range(call.range.start..end, here);
            others += 1;
        }
    }
    if others > 1 {
        all.push(Proposal::new("functions have their usual short names", renamed));
    }
    if let Some(here) = here(word) {
        let why = format!("`{word}` is written `{here}` here");
        all.push(Proposal::new(why, mistake.replaced(mistake.place.clone(), here)));
    }
    all
}

/// A name with the spelling corrected, if the error suggests one: the whole line.
pub(super) fn misspelled(mistake: &Mistake<'_>) -> Vec<Proposal> {
    let is_name =
        matches!(mistake.kind, ErrorKind::UnknownFunction { .. } | ErrorKind::UnknownName { .. });
    let word = mistake.typed();
    if !is_name || word.is_empty() {
        return Vec::new();
    }
    let mut all = product_with_letters(mistake, word);
    let is_function = |name: &str| {
        zeroset_ops::names().any(|other| other == name)
            || zeroset_ops::builders(name).next().is_some()
    };
    // `resolution 100` and `light (x, 1, 2)` are no misspelled functions.
    let is_line = pieces(mistake.line).len() == 2 || setting(word).is_some();
    let fits = |name: &str| !(is_line && is_function(name));
    let suggested = mistake.suggestion.map(|suggestion| suggestion.replacement.as_str());
    // A misspelled name from elsewhere.
    let others = NAMES.iter().flat_map(|(_, names)| names.split_whitespace());
    let others = others.filter(|other| other.chars().next() == word.chars().next());
    let elsewhere = nearest(word, others).as_deref().and_then(here);
    for name in suggested.into_iter().chain(elsewhere).filter(|name| fits(name)) {
        let line = mistake.replaced(mistake.place.clone(), name);
        all.push(Proposal::new(format!("did you mean `{name}`?"), line));
    }
    all
}

/// Functions that may stand at the end of a name.
const FUNCTIONS: [&str; 14] = [
    "sinh", "cosh", "tanh", "asin", "acos", "atan", "sqrt", "sin", "cos", "tan", "exp", "abs",
    "log", "ln",
];

/// Constants that may stand at the start of a name.
const CONSTANTS: [&str; 2] = ["pi", "tau"];

/// Reads `axcos(y)` and `pir` as products, with values for the letters that have none.
fn product_with_letters(mistake: &Mistake<'_>, word: &str) -> Vec<Proposal> {
    let is_product = |letters: &str| {
        (1..=3).contains(&letters.len()) && letters.bytes().all(|c| c.is_ascii_lowercase())
    };
    let split = |letters: &str| letters.chars().map(String::from).collect::<Vec<_>>().join("*");
    let call = FUNCTIONS.iter().find_map(|function| {
        let letters = word.strip_suffix(function)?;
        is_product(letters).then(|| (letters, format!("{}*{function}", split(letters))))
    });
    let multiple = CONSTANTS.iter().find_map(|constant| {
        let letters = word.strip_prefix(constant)?;
        is_product(letters).then(|| (letters, format!("{constant}*{}", split(letters))))
    });
    let Some((letters, product)) = call.or(multiple) else { return Vec::new() };
    let line = mistake.replaced(mistake.place.clone(), &product);
    let values: BTreeSet<char> = letters.chars().filter(|c| !"xyzt".contains(*c)).collect();
    let values: Vec<String> = values.iter().map(|letter| format!("{letter} = 1")).collect();
    let why = format!("`{word}` has no meaning; as a product");
    let with_values = format!("{}\n{line}", values.join("; "));
    vec![Proposal::new(why.clone(), line), Proposal::new(why, with_values)]
}

#[cfg(test)]
mod tests {
    use super::{ABSENT, NAMES};
    use std::collections::HashSet;
    use zeroset_parser::tree::scope::{NameMeaning, built_in};

    #[test]
    fn names_lead_to_names_of_the_language() {
        let mut seen = HashSet::new();
        for (here, names) in NAMES {
            let is_known =
                built_in(here) != NameMeaning::Unknown || zeroset_ops::form(here).is_some();
            assert!(is_known, "{here}");
            for name in names.split_whitespace() {
                assert!(seen.insert(name), "{name} is listed twice");
                assert!(
                    !ABSENT.iter().any(|(all, _)| all.split(' ').any(|one| one == name)),
                    "{name}"
                );
            }
        }
    }
}
