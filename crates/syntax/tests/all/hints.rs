//! Messages for wrong lines say what a teacher would say.

use zeroset_syntax::{Options, read};

struct Row {
    text: String,
    hint: String,
    /// Pieces of a good message. One is enough.
    pieces: Vec<String>,
}

fn rows() -> Vec<Row> {
    let path = format!("{}/../../tests/data/hints.txt", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).expect("the corpus is there");
    let mut rows = Vec::new();
    for block in text.split("\n\n") {
        let lines = |sign: char| -> Vec<String> {
            let all = block.lines().filter_map(|line| line.strip_prefix(sign));
            all.map(|line| line.strip_prefix(' ').unwrap_or(line).to_owned()).collect()
        };
        let (text, pieces) = (lines('>').join("\n"), lines('*'));
        if !text.is_empty() {
            rows.push(Row { text, hint: lines('?').join("\n"), pieces });
        }
    }
    rows
}

/// The messages for a text, without the text itself.
fn messages(text: &str) -> String {
    let unquoted = |rendered: String| -> String {
        let is_quoted = |line: &&str| text.lines().any(|own| !own.is_empty() && line.contains(own));
        rendered.lines().filter(|line| !is_quoted(line)).collect::<Vec<_>>().join("\n")
    };
    match read(text, &Options::default()) {
        Ok(document) => {
            let notes = document.notes.iter().map(|note| note.message());
            unquoted(notes.collect::<Vec<_>>().join("\n"))
        }
        Err(errors) => unquoted(errors.render(None, text, false)),
    }
}

/// As many rows have a good message as when this was written, at least. Commands at the prompt are
/// not asked here.
#[test]
fn wrong_lines_get_the_hints_of_a_teacher() {
    let without_blanks = |text: &str| text.replace(char::is_whitespace, "");
    let (mut good, mut asked) = (0, 0);
    for Row { text, hint, pieces } in rows().iter().filter(|row| !row.text.starts_with(':')) {
        let said = messages(text);
        asked += 1;
        let plain = without_blanks(&said);
        if pieces.iter().any(|piece| plain.contains(&without_blanks(piece))) {
            good += 1;
        } else {
            println!("{text}\n  wanted {hint}\n  {}", said.replace('\n', "\n  "));
        }
    }
    println!("{good} of {asked}");
    assert!(asked > 150 && good >= 192, "{good} of {asked}");
}

