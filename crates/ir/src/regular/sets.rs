//! The sets of which a solid is made: bounds of linear forms, and their unions and intersections.

use super::emit::Plan;
use super::form::{Forms, LinearForm};
use super::thin::{Nonneg, Thinness};
use crate::constant::Constant;
use crate::graph::{Graph, Node, NodeId};
use num_rational::BigRational;
use num_traits::{One, Signed, Zero};
use rustc_hash::{FxHashMap, FxHashSet};
use std::ops::Not;
use std::rc::Rc;
use zeroset_interval::Interval;
use zeroset_ops::Op;

/// Largest depth of nested minima and maxima. A chain counts once. A deeper minimum or maximum is
/// one set: no rule looks at its operands.
const DEPTH_LIMIT: usize = 128;
/// Largest number of choices in one sum that are replaced by their cases.
const CASES_LIMIT: usize = 3;
/// Limits on the steps that all rules together may take: a constant part, and a part for each node.
/// Most functions take at most some tenths of a second. A set is left as it is once the steps are
/// used up.
const WORK_LIMITS: [usize; 2] = [200_000, 64];
/// Largest number of steps, however many nodes a function has.
const WORK_LIMIT: usize = 2_000_000;

/// Index of a set in [`Sets`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct SetId(pub u32);

impl SetId {
    /// All of space.
    pub const ALL: Self = Self(0);
    /// The empty set.
    pub const NONE: Self = Self(1);

    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// The kind of a group of sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Kind {
    Intersection,
    Union,
}

impl Kind {
    /// The set that does not change a group. A group without members is this set.
    pub fn neutral(self) -> SetId {
        match self {
            Self::Intersection => SetId::ALL,
            Self::Union => SetId::NONE,
        }
    }

    /// The set that decides a group: a group that has this set as a member equals it.
    pub fn absorbing(self) -> SetId {
        (!self).neutral()
    }
}

impl Not for Kind {
    type Output = Self;
    fn not(self) -> Self {
        match self {
            Self::Intersection => Self::Union,
            Self::Union => Self::Intersection,
        }
    }
}

/// The side of a bound on which its set lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Side {
    /// The set v ≤ c.
    Below,
    /// The set v ≥ c.
    Above,
}

impl Not for Side {
    type Output = Self;
    fn not(self) -> Self {
        match self {
            Self::Below => Self::Above,
            Self::Above => Self::Below,
        }
    }
}

/// A bound v ≤ c or v ≥ c of a sum of terms v.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Bound {
    /// Number of the sum v in [`Sets`].
    pub sum: u32,
    pub side: Side,
    /// The number c.
    pub at: Rc<BigRational>,
}

#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Set {
    All,
    Nothing,
    Bound(Bound),
    Group(Kind, Rc<[SetId]>),
}

/// A set, and a function that is ≤ 0 in it.
pub(super) struct Entry {
    pub set: Set,
    /// A node that is the function; it is negated if the flag is set.
    pub source: Option<(NodeId, bool)>,
    /// A form that is the function.
    pub form: Option<Rc<LinearForm>>,
}

/// A sum of terms, with the coefficient 1 for its first term.
struct Sum {
    terms: Vec<(NodeId, Constant)>,
    is_nonneg: bool,
    /// Values at some places, for the proof that bounds are thin.
    values: Option<Vec<Option<Rc<Vec<Interval>>>>>,
}

/// The set where a function is ≤ 0, with a property of the function.
#[derive(Clone, Copy)]
struct Found {
    set: SetId,
    /// True if the function is 0 on the faces of its bounds only. False if a case or a factor was
    /// dropped: the function may then be 0 inside of the set, so it must not stand for the set.
    is_sharp: bool,
}

