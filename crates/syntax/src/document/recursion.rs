//! Finds definitions that depend on themselves.

use rustc_hash::FxHashMap;
use zeroset_parser::tree::ast::Definition;
use zeroset_parser::tree::built_statement::BuiltStatement;
use zeroset_parser::{Error, ErrorKind, Fallible};

/// Fails if a definition depends on itself, directly or through other definitions.
pub(crate) fn no_recursion(definitions: &[(&Definition, &BuiltStatement)]) -> Fallible<()> {
    const NEW: u8 = 0;
    const OPEN: u8 = 1;
    const DONE: u8 = 2;
    let index: FxHashMap<&str, usize> = definitions
        .iter()
        .enumerate()
        .map(|(index, (definition, _))| (definition.name.text.as_str(), index))
        .collect();
    let uses: Vec<Vec<usize>> = definitions
        .iter()
        .map(|(_, built)| {
            let mut uses: Vec<usize> =
                built.used.iter().filter_map(|name| index.get(name.as_str()).copied()).collect();
            uses.sort_unstable();
            uses
        })
        .collect();
    let mut state = vec![NEW; definitions.len()];
    for start in 0..definitions.len() {
        if state[start] != NEW {
            continue;
        }
        // Stack of a depth-first search: definitions, each with the number of its uses already
        // followed.
        let mut path: Vec<(usize, usize)> = vec![(start, 0)];
        state[start] = OPEN;
        while let Some((at, followed)) = path.last_mut() {
            let Some(&next) = uses[*at].get(*followed) else {
                state[*at] = DONE;
                path.pop();
                continue;
            };
            *followed += 1;
            match state[next] {
                NEW => {
                    state[next] = OPEN;
                    path.push((next, 0));
                }
                OPEN => {
                    let from = path.iter().position(|(at, _)| *at == next).unwrap_or(0);
                    let mut cycle: Vec<usize> = path[from..].iter().map(|(at, _)| *at).collect();
                    // The reported cycle starts with the definition that comes first in the text.
                    let first = (0..cycle.len()).min_by_key(|i| cycle[*i]).unwrap_or(0);
                    cycle.rotate_left(first);
                    let name = |index: &usize| definitions[*index].0.name.text.clone();
                    let kind = ErrorKind::Recursion { cycle: cycle.iter().map(name).collect() };
                    return Err(Error::new(definitions[cycle[0]].0.name.span, kind));
                }
                _ => {}
            }
        }
    }
    Ok(())
}
