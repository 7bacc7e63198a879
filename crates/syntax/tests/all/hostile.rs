//! Checks that texts designed to overflow, hang or panic are read or refused, on a small stack.

use std::fmt::Write as _;
use zeroset_parser::{ErrorKind, Errors, Limits};
use zeroset_syntax::{Options, read, read_bytes};

/// Stack of a test thread, in bytes. It is less than a third of the usual size, so compilers with
/// larger frames still fit the usual size. Reading brackets takes up to 460 KiB, in test and
/// release builds. pest requires another 64 KiB to be free.
const STACK: usize = 5 << 17;

fn on_a_small_stack<T: Send + 'static>(run: impl FnOnce() -> T + Send + 'static) -> T {
    let thread = std::thread::Builder::new().stack_size(STACK).spawn(run);
    thread.expect("a thread").join().expect("no panic")
}

/// The only error of `text`. Fails if there are other errors, or if the rendering is long.
fn error(text: String) -> ErrorKind {
    error_within(Limits::default(), text)
}

fn error_within(limits: Limits, text: String) -> ErrorKind {
    on_a_small_stack(move || {
        let options = Options { limits, ..Options::default() };
        let errors = read(&text, &options).expect_err("must be refused");
        let rendered = errors.render(Some("input"), &text, false);
        assert!(rendered.len() < 2000, "{} bytes", rendered.len());
        let mut kinds = errors.iter().map(|error| error.kind.clone());
        let first = kinds.next().expect("an error");
        assert_eq!(kinds.next(), None, "one error only");
        first
    })
}

fn accepted(text: String) -> usize {
    on_a_small_stack(move || {
        let document: Result<_, Errors> = read(&text, &Options::default());
        document.map_or_else(|e| panic!("{}", e.render(None, &text, false)), |d| d.graph.len())
    })
}

fn is_too_deep(text: String) -> bool {
    matches!(error(text), ErrorKind::TooDeep { .. })
}

#[test]
fn nesting_is_bounded() {
    assert!(is_too_deep("(".repeat(100_000)));
    assert!(is_too_deep(format!("{}x{}", "(".repeat(20_000), ")".repeat(20_000))));
    assert!(is_too_deep(format!("{}x", "-".repeat(20_000))));
    assert!(is_too_deep(format!("x{}", "^x".repeat(20_000))));
    assert!(is_too_deep(format!("x{}", "^-x".repeat(20_000))));
    assert!(is_too_deep(format!("x{}", "^2".repeat(20_000))));
    assert!(is_too_deep(format!("{}x", "sin ".repeat(20_000))));
    assert!(is_too_deep(format!("{}x", "√".repeat(20_000))));
    assert!(is_too_deep(format!("{}x < 1", "not ".repeat(20_000))));
    assert!(is_too_deep("\\sqrt{".repeat(50_000)));
    assert!(is_too_deep("\\frac{".repeat(30_000)));
    assert!(is_too_deep("sin(".repeat(30_000)));
    assert!(is_too_deep("[{(".repeat(30_000)));
}

#[test]
fn allowed_nesting_fits_the_stack() {
    let depth = Limits::default().depth - 10;
    for (open, close) in [
        ("(", ")"),
        ("[", "]"),
        ("sin(", ")"),
        ("|(", ")|"),
        ("-(1+2*", ")"),
        ("2^(", ")"),
        ("√(", ")"),
    ] {
        for levels in [depth / 3, depth / 2, depth] {
            let text = format!("{}x{}", open.repeat(levels), close.repeat(levels));
            on_a_small_stack(move || {
                let read = read(&text, &Options::default());
                if let Ok(document) = &read {
                    assert!(document.surfaces[0].echo.contains('x'));
                } else {
                    let errors = read.unwrap_err();
                    assert!(
                        errors.iter().all(|e| matches!(e.kind, ErrorKind::TooDeep { .. })),
                        "{errors}"
                    );
                }
            });
        }
    }
    accepted(format!("{}x{}", "(".repeat(depth / 2), ")".repeat(depth / 2)));
    accepted(format!("{}x < 1{}", "(x < 1 or ".repeat(depth), ")".repeat(depth)));
    accepted(format!("x{}", "^x".repeat(depth)));
    accepted(format!("{}x", "-".repeat(depth)));
}