/// Each text, and the only advice that it gets.
#[test]
fn advice_is_the_line_to_write_and_is_given_once() {
    for (text, line) in [
        // A definition with a word before it. The other errors follow from the first.
        ("vec r = (x,y,z)\nr.x^2 + r.y^2 = 1", "write `r = (x,y,z)`"),
        ("point A = (1, 2, 0)\nlength((x,y,z) - A) = 1", "write `A = (1, 2, 0)`"),
        ("scalar r = 2\nx^2 + y^2 + z^2 = r^2", "write `r = 2`"),
        ("given k = 2\nz = k*x", "write `k = 2`"),
        ("vector v = (1, 2, 2)\ndot(v, (x, y, z)) = 4", "write `v = (1, 2, 2)`"),
        ("given f(a) = a^2\nz = f(x)", "write `f(a) = a^2`"),
        // A letter without a value, in each round of a loop.
        ("s = 0\nfor k in range(3):\n    s += sin(k*x)*q\nz = s", "with a line `q = 1`"),
        ("for k in range(3):\n    (x-k)^2 + y^2 + z^2 = p*w", "write `p = 1; w = 1`"),
        ("for c in [1, 2, 3]:\n    x^2 + y^2 + z^2 = p*c", "with a line `p = 1`"),
        (
            "float f(vec3 v){ float s = 0.; for(int i=0;i<3;i++){ s += sin(v.x*float(i))*pq; } \
             return s-v.z; }",
            "write `p = 1; q = 1`",
        ),
        ("z = sum(k=1..3, sin(k*x)*w*v)", "write `v = 1; w = 1`"),
        ("f(s) = s^2 + a*b\nz = f(x)", "write `a = 1; b = 1`"),
        // Products with pi.
        ("y = 2piu", "write `u = 1` and below it `y = 2pi*u`"),
        ("z = sin(2pik*x)", "write `k = 1` and below it `z = sin(2pi*k*x)`"),
        ("z = sin(pir)", "write `z = sin(pi*r)`"),
        ("z = taux", "write `z = tau*x`"),
        ("z = cos(piab)", "write `a = 1; b = 1` and below it `z = cos(pi*a*b)`"),
        // Logarithms.
        ("z = log(8, 2)*x", "write `z = ln(8)/ln(2)*x`"),
        ("z = ln(x, 10)", "write `z = ln(x)/ln(10)`"),
        ("z = logb(2, x)", "a logarithm to a base is a quotient: write `z = ln(x)/ln(2)`"),
        // Curves and lists of levels.
        ("curve y = x^2", "write `curve y = x^2, z = 0`"),
        ("curve x^2 + z^2 = 1 {x > 0}", "write `curve x^2 + z^2 = 1, y = 0 {x > 0}`"),
        ("curve x^3 + y^3 = 6xy", "write `curve x^3 + y^3 = 6xy, z = 0`"),
        ("(3 cos t, 2 sin t) for t in [0, 2pi]", "write `(3 cos t, 2 sin t, 0) for t in [0, 2pi]`"),
        ("x^2 - y^2 = [-1, 1]", "write `x^2 - y^2 = -1` and below it `x^2 - y^2 = 1`"),
        ("z = c*x for c in [1, 2]", "write `c = 1 in [1, 2]` and below it `z = c*x`"),
        (
            "x*y = k for k in [1, 2, 3]",
            "write `x*y = 1` and below it `x*y = 2` and below it `x*y = 3`",
        ),
        ("z = c*x for c in [-1, 0, 1]", "write `z = -1*x` and below it `z = 0*x`"),
        // Colors.
        ("color rgb(255,0,0); sphere(1)", "write `color #ff0000`"),
        ("color vec3(1, 0.5, 0)\nsphere(1)", "write `color #ff8000`"),
        ("color hsl(30,100%,50%) 50%\nsphere(1)", "write `color #ff8000 50%`"),
        // Programs.
        (
            "fn f(p: vec3<f32>) -> f32 { return length(p) - vec3<f32>(1.0).x; }",
            "write `fn f(p: vec3) -> f32 { return length(p) - vec3(1.0).x; }`",
        ),
        (
            "struct Hit { float d; }; Hit map(vec3 p){ Hit h; h.d = length(p)-1.; return h; }",
            "`float map(vec3 p) { return length(p) - 1.; }`",
        ),
        ("sphere(1) minus box(0.5)", "by a function: write `subtract(sphere(1), box(0.5)) <= 0`"),
    ] {
        let errors = read(text, &Options::default()).expect_err(text);
        let said = errors.render(None, text, false);
        assert_eq!(errors.iter().count(), 1, "{text}: {said}");
        assert!(said.contains(line), "{text}: {said}");
        assert!(said.matches("base").count() < 2, "{text}: {said}");
    }
}

