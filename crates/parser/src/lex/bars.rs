//! Decides which bars open, which close, and which pairs of bars mean `or`.

use crate::lex::token::Token;
use crate::lex::token_kind::TokenKind::{self, *};
use crate::messages::error::{Error, ErrorKind, Fallible};

/// Largest number of bars that may be open at once.
const DEPTH: usize = 12;

#[derive(Clone, Copy, PartialEq, Eq)]
enum Role {
    Opens,
    Closes,
    /// The second of two bars that mean `or`.
    Joins,
}

const ROLES: [Role; 3] = [Role::Opens, Role::Closes, Role::Joins];

/// The cheapest roles for the first bars of a level, up to some last bar. The indices in
/// [`Readings`] are the number of bars that are open after the last bar, and the role of the last
/// bar.
#[derive(Clone, Copy)]
struct Reading {
    /// Sum of the costs of the bars' roles. The reading with the lowest cost wins.
    cost: u32,
    /// True if another choice of roles for the same bars has the same cost.
    is_tied: bool,
    /// Role of the bar before the last bar.
    before: Role,
}

/// Readings up to one bar. Indices: the number of bars open after that bar, and that bar's role.
type Readings = [[Option<Reading>; ROLES.len()]; DEPTH + 1];

/// The bars directly within one pair of brackets.
#[derive(Default)]
struct BarLevel {
    /// Token indices of the bars.
    places: Vec<usize>,
    /// Token indices of relations, `and` and `or`.
    signs: Vec<usize>,
}

impl BarLevel {
    /// Returns whether a relation, `and` or `or` stands between a bar and the bar before it.
    fn compares(&self, bar: usize) -> bool {
        let before = bar.checked_sub(1).map_or(0, |before| self.places[before]);
        let first = self.signs.partition_point(|sign| *sign < before);
        self.signs.get(first).is_some_and(|sign| *sign < self.places[bar])
    }

    /// Returns whether a relation, `and` or `or` stands on each side of a bar, at any distance.
    fn is_between_relations(&self, bar: usize) -> bool {
        let place = self.places[bar];
        self.signs.first().is_some_and(|sign| *sign < place)
            && self.signs.last().is_some_and(|sign| *sign > place)
    }
}

/// Cost of a relation within bars, and of an `or` of two bars that does not join two comparisons.
const UNLIKELY: u32 = 1000;

/// Decides the role of each bar, separately within each pair of brackets. Two adjacent bars after
/// an operand may mean `or` if no bar is open. An implicit product next to a bar costs 1, and the
/// roles with the lowest cost win. Fails if two choices of roles tie, or if none is possible.
pub(crate) fn pair_bars(tokens: &mut Vec<Token>) -> Fallible<()> {
    if !tokens.iter().any(|token| matches!(token.kind, Bar | OpenBar | CloseBar)) {
        return Ok(());
    }
    let mut levels = vec![BarLevel::default()];
    for index in 0..tokens.len() {
        let kind = tokens[index].kind;
        if kind.closer().is_some() {
            levels.push(BarLevel::default());
        } else if kind.is_closer() {
            pair(tokens, &levels.pop().unwrap_or_default())?;
        } else if let Some(level) = levels.last_mut() {
            if matches!(kind, Bar | OpenBar | CloseBar) {
                level.places.push(index);
            } else if kind.is_relation() || matches!(kind, And | Or) {
                level.signs.push(index);
            }
        }
    }
    for level in levels {
        pair(tokens, &level)?;
    }
    tokens.retain(|token| token.kind != Blank);
    Ok(())
}

fn pair(tokens: &mut [Token], level: &BarLevel) -> Fallible<()> {
    let places = &level.places;
    let (Some(&first), Some(&last)) = (places.first(), places.last()) else { return Ok(()) };
    let mut readings: Vec<Readings> = vec![[[None; ROLES.len()]; DEPTH + 1]; places.len() + 1];
    // Before the first bar, the search is in the state that follows an `or`.
    readings[0][0][Role::Joins as usize] =
        Some(Reading { cost: 0, is_tied: false, before: Role::Joins });
    for bar in 0..places.len() {
        for depth in 0..=DEPTH {
            for role in ROLES {
                if let Some(reading) = readings[bar][depth][role as usize] {
                    let is_wrong = depth > 0 && level.compares(bar);
                    let cost = reading.cost + if is_wrong { UNLIKELY } else { 0 };
                    let reading = Reading { cost, ..reading };
                    extend_reading(tokens, level, bar, (depth, role, reading), &mut readings);
                }
            }
        }
    }
    let whole = readings[places.len()][0];
    let found = ROLES.iter().filter_map(|role| Some((*role, whole[*role as usize]?)));
    let Some((mut role, best)) = found.min_by_key(|(_, reading)| reading.cost) else {
        let is_empty = places.len() == 2 && first + 1 == last;
        let kind = if is_empty { ErrorKind::EmptyBars } else { ErrorKind::UnclosedBar };
        let from = if is_empty { first } else { last };
        return Err(Error::new(tokens[from].span.to(tokens[last].span), kind));
    };
    let costs = whole.iter().flatten().filter(|reading| reading.cost == best.cost);
    if best.is_tied || costs.count() > 1 {
        let all = tokens[first].span.to(tokens[last].span);
        return Err(Error::new(all, ErrorKind::AmbiguousBars));
    }
    let (mut bar, mut depth) = (places.len(), 0);
    while bar > 0 {
        let before = readings[bar][depth][role as usize].map_or(Role::Joins, |found| found.before);
        bar -= 1;
        match role {
            Role::Opens => {
                tokens[places[bar]].kind = OpenBar;
                depth -= 1;
            }
            Role::Closes => {
                tokens[places[bar]].kind = CloseBar;
                depth += 1;
            }
            Role::Joins => {
                tokens[places[bar]].kind = Blank;
                bar -= 1;
                tokens[places[bar]].kind = Or;
            }
        }
        role = before;
    }
    Ok(())
}