/// Hundreds of definitions, each using the one before, are read on a small stack.
#[test]
fn allowed_definitions_fit_the_stack() {
    let chain = |count: usize, line: &dyn Fn(usize) -> String, last: &str| {
        let lines: Vec<String> = (1..count).map(line).collect();
        format!("a0 = x*x\nf0(v) = v*x\n{}\n{last}", lines.join("\n"))
    };
    accepted(chain(330, &|i| format!("a{i} = 1 - sin(a{})", i - 1), "a329"));
    accepted(chain(330, &|i| format!("f{i}(v) = 1 - sin(f{}(v + 1))", i - 1), "f329(y)"));
    accepted(chain(490, &|i| format!("a{i} = {{a{} < 1: 2, y}}", i - 1), "a489"));
    accepted(chain(330, &|i| format!("a{i} = sum(k = 1..2, a{} + k)", i - 1), "a329"));
    let vectors = |i: usize| format!("b{i} = cross(b{}, vec3(1, 2, 3))", i - 1);
    accepted("b0 = vec3(x, y, z)\n".to_owned() + &chain(330, &vectors, "length(b329)"));
    let step = "if (p.x < d) { d += 1.; } else { d = min(d, p.y); }\n".repeat(240);
    accepted(format!("float map(vec3 p) {{ float d = 0.;\n{step}return d; }}"));
}

/// Chains of definitions are as long as the text: nothing recurses along them, whatever their
/// order.
#[test]
fn chains_of_definitions_are_not_nested() {
    let count = 20_000;
    let values: Vec<String> = (1..count).map(|i| format!("a{i} = a{} + {i}", i - 1)).collect();
    let last = count - 1;
    // Two nodes a line: the number and the sum.
    let nodes = 2 * last + 1;
    assert_eq!(accepted(format!("a0 = x\n{}\na{last}", values.join("\n"))), nodes);
    let reversed: Vec<String> = values.into_iter().rev().collect();
    assert_eq!(accepted(format!("{}\na0 = x\na{last}", reversed.join("\n"))), nodes);
    let functions: Vec<String> = (1..count).map(|i| format!("f{i}(a) = f{}(a)*y", i - 1)).collect();
    assert_eq!(accepted(format!("f0(a) = a\n{}\nf{last}(x)", functions.join("\n"))), last + 2);
    let branches: Vec<String> = (1..3000)
        .map(|i| format!("a{i} = {{x < a{} and y < {i}: 1, -a{}}}", i - 1, i - 1))
        .collect();
    accepted(format!("a0 = x\n{}\na2999", branches.join("\n")));
    // An error at the far end of a chain is shown where it is.
    let text = format!("a0 = sqr(x, y, z)\n{}\na2999", branches.join("\n"));
    assert!(matches!(error(text), ErrorKind::WrongCount { .. }));
    let text = format!("a0 = vec2(x, y) + vec3(x, y, z)\n{}\na2999", branches.join("\n"));
    assert!(matches!(error(text), ErrorKind::VectorSizes { .. }));
}

#[test]
fn length_is_bounded() {
    let long = 1_000_000;
    let most = Limits::default();
    assert!(matches!(error(" ".repeat(most.bytes + 1)), ErrorKind::TooLong { .. }));
    let limits = Limits { symbols: long, ..most };
    let error = |text: String| error_within(limits, text);
    assert!(matches!(error("x+".repeat(long)), ErrorKind::TooManySymbols { .. }));
    assert!(matches!(error("2".repeat(long) + "q"), ErrorKind::UnknownName { .. }));
    assert!(matches!(error("q".repeat(long)), ErrorKind::UnknownName { .. }));
    assert!(matches!(error("x".repeat(long)), ErrorKind::UnknownName { .. }));
    assert!(matches!(error("é".repeat(long / 2)), ErrorKind::UnknownName { .. }));
    assert!(matches!(error("x2".repeat(long / 2)), ErrorKind::UnknownName { .. }));
    assert!(matches!(error(" ".repeat(long)), ErrorKind::Empty));
    assert!(matches!(error("\n".repeat(2 * long)), ErrorKind::TooManySymbols { .. }));
    assert!(matches!(error("#".repeat(long)), ErrorKind::Empty));
    assert!(matches!(
        error(")".repeat(long)),
        ErrorKind::TooManySymbols { .. } | ErrorKind::Unopened { .. }
    ));
    accepted("1".repeat(long) + "x");
    accepted(format!("x = 0.{}", "3".repeat(long)));
    accepted(format!("x{}", "+x".repeat(20_000)));
    accepted(format!("x{}", "*x".repeat(20_000)));
    accepted("x ".repeat(40_000));
    accepted(format!("x < 1{}", " and x < 1".repeat(10_000)));
    accepted(format!("0 < x{}", " < y".repeat(20_000)));
    accepted(format!("max(x{})", ", y".repeat(20_000)));
}