/// Texts in notations of textbooks, and a part of the messages on them. A line uses the numbers of
/// the text.
#[test]
fn notations_of_textbooks_get_their_line() {
    let rows = [
        ("r(t) = <cos t, sin t, t>", "write `(cos t, sin t, t) for t in [0, 20]`"),
        ("r(u,v) = (cos u sin v, sin u sin v, cos v)", "ranges of both parameters"),
        ("(x,y,z) = (1,2,3) + t(1,-1,2)", "write `(1,2,3) + t*(1,-1,2) for t in [-2, 2]`"),
        ("P(1,2,3)", "write `(1, 2, 3) \"P\"`"),
        ("A=(1,2,3)", "write `(1, 2, 3) \"A\"`"),
        ("vector (1,2,3)", "write `vector((1, 2, 3))`"),
        ("segment (0,0,0),(1,1,1)", "write `segment((0, 0, 0), (1, 1, 1))`"),
        ("plane 2x+y-z=3", "write `2x+y-z = 3`"),
        ("sphere center (1,2,3) radius 4", "write `sphere(4, (1, 2, 3))`"),
        ("{x^2+y^2<=100, |z|<=5}", "write `x^2+y^2<=100 and |z|<=5`"),
        ("z = x^2+y^2; x in [-1,1]", "write `domain x in [-1, 1]`"),
        ("3x+2y=12, x=0, y=0, z=0", "write `3x+2y=12; x=0; y=0; z=0`"),
        ("∫x^2 dx = z", "there are derivatives"),
        ("z=max{x,y}", "write `z=max(x,y)`"),
        ("w = x^2+y^2+z^2; w = 4", "write `x^2+y^2+z^2 = 4`"),
        ("x_1^2+x_2^2+x_3^2=1", "write `x^2+y^2+z^2=1`"),
        ("x1^2+x2^2=1", "write `x^2+y^2=1`"),
        ("axis on; z=x*y", "write `axes on`"),
        ("xlim([-5,5]); z=x*y", "write `domain x in [-5, 5]`"),
        ("ylim([0 3]); z=x*y", "write `domain y in [0, 3]`"),
        ("text (1,1,1) \"hello\"", "write `(1, 1, 1) \"hello\"`"),
        ("light 1 1 1\nz=x", "write `light (1, 1, 1)`"),
        ("size 800 600\nz=x", "write `--size 800x600`"),
        ("red z=x*y", "write `color red` and below it `z=x*y`"),
        ("color: red\nz=x*y", "write `color red`"),
        ("cylinder(h=20,r=5) <= 0", "write `cylinder(5, 10) <= 0`"),
        ("sphere(r=5) <= 0", "write `sphere(5) <= 0`"),
        ("sphere(d=10) <= 0", "write `sphere(5) <= 0`"),
        ("cone(r1=5,r2=2,h=10) <= 0", "write `cone(5, 2, 5) <= 0`"),
        ("z = 1 000 x", "write `z = 1000 x`"),
        ("z = 3 1/2 x", "write `z = (3 + 1/2) x`"),
        ("z = 2½x", "write `z = (2 + 1/2) x`"),
        ("z = 2x10^3 y", "write `z = 2*10^3 y`"),
        ("torus(3,0,5) <= 0", "write `torus(3, 0.5) <= 0`"),
        ("torus(1,3,0,3) <= 0", "write `torus(1.3, 0.3) <= 0`"),
        (
            "hull(sphere(1), sphere(1,(3,0,0))) <= 0",
            "write `capsule((0, 0, 0), (3, 0, 0), 1) <= 0`",
        ),
        ("fillet(box(1), 0.1) <= 0", "write `rounded_box(1, 0.1) <= 0`"),
        ("hull(sphere(1), sphere(2)) <= 0", "there is no hull of any solids"),
        ("chamfer(box(1), 0.1) <= 0", "`blend(a, b, r)`"),
        ("float map(vec3 p){ return length(p)-iMouse.x; }", "write `0.0` in place"),
        (
            "float map(vec3 p){ return length(inverse(mat3(1.))*p)-1.; }",
            "that of one that only turns is `transpose(m)`",
        ),
    ];
    let said = |text: &str| match read(text, &Options::default()) {
        Ok(_) => "it is read".to_owned(),
        Err(errors) => errors.render(None, text, false),
    };
    let is_wrong = |(text, line): &&(&str, &str)| !said(text).contains(line);
    let wrong: Vec<String> = rows
        .iter()
        .filter(is_wrong)
        .map(|(text, line)| format!("{line}:\n{}", said(text)))
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let said = said("polygon([[0,0],[2,0],[1,2]])");
    assert!(!said.contains("write `polygon(6, 1)`"), "{said}");
}