/// All sets of a function. Equal sets are stored once.
pub(super) struct Sets<'a> {
    graph: &'a Graph,
    forms: Forms,
    thinness: Thinness<'a>,
    nonneg: Nonneg,
    entries: Vec<Entry>,
    index: FxHashMap<Set, SetId>,
    sums: Vec<Sum>,
    sum_index: FxHashMap<Vec<(NodeId, BigRational)>, u32>,
    of_nodes: FxHashMap<(NodeId, bool), Found>,
    of_forms: FxHashMap<LinearForm, Found>,
    /// For each node, whether it is or uses a choice.
    chooses: Vec<bool>,
    depth: usize,
    /// Number of steps that the rules may still take.
    pub work: usize,
}

impl<'a> Sets<'a> {
    pub fn new(graph: &'a Graph, root: NodeId, parameters: &'a [Interval]) -> Self {
        let mut chooses = vec![false; graph.len()];
        let needed = graph.needed(&[root]);
        let [least, each] = WORK_LIMITS;
        let work = WORK_LIMIT.min(least + each * needed.len());
        for id in needed {
            if let Node::Apply(op, operands) = graph.node(id) {
                let own = [Op::Min, Op::Max, Op::Abs].contains(op);
                chooses[id.index()] = own || operands.iter().any(|id| chooses[id.index()]);
            }
        }
        let mut sets = Self {
            graph,
            forms: Forms::default(),
            thinness: Thinness::new(parameters),
            nonneg: Nonneg::default(),
            entries: Vec::new(),
            index: FxHashMap::default(),
            sums: Vec::new(),
            sum_index: FxHashMap::default(),
            of_nodes: FxHashMap::default(),
            of_forms: FxHashMap::default(),
            chooses,
            depth: 0,
            work,
        };
        assert_eq!(sets.intern(Set::All, None), SetId::ALL);
        assert_eq!(sets.intern(Set::Nothing, None), SetId::NONE);
        sets
    }

    pub fn into_plan(self) -> Plan {
        let Self { entries, .. } = self;
        Plan::new(entries)
    }

    pub fn set(&self, id: SetId) -> &Set {
        &self.entries[id.index()].set
    }

    pub fn bound(&self, id: SetId) -> Option<&Bound> {
        match self.set(id) {
            Set::Bound(bound) => Some(bound),
            Set::All | Set::Nothing | Set::Group(..) => None,
        }
    }

    /// The members of set `id` if it is a group of this kind. Otherwise the set itself, as the only
    /// member.
    pub fn members(&self, kind: Kind, id: SetId) -> Rc<[SetId]> {
        match self.set(id) {
            Set::Group(found, members) if *found == kind => Rc::clone(members),
            _ if id == kind.neutral() => Rc::new([]),
            Set::All | Set::Nothing | Set::Bound(_) | Set::Group(..) => Rc::new([id]),
        }
    }

    /// The number of a set, which is added unless it is known.
    fn intern(&mut self, set: Set, form: Option<Rc<LinearForm>>) -> SetId {
        if let Some(id) = self.index.get(&set) {
            return *id;
        }
        let id = SetId(u32::try_from(self.entries.len()).expect("fewer than 2^32 sets"));
        self.index.insert(set.clone(), id);
        self.entries.push(Entry { set, source: None, form });
        id
    }

    /// The group of these sets. A member that is a group of the same kind is replaced by its
    /// members.
    pub fn group(&mut self, kind: Kind, sets: impl IntoIterator<Item = SetId>) -> SetId {
        let mut members: Vec<SetId> = Vec::new();
        let mut known = FxHashSet::default();
        for set in sets {
            if set == kind.absorbing() {
                return set;
            }
            for member in &*self.members(kind, set) {
                if known.insert(*member) {
                    members.push(*member);
                }
            }
        }
        match members[..] {
            [] => kind.neutral(),
            [only] => only,
            _ => self.intern(Set::Group(kind, members.into()), None),
        }
    }

    /// The set where a node is ≤ 0.
    pub fn of_node(&mut self, id: NodeId) -> SetId {
        self.of_signed(id, false).set
    }