#[test]
fn bars_are_read_in_one_pass() {
    assert!(matches!(error("|".repeat(50_000)), ErrorKind::UnclosedBar));
    assert!(matches!(error("|x".repeat(50_000)), ErrorKind::AmbiguousBars));
    accepted(format!("|x|{}", "+|x|".repeat(10_000)));
    accepted("|x|".repeat(10_000));
}

#[test]
fn expansion_is_bounded() {
    let mut chain = String::from("a0 = x*x\n");
    let mut doubling = String::from("f0(a) = a*a\n");
    let mut tree = String::from("g0(a) = a + x\n");
    for i in 1..60 {
        let before = i - 1;
        writeln!(chain, "a{i} = a{before} + a{before}").unwrap();
        writeln!(doubling, "f{i}(a) = f{before}(a) + f{before}(a)").unwrap();
        writeln!(tree, "g{i}(a) = g{before}(2*a) + g{before}(3*a + {i})").unwrap();
    }
    accepted(chain + "a59\n");
    accepted(doubling + "f59(x)\n");
    assert!(matches!(error(tree + "g59(x)\n"), ErrorKind::TooLarge { .. }));

    let mut circle = String::from("a0 = a4999\n");
    for i in 1..5000 {
        writeln!(circle, "a{i} = a{} + 1", i - 1).unwrap();
    }
    let text = circle + "x\n";
    let errors = on_a_small_stack(move || read(&text, &Options::default()).expect_err("a circle"));
    assert!(errors.to_string().len() < 500, "a short message");
}

#[test]
fn many_errors_are_cut_short() {
    let mut text = String::new();
    for i in 0..20_000 {
        writeln!(text, "abc{i}def + x").unwrap();
    }
    let errors =
        on_a_small_stack(move || read(&text, &Options::default()).expect_err("unknown names"));
    assert!(errors.iter().count() <= 20);
}

#[test]
fn bytes_that_are_not_text_are_refused() {
    let bytes = b"x^2 + \xff\xfe = 1";
    let errors = read_bytes(bytes, &Options::default()).expect_err("not UTF-8");
    let kinds: Vec<&ErrorKind> = errors.iter().map(|error| &error.kind).collect();
    assert_eq!(kinds, [&ErrorKind::NotUtf8 { offset: 6 }]);
    let lossy = String::from_utf8_lossy(bytes);
    assert!(errors.render(None, &lossy, false).contains("byte 6"));
    assert!(read_bytes(b"x^2", &Options::default()).is_ok());
}

#[test]
fn unused_definitions_are_remarked_on_in_bounded_time() {
    let mut text = String::from("z = x\n");
    for index in 0..20_000 {
        writeln!(text, "abcdefghijklm{index} = 1").unwrap();
    }
    let document = read(&text, &Options::default()).expect("a surface");
    assert!((1..100).contains(&document.notes.len()), "{}", document.notes.len());
}

#[test]
fn remarks_on_one_long_line_are_bounded() {
    let text = format!("{} - 1", "xyz ".repeat(20_000));
    let document = read(&text, &Options::default()).expect("a surface");
    assert_eq!(document.notes.len(), 1, "the same remark once");
    let mut text = String::new();
    let letters: Vec<char> = ('a'..='w').filter(|c| !matches!(c, 'e' | 't')).collect();
    for letter in &letters {
        writeln!(text, "{letter} = 1").unwrap();
    }
    for (a, b) in letters.iter().flat_map(|a| letters.iter().map(move |b| (a, b))) {
        write!(text, "{a}x{b} ").unwrap();
    }
    let document = read(&text, &Options::default()).expect("a surface");
    assert_eq!(document.notes.len(), 41);
    let last = document.notes.last().expect("a note").message();
    assert!(last.contains("further notes omitted"), "{last}");
}

#[test]
fn surfaces_are_counted() {
    let lines = |count: usize| "x = 1\n".repeat(count);
    assert_eq!(accepted(lines(10_000)), 3);
    assert!(matches!(error(lines(10_001)), ErrorKind::TooManySurfaces { limit: 10_000 }));
}

