//! Random models that are long enough to be drawn by parts, as text.

use std::fmt::Write as _;
use zeroset_testkit::Rng;

/// A document that is written line by line.
pub struct Writer<'r> {
    rng: &'r mut Rng,
    text: String,
    lines: usize,
    /// Coordinates that are folded. Several primitives use each.
    folds: Vec<String>,
    /// Primitives that several surfaces may share.
    primitives: Vec<String>,
}

impl<'r> Writer<'r> {
    pub fn new(rng: &'r mut Rng) -> Self {
        let (text, folds, primitives) = (String::new(), Vec::new(), Vec::new());
        Self { rng, text, lines: 0, folds, primitives }
    }

    /// The lines so far.
    pub fn text(self) -> String {
        self.text
    }

    /// Adds a surface of this many primitives.
    pub fn surface(&mut self, count: usize) {
        let mut open: Vec<String> = (0..count).map(|_| self.primitive()).collect();
        while open.len() > 1 {
            // Some models are joined in a row, others in pairs.
            let place = if self.one_in(3) { open.len() - 2 } else { 0 };
            let (a, b) = (open.remove(place), open.remove(place));
            let joined = self.joined(&a, &b);
            open.push(joined);
        }
        let mut all = open.remove(0);
        if self.one_in(8) {
            let part = self.seam();
            all = self.define(&format!("min({all},{part})"));
        }
        let _ = match self.rng.u32(0..8) {
            0 | 1 => {
                let plane = self.plane();
                writeln!(self.text, "0 = ({all}){{{plane} < 0.9}}")
            }
            2..=4 => writeln!(self.text, "0 = {all}"),
            5 => writeln!(self.text, "{all} >= 0"),
            _ => writeln!(self.text, "{all} <= 0"),
        };
    }

    fn define(&mut self, value: &str) -> String {
        let name = format!("v_{}", self.lines);
        let _ = writeln!(self.text, "{name} = {value}");
        self.lines += 1;
        name
    }

    fn one_in(&mut self, count: u32) -> bool {
        self.rng.u32(0..count) == 0
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * f64::from(self.rng.u32(0..=1000)) / 1000.0
    }

    fn number(&mut self, low: f64, high: f64) -> String {
        format!("({:.4})", self.between(low, high))
    }

    /// A coordinate, often folded.
    fn coordinate(&mut self, axis: &str) -> String {
        if !self.one_in(6) {
            return axis.to_owned();
        }
        if self.folds.len() < 4 || self.one_in(8) {
            // Some folds are nested.
            let inner = match self.folds.last() {
                Some(last) if self.rng.bool() => last.clone(),
                _ => axis.to_owned(),
            };
            let [at, by] = [self.number(-0.8, 0.8), self.number(0.0, 0.8)];
            let fold = self.define(&format!("abs({inner}-{at})-{by}"));
            self.folds.push(fold);
        }
        self.folds[self.rng.u32(0..self.folds.len() as u32) as usize].clone()
    }

    /// Coordinates relative to a random place.
    fn place(&mut self) -> [String; 3] {
        ["x", "y", "z"].map(|axis| {
            let axis = self.coordinate(axis);
            format!("({axis}-{})", self.number(-1.4, 1.4))
        })
    }

    fn plane(&mut self) -> String {
        let [a, b, c] = [(); 3].map(|()| self.number(-0.8, 0.8));
        format!("({a}*x+{b}*y+{c}*z)")
    }