    /// The set where a node is ≤ 0 or, if `negated`, ≥ 0.
    fn of_signed(&mut self, id: NodeId, negated: bool) -> Found {
        if let Some(found) = self.of_nodes.get(&(id, negated)) {
            return *found;
        }
        let mut form = self.forms.of(self.graph, id);
        if negated {
            form = Rc::new(form.scaled(&-BigRational::one()));
        }
        self.depth += 1;
        let found = self.of_form(&form);
        self.depth -= 1;
        if found.is_sharp {
            self.entries[found.set.index()].source.get_or_insert((id, negated));
        }
        self.of_nodes.insert((id, negated), found);
        found
    }

    /// The set where a form is ≤ 0.
    fn of_form(&mut self, form: &Rc<LinearForm>) -> Found {
        if let Some(found) = self.of_forms.get(&**form) {
            return *found;
        }
        let found = match self.cases(form).or_else(|| self.factor(form)) {
            Some(found) => found,
            None => Found { set: self.simple(form), is_sharp: true },
        };
        self.of_forms.insert((**form).clone(), found);
        found
    }

    /// The set of a form with a choice among its terms, from the cases of the choice.
    fn cases(&mut self, form: &LinearForm) -> Option<Found> {
        let chooses = |id: NodeId| self.chooses[id.index()];
        let choices = form.terms.iter().filter(|(id, _)| chooses(*id));
        if self.depth > DEPTH_LIMIT || choices.count() > CASES_LIMIT {
            return None;
        }
        // Other terms that choose, like those of a smooth blend, would be repeated in each case.
        let is_magnitude = |id: &NodeId| self.graph.operands(*id, Op::Abs).is_some();
        let own = |(id, _): &&(NodeId, BigRational)| {
            matches!(self.graph.node(*id), Node::Apply(Op::Min | Op::Max | Op::Abs, _))
        };
        let (choice, factor) = form.terms.iter().find(own)?.clone();
        let mut others = form.terms.iter().filter(|(id, _)| *id != choice && chooses(*id));
        if !others.all(|(id, _)| is_magnitude(id)) {
            return None;
        }
        let Node::Apply(op, operands) = *self.graph.node(choice) else { return None };
        let mut rest = form.clone();
        rest.terms.retain(|(id, _)| *id != choice);
        let is_larger = (op != Op::Min) == factor.is_positive();
        let kind = if is_larger { Kind::Intersection } else { Kind::Union };
        let cases: Vec<(NodeId, BigRational)> = if op == Op::Abs {
            vec![(operands[0], factor.clone()), (operands[0], -factor)]
        } else {
            self.chain(op, choice).into_iter().map(|id| (id, factor.clone())).collect()
        };
        self.work = self.work.checked_sub(cases.len())?;
        let found: Vec<Found> = cases
            .into_iter()
            .map(|(id, factor)| {
                if rest.is_zero() {
                    return self.of_signed(id, factor.is_negative());
                }
                let case = self.forms.of(self.graph, id).scaled(&factor).plus(&rest);
                self.depth += 1;
                let found = self.of_form(&Rc::new(case));
                self.depth -= 1;
                found
            })
            .collect();
        let is_sharp = |found: &Found| found.is_sharp && found.set != kind.neutral();
        let is_sharp = found.iter().all(is_sharp);
        Some(Found { set: self.group(kind, found.iter().map(|found| found.set)), is_sharp })
    }

    /// The operands of a chain of minima or of maxima, from left to right.
    fn chain(&self, op: Op, id: NodeId) -> Vec<NodeId> {
        let (mut found, mut rest) = (Vec::new(), vec![id]);
        let mut seen = FxHashSet::default();
        while let Some(id) = rest.pop() {
            if !seen.insert(id) {
                continue;
            }
            match self.graph.operands(id, op) {
                Some(operands) => rest.extend(operands.iter().rev()),
                None => found.push(id),
            }
        }
        found
    }