#[test]
fn errors_in_long_lines_are_drawn_in_bounded_time() {
    let text = vec![format!("x + {}foo", " ".repeat(40_000)); 22].join(" ; ");
    let rendered = read(&text, &Options::default()).expect_err("errors").render(None, &text, false);
    assert!(rendered.len() < 20_000, "{}", rendered.len());
}

#[test]
fn what_is_unrolled_is_bounded() {
    let is_long = |text: &str| matches!(error(text.to_owned()), ErrorKind::TooManyTerms { .. });
    assert!(is_long("z = sum(k = 1..1e9, x)"));
    assert!(is_long("z = sum(k = -1e18..1e18, x)"));
    assert!(is_long("z = product(k = 1..1001, x)"));
    assert!(is_long("z = iterate(sin, 1e6, x)"));
    assert!(is_long(r"\sum_{k=1}^{99999} x"));
    let is_large = |text: &str| matches!(error(text.to_owned()), ErrorKind::TooLarge { .. });
    assert!(is_large("z = sum(i = 1..900, sum(j = 1..900, sum(k = 1..900, sin(i j k x))))"));
    assert!(is_large("f(v) = iterate(g, 900, v)\ng(v) = iterate(h, 900, v)\nh(v) = v^2 + x\nf(y)"));
    assert!(is_deep_or_large("f(v) = v^2 + x\ng(v) = iterate(f, 900, v)\ng(y)"));
    accepted("z = sum(k = 1..1000, sin(k x)/k)".to_owned());
    accepted("z = sum(k = 5..1, x)".to_owned());
    assert!(is_too_deep(r"\sum_{k=1}^{2} ".repeat(5_000) + "x"));
    assert!(is_too_deep("sum(k = 1..2, ".repeat(5_000)));
}

/// Returns whether a text is read, or is refused only as too large or too deep.
fn is_deep_or_large(text: &str) -> bool {
    let text = text.to_owned();
    on_a_small_stack(move || match read(&text, &Options::default()) {
        Ok(_) => true,
        Err(errors) => errors
            .iter()
            .all(|e| matches!(e.kind, ErrorKind::TooLarge { .. } | ErrorKind::TooDeep { .. })),
    })
}

#[test]
fn choices_are_bounded() {
    assert!(is_too_deep("{x < 0: ".repeat(5_000) + "x"));
    assert!(is_too_deep("x < 0 ? ".repeat(5_000) + "x" + &" : y".repeat(5_000)));
    assert!(is_deep_or_large(&("x < 0 ? 1 : ".repeat(10_000) + "x")));
    assert!(is_deep_or_large(&("1 if x < 0 else ".repeat(10_000) + "x")));
    assert!(is_deep_or_large(&format!("{{{}x}}", "x < 0: 1, ".repeat(10_000))));
    let depth = 40;
    accepted("x < 0 ? ".repeat(depth) + "x" + &" : y".repeat(depth));
    accepted("{x < 0: ".repeat(depth) + "x" + &", y}".repeat(depth));
    accepted("if(x < 0, ".repeat(depth) + "x" + &", y)".repeat(depth));
}

#[test]
fn programs_are_bounded() {
    let sets = |count: usize| "d += x;".repeat(count);
    assert!(matches!(
        error(format!("float d = 1.;{}return d;", sets(10_000))),
        ErrorKind::TooManyNames { .. }
    ));
    accepted(format!("float d = 1.;{}return d;", sets(200)));
    let functions = "float f(float a){return a;}";
    assert!(matches!(error(functions.repeat(5_000)), ErrorKind::TooManyNames { .. }));
    accepted(format!("{}\nf(x)", (functions.to_owned() + "\n").repeat(3_000)));
    let nested = "float f(float a){".repeat(20_000);
    assert!(is_too_deep(nested));
    accepted("x // a comment\n".repeat(900));
    error("x // 2 ".repeat(5_000));
    error(r"\begin{".repeat(50_000));
    error("(*".repeat(150));
    error("/*".repeat(40_000));
    error("x = 1\n/* never closed\ny = 2".to_owned());
    error("f = lambda x: ".repeat(5_000));
    error("p.x = ".repeat(5_000));
    accepted("r == theta + rho + phi\n".repeat(900));
}

