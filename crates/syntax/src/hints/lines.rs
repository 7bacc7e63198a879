//! Hints on whole statements: signs, conditions, words and lines of other systems.

use super::pattern::{filled, matched};
use super::{Mistake, Proposal};
use zeroset_parser::ErrorKind;

/// Statements that are written otherwise here: the pattern, the reason, and templates in this
/// language.
#[rustfmt::skip] // one row a line
const LINES: &[(&str, &str, &[&str])] = &[
    // Signs.
    ("N = N -> A", "a graph needs no arrow", &["z = A"]),
    ("N : N -> A", "a function is defined by its values", &["N(x) = A"]),
    ("N(A) -> B", "a function is defined by `=`", &["N(A) = B"]),
    ("A -> B", "an equation is written with `=`", &["A = B"]),
    ("A <- B", "an equation is written with `=`", &["A = B"]),
    ("A === B", "one `=` is enough", &["A = B"]),
    ("A = B ^^ C", "one `^` is enough", &["A = B^C"]),
    ("A ^^ B", "one `^` is enough", &["A^B"]),
    ("A = N()B", "the argument stands in the brackets", &["A = N(B)"]),
    ("A = N() B", "the argument stands in the brackets", &["A = N(B)"]),
    ("A = B ± C", "a formula has one value; these are two surfaces", &["A = B + C\nA = B - C"]),
    ("A ± B = C", "a formula has one value; these are two surfaces", &["A + B = C\nA - B = C"]),
    ("A = ± B", "a formula has one value; these are two surfaces", &["A = B\nA = -B"]),
    ("A = +- B", "a formula has one value; these are two surfaces", &["A = B\nA = -B"]),
    ("A = B +- C", "a formula has one value; these are two surfaces", &["A = B + C\nA = B - C"]),
    ("A = B +/- C", "a formula has one value; these are two surfaces", &["A = B + C\nA = B - C"]),
    ("not A", "`not` is for conditions", &["not (A < 1)"]),
    ("A ~ B", "an equation is written with `=`", &["A = B"]),
    ("A ~= B", "an equation is written with `=`", &["A = B"]),
    ("A <> B", "an equation is written with `=`", &["A = B"]),
    ("A is B", "an equation is written with `=`", &["A = B"]),
    ("A equals B", "an equation is written with `=`", &["A = B"]),
    ("A + * B", "a value is missing between the two signs", &["A + B", "A*B"]),
    // Conditions.
    ("A = B if P else D", "a choice is written so", &["A = {P: B, D}"]),
    ("A = B if P", "a condition stands in braces", &["A = B {P}"]),
    ("A = B when P", "a condition stands in braces", &["A = B {P}"]),
    ("A = B where P", "a condition stands in braces", &["A = B {P}"]),
    ("A = B for P", "a condition stands in braces", &["A = B {P}"]),
    ("A = B while P", "a condition stands in braces", &["A = B {P}"]),
    ("A = B unless P", "a condition stands in braces", &["A = B {not (P)}"]),
    ("A = B and C = D", "where both hold is a curve", &["curve A = B, C = D"]),
    ("A = B or C = D", "two surfaces stand on a line of its own each; in one line they are", &["(A - B)*(C - D) = 0"]),
    ("A = B and P", "a condition for an equation stands in braces", &["A = B {P}"]),
    ("A = B && P", "a condition for an equation stands in braces", &["A = B {P}"]),
    ("A = B with P", "a condition for an equation stands in braces", &["A = B {P}"]),
    ("A < B = C", "a condition for an equation stands in braces", &["B = C {A < B}"]),
    ("A <= B = C", "a condition for an equation stands in braces", &["B = C {A <= B}"]),
    ("A > B = C", "a condition for an equation stands in braces", &["B = C {A > B}"]),
    ("A = B < C", "a condition for an equation stands in braces", &["A = B {B < C}"]),
    ("A = B > C", "a condition for an equation stands in braces", &["A = B {B > C}"]),
    ("A = B <= C", "a condition for an equation stands in braces", &["A = B {B <= C}"]),
    ("A > B and < C", "both comparisons need both sides", &["B < A < C"]),
    ("A < B and > C", "both comparisons need both sides", &["C < A < B"]),
    ("A >= B and <= C", "both comparisons need both sides", &["B <= A <= C"]),
    ("A <= B and >= C", "both comparisons need both sides", &["C <= A <= B"]),
    ("A > B or < C", "both comparisons need both sides", &["A > B or A < C"]),
    ("A < B or > C", "both comparisons need both sides", &["A < B or A > C"]),
    ("A, B > C", "each condition is written out", &["A > C and B > C"]),
    ("A, B < C", "each condition is written out", &["A < C and B < C"]),
    ("A, B >= C", "each condition is written out", &["A >= C and B >= C"]),
    ("A, B <= C", "each condition is written out", &["A <= C and B <= C"]),
    ("A, B, C > D", "each condition is written out", &["A > D and B > D and C > D"]),
    ("A, B, C >= D", "each condition is written out", &["A >= D and B >= D and C >= D"]),
    ("A, B, C < D", "each condition is written out", &["A < D and B < D and C < D"]),
    ("A or B > C", "each condition is written out", &["A > C or B > C"]),
    ("A or B < C", "each condition is written out", &["A < C or B < C"]),
    ("A and B > C", "each condition is written out", &["A > C and B > C"]),
    ("A and B < C", "each condition is written out", &["A < C and B < C"]),
    ("A > B or C", "each condition is written out", &["A > B or A > C"]),
    ("A between B and C", "a range is a chain of comparisons", &["B < A < C"]),
    ("A = B {P, D}", "a choice has a colon between condition and value", &["A = {P: B, D}"]),
    ("A = {P, Q}", "a colon stands between condition and value", &["A = {P: Q}", "A = {Q: P}"]),
    ("A = {B, P; D, Q}", "a colon stands between condition and value", &["A = {P: B, Q: D}"]),
    ("A = {B: P, D}", "the condition comes first", &["A = {P: B, D}"]),
    ("A = {B: P}", "the condition comes first", &["A = {P: B}"]),
    ("A = {B if P, D}", "the condition comes first", &["A = {P: B, D}"]),
    ("A = P ? C", "a choice with `?` has a second value", &["A = P ? C : 0"]),
    ("A = if P then C", "a choice is written so", &["A = {P: C}"]),
    ("A = if P C else D", "a choice is written so", &["A = {P: C, D}"]),
    ("A = if (P) {C} else {D}", "a choice is written so", &["A = {P: C, D}"]),
    ("if P: A = C", "a condition stands in braces", &["A = C {P}"]),
    ("if P then A = C", "a condition stands in braces", &["A = C {P}"]),
    ("if (P) A = C", "a condition stands in braces", &["A = C {P}"]),
    // Calls inside of statements.
    ("A = iterate(B, C)", "give the function a name", &["f(x) = B\nA = iterate(f, C, x)"]),
    ("A = [B for N in range(C)]", "a list is not a number, but its sum is one", &["A = sum(N = 0..(C - 1), B)"]),
    ("A = [B for N in range(C, D)]", "a list is not a number, but its sum is one", &["A = sum(N = C..(D - 1), B)"]),
    ("A = sum(B for N in range(C))", "a sum has its range first", &["A = sum(N = 0..(C - 1), B)"]),
    ("A = sum(B, N, C, D)", "a sum has its range first", &["A = sum(N = C..D, B)"]),
    ("A = sum(N, C, D, B)", "a sum has its range first", &["A = sum(N = C..D, B)"]),
    ("A = ∑ B", "a sum needs its range", &["A = sum(k = 1..5, B)"]),
    ("A = Σ B", "a sum needs its range", &["A = sum(k = 1..5, B)"]),
    ("A = \\sum B", "a sum needs its range", &["A = sum(k = 1..5, B)"]),
    ("A = ∏ B", "a product needs its range", &["A = product(k = 1..5, B)"]),
    ("A = sum(B)", "a sum needs its range", &["A = sum(k = 1..5, B)"]),
    ("A = product(B)", "a product needs its range", &["A = product(k = 1..5, B)"]),
    // Definitions.
    ("let N = A in C = D", "a definition stands on a line of its own", &["N = A\nC = D"]),
    ("let N be A", "a definition has an equals sign", &["N = A"]),
    ("let N is A", "a definition has an equals sign", &["N = A"]),
    ("let N A", "a definition has an equals sign", &["N = A"]),
    ("set N to A", "a definition has an equals sign", &["N = A"]),
    ("set N A", "a definition has an equals sign", &["N = A"]),
    ("define N as A", "a definition has an equals sign", &["N = A"]),
    ("define N A", "a definition has an equals sign", &["N = A"]),
    ("N is A", "a definition has an equals sign", &["N = A"]),
    // Curves and solids.
    ("line from A to B", "a segment is a curve with a parameter", &["(1 - t)*A + t*B for t in [0, 1]"]),
    ("segment from A to B", "a segment is a curve with a parameter", &["(1 - t)*A + t*B for t in [0, 1]"]),
    ("arrow from A to B", "a segment is a curve with a parameter", &["(1 - t)*A + t*B for t in [0, 1]"]),
    ("vector from A to B", "a segment is a curve with a parameter", &["(1 - t)*A + t*B for t in [0, 1]"]),
    ("line through A and B", "a line is a curve with a parameter", &["(1 - t)*A + t*B for t in [-3, 3]"]),
    ("line A B", "a segment is a curve with a parameter", &["(1 - t)*A + t*B for t in [0, 1]"]),
    ("text(A)", "there are no letters of material; a label stands at a point", &["(0, 0, 0) A"]),
    ("label(A)", "a label stands at a point", &["(0, 0, 0) A"]),
    ("text(A, B, C, D)", "a label stands at a point", &["(A, B, C) D"]),
    ("label A", "a label stands at a point", &["(0, 0, 0) A"]),
    ("point at A", "a point is its coordinates", &["A"]),
    ("(A, B) for N in C", "a point of space has three coordinates", &["(A, B, 0) for N in C"]),
    ("curve (A, B) for N in C", "a point of space has three coordinates", &["(A, B, 0) for N in C"]),
    ("circle of radius A", "a circle is a curve", &["curve x^2 + y^2 = A^2, z = 0"]),
    ("plane A = B", "a plane is its equation", &["A = B"]),
    ("surface A = B", "a surface is its equation", &["A = B"]),
    ("sphere A = B", "a sphere is its equation", &["A = B"]),
    ("vector (A, B, C)", "an arrow has its end in brackets", &["vector((A, B, C))"]),
    ("segment (A, B, C), (D, E, F)", "a segment has its ends in brackets", &["segment((A, B, C), (D, E, F))"]),
    ("segment (A, B, C) (D, E, F)", "a segment has its ends in brackets", &["segment((A, B, C), (D, E, F))"]),
    ("vector (A, B, C), (D, E, F)", "an arrow has its ends in brackets", &["vector((A, B, C), (D, E, F))"]),
    ("text (A, B, C) D", "a label stands behind its point", &["(A, B, C) D"]),
    ("label (A, B, C) D", "a label stands behind its point", &["(A, B, C) D"]),
    ("point (A, B, C) D", "a label stands behind its point", &["(A, B, C) D"]),
    ("sphere center (A, B, C) radius D", "a ball has its radius, then its center", &["sphere(D, (A, B, C))"]),
    ("sphere with center (A, B, C) and radius D", "a ball has its radius, then its center", &["sphere(D, (A, B, C))"]),
    ("sphere centered at (A, B, C) with radius D", "a ball has its radius, then its center", &["sphere(D, (A, B, C))"]),
    ("sphere radius D center (A, B, C)", "a ball has its radius, then its center", &["sphere(D, (A, B, C))"]),
    ("sphere of radius D at (A, B, C)", "a ball has its radius, then its center", &["sphere(D, (A, B, C))"]),
    ("sphere of radius D centered at (A, B, C)", "a ball has its radius, then its center", &["sphere(D, (A, B, C))"]),
    ("{P, Q}", "conditions are joined by `and`", &["P and Q"]),
    ("{P}", "a condition stands alone", &["P"]),
    ("A of radius B", "a solid is a call, and an equation such as `x^2 + y^2 + z^2 = 4` a surface", &["A(B)"]),
    ("a A of radius B", "a solid is a call, and an equation such as `x^2 + y^2 + z^2 = 4` a surface", &["A(B)"]),
    ("a A with radius B", "a solid is a call, and an equation such as `x^2 + y^2 + z^2 = 4` a surface", &["A(B)"]),
    ("draw a A of radius B", "a solid is a call, and an equation such as `x^2 + y^2 + z^2 = 4` a surface", &["A(B)"]),
    ("a cube of side A", "a cube has half its side", &["box(A/2)"]),
    ("a cube with side A", "a cube has half its side", &["box(A/2)"]),
    ("a cube of size A", "a cube has half its size", &["box(A/2)"]),
    ("a cylinder of radius A and height B", "a cylinder has half its height", &["cylinder(A, B/2)"]),
    ("a cone of radius A and height B", "a cone has half its height", &["cone(A, B/2)"]),
    ("a torus with radii A and B", "a solid is a call", &["torus(A, B)"]),
    ("S & T", "solids are joined by functions", &["intersect(S, T) <= 0"]),
    ("S && T", "solids are joined by functions", &["intersect(S, T) <= 0"]),
    ("S ∩ T", "solids are joined by functions", &["intersect(S, T) <= 0"]),
    ("S | T", "solids are joined by functions", &["union(S, T) <= 0"]),
    ("S || T", "solids are joined by functions", &["union(S, T) <= 0"]),
    ("S and T", "solids are joined by functions", &["intersect(S, T) <= 0"]),
    ("S or T", "solids are joined by functions", &["union(S, T) <= 0"]),
    ("S without T", "a solid is cut out of another by a function", &["subtract(S, T) <= 0"]),
    ("S ∪ T", "solids are joined by functions", &["union(S, T) <= 0"]),
    ("S \\ T", "a solid is cut out of another by a function", &["subtract(S, T) <= 0"]),
    ("S ∖ T", "a solid is cut out of another by a function", &["subtract(S, T) <= 0"]),
    ("S and T <= C", "solids are joined by functions", &["intersect(S, T) <= C"]),
    ("S or T <= C", "solids are joined by functions", &["union(S, T) <= C"]),
    ("S minus T", "a solid is cut out of another by a function", &["subtract(S, T) <= 0"]),
    ("S intersect T", "solids are joined by functions", &["intersect(S, T) <= 0"]),
    ("S union T", "solids are joined by functions", &["union(S, T) <= 0"]),
    // Lines about the picture.
    ("domain N from A to B", "a range stands in square brackets", &["domain N in [A, B]"]),
    ("domain N A to B", "a range stands in square brackets", &["domain N in [A, B]"]),
    ("domain N A B", "a range stands in square brackets", &["domain N in [A, B]"]),
    ("domain N = A..B", "a range stands in square brackets", &["domain N in [A, B]"]),
    ("domain N: A..B", "a range stands in square brackets", &["domain N in [A, B]"]),
    ("domain N = [A, B]", "a range stands after `in`", &["domain N in [A, B]"]),
    ("domain A < N < B", "a range stands in square brackets", &["domain N in [A, B]"]),
    ("domain A <= N <= B", "a range stands in square brackets", &["domain N in [A, B]"]),
    ("domain A to B", "a range is the same on all axes", &["domain [A, B]"]),
    ("domain from A to B", "a range is the same on all axes", &["domain [A, B]"]),
    ("N from A to B", "where to look is a line `domain`", &["domain N in [A, B]"]),
    ("N in [A, B]", "where to look is a line `domain`", &["domain N in [A, B]"]),
    ("range N A B", "where to look is a line `domain`", &["domain N in [A, B]"]),
    ("xrange [A:B]", "where to look is a line `domain`", &["domain x in [A, B]"]),
    ("xlim(A, B)", "where to look is a line `domain`", &["domain x in [A, B]"]),
    ("xlim([A, B])", "where to look is a line `domain`", &["domain x in [A, B]"]),
    ("ylim([A, B])", "where to look is a line `domain`", &["domain y in [A, B]"]),
    ("zlim([A, B])", "where to look is a line `domain`", &["domain z in [A, B]"]),
    ("xlim([V U])", "where to look is a line `domain`", &["domain x in [V, U]"]),
    ("ylim([V U])", "where to look is a line `domain`", &["domain y in [V, U]"]),
    ("zlim([V U])", "where to look is a line `domain`", &["domain z in [V, U]"]),
    ("ylim(A, B)", "where to look is a line `domain`", &["domain y in [A, B]"]),
    ("zlim(A, B)", "where to look is a line `domain`", &["domain z in [A, B]"]),
    ("color: A", "a line about the picture has no colon", &["color A"]),
    ("background: A", "a line about the picture has no colon", &["background A"]),
    ("opacity: A", "a line about the picture has no colon", &["opacity A"]),
    ("look: A", "a line about the picture has no colon", &["look A"]),
    ("light A B C", "a direction stands in brackets", &["light (A, B, C)"]),
    ("color = A", "a line about the picture has no equals sign", &["color A"]),
    ("domain = A", "a line about the picture has no equals sign", &["domain A"]),
    ("opacity = A", "a line about the picture has no equals sign", &["opacity A"]),
    ("view = A", "a line about the picture has no equals sign", &["view A"]),
    ("background = A", "a line about the picture has no equals sign", &["background A"]),
    ("look = A", "a line about the picture has no equals sign", &["look A"]),
    ("mesh = A", "a line about the picture has no equals sign", &["mesh A"]),
    ("axes = A", "a line about the picture has no equals sign", &["axes A"]),
    ("title = A", "a line about the picture has no equals sign", &["title A"]),
    ("width = A", "a line about the picture has no equals sign", &["width A"]),
    ("contours = A", "a line about the picture has no equals sign", &["contours A"]),
    ("domain V U", "a range stands in square brackets", &["domain [V, U]"]),
    ("domain V, U", "a range stands in square brackets", &["domain [V, U]"]),
    ("domain N V U", "a range stands in square brackets", &["domain N in [V, U]"]),
    ("domain N V, U", "a range stands in square brackets", &["domain N in [V, U]"]),
    ("range V U", "where to look is a line `domain`", &["domain [V, U]"]),
    ("range V to U", "where to look is a line `domain`", &["domain [V, U]"]),
    ("xrange V U", "where to look is a line `domain`", &["domain x in [V, U]"]),
    ("yrange V U", "where to look is a line `domain`", &["domain y in [V, U]"]),
    ("zrange V U", "where to look is a line `domain`", &["domain z in [V, U]"]),
    ("xlim V U", "where to look is a line `domain`", &["domain x in [V, U]"]),
    ("ylim V U", "where to look is a line `domain`", &["domain y in [V, U]"]),
    ("zlim V U", "where to look is a line `domain`", &["domain z in [V, U]"]),
    ("view isometric", "the view is called", &["view iso"]),
    ("view 3d", "the view is called", &["view iso"]),
    ("view side", "the view is called", &["view right"]),
    ("view below", "the view is called", &["view bottom"]),
    ("view up", "the view is called", &["view top"]),
    ("look dark", "the look is called", &["look night"]),
    ("look black", "the look is called", &["look night"]),
    ("look white", "the look is called", &["look paper"]),
    ("look light", "the look is called", &["look paper"]),
    ("look book", "the look is called", &["look textbook"]),
    ("background dark", "a color has a name of CSS", &["background black"]),
    ("background light", "a color has a name of CSS", &["background white"]),
    ("material shiny", "the material is called", &["material gloss"]),
    ("material glossy", "the material is called", &["material gloss"]),
    ("material metallic", "the material is called", &["material metal"]),
    ("material mirror", "the material is called", &["material metal"]),
    ("material dull", "the material is called", &["material matte"]),
    ("zoom A", "where to look is a line `domain`", &["domain A"]),
    ("range A", "where to look is a line `domain`", &["domain A"]),
    ("size A", "where to look is a line `domain`", &["domain A"]),
    ("window A", "where to look is a line `domain`", &["domain A"]),
    ("bounds A", "where to look is a line `domain`", &["domain A"]),
    ("limits A", "where to look is a line `domain`", &["domain A"]),
    ("box A", "where to look is a line `domain`", &["domain A"]),
    ("transparent", "how much light a surface blocks is its `opacity`", &["opacity 50%"]),
    ("transparent A", "how much light a surface blocks is its `opacity`", &["opacity 50%"]),
    ("alpha A", "how much light a surface blocks is its `opacity`", &["opacity A"]),
    ("wireframe A", "lines on the surface are a line `mesh`", &["mesh A"]),
    ("wireframe", "lines on the surface are a line `mesh`", &["mesh on"]),
    ("wire A", "lines on the surface are a line `mesh`", &["mesh A"]),
    ("lines on", "lines on the surface are a line `mesh`", &["mesh on"]),
    ("camera A", "where the eye is stands in a line `view`", &["view eye A"]),
    ("eye A", "where the eye is stands in a line `view`", &["view eye A"]),
    ("camera from A", "where the eye is stands in a line `view`", &["view eye A"]),
    ("view from A", "a view has a name, or an eye", &["view eye A", "view A"]),
    ("view (A, B, C)", "where the eye is stands behind `eye`", &["view eye (A, B, C)"]),
    ("view above", "from above is the view", &["view top"]),
    ("look from A", "where the eye is stands in a line `view`", &["view eye A"]),
    ("clip x > 0", "a clip plane a, b, c, d keeps what has a*x + b*y + c*z <= d", &["clip -1, 0, 0, 0"]),
    ("clip y > 0", "a clip plane a, b, c, d keeps what has a*x + b*y + c*z <= d", &["clip 0, -1, 0, 0"]),
    ("clip z > 0", "a clip plane a, b, c, d keeps what has a*x + b*y + c*z <= d", &["clip 0, 0, -1, 0"]),
    ("clip x > A", "a clip plane a, b, c, d keeps what has a*x + b*y + c*z <= d", &["clip -1, 0, 0, -A"]),
    ("clip x < A", "a clip plane a, b, c, d keeps what has a*x + b*y + c*z <= d", &["clip 1, 0, 0, A"]),
    ("clip y > A", "a clip plane a, b, c, d keeps what has a*x + b*y + c*z <= d", &["clip 0, -1, 0, -A"]),
    ("clip y < A", "a clip plane a, b, c, d keeps what has a*x + b*y + c*z <= d", &["clip 0, 1, 0, A"]),
    ("clip z > A", "a clip plane a, b, c, d keeps what has a*x + b*y + c*z <= d", &["clip 0, 0, -1, -A"]),
    ("clip z < A", "a clip plane a, b, c, d keeps what has a*x + b*y + c*z <= d", &["clip 0, 0, 1, A"]),
    ("cut x > A", "a clip plane a, b, c, d keeps what has a*x + b*y + c*z <= d", &["clip 1, 0, 0, A"]),
    ("colour A", "it is spelled", &["color A"]),
    ("colors A", "one color applies to the formulas below it", &["color A"]),
    ("paint A", "a color is a line `color`", &["color A"]),
    ("fill A", "a color is a line `color`", &["color A"]),
    ("color A by N", "a color map takes a value", &["color A(N)"]),
    ("color by N", "a color map takes a value", &["color viridis(N)"]),
    ("bg A", "it is spelled out", &["background A"]),
    ("background color A", "one word is enough", &["background A"]),
    ("theme A", "a whole style is a line `look`", &["look A", "look night"]),
    ("style A", "a whole style is a line `look`", &["look A", "look night"]),
    ("grid A", "lines on the surface are a line `mesh`, those around it `axes`", &["axes A", "axes on"]),
    ("axis A", "it is spelled", &["axes A"]),
    ("show axes", "it is switched by `on` and `off`", &["axes on"]),
    ("hide axes", "it is switched by `on` and `off`", &["axes off"]),
    ("no axes", "it is switched by `on` and `off`", &["axes off"]),
    ("shadow A", "it is spelled", &["shadows A"]),
    ("thickness A", "how wide curves are is a line `width`", &["width A"]),
    ("linewidth A", "how wide curves are is a line `width`", &["width A"]),
    ("levels A", "lines of equal height are a line `contours`", &["contours A"]),
    ("contour A", "it is spelled", &["contours A"]),
    ("animate N", "what moves depends on the time t", &["N = 1 + sin(t)"]),
];