    /// The set of a product if all factors but one are ≥ 0 and thin, or of a power with an odd
    /// exponent. `None` for other forms.
    fn factor(&mut self, form: &LinearForm) -> Option<Found> {
        let [(id, coefficient)] = &form.terms[..] else { return None };
        let Node::Apply(op, operands) = *self.graph.node(*id) else { return None };
        if !form.constant.is_zero() || self.depth > DEPTH_LIMIT {
            return None;
        }
        let is_negative = coefficient.is_negative();
        let other = if op == Op::Pow {
            let exponent = self.graph.number(operands[1]).and_then(Constant::as_integer)?;
            (exponent > 0 && exponent % 2 == 1).then_some(operands[0])?
        } else if op == Op::Mul {
            [(1, 0), (0, 1)].into_iter().find_map(|(square, other)| {
                let square = operands[square];
                let is_dropped = self.nonneg.holds(self.graph, square) && self.is_thin_zero(square);
                is_dropped.then_some(operands[other])
            })?
        } else {
            return None;
        };
        Some(Found { is_sharp: false, ..self.of_signed(other, is_negative) })
    }

    fn is_thin_zero(&mut self, id: NodeId) -> bool {
        let form = self.forms.of(self.graph, id);
        match self.sum_of(&form) {
            Some((sum, side, at)) => self.is_thin(&Bound { sum, side, at }),
            None => false,
        }
    }

    /// The set of a form, as a bound on the sum of its terms. The terms themselves are not
    /// examined.
    fn simple(&mut self, form: &Rc<LinearForm>) -> SetId {
        let Some((sum, side, at)) = self.sum_of(form) else {
            return if form.constant.is_positive() { SetId::NONE } else { SetId::ALL };
        };
        let bound = Bound { sum, side, at };
        if self.sums[sum as usize].is_nonneg && !bound.at.is_positive() {
            let is_below = bound.at.is_negative();
            match side {
                Side::Above => return SetId::ALL,
                Side::Below if is_below || self.is_thin(&bound) => return SetId::NONE,
                Side::Below => {}
            }
        }
        self.intern(Set::Bound(bound), Some(Rc::clone(form)))
    }

    /// The sum in a form, and the side and the number of its bound. `None` if the form is constant.
    fn sum_of(&mut self, form: &LinearForm) -> Option<(u32, Side, Rc<BigRational>)> {
        let (_, first) = form.terms.first()?;
        let scale = first.recip();
        let LinearForm { terms, constant } = form.scaled(&scale);
        let side = if first.is_positive() { Side::Below } else { Side::Above };
        let sum = match self.sum_index.get(&terms) {
            Some(sum) => *sum,
            None => self.add_sum(terms),
        };
        Some((sum, side, Rc::new(-constant)))
    }

    /// Adds a sum of terms, and returns its number.
    fn add_sum(&mut self, terms: Vec<(NodeId, BigRational)>) -> u32 {
        let sum = u32::try_from(self.sums.len()).expect("fewer than 2^32 sums");
        let is_nonneg =
            terms.iter().all(|(id, c)| c.is_positive() && self.nonneg.holds(self.graph, *id));
        let number = |(id, c): &(NodeId, BigRational)| (*id, Constant::rational(c.clone()));
        let constants = terms.iter().map(number).collect();
        self.sums.push(Sum { terms: constants, is_nonneg, values: None });
        self.sum_index.insert(terms, sum);
        sum
    }

    /// Returns whether the face of a bound is proven to have no interior.
    pub fn is_thin(&mut self, bound: &Bound) -> bool {
        let Sum { terms, values, .. } = &mut self.sums[bound.sum as usize];
        let values = values.get_or_insert_with(|| self.thinness.sums(self.graph, terms));
        let at = Constant::rational((*bound.at).clone()).bounds();
        values
            .iter()
            .flatten()
            .any(|values| values.iter().all(|value| value.hi < at.lo || at.hi < value.lo))
    }
}