    /// A primitive, sometimes one that is used already.
    fn primitive(&mut self) -> String {
        if !self.primitives.is_empty() && self.one_in(12) {
            return self.primitives[self.rng.u32(0..self.primitives.len() as u32) as usize].clone();
        }
        let [x, y, z] = self.place();
        let [r, h] = [(); 2].map(|()| self.number(0.1, 0.45));
        let value = match self.rng.u32(0..10) {
            0..=2 => format!("sqrt({x}^2+{y}^2+{z}^2)-{r}"),
            3 => format!("{x}^2+{y}^2+{z}^2-{r}^2"),
            4 | 5 => {
                let p = self.define(&format!("max(abs{x}-{r},abs{y}-{h})"));
                let q = self.define(&format!("abs{z}-{r}"));
                format!("min(max({p},{q}),0)+sqrt(max({p},0)^2+max({q},0)^2)")
            }
            6 => {
                let plane = self.plane();
                format!("max(sqrt({x}^2+{y}^2+{z}^2)-2*{r},abs({plane}-{h}+0.3)-0.08)")
            }
            7 => format!("max(sqrt({x}^2+{y}^2)-{r},abs{z}-{h})"),
            8 => {
                let k = self.number(3.0, 9.0);
                let wave =
                    format!("sin({k}*x)*cos({k}*y)+sin({k}*y)*cos({k}*z)+sin({k}*z)*cos({k}*x)");
                format!("max(abs({wave})/{k}-0.04,sqrt({x}^2+{y}^2+{z}^2)-{r}-0.2)")
            }
            _ => format!("sqrt((sqrt({x}^2+{y}^2)-{r}-0.1)^2+{z}^2)-{r}/3"),
        };
        let name = self.define(&value);
        self.primitives.push(name.clone());
        name
    }

    /// A part with a pole, a jump or a gap. Then the surface may be drawn as a whole.
    fn seam(&mut self) -> String {
        let (at, ball) = (self.number(-0.7, 0.7), self.primitive());
        match self.rng.u32(0..4) {
            0 => format!("max({ball},0.02/(x-{at})-y)"),
            1 => format!("max({ball},z-floor(2*x)/3)"),
            2 => format!("if(y<{at},{ball},{ball}+0.1)"),
            _ => format!("({ball}+0.05*sqrt(z-{at}))"),
        }
    }

    /// A blend of two terms: (is it a maximum, a, b).
    fn blend(&mut self, is_max: bool, a: &str, b: &str) -> String {
        // Wide blends reach across the model.
        let k = if self.one_in(4) { self.between(0.3, 1.2) } else { self.between(0.02, 0.3) };
        let c = match self.rng.u32(0..8) {
            0..=4 => 0.25,
            5 => self.between(0.0, 1.0),
            6 => 0.9999,
            // Thresholds do not hold for such a blend.
            _ => 1.3,
        } / k;
        let (word, sign) = if is_max { ("max", '+') } else { ("min", '-') };
        match self.rng.u32(0..4) {
            0 => {
                let (h, k) = (format!("clamp(0.5+0.5*({b}-{a})/{k:.4},0,1)"), format!("{k:.4}"));
                let h = self.define(&if is_max { format!("1-{h}") } else { h });
                format!("(mix({b},{a},{h}){sign}{k}*{h}*(1-{h}))")
            }
            _ => format!("({word}({a},{b}){sign}{c:.4}*max({k:.4}-abs({a}-{b}),0)^2)"),
        }
    }

    /// A combination of two parts.
    fn joined(&mut self, a: &str, b: &str) -> String {
        let value = match self.rng.u32(0..32) {
            0..=11 => format!("min({a},{b})"),
            12 | 13 => format!("max({a},{b}-{})", self.number(0.3, 1.0)),
            14..=16 => format!("max({a},-{b})"),
            17..=22 => self.blend(false, a, b),
            23 => {
                let offset = self.number(0.3, 1.0);
                let wide = self.define(&format!("{b}-{offset}"));
                self.blend(true, a, &wide)
            }
            24 => {
                let hole = self.define(&format!("-{b}"));
                self.blend(true, a, &hole)
            }
            25 => {
                // A hollow that two parts have together.
                let other = self.primitive();
                let both = self.blend(false, b, &other);
                format!("max({a},-({both}))")
            }
            26 => {
                let [wall, size] = [self.number(0.02, 0.1), self.number(0.5, 2.0)];
                format!("min(abs({a})-{wall},{size}*{b})")
            }
            27 => format!("min({a}/1.7-{},0.01-(-{b}))", self.number(-0.05, 0.05)),
            28 => format!("min({a},{b})+0.03*sin(9*x)*sin(8*y)"),
            29 => {
                // A choice that does not jump.
                let at = self.number(-0.5, 0.5);
                format!("min({a},max({b},min(x-{at},{b}+0.3)))")
            }
            30 => format!("max(min({a},{b}),-max(abs(x)-0.2,abs(y)-0.2))"),
            _ => {
                let other = self.primitive();
                let both = self.blend(false, a, &other);
                let whole = self.define(&both);
                self.blend(false, &whole, b)
            }
        };
        self.define(&value)
    }
}