/// Words that stand before definitions in other systems, mostly types.
const BEFORE_DEFINITIONS: &str = "vec vector vec2 vec3 vec4 point float double real scalar number \
    num int integer bool var let const constant val param parameter slider local auto def func \
    function fn fun set given assume define where with";

/// Words for signs.
const SIGNS: &[(&str, &str)] = &[
    (" is less than or equal to ", " <= "),
    (" is greater than or equal to ", " >= "),
    (" is less than ", " < "),
    (" is greater than ", " > "),
    (" to the power of ", "^"),
    (" to the power ", "^"),
    (" multiplied by ", "*"),
    (" divided by ", "/"),
    (" is equal to ", " = "),
    ("square root of ", "sqrt "),
    ("the absolute value of ", "abs "),
    ("absolute value of ", "abs "),
    (" squared", "^2"),
    (" cubed", "^3"),
    (" plus ", " + "),
    (" minus ", " - "),
    (" times ", "*"),
    (" over ", "/"),
    (" equals ", " = "),
    (" equal ", " = "),
    (" is ", " = "),
    ("the ", ""),
    ("sine of ", "sin "),
    ("cosine of ", "cos "),
];

/// Advice on statements that have no corrected line: commands, files, other programs.
pub(super) fn unread(mistake: &Mistake<'_>) -> Option<String> {
    const COMMANDS: [&str; 6] = ["save", "load", "open", "export", "quit", "help"];
    let line = mistake.line;
    let word = line.split_whitespace().next()?;
    let is_file = |word: &str| {
        let (_, end) = word.rsplit_once('.').unwrap_or_default();
        matches!(end, "zset" | "txt" | "stl" | "obj" | "ply" | "glb" | "png" | "3mf" | "step")
    };
    let has = |word: &str| mistake.text.contains(word);
    match mistake.kind {
        ErrorKind::UnexpectedCharacter { character: '.' }
            if COMMANDS.contains(&word) && line.split_whitespace().any(is_file) =>
        {
            Some(format!("a command stands at the prompt and begins with a colon, as in `:{word}`"))
        }
        ErrorKind::UnexpectedCharacter { character: '.' } if line == word && is_file(word) => {
            Some("there is no file of this name here; check its name and its folder".to_owned())
        }
        ErrorKind::UnknownName { name, .. } if name == "iMouse" => {
            Some("there is no mouse here; write `0.0` in place of its coordinates".to_owned())
        }
        ErrorKind::UnknownName { name, .. } if name == "iResolution" => Some(
            "there is no screen here; write the size in its place, as `vec2(640, 360)`".to_owned(),
        ),
        ErrorKind::UnknownName { name, .. } if name.contains('_') && line == name => {
            let other = name.replace('_', "-");
            Some(format!("if a surface of the gallery is meant, its name is `{other}`"))
        }
        ErrorKind::Empty if has("mainImage") || has("ragColor") => Some(
            "this program computes colors; what can be shown is its distance function, \
             such as `float map(vec3 p) { return length(p) - 1.; }`"
                .to_owned(),
        ),
        ErrorKind::Program { word } if word == "struct" => Some(
            "a function that is drawn returns the distance alone, as in \
             `float map(vec3 p) { return length(p) - 1.; }`"
                .to_owned(),
        ),
        ErrorKind::Empty if has("import ") => Some(
            "this only loads a module; add the formula, such as `z = np.sin(x)*np.cos(y)`"
                .to_owned(),
        ),
        _ => None,
    }
}