/// A program of solids gets a line with the same solid, or no line.
#[test]
fn programs_of_solids_get_lines_with_the_same_solid() {
    for (text, line) in [
        ("linear_extrude(10) circle(5);", "translate(extrude(circle(5), 5), 0, 0, 5) <= 0"),
        (
            "linear_extrude(5) square([20,10]);",
            "translate(extrude(translate(rectangle(10, 5), 10, 5, 0), 2.5), 0, 0, 2.5) <= 0",
        ),
        ("linear_extrude(height=5, twist=90) square(10, center=true);", ""),
        ("linear_extrude(height=5, scale=0.5) circle(4);", ""),
        ("linear_extrude(height=4, center=true) circle(d=4);", "extrude(circle(2), 2) <= 0"),
        ("rotate_extrude(angle=270) translate([10,0,0]) circle(r=3);", ""),
        (
            "rotate_extrude() translate([20,5,0]) circle(r=3);",
            "revolve(translate(circle(3), 20, 5, 0)) <= 0",
        ),
        (
            "rotate_extrude($fn=60) translate([10,0]) square(4);",
            "revolve(translate(translate(rectangle(2, 2), 2, 2, 0), 10, 0, 0)) <= 0",
        ),
        (
            "rotate(a=45, v=[0,1,0]) cube(4);",
            "rotate(translate(box(2), 2, 2, 2), 45°, (0, 1, 0)) <= 0",
        ),
        ("cube(10, true);", "box(5) <= 0"),
        (
            "difference(){ cube([20,20,20], true); sphere(12); }",
            "subtract(box(10, 10, 10), sphere(12)) <= 0",
        ),
        ("#cube([10,10,10]); %sphere(3);", "translate(box(5, 5, 5), 5, 5, 5) <= 0"),
        ("cylinder(h=20,r=2);", "translate(cylinder(2, 10), 0, 0, 10) <= 0"),
        ("cylinder(h=10, r1=5, r2=0, center=true);", "cone(5, 5) <= 0"),
        ("cylinder(d1=10,d2=5,h=3);", "translate(cone(5, 2.5, 1.5), 0, 0, 1.5) <= 0"),
        (
            "translate([0,0,1]) cylinder(6, 3);",
            "translate(translate(cone(3, 1, 3), 0, 0, 3), 0, 0, 1) <= 0",
        ),
        ("sphere(3, $fn=50);", "sphere(3) <= 0"),
        ("cylinder(10, 5, 5, $fn=6);", ""),
        ("$fn = 6; cube(1); cylinder(10, 5, 5);", ""),
        ("scale(2) sphere(1);", "scale(sphere(1), 2) <= 0"),
        ("translate(v=[1,2,3]) sphere(2);", "translate(sphere(2), 1, 2, 3) <= 0"),
        ("resize([1,2,3]) sphere(2);", ""),
        (
            "w=2; difference(){ cube(9); translate([w,w,w]) cube(9-2*w); }",
            "subtract(translate(box(4.5), 4.5, 4.5, 4.5), translate(translate(box((9-2*w)/2), \
             (9-2*w)/2, (9-2*w)/2, (9-2*w)/2), w, w, w)) <= 0",
        ),
        ("x = 5; translate([x,0,0]) cube(2);", ""),
        ("a = 30; translate([9*cos(a), 0, 0]) cube(2);", ""),
        ("for (i=[0:2]) translate([i*3,0,0]) sphere(1);", "repeat(sphere(1), (3, 0, 0), 3) <= 0"),
        (
            "for (i=[1:3]) { translate([3*i,0,2]) sphere(1); }",
            "translate(repeat(sphere(1), (3, 0, 0), 3), 3, 0, 2) <= 0",
        ),
        (
            "for (i=[1,4]) translate([i+1,0,0]) sphere(i);",
            "union(translate(sphere((1)), (1)+1, 0, 0), translate(sphere((4)), (4)+1, 0, 0)) <= 0",
        ),
        (
            "for (i=[0:1]) rotate([0,0,180*i]) translate([9,0,0]) sphere(1);",
            "union(rotate(translate(sphere(1), 9, 0, 0), (180*(0))°, (0, 0, 1)), \
             rotate(translate(sphere(1), 9, 0, 0), (180*(1))°, (0, 0, 1))) <= 0",
        ),
        ("module peg(h, d = 2) { cylinder(h, d, d); } peg(5);", ""),
        ("module peg(h) { cylinder(h, 2, 2, true); } peg(5);", "peg(5) <= 0"),
        ("polyhedron(points=[[0,0,0]], faces=[[0]]);", ""),
        ("minkowski() { cube([10,10,10]); cylinder(r=2,h=1); }", ""),
        (
            "cq.Workplane(\"XY\").circle(2).extrude(5)",
            "translate(extrude(circle(2), 2.5), 0, 0, 2.5) <= 0",
        ),
        ("cq.Workplane(\"XZ\").circle(2).extrude(5)", ""),
        ("cq.Workplane(\"XY\").box(2, 1, 1).faces(\">X\").workplane().hole(0.5)", ""),
        (
            "new THREE.CylinderGeometry(1, 2, 3, 32)",
            "rotate(cone(2, 1, 1.5), -90°, (1, 0, 0)) <= 0",
        ),
    ] {
        let errors = read(text, &Options::default()).expect_err(text);
        let said = errors.render(None, text, false);
        match line {
            "" => assert!(!said.contains("solids are joined and moved"), "{text}: {said}"),
            line => assert!(said.contains(&format!("`{line}`")), "{text}: {said}"),
        }
    }
}