#[test]
fn curves_and_points_are_bounded() {
    assert!(matches!(error("(1, 2, 3)\n".repeat(10_001)), ErrorKind::TooManyCurves { .. }));
    assert_eq!(accepted("(1, 2, 3) \"A\"\n".repeat(9_000)), 0);
    accepted("curve x = 0, y = 0\n".repeat(900));
    let long = |part: &str| part.repeat(20_000);
    let texts = [
        format!("curve {}x", long("x + ")),
        format!("curve {}", long("x, ")),
        format!("({}1)", long("1, ")),
        format!("(1, 2, 3) for t in [0, {}1]", long("1 + ")),
        format!("(1, 2, 3) {}", long("for t in [0, 1] ")),
        format!("(1, 2, 3) \"{}\"", long("A")),
        format!("ParametricPlot3D[{{{}1}}, {{t, 0, 1}}]", long("t, ")),
        format!("fplot3({}@(t) t)", long("@(t) t, ")),
        long("curve "),
        long("point ("),
        "curve".to_owned(),
        "curve (".to_owned(),
        "curve ,".to_owned(),
        "point".to_owned(),
        "point ()".to_owned(),
        "(,,)".to_owned(),
        "(1, 2, 3) for".to_owned(),
        "(1, 2, 3) for t".to_owned(),
        "(1, 2, 3) for t in []".to_owned(),
        "(1, 2, 3) for t in [,]".to_owned(),
        "(1, 2, 3) for t = ..".to_owned(),
        "(1, 2, 3) for < t <".to_owned(),
        "⟨1, 2, 3⟩ for 0 < t < 1".to_owned(),
        "Curve()".to_owned(),
        "Curve(,,,)".to_owned(),
        "spacecurve([t, t, t], t=)".to_owned(),
        "fplot3(@(t) t, @(t) t, @(t) t, [])".to_owned(),
        "ParametricFunction(lambda t: , t_range=[0, 1])".to_owned(),
        "width".to_owned(),
        "width px".to_owned(),
        "width -3\n(1, 2, 3)".to_owned(),
    ];
    for text in texts {
        on_a_small_stack(move || {
            if let Err(errors) = read(&text, &Options::default()) {
                errors.render(None, &text, false);
            }
        });
    }
}

/// Notebooks, tables and scripts that end too early, or leave out what they need.
const UNFINISHED: &[&str] = &[
    "np.\ndef",
    "function f(x) = k *= z",
    "contour(a, b, 'LevelList', 0)",
    "np.\ndef f():",
    "np.\nx, y = np.meshgrid(*[]*3)",
    "np.\nx, y = mgrid[:, :]",
    "np.\nf = .lambdify(x, )",
    "np.\n.lambdify((x), x, 1)",
    "np.\nf.subs()",
    "np.\nf.subs({})",
    "np.\ngrid[\"v\"] =",
    "np.\ngo.Isosurface(value=, isomin=1, isomax=)",
    "np.\ngo.Isosurface(value=x, isomin=1, isomax=2, surface=dict(count))",
    "np.\nmcubes.marching_cubes_func((1, 2), (3))",
    "np.\na.contour3d()",
    "np.\nfor a, b in zip():\n  c = 1",
    "np.\nfor a, b in enumerate([]):\n  c = 1",
    "np.\nselect([], [])",
    "np.\npiecewise(x, [x > 0], [lambda: 1, lambda a: a])",
    "np.\npolyval([], x)",
    "np.\nclass",
    "np.\nif __name__",
    "np.\n>>> x = '",
    "np.\nfr\"\"\"",
    "v = [x for x in, y in ]\ncontour(x, y, v)",
    "plot3()",
    "contour(x, y, z, 'LevelList')",
    "ezplot('')",
    "ezplot('",
    "Manipulate[]",
    "Manipulate[x, {}, {{}}, {a}, {{a}, 1}]",
    "Table[x, {}]",
    "Show[Table[x, {k}]]",
    "Plot3D[x, {x, y} \\[Element] ]",
    "Plot3D[x, {x, y} \\[Element] Disk[]]",
    "Plot3D[x, {x, 1, 2}, {y, 1, 2}, PlotRange -> {}]",
    "Nest[#, x, ]",
    "Fold[# &, 0, {}]",
    "Total[# & /@ ]",
    "Total[ /@ x]",
    "{\"Iso3D\": {",
    "{\"Iso3D\": {\"Fxyz\": [\"x\"], \"Const\": [\"=\", \"a=\"]}}",
    "{\"Iso3D\": {\"Fxyz\": [\"x\", \"y\"], \"Xmin\": [\"1\\\"\"]}}",
    "{\"Param3D\"",
    "{equation: '",
    "expression = \"x\"\nvalue = ,",
    "set parametric\nsplot",
    "set parametric\nsplot [] u, u, u",
    "\\begin{cases}x = y \\\\ x = z\\end{cases}",
    "x <-",
    "f(x) <- ",
    "draw3d(parametric())",
    "plots[](x)",
    "curve3d(x, from = c(), to = c())",
];