pub(super) fn proposals(mistake: &Mistake<'_>) -> Vec<Proposal> {
    let mut all = Vec::new();
    if mistake.text.contains("<f32>") {
        let why = "a vector has its size alone";
        all.push(Proposal::text(why, mistake.text.replace("<f32>", "")));
    }
    for (pattern, why, templates) in LINES {
        let Some(parts) = matched(pattern, mistake.line) else { continue };
        let lines = templates.iter().map(|template| Proposal::new(*why, filled(template, &parts)));
        all.extend(lines);
    }
    if let Some((word, definition)) = mistake.line.split_once(char::is_whitespace)
        && BEFORE_DEFINITIONS.split_whitespace().any(|one| one == word)
        && ["N = A", "N(A) = B"].iter().any(|one| matched(one, definition).is_some())
    {
        let why = format!("a definition stands alone, without `{word}`");
        all.push(Proposal::new(why, definition.trim()));
    }
    if let ErrorKind::InWords | ErrorKind::Solid { .. } = mistake.kind {
        let signs = |line: String, (word, sign): &(&str, &str)| line.replace(word, sign);
        let line = SIGNS.iter().fold(mistake.line.to_owned(), signs);
        all.push(Proposal::new("a formula has signs", line));
    }
    all.extend(of_brackets_and_signs(mistake));
    all.extend(of_color(mistake));
    all
}