/// Extends a reading that ends before `bar` by each possible role of `bar`.
fn extend_reading(
    tokens: &[Token],
    level: &BarLevel,
    bar: usize,
    (depth, role, reading): (usize, Role, Reading),
    readings: &mut [Readings],
) {
    let places = &level.places;
    let index = places[bar];
    let kind = |index: usize| tokens.get(index).map_or(Blank, |token| token.kind);
    let is_bar = |kind: TokenKind| matches!(kind, Bar | OpenBar | CloseBar);
    let follows_bar = bar > 0 && places[bar - 1] + 1 == index;
    let (before, after) = (index.checked_sub(1).map_or(Blank, kind), kind(index + 1));
    let ends = if follows_bar { role == Role::Closes } else { before.ends_operand() };
    let begins = |kind: TokenKind| kind.begins_operand() || is_bar(kind) || kind == Minus;
    let mut add = |bars: usize, depth: usize, next: Role, cost: u32| {
        let cost = reading.cost + cost;
        let place = &mut readings[bar + bars][depth][next as usize];
        let is_tied = match place {
            Some(other) if other.cost < cost => return,
            Some(other) if other.cost == cost => true,
            _ => reading.is_tied,
        };
        *place = Some(Reading { cost, is_tied, before: role });
    };
    let typed = tokens[index].kind;
    if typed != CloseBar && depth < DEPTH && (!ends || begins(after)) {
        // A bar that opens directly after another bar costs as much as an implicit product.
        add(1, depth + 1, Role::Opens, (ends || follows_bar).into());
    }
    if typed != OpenBar && depth > 0 && ends {
        add(1, depth - 1, Role::Closes, (!is_bar(after) && after.begins_operand()).into());
    }
    let touches = || tokens[index].span.end == tokens[index + 1].span.start;
    let goes_on = || {
        let Some(beyond) = tokens.get(index + 2) else { return false };
        let is_apart = beyond.span.start > tokens[index + 1].span.end;
        begins(beyond.kind) && (!is_bar(beyond.kind) || is_apart)
    };
    if typed == Bar && after == Bar && depth == 0 && ends && touches() && goes_on() {
        add(2, depth, Role::Joins, if level.is_between_relations(bar) { 1 } else { UNLIKELY });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lex::scanner::scan;
    use crate::limits::Limits;

    fn kind(text: &str) -> Option<ErrorKind> {
        let mut statements = scan(text, &Limits::default()).expect("brackets are paired");
        pair_bars(&mut statements[0]).err().map(|e| e.kind)
    }

    /// The text with bars replaced: `(` for an opening bar, `)` for a closing one, `∨` for `or`.
    fn paired(text: &str) -> String {
        let mut statements = scan(text, &Limits::default()).expect("brackets are paired");
        pair_bars(&mut statements[0]).expect("bars are paired");
        let shown = |token: &Token| match token.kind {
            OpenBar => '(',
            CloseBar => ')',
            Or => '∨',
            _ => text[token.span.range()].chars().next().expect("a sign"),
        };
        statements[0].iter().map(shown).collect()
    }

    #[test]
    fn bars_within_bars() {
        for (text, expected) in [
            ("||x|-1|", "((x)-1)"),
            ("|x-|y+z||", "(x-(y+z))"),
            ("||x||", "((x))"),
            ("||x|-|y||", "((x)-(y))"),
            ("|x|-y|z|", "(x)-y(z)"),
            ("2||x|-1|", "2((x)-1)"),
            ("|||x|-2|-1|", "(((x)-2)-1)"),
            ("|x||y||z|", "(x)(y)(z)"),
            (r"\left|x\left|y\right|z\right|", "(x(y)z)"),
        ] {
            assert_eq!(paired(text), expected, "{text}");
        }
    }

    #[test]
    fn bars_pair_in_one_way_or_not_at_all() {
        for text in ["|x|", "|x|+|y|", "|x||y|", "2|x|y", "|x|-y|z|", "(|x|)|y|", "|(|x|)|"] {
            assert_eq!(kind(text), None, "{text}");
        }
        for text in ["|x|y|z|", "|x| 2|y|", "|x| y + 2 |z|"] {
            assert_eq!(kind(text), Some(ErrorKind::AmbiguousBars), "{text}");
        }
        assert_eq!(kind("2 |||x|-1|"), Some(ErrorKind::UnclosedBar));
        assert_eq!(kind("|x"), Some(ErrorKind::UnclosedBar));
        assert_eq!(kind("(|x)|"), Some(ErrorKind::UnclosedBar));
        assert_eq!(kind("||"), Some(ErrorKind::EmptyBars));
        for text in ["x > 0 || y > 0", "(x > 0 || |y| > 1)", "|x| > 0||y > 0"] {
            assert_eq!(kind(text), None, "{text}");
        }
        for (text, joined) in [
            ("x>1 || y>1 || z>1", "x>1∨y>1∨z>1"),
            ("|x|<1 || |y|<1 || |z|<1", "(x)<1∨(y)<1∨(z)<1"),
            ("x>0 && y>0 || z>0 && x<0 || y<0", "x>0&y>0∨z>0&x<0∨y<0"),
            ("||x|-1| > 2 || y < 1 || 2|z| > x", "((x)-1)>2∨y<1∨2(z)>x"),
        ] {
            assert_eq!(paired(text), joined);
        }
    }
}