/// Texts of other systems that are long, or end early. Each must be read or refused within a
/// second.
#[test]
fn texts_of_other_systems_are_bounded() {
    let many = |part: &str| part.repeat(20_000);
    let long = [
        format!("x{}", many("@x")),
        format!("implicit_plot3d(lambda {}: x)", many("a, ")),
        format!("ContourPlot3D[x, Contours -> {{{}1}}]", many("1, ")),
        format!("ContourPlot3D[{{{}1}}, Contours -> {{1, 2}}]", many("x, ")),
        format!("{}x == z /. x -> {}x", many("x + "), many("x + ")),
        format!("a = [{}1 2]\n{}", many("1*"), many("a ")),
        format!("f(x, y, z) = x\nimplicit_plot3d({}f)", many("f + ")),
        format!("(+ {} 1)", many("x ")),
        format!("(define-shape (a x y z) (let ({}) x))", many("(a x)")),
        format!("template<typename T>\n{}", many("T\n")),
        format!("[X, Y] = meshgrid(t, t)\n{}", many("a = 1:2\n")),
        format!("{}plot3d(x)", many("a = ")),
        format!("\\overline{{{}x}}", many("x + ")),
    ];
    let short = [
        "= [1 2]",
        "[X,Y] = meshgrid()",
        "[a,b,c,d] = meshgrid(1:2)",
        "splot",
        "set xrange [1:]",
        "ContourPlot3D[]",
        "Re@",
        "@x",
        "f@@x",
        "function f(x)",
        "torus(x;) = 3",
        "f = function { }",
        "{\"Fxyz\"",
        "{\"Fxyz\": [\"",
        "{\"Fxyz\": [\"é\"], \"Xmin\": [\"\"]}",
        "type=implicit;",
        "type=implicit;equation=~;xmin=",
        "(define",
        "(define-shape)",
        "(define-shape (a) 1)",
        "(define-shape (a x) 1)",
        "(+)",
        "(lambda-shape)",
        "(set-bounds! [] [])\n(define-shape (a x y z) x)",
        "With[{x = }, x]",
        "plot3d(lambda x: )",
        "fsurf(@(x,y) {return})",
        "isosurface { function { } }",
        "x /. x ->",
        "contour([1], )",
        "a.contour([1])",
        "a.contour()",
        "{0,1}",
        "x + {0,1}",
        "f.()",
        "....:",
        "sage:",
        "def",
    ];
    for text in long.iter().map(String::as_str).chain(short).chain(UNFINISHED.iter().copied()) {
        let _ = read(text, &Options::default());
    }
}