/// A color in the notation of CSS, or a vector as in a shader, by its digits.
fn of_color(mistake: &Mistake<'_>) -> Option<Proposal> {
    let (word, rest) = mistake.line.split_once(' ')?;
    let (ErrorKind::BadColorMap | ErrorKind::BadColor) = mistake.kind else { return None };
    let (call, opacity) = rest.split_at(rest.rfind(')')? + 1);
    let color = match matched("N(A, B, C)", call) {
        Some(parts) if parts[&'N'].starts_with("vec") || parts[&'N'].starts_with("float") => {
            let number = |letter| parts[&letter].parse::<f32>().ok();
            csscolorparser::Color::new(number('A')?, number('B')?, number('C')?, 1.0)
        }
        _ => csscolorparser::parse(call).ok()?,
    };
    let digits = color.to_css_hex().to_string();
    let why = "a color has a name of CSS, or digits";
    // Digits of the opacity are no part of a color here.
    Some(Proposal::new(why, format!("{word} {}{opacity}", digits.get(..7)?)))
}

/// Corrections of unpaired or empty brackets, and of signs without an operand.
fn of_brackets_and_signs(mistake: &Mistake<'_>) -> Vec<Proposal> {
    let line = mistake.line;
    let mut all = Vec::new();
    match mistake.kind {
        ErrorKind::Unopened { .. } => {
            let why = "this bracket closes nothing";
            all.push(Proposal::new(why, mistake.replaced(mistake.place.clone(), "")));
        }
        ErrorKind::MissingAfter { sign } if line.ends_with(sign.as_str()) => {
            let why = "the line ends too early";
            let before = line[..line.len() - sign.len()].trim_end();
            let is_number = before.ends_with(|c: char| c.is_ascii_digit());
            let ends: &[&str] = match sign.as_str() {
                "^" | "**" if is_number => &["x"],
                "^" | "**" => &["2"],
                "=" | "<" | "<=" | ">" | ">=" => &[" 1"],
                _ => &[],
            };
            all.extend(ends.iter().map(|end| Proposal::new(why, format!("{line}{end}"))));
            all.push(Proposal::new(why, line[..line.len() - sign.len()].trim_end()));
            all.push(Proposal::new(why, format!("{line}x")));
        }
        // One of two signs in a row is too many.
        ErrorKind::MissingAfter { .. } => {
            let why = "one of these signs is too many";
            if !mistake.typed().contains(['=', '<', '>']) {
                all.push(Proposal::new(why, mistake.replaced(mistake.place.clone(), "")));
            }
            let behind = &line[mistake.place.end..];
            let next = behind.find(|c: char| !c.is_whitespace()).unwrap_or(0);
            let is_sign = |c: char| "+-*/^=<>".contains(c);
            let length = behind[next..].find(|c| !is_sign(c)).unwrap_or(0);
            let start = mistake.place.end + next;
            all.push(Proposal::new(why, mistake.replaced(start..start + length, "")));
        }
        ErrorKind::EmptyBrackets => {
            let inner = mistake.replaced(mistake.place.clone(), "x");
            all.push(Proposal::new("a value is missing in the brackets", inner));
        }
        _ => {}
    }
    all
}