/// Derivatives and complex numbers that grow, nest or end early. Each is read or refused within
/// seconds, on a small stack.
#[test]
fn derivatives_and_complex_numbers_are_bounded() {
    let many = |part: &str, times: usize| part.repeat(times);
    let texts = [
        format!("f(a) = a^2\nf{}(x)", many("'", 300)),
        format!("f(a) = a^2\nf{}(x)", many("″", 300)),
        "diff(tan(tan(tan(x))), x, 20)".to_owned(),
        "diff(x^x^x*exp(x*y*z)/sin(x), x, x, x, x, x, x, x, x, x, x, x, x)".to_owned(),
        format!("{}x{}", many("diff(", 150), many(", x)", 150)),
        format!("{}x{}", many("curvature(", 12), many(")", 12)),
        format!("{}sin(x){}", many("offset(", 12), many(", 0.1)", 12)),
        "f(a) = a^9*sin(a)\ng(a) = f'(a)*f(a)\nh(a) = g''(a)\nh'''(x)".to_owned(),
        "f(a) = a^3 + sin(a)\nz = sum(k = 1..1000, sum(j = 1..1000, f'(x + k*j)))".to_owned(),
        format!("z = {}", many(r"+\frac{1}{2}x", 60_000)),
        format!("z = {}", many(r"\frac{d", 60_000)),
        "f(u, v) = diff(u^2*v, u)\ng(v) = f(v, v)\ng'(x)".to_owned(),
        "diff(x, diff(x, x))".to_owned(),
        "diff(x)".to_owned(),
        "diff()".to_owned(),
        "diff(x, 2)".to_owned(),
        "diff(x, x, 99999999999999999999)".to_owned(),
        "diff(x, e)".to_owned(),
        "diff(x, i)".to_owned(),
        "d/d".to_owned(),
        "d/dé(x)".to_owned(),
        "∂/∂".to_owned(),
        "∂/∂x".to_owned(),
        r"\frac{d}{dx}".to_owned(),
        r"\frac{d}{d".to_owned(),
        r"\frac{∂^2}{∂}x".to_owned(),
        r"\nabla".to_owned(),
        "∇²".to_owned(),
        format!("{}x", many("∇", 300)),
        format!("{}x", many("∂/∂x ", 300)),
        "f' = 2".to_owned(),
        "x'(2)".to_owned(),
        "abs((x + i y)^1000)".to_owned(),
        "abs((x + i y)^(10^30))".to_owned(),
        "abs((x + i)^(-1000))".to_owned(),
        format!("abs({}x + i{})", many("sin(", 100), many(")", 100)),
        "f(w) = w^w\nabs(iterate(f, 1000, x + i y))".to_owned(),
        "re(spherical_harmonic(100, 100, x, y))".to_owned(),
        "legendre(101, x)".to_owned(),
        "legendre(x, x)".to_owned(),
        "legendre(2, 5, x)".to_owned(),
        "hermite(-1, x)".to_owned(),
        "T_99999999999999999999(x)".to_owned(),
        "quat(x, y, z, i)".to_owned(),
        "vec3(i, x, y)".to_owned(),
        "min(i, x)".to_owned(),
        "i < 2".to_owned(),
        "{i: x, y}".to_owned(),
        "mat2(i)*vec2(x, y)".to_owned(),
        "quat(x, y, z, 1)^0.5".to_owned(),
        "sum(k = 1..i, x)".to_owned(),
        "sphere(i)".to_owned(),
    ];
    for text in texts {
        let shown: String = text.chars().take(60).collect();
        println!("{shown}");
        on_a_small_stack(move || {
            if let Err(errors) = read(&text, &Options::default()) {
                errors.render(None, &text, false);
            }
        });
    }
}

#[test]
fn expressions_of_programs_are_bounded() {
    let many = 20_000;
    let program = |value: String| format!("float map(vec3 p) {{ float d = 1.; return {value}; }}");
    assert!(is_too_deep(program(format!("{}p.x", "d = ".repeat(many)))));
    assert!(is_too_deep(program(format!("{}p.x", "p.y > 0. ? 1. : ".repeat(many)))));
    assert!(is_too_deep(program(format!("float(p.y > 0. {})", "|| d++ > p.y ".repeat(many)))));
    assert!(is_too_deep(program(format!("p.x{}", "^2.".repeat(many)))));
    let depth = Limits::default().depth - 20;
    for (open, close) in [("(", ")"), ("sin(", ")"), ("(d++, ", ")"), ("(d > 0. ? d : ", ")")] {
        for levels in [depth / 4, depth / 2] {
            let nested = format!("{}p.x{}", open.repeat(levels), close.repeat(levels));
            // Read or refused, without a panic.
            on_a_small_stack({
                let text = program(nested);
                move || read(&text, &Options::default()).is_ok()
            });
        }
        let nested = format!("{}p.x{}", open.repeat(depth / 4), close.repeat(depth / 4));
        assert!(accepted(program(nested)) > 0, "{open}");
    }
}

#[test]
fn loops_without_a_variable_are_refused() {
    for text in [
        "def f(x, y, z):\n    for 3 in (1, 2):\n        x += 1\n    return x",
        "def f(x, y, z):\n    for () in ((1, 2), (3, 4)):\n        x += 1\n    return x",
        "function f(x, y, z) { for (const of [1, 2]) { x += 1; } return x; }",
    ] {
        assert!(read(text, &Options::default()).is_err(), "{text}");
    }
}
